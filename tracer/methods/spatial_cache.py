"""What methods have in common that keep what is proved in a store, and first ask about what primary rays hit."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.geometry.camera import primary_direction
from tracer.methods.interface import FrameView, Services, ShadowMethod
from tracer.runtime.kernels import inlined
from tracer.runtime.parallel import for_each_chunk
from tracer.shading.primary import block_at
from tracer.simd import address_of, gather_f32x16, gather_i32x16, i32x16, select, to_f32
from tracer.simd.records import pack
from tracer.statistics import FrameStatistics
from tracer.visibility.budget import Counts

NOWHERE = np.empty(0, np.int32)  # instead of the cells of pixels, for further samples
WORDS = 16  # of 64 vectors, in the bits of those that must look at a light: as many as the waves of four tiles have


@inlined
def hits_in_block(camera, buffers, tile, block):
    """What the primary rays of a tile's block have hit, by the buffers: (whether anything, depth, point)."""
    x, y, inside = block_at(tile, block)
    place = select(inside, y * np.int32(buffers.primitive.shape[1]) + x, i32x16(0))
    hit = inside & (gather_i32x16(address_of(buffers.primitive), place) >= np.int32(0))
    depth, eye = gather_f32x16(address_of(buffers.depth), place), camera.origin
    dx, dy, dz = primary_direction(camera, to_f32(x), to_f32(y))
    return hit, depth, (eye[0] + depth * dx, eye[1] + depth * dy, eye[2] + depth * dz)


def want_hits(frame: FrameView, kernel: Callable[..., None], view: NamedTuple, shares: int) -> None:
    """Let a kernel (address of the view, camera, tiles, numbers of some of these, buffers) want what is to be known at
    primary hits, in so many shares of the picture."""
    block, numbers = pack(view), np.array_split(np.arange(len(frame.tiles)), shares)

    def work(chunk: int, worker: int) -> None:
        kernel(block.ctypes.data, frame.rays, frame.tiles, numbers[chunk], frame.buffers)

    for_each_chunk(work, len(numbers), frame.workers, frame.cancel)


class WithStore(ShadowMethod):
    """Has a store of what is proved, which says what it knows of a light at a point (`describe`) and what memory it
    takes (`bytes`)."""

    def __init__(self, services: Services) -> None:
        super().__init__(services)
        self.store: Any = None
        self.made_now = False  # whether the store has been set up in this frame
        self._counts = Counts()

    def begin(self, frame: FrameView) -> None:
        self._counts = Counts()

    def report(self, statistics: FrameStatistics) -> None:
        statistics.add_made(self._counts)

    def explain(self, primitive: int, point: NDArray[np.float32], light: int) -> tuple[str, tuple[int, ...]]:
        return ("none", ()) if self.store is None else self.store.describe(primitive, point, light)

    def forget(self) -> None:
        self.store = None

    @property
    def memory_bytes(self) -> int:
        return 0 if self.store is None else self.store.bytes


class CellsOfSpace(WithStore):
    """Has a store of cells of space, made anew where the memory that it may take is another, and shows the cell that
    each pixel's point is in."""

    def __init__(self, services: Services) -> None:
        super().__init__(services)
        self._memory, self._cell = 0.0, NOWHERE

    def begin(self, frame: FrameView) -> None:
        super().begin(frame)
        self._cell = np.full(frame.settings.width * frame.settings.height, -1, np.int32)

    def new_store(self, frame: FrameView, memory: float, by_ray: bool) -> Any:
        """A store in so many bytes of memory; `by_ray` if its steps and tests are counted ray by ray."""
        raise NotImplementedError

    def update(self, frame: FrameView) -> None:
        settings = frame.settings
        if self.store is None or self._memory != settings.certificate_memory:
            self._memory = settings.certificate_memory
            self.store = self.new_store(frame, 1e6 * self._memory, settings.accelerator == "kdtree")
        self.store.update(frame.shading.lamps, frame.resting)

    def layers(self, frame: FrameView) -> dict[str, Any]:
        assert self.store is not None, "updated before"
        cell = self._cell.reshape(frame.buffers.primitive.shape)
        return {"cells": cell, "certificates": self.store.at_pixels(cell)}

    def report(self, statistics: FrameStatistics) -> None:
        super().report(statistics)
        if self.store is not None:
            statistics.say(self.store.told)
