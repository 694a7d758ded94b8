"""The addition `cache`: what blocked a light before is tested first (`tracer.culling.occluder_cache`).

Two older ways of remembering it stand beside ours for comparison: by direction alone (Haines, Greenberg 1986), and the
last one of a tile (Wald 2004).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tracer.culling.occluder_cache import OccluderSlots, SlotKey, remember, test_slots
from tracer.culling.shadow_testing import shadow_batch_in
from tracer.culling.stages import call_at, scratch_of
from tracer.culling.verdicts import Answered, CullReason, Verdict
from tracer.methods.interface import FrameView, Services, ShadowMethod, Stage
from tracer.runtime.kernels import native_callback
from tracer.shading.points import points_in
from tracer.simd import i64_at
from tracer.simd.records import I32, F32x2D, reading


class Cache(NamedTuple):
    """The occluder in each slot, what this worker has found for the next frame, all triangles (t, 9), how many of them
    never move, the padding of boxes, and what slots are found by (`SlotKey`)."""

    occluders: I32
    found: I32
    triangles: F32x2D
    static: int
    padding: float
    primitive: int
    direction: int
    tile: int


cache_at = reading(Cache)
SLOT_ROWS = 1


@native_callback
def choose(data, call, light, count, counts):
    """Rays that a cached occluder surely blocks need not be traced."""
    given, cache = call_at(call), cache_at(data)
    points, batch, slots = points_in(given.points), shadow_batch_in(given.shadows), scratch_of(given)[0].view(np.int32)
    test_slots(cache, given.tile, points, given.samples[given.sample], light, count, batch, slots, i64_at(counts))


@native_callback
def learn(data, call, light, count, counts):
    """Remember what has blocked the rays that were traced."""
    given, cache = call_at(call), cache_at(data)
    remember(cache, scratch_of(given)[0].view(np.int32), count, shadow_batch_in(given.shadows))


class OccluderCache(ShadowMethod):
    """Keeps the last occluder for every primitive, light and range of directions."""

    key = SlotKey(primitive=1, direction=1, tile=0)

    def __init__(self, services: Services) -> None:
        super().__init__(services)
        triangles = services.world.placed.triangles
        self._slots = OccluderSlots(triangles, int((services.world.object_of[: len(triangles)] == 0).sum()))
        self._read = self._slots.occluders

    def begin(self, frame: FrameView) -> None:
        self._read = self._slots.occluders

    def stages(self, frame: FrameView, worker: int, learns: bool) -> list[Stage]:
        slots = self._slots
        slots.make_room(frame.workers)
        triangles = self.services.world.placed.triangles
        cache = Cache(self._read, slots.found[worker], triangles, slots.static, slots.padding, *self.key)
        return [Stage(cache, choose=choose, learn=learn if learns else None, rows=SLOT_ROWS, occluders=learns)]

    def keep(self, frame: FrameView) -> None:
        self._slots.keep_found()

    def discard(self, frame: FrameView, begun: bool) -> None:
        self._slots.discard_found()

    def because(self, answered: Answered) -> CullReason:
        return CullReason(Verdict.CACHED, (int(self._read[answered.kept]),) if answered.kept >= 0 else ())

    def forget(self) -> None:
        triangles = self.services.world.placed.triangles
        self._slots = OccluderSlots(triangles, self._slots.static)

    @property
    def memory_bytes(self) -> int:
        return self._slots.occluders.nbytes + self._slots.found.nbytes


class DirectionCache(OccluderCache):
    """Keeps the last occluder for every light and range of directions, whatever primitive it shines on."""

    key = SlotKey(primitive=0, direction=1, tile=0)


class TileCache(OccluderCache):
    """Keeps the last occluder for every light and tile of the picture."""

    key = SlotKey(primitive=0, direction=0, tile=1)
