"""Local illumination environments: cells of an octree that know which lights shine into them, and what blocks each
(`tracer.neighbours.environments`).

Before shading, the cells are settled that primary hits lie in, and those in which rays of the last frame have ended.
In shadow testing `find` leads each point to its cell, `select` passes over the lights that are hidden from all of its
vector, and `choose` answers the others' rays by what their cells know, asking the blockers of a light alone.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from tracer.culling.shadow_testing import shadow_batch_in
from tracer.culling.stages import call_at, scratch_of, selects
from tracer.culling.verdicts import Answered, CullReason, Verdict
from tracer.geometry.memory import without_refcount
from tracer.methods.interface import FrameView, Stage
from tracer.methods.spatial_cache import NOWHERE, WORDS, CellsOfSpace, hits_in_block, want_hits
from tracer.neighbours.cells_of_space import record_cells, want
from tracer.neighbours.environments.ask import answer, find_cells, select_lights
from tracer.neighbours.environments.octree import cells_at, environments_at
from tracer.neighbours.environments.sample import seen_points, settle_by_samples
from tracer.neighbours.environments.store import By, EnvironmentStore
from tracer.runtime.kernels import kernel, native_callback
from tracer.shading.points import points_in
from tracer.shading.primary import blocks_of
from tracer.shading.wave import wave_in
from tracer.simd import any_lane, bits_of, i64_at, local_memory, store

CELL_ROWS = 1


@native_callback
def find(data, call, light, count, counts):
    """In which cell does the shadow ray of each point end?"""
    given, environments, cells = call_at(call), environments_at(data), scratch_of(call_at(call))[0].view(np.int32)
    find_cells(environments, points_in(given.points), count, cells)
    if given.bounce == 0:
        record_cells(environments.cell, given.place, wave_in(given.rays, count), cells)


@native_callback
def select(data, call, light, count, counts):
    """Which lights must each vector of points look at?"""
    given, environments = call_at(call), environments_at(data)
    if selects(environments.looks, count):
        select_lights(environments, count, scratch_of(given)[0].view(np.int32))


@native_callback
def choose(data, call, light, count, counts):
    """Answer the rays to a light whose blockers are known."""
    given, environments = call_at(call), environments_at(data)
    if light >= environments.held:
        return
    points, batch, sample = points_in(given.points), shadow_batch_in(given.shadows), given.samples[given.sample]
    place, cells = (sample[0], sample[1], sample[2]), scratch_of(given)[0].view(np.int32)
    answer(environments, points, batch, light, place, count, cells, i64_at(counts))


@kernel
def want_in_tiles(data, camera, tiles, numbers, buffers):
    """Want the cells in which primary hits of some tiles lie.

    Tiles have `numbers` (k,) among all (n, 5); their hits are in the buffers; `data` is the address of an
    `EnvironmentView`."""
    environments, buffers, cells = environments_at(data), without_refcount(buffers), local_memory(64)
    for number in numbers:
        for block in range(blocks_of(tiles[number])):
            hit, _depth, (x, y, z) = hits_in_block(camera, buffers, tiles[number], block)
            if any_lane(hit):
                store(cells, cells_at(environments, x, y, z))
                want(environments.wanted, environments.open, 1, cells, bits_of(hit))


class Environments(CellsOfSpace):
    """Settles cells by proofs, and culls by what they know."""

    store: EnvironmentStore | None
    coarse = 0  # how often cells are divided at most, 0 for as often as is worth it

    def new_store(self, frame: FrameView, memory: float, by_ray: bool) -> EnvironmentStore:
        given = self.services.world, frame.shading.lamps, frame.workers, memory, by_ray
        return EnvironmentStore(*given, self.services.clock, self.coarse)

    def prepare(self, frame: FrameView) -> None:
        store, settings = self.store, frame.settings
        assert store is not None, "updated before"

        def want() -> None:
            want_hits(frame, want_in_tiles, store.view(np.zeros((0, WORDS), np.int64), NOWHERE), 16)

        if settings.certificates > 0 and store.waits:
            self._counts = store.work(want, settings.certificate_seconds, frame.cancel, self.settles_by(frame))

    def settles_by(self, frame: FrameView) -> By | None:
        """What finds out about cells, other than proofs."""
        return None

    def stages(self, frame: FrameView, worker: int, learns: bool) -> list[Stage]:
        assert self.store is not None, "updated before"
        if not len(self.store.places):
            return []
        looks = np.zeros((len(self.store.places), WORDS), np.int64)
        view = self.store.view(looks, self._cell if learns else NOWHERE)
        chooses = choose if self.store.held else None
        return [Stage(view, find=find, select=select, choose=chooses, rows=CELL_ROWS, looks=looks)]

    def layers(self, frame: FrameView) -> dict[str, Any]:
        assert self.store is not None, "updated before"
        found = super().layers(frame)
        return found | {"cell lights": self.store.asked_in(found["cells"])}

    def because(self, answered: Answered) -> CullReason:
        store, point = self.store, np.array(answered.point, np.float32)
        if store is None:
            return CullReason(Verdict.ANSWERED)
        state, named = store.describe(answered.primitive, point, answered.light)
        tree, cell = store.tree, store.tree.leaf_at(point)
        asked, side = int(store.asked_in(np.array(cell, np.int32))), 2.0 ** tree.cells[cell, 3] * tree.grid.side
        told = (
            f"The cell is {side:.3g} wide, on level {tree.levels - int(tree.cells[cell, 3])} of the octree; "
            f"it asks {asked:,} of {len(store.places):,} lights."
        )
        verdict = Verdict.CELL_LIT if answered.lit else Verdict.CELL_FULL
        return CullReason(Verdict.CELL_TESTED if state == "candidates" else verdict, named, told)


class SampledEnvironments(Environments):
    """As published: settles cells by rays to some of their points."""

    coarse = 6

    def settles_by(self, frame: FrameView) -> By:
        points = seen_points(frame.buffers.primitive, frame.buffers.depth, frame.rays)
        return settle_by_samples(self.services.world, points)
