"""What methods have in common that keep what they know in cells of space, and show the cell that each pixel's point is
in."""

from __future__ import annotations

from typing import Any

import numpy as np

from tracer.methods.interface import FrameView, Services, ShadowMethod
from tracer.statistics import FrameStatistics
from tracer.visibility.budget import Counts

NOWHERE = np.empty(0, np.int32)  # instead of the cells of pixels, for further samples


class CellsOfSpace(ShadowMethod):
    """Has a store of cells, made anew where the memory that it may take is another."""

    def __init__(self, services: Services) -> None:
        super().__init__(services)
        self.store: Any = None
        self._memory = 0.0
        self._counts, self._cell = Counts(), NOWHERE

    def begin(self, frame: FrameView) -> None:
        self._counts = Counts()
        self._cell = np.full(frame.settings.width * frame.settings.height, -1, np.int32)

    def layers(self, frame: FrameView) -> dict[str, Any]:
        assert self.store is not None, "updated before"
        cell = self._cell.reshape(frame.buffers.primitive.shape)
        return {"cells": cell, "certificates": self.store.at_pixels(cell)}

    def report(self, statistics: FrameStatistics) -> None:
        statistics.add_made(self._counts)
        if self.store is not None:
            statistics.say(self.store.told)

    def forget(self) -> None:
        self.store = None

    @property
    def memory_bytes(self) -> int:
        return 0 if self.store is None else self.store.bytes
