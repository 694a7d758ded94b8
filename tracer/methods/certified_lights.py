"""Certified lights: lights that are proved to shine on nothing in a region are not even looked at.

This is what the method `certified` does where a scene has more lights than a cell's word has room for.  Before shading,
the regions are certified that primary hits lie in, and those in which rays of the last frame have ended
(`tracer.neighbours.regions`).  In shadow testing `select` says which lights each vector of points must look at.  Of the
lamps that are left, `approach` finds out from which points they are hidden, sample by sample, by what hides them from
neighbours (`tracer.neighbours.area_lights.recent_occluders`); `choose` answers these rays.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tracer.culling.shadow_testing import shadow_batch_in
from tracer.culling.stages import call_at, looked_at, scratch_of, vectors
from tracer.culling.verdicts import Answered, CullReason, Verdict
from tracer.geometry.memory import aligned_rows, without_refcount
from tracer.geometry.rays import RAY_OFFSET
from tracer.methods.interface import FrameView, Services, Stage
from tracer.methods.spatial_cache import WORDS, WithStore, hits_in_block, want_hits
from tracer.neighbours.area_lights.lamp_answers import ALL, HIDDEN_SAMPLE_ROWS, answer_hidden, hidden_samples_in
from tracer.neighbours.area_lights.recent_occluders import RecentOccluders, find_hidden, is_lamp
from tracer.neighbours.regions.lookup import look, want_around
from tracer.neighbours.regions.store import RegionStore, RegionView
from tracer.runtime.kernels import kernel, native_callback
from tracer.scene.lights import Lamps
from tracer.shading.points import points_in
from tracer.shading.primary import blocks_of
from tracer.simd import any_lane, i64_at, maximum
from tracer.simd.records import I64x2D, reading
from tracer.visibility.budget import Budget
from tracer.visibility.error_bounds import BOX, CORNER_ERROR, ROW, SureHitLength

SET_UP = 1.5e-6  # seconds for each primitive
NO_TRIANGLES = aligned_rows(0, ROW)


class Selection(NamedTuple):
    """What a worker is given: all regions; looks (lights, WORDS) int64, into which `select` puts its answer; and what
    is asked about lamps."""

    regions: RegionView
    looks: I64x2D
    recent: RecentOccluders


selection_at = reading(Selection)


@native_callback
def select(data, call, light, count, counts):
    """Which lights must each vector of points look at?"""
    given, selection = call_at(call), selection_at(data)
    look(selection.regions, points_in(given.points), count, selection.looks)


@native_callback
def approach(data, call, light, count, counts):
    """Find from which points a lamp is hidden, and pass over it where that is all of them."""
    given, selection = call_at(call), selection_at(data)
    looks, recent = selection.looks, selection.recent
    if not is_lamp(recent, light):
        return
    points, batch = points_in(given.points), shadow_batch_in(given.shadows)
    hidden, looked = hidden_samples_in(scratch_of(given)), looked_at(looks, light, count)
    find_hidden(recent, points, batch, hidden, light, looked, count, i64_at(counts))
    if looked != 0:
        for v in range(vectors(count)):
            if hidden.some[v] == ALL:
                looks[light, v >> 6] &= ~(np.int64(1) << (v & 63))


@native_callback
def choose(data, call, light, count, counts):
    """Answer those rays of a lamp's sample that are certainly blocked."""
    given, selection = call_at(call), selection_at(data)
    if is_lamp(selection.recent, light):
        hidden, batch = hidden_samples_in(scratch_of(given)), shadow_batch_in(given.shadows)
        answer_hidden(hidden, given.nth, count, batch, i64_at(counts))


@kernel
def want_in_tiles(selection, camera, tiles, numbers, buffers):
    """Want the regions in which primary hits of some tiles lie.

    Tiles have `numbers` (k,) among all (n, 5); their hits are in the buffers; `selection` is the address of a
    `Selection`."""
    regions, buffers, eye = selection_at(selection).regions, without_refcount(buffers), camera.origin
    largest = max(abs(eye[0]), max(abs(eye[1]), abs(eye[2])))
    for number in numbers:
        for block in range(blocks_of(tiles[number])):
            hit, depth, point = hits_in_block(camera, buffers, tiles[number], block)
            if any_lane(hit):
                want_around(regions, point, np.float32(2 * RAY_OFFSET) * (maximum(depth, -depth) + largest), hit)


