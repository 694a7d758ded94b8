"""Local illumination environments: cells of an octree that know which lights shine into them, and what blocks each
(`tracer.neighbours.environments`).

Before shading, the cells are settled that primary hits lie in, and those in which rays of the last frame have ended.
In shadow testing `find` leads each point to its cell, `select` passes over the lights that are hidden from all of its
vector, and `choose` answers the others' rays by what their cells know, asking the blockers of a light alone.
"""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tracer.culling.shadow_testing import shadow_batch_in
from tracer.culling.stages import call_at, scratch_of, vectors
from tracer.culling.verdicts import Answered, CullReason, Verdict
from tracer.geometry.camera import primary_direction
from tracer.geometry.memory import without_refcount
from tracer.methods.interface import FrameView, Stage
from tracer.methods.spatial_cache import NOWHERE, CellsOfSpace
from tracer.neighbours.environments.ask import answer, find_cells, select_lights
from tracer.neighbours.environments.octree import cells_at, environments_at
from tracer.neighbours.environments.sample import seen_points, settle_by_samples
from tracer.neighbours.environments.store import EnvironmentStore
from tracer.runtime.kernels import kernel, native_callback
from tracer.runtime.parallel import for_each_chunk
from tracer.shading.points import points_in
from tracer.shading.primary import block_at, blocks_of
from tracer.shading.wave import wave_in
from tracer.simd import (
    address_of,
    bits_of,
    gather_f32x16,
    gather_i32x16,
    i32_at,
    i32x16,
    i64_at,
    local_memory,
    lowest_bit,
    store,
    to_f32,
)
from tracer.simd import select as choose_lanes
from tracer.simd.records import pack

CELL_ROWS = 1
WORDS = 16  # of 64 vectors: as many as the waves of four tiles have


@native_callback
def find(data, call, light, count, counts):
    """In which cell does the shadow ray of each point end?"""
    given, environments, cells = call_at(call), environments_at(data), scratch_of(call_at(call))[0].view(np.int32)
    find_cells(environments, points_in(given.points), count, cells)
    if given.bounce == 0 and len(environments.cell) > 0:
        wave = wave_in(given.rays, count)
        for i in range(wave.size):
            environments.cell[given.place[wave.pixel[i]]] = cells[i]


@native_callback
def select(data, call, light, count, counts):
    """Which lights must each vector of points look at?"""
    given, environments = call_at(call), environments_at(data)
    if vectors(count) <= 64 * environments.looks.shape[1]:
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
    environments, buffers, lanes = environments_at(data), without_refcount(buffers), local_memory(64)
    width, primitives, depths, eye = (
        np.int32(buffers.primitive.shape[1]),
        buffers.primitive,
        buffers.depth,
        camera.origin,
    )
    for number in numbers:
        tile = tiles[number]
        for block in range(blocks_of(tile)):
            x, y, inside = block_at(tile, block)
            place = choose_lanes(inside, y * width + x, i32x16(0))
            hit = inside & (gather_i32x16(address_of(primitives), place) >= np.int32(0))
            if bits_of(hit) == 0:
                continue
            depth = gather_f32x16(address_of(depths), place)
            dx, dy, dz = primary_direction(camera, to_f32(x), to_f32(y))
            at = cells_at(environments, eye[0] + depth * dx, eye[1] + depth * dy, eye[2] + depth * dz)
            store(lanes, at)
            rest, before = bits_of(hit), -1
            while rest != 0:
                cell = i32_at(lanes)[lowest_bit(rest)]
                rest &= rest - 1
                if cell != before and environments.open[cell]:
                    environments.wanted[cell] = True
                before = cell


class Environments(CellsOfSpace):
    """Settles cells by proofs, and culls by what they know."""

    store: EnvironmentStore | None
    coarse = 0  # how often cells are divided at most, 0 for as often as is worth it

    def update(self, frame: FrameView) -> None:
        settings, lamps = frame.settings, frame.shading.lamps
        if self.store is None or self._memory != settings.certificate_memory:
            memory, by_ray = 1e6 * settings.certificate_memory, settings.accelerator == "kdtree"
            world = self.services.world
            clock = self.services.clock
            self.store = EnvironmentStore(world, lamps, frame.workers, memory, by_ray, clock, self.coarse)
            self._memory = settings.certificate_memory
        self.store.keep_within()
        self.store.update(lamps, frame.resting)

    def prepare(self, frame: FrameView) -> None:
        store, settings = self.store, frame.settings
        assert store is not None, "updated before"
        if settings.certificates > 0 and store.waits:
            want = partial(self._want, frame, store)
            self._counts = store.work(want, settings.certificate_seconds, frame.cancel)

    def _want(self, frame: FrameView, store: EnvironmentStore) -> None:
        """Want the cells in which primary hits lie."""
        view, shares = (
            store.view(np.zeros((0, WORDS), np.int64), NOWHERE),
            np.array_split(np.arange(len(frame.tiles)), 16),
        )
        block = pack(view)

        def work(chunk: int, worker: int) -> None:
            want_in_tiles(block.ctypes.data, frame.rays, frame.tiles, shares[chunk], frame.buffers)

        for_each_chunk(work, len(shares), frame.workers, frame.cancel)

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
        state, named = store.state_at(point, answered.light)
        tree, cell = store.tree, store.tree.leaf_at(point)
        asked, side = int(store.asked_in(np.array(cell, np.int32))), 2.0 ** tree.cells[cell, 3] * tree.frame.side
        told = (
            f"The cell is {side:.3g} wide, on level {tree.frame.levels - int(tree.cells[cell, 3])} of the octree; "
            f"it asks {asked:,} of {len(store.places):,} lights."
        )
        verdict = Verdict.CELL_LIT if answered.lit else Verdict.CELL_FULL
        return CullReason(Verdict.CELL_TESTED if state == "candidates" else verdict, named, told)

    def explain(self, primitive: int, point: NDArray[np.float32], light: int) -> tuple[str, tuple[int, ...]] | None:
        return None if self.store is None else self.store.state_at(point, light)


class SampledEnvironments(Environments):
    """As published: settles cells by rays to some of their points."""

    coarse = 6

    def prepare(self, frame: FrameView) -> None:
        store, settings = self.store, frame.settings
        assert store is not None, "updated before"
        if settings.certificates > 0 and store.waits:
            points = seen_points(frame.buffers.primitive, frame.buffers.depth, frame.rays)
            want, by = partial(self._want, frame, store), settle_by_samples(self.services.world, points)
            self._counts = store.work(want, settings.certificate_seconds, frame.cancel, by)
