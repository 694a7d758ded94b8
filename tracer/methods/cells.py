"""The paper's method with cells of large triangles in the place of primitives (`tracer.culling.cells`)."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from tracer.culling.cells import cells_at, first_units
from tracer.culling.modes import point_modes_in
from tracer.culling.stages import call_at, scratch_of, vectors
from tracer.methods.interface import FrameView
from tracer.methods.paper import Paper, modes_at
from tracer.runtime.kernels import native_callback
from tracer.shading.points import points_in
from tracer.shading.wave import wave_in
from tracer.simd import address_of, load_f32x16, load_i32x16, store


@native_callback
def find(data, call, light, count, counts):
    """Which cell is each point of the wave in?  Its modes have not been looked up yet."""
    given, first = call_at(call), modes_at(data).first
    points, wave = points_in(given.points), wave_in(given.rays, count)
    found = point_modes_in(scratch_of(given))
    for v in range(vectors(count)):
        found.looked_up[v], at = 0, 64 * v
        primitive = load_i32x16(address_of(points.primitive) + at)
        weights = load_f32x16(address_of(wave.u) + at), load_f32x16(address_of(wave.v) + at)
        store(address_of(found.unit) + at, cells_at(first, primitive, *weights))


class Cells(Paper):
    """Culls by the modes of cells, and sets them."""

    finds_units = find

    @cached_property
    def _first(self) -> NDArray[np.int32]:
        return first_units(self.services.world.placed.triangles, self.services.world.object_of)

    def first_units(self) -> NDArray[np.int32]:
        return self._first

    def layers(self, frame: FrameView) -> dict[str, NDArray]:
        return {"cells": frame.units}