class CertifiedLights(WithStore):
    """Finds out which lights matter to regions, within a budget, and looks at no others."""

    store: RegionStore | None

    def __init__(self, services: Services) -> None:
        super().__init__(services)
        self._rows = NO_TRIANGLES  # what recent occluders are taken from, where there are lamps

    def update(self, frame: FrameView) -> None:
        self.made_now = self.store is None
        if self.store is None:
            self.store = RegionStore(self.services.world, frame.shading.lamps, self.services.clock)
        self.store.update(frame.shading.lamps)

    def prepare(self, frame: FrameView) -> None:
        self.certify(frame, frame.settings.certificate_seconds)

    def take_requests(self, frame: FrameView, seconds: float) -> None:
        """Regions are wanted in any case."""

    def certify(self, frame: FrameView, seconds: float) -> None:
        """Certify regions for so many seconds, at most."""
        store = self.store
        assert store is not None, "updated before"
        selection = Selection(store.view(), np.zeros((0, WORDS), np.int64), self._recent(frame.shading.lamps))
        want_hits(frame, want_in_tiles, selection, 8 * frame.workers)
        self._counts = store.certify(Budget(frame.settings.certificates, seconds), frame.workers, frame.cancel)

    def stages(self, frame: FrameView, worker: int, learns: bool) -> list[Stage]:
        assert self.store is not None, "updated before"
        looks = np.zeros((len(frame.lights), WORDS), np.int64)
        selection = Selection(self.store.view(), looks, self._recent(frame.shading.lamps))
        if not self._has_lamps(frame.shading.lamps):
            return [Stage(selection, select=select, looks=looks)]
        rows = HIDDEN_SAMPLE_ROWS
        return [Stage(selection, select=select, approach=approach, choose=choose, rows=rows, looks=looks)]

    def _has_lamps(self, lamps: Lamps) -> bool:
        """Whether any light has so many samples that recent occluders are asked about it."""
        return bool((np.diff(lamps.first) >= self.services.cost_model.least_samples).any())

    def _recent(self, lamps: Lamps) -> RecentOccluders:
        assert self.store is not None, "updated before"
        placed = self.services.world.placed
        if not len(self._rows) and self._has_lamps(lamps):
            triangles = self.services.world.triangles_of(0)
            self._rows = aligned_rows(len(triangles.rows), ROW)
            self._rows[:, :CORNER_ERROR], self._rows[:, CORNER_ERROR], self._rows[:, BOX:] = triangles
        sure = SureHitLength(len(self._rows), self.store.hidden.blockers.longest, 0.0)
        return RecentOccluders(
            self._rows, sure, lamps.places, lamps.radii, lamps.samples, lamps.first,
            self.services.cost_model.least_samples, placed.any_hit, placed.data,
        )  # fmt: skip

    def keep(self, frame: FrameView) -> None:
        assert self.store is not None, "updated before"
        self.store.keep_within(1e6 * frame.settings.certificate_memory)

    def because(self, answered: Answered) -> CullReason:
        _, named = self.explain(answered.primitive, np.array(answered.point, np.float32), answered.light)
        # What no region hides was hidden, sample by sample, by what had hidden it from neighbours.
        return CullReason(Verdict.PASSED_OVER if named else Verdict.BEAM, named)

    def forget(self) -> None:
        super().forget()
        self._rows = NO_TRIANGLES

    @property
    def price(self) -> float:
        """Seconds, about, that it takes to set the store up."""
        return SET_UP * len(self.services.world.object_of)

    @property
    def pays_as_a_rule(self) -> bool:
        """Whether certificates can be expected to save time: with so many lights, trials soon tell."""
        return True

    @property
    def memory_bytes(self) -> int:
        return self._rows.nbytes + super().memory_bytes
