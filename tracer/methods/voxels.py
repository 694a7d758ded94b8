"""Voxel occlusion testing: cubes of space that are known to be lit or in shadow as a whole
(`tracer.neighbours.voxels`).

Before shading, the voxels of the scene are classified for each point light, anew where it has moved.  In shadow testing
`find` leads each point to its voxel, and `choose` answers its rays: by the state of that voxel, or of the first on the
way to the light that has one, with tests of what lies in those before.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from tracer.culling.counters import STEPS
from tracer.culling.modes import POINT_MODE_ROWS, look_up, point_modes_in, shadow_modes
from tracer.culling.shadow_testing import shadow_batch_in
from tracer.culling.stages import call_at, scratch_of, vectors
from tracer.culling.verdicts import Answered, CullReason, Verdict
from tracer.methods.interface import FrameView, Stage
from tracer.methods.spatial_cache import NOWHERE, CellsOfSpace
from tracer.neighbours.cells_of_space import answer_in_cells, record_cells
from tracer.neighbours.voxels.store import VoxelStore
from tracer.neighbours.voxels.tell import Stop
from tracer.neighbours.voxels.walk import full_and_null, voxel_view_at, walk
from tracer.runtime.kernels import native_callback
from tracer.shading.points import points_in
from tracer.shading.wave import wave_in
from tracer.simd import address_of, bits_of, i32x16, i64_at, load_i32x16, load_three, mask16, ones, select, store
from tracer.visibility.grid import cubes_at


@native_callback
def find(data, call, light, count, counts):
    """In which voxel does the shadow ray of each point end?"""
    given, voxels = call_at(call), voxel_view_at(data)
    grid = voxels.grid
    points, found = points_in(given.points), point_modes_in(scratch_of(given))
    for v in range(vectors(count)):
        found.looked_up[v] = 0
        x, y, z = load_three(points.lifted, v)
        store(address_of(found.unit) + 64 * v, cubes_at(grid, x, y, z, grid.nx * grid.ny * grid.nz))
    if given.bounce == 0:
        record_cells(voxels.cell, given.place, wave_in(given.rays, count), found.unit)


@native_callback
def choose(data, call, light, count, counts):
    """Answer the rays to a light of which voxels are known."""
    given, voxels = call_at(call), voxel_view_at(data)
    if light >= len(voxels.known) or voxels.known[light] == 0:
        return
    points, batch, found = points_in(given.points), shadow_batch_in(given.shadows), point_modes_in(scratch_of(given))
    counted, sample = i64_at(counts), given.samples[given.sample]
    place, outside = (sample[0], sample[1], sample[2]), np.int32(voxels.grid.nx * voxels.grid.ny * voxels.grid.nz)
    for v in range(vectors(count)):
        live = np.int64(batch.live[v])
        if live == 0:
            continue
        look_up(voxels.words, v, found)
        full, null = full_and_null(shadow_modes(found, light, v))
        full, null = full & live, null & live
        unit, walked = load_i32x16(address_of(found.unit) + 64 * v), np.int64(0)
        counted[STEPS] += ones(live) if voxels.by_ray else 1
        rest, end = live & ~(full | null) & bits_of(unit < outside), load_three(points.lifted, v)
        if rest != 0:
            begin = select(mask16(rest), unit, i32x16(np.int32(0)))
            blocked, lit = walk(voxels, place, light, end, begin, rest, counted)
            walked = blocked | lit
            full, null = full | blocked, null | lit
        answer_in_cells(batch, v, full, null, walked, voxels.resting, place, end, counted)


class Voxels(CellsOfSpace):
    """Classifies voxels, and culls by their states."""

    store: VoxelStore | None

    def new_store(self, frame: FrameView, memory: float, by_ray: bool) -> VoxelStore:
        world, clock = self.services.world, self.services.clock
        return VoxelStore(world, len(frame.lights), frame.workers, memory, by_ray, clock)

    def prepare(self, frame: FrameView) -> None:
        assert self.store is not None, "updated before"
        settings = frame.settings
        if settings.certificates > 0:
            self._counts = self.store.classify(settings.certificate_seconds, frame.workers, frame.cancel)

    def stages(self, frame: FrameView, worker: int, learns: bool) -> list[Stage]:
        assert self.store is not None, "updated before"
        return [
            Stage(self.store.view(self._cell if learns else NOWHERE), find=find, choose=choose, rows=POINT_MODE_ROWS)
        ]

    def layers(self, frame: FrameView) -> dict[str, Any]:
        assert self.store is not None, "updated before"
        return super().layers(frame) | {"voxels": self.store.shown()}

    def because(self, answered: Answered) -> CullReason:
        point = np.array(answered.point, np.float32)
        found = None if self.store is None else self.store.walked(point, answered.light)
        if found is None or self.store is None:
            return CullReason(Verdict.ANSWERED)
        verdict = Verdict.VOXEL_LIT if answered.lit else Verdict.VOXEL_FULL
        named = (found.blocker,) if found.blocker >= 0 else ()
        said = found.in_words(self.store.shown(), answered.light)
        return CullReason(verdict if found.stop is Stop.HERE else Verdict.VOXEL_WALK, named, said)
