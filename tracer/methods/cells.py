"""The paper's method with cells of large triangles in the place of primitives (`tracer.culling.cells`)."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from tracer.culling.cells import first_units
from tracer.methods.interface import FrameView
from tracer.methods.paper import Paper


class Cells(Paper):
    """Culls by the modes of cells, and sets them."""

    @cached_property
    def _first(self) -> NDArray[np.int32]:
        return first_units(self.services.world.placed.triangles, self.services.world.object_of)

    def first_units(self) -> NDArray[np.int32]:
        return self._first

    def layers(self, frame: FrameView) -> dict[str, NDArray]:
        return {"cells": frame.units}
