"""The method of the paper: culling by the shadow modes of primitives that were seen whole (§2.4, §2.5).

Occlusion testing and occlusion-mode setting (§2.3, §2.6) are phases of every frame that keeps modes, and stand in
`tracer.culling.occlusion`.  The kernels here take part in shadow testing
(`tracer.culling.shadow_testing`), wave by wave: `choose` answers rays, and `learn` sets the shadow modes.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tracer.culling.counters import BY_LIGHT
from tracer.culling.modes import (
    DYNAMIC,
    FULL_SHADOW,
    MAX_CULLED_LIGHTS,
    NON_SHADOW,
    POINT_MODE_ROWS,
    Words,
    add_shadow,
    look_up,
    occlusion_modes,
    point_modes_in,
    shadow_modes,
    words_at,
)
from tracer.culling.shadow_testing import answer, classify_by_modes, shadow_batch_in
from tracer.culling.stages import call_at, scratch_of, vectors
from tracer.culling.verdicts import Answered, CullReason, Verdict
from tracer.methods.interface import FrameView, ShadowMethod, Stage
from tracer.runtime.kernels import native_callback
from tracer.shading.points import points_in
from tracer.simd import address_of, bits_of, i64_at, load_i32x16, lowest_bit, ones, store
from tracer.simd.records import I32, reading


class Modes(NamedTuple):
    """Words of all units as the last frame left them; what this worker gains for the next; and, for the method `cells`,
    the first unit of each primitive."""

    words: Words
    gained: Words
    first: I32


modes_at = reading(Modes)


@native_callback
def find(data, call, light, count, counts):
    """Which primitive is each point of the wave on?  Its modes have not been looked up yet."""
    given = call_at(call)
    points, found = points_in(given.points), point_modes_in(scratch_of(given))
    for v in range(vectors(count)):
        found.looked_up[v] = 0
        store(address_of(found.unit) + 64 * v, load_i32x16(address_of(points.primitive) + 64 * v))


@native_callback
def choose(data, call, light, count, counts):
    """§2.4: answer the rays of points on units whose modes say what they meet."""
    given, words, counted = call_at(call), modes_at(data).words, i64_at(counts)
    found, batch = point_modes_in(scratch_of(given)), shadow_batch_in(given.shadows)
    if light >= MAX_CULLED_LIGHTS:
        return
    for v in range(vectors(count)):
        if batch.live[v] != 0:
            look_up(words, v, found)
            skip, dynamic_only = classify_by_modes(found, light, v)
            answer(batch, v, skip, dynamic_only, counted)


@native_callback
def learn(data, call, light, count, counts):
    """§2.5: OR what rays have met into what units gain, and count what modes say of due rays.

    Whoever gave the answer: a mode is set if the paper's method would have traced the ray, and static geometry has
    answered it.  So the modes kept beside a method that does not cull by them are those that the paper's would have."""
    given, modes, counted = call_at(call), modes_at(data), i64_at(counts)
    found, batch = point_modes_in(scratch_of(given)), shadow_batch_in(given.shadows)
    if light >= MAX_CULLED_LIGHTS:
        return
    for v in range(vectors(count)):
        due = np.int64(batch.due[v])
        if due == 0:
            continue
        look_up(modes.words, v, found)
        skip, dynamic_only = classify_by_modes(found, light, v)
        counted[BY_LIGHT + 3 * light] += ones(due)
        counted[BY_LIGHT + 3 * light + 1] += ones(due & skip)
        counted[BY_LIGHT + 3 * light + 2] += ones(due & dynamic_only)

        # Only where it is news: most rays meet what others of their unit have met before.
        shadow, unblocked = shadow_modes(found, light, v), np.int64(batch.unblocked[v])
        knows_blocked = bits_of((shadow & np.int32(FULL_SHADOW)) > np.int32(0))
        knows_unblocked = bits_of((shadow & np.int32(NON_SHADOW)) > np.int32(0))
        traced = due & ~(bits_of(occlusion_modes(found, v) == DYNAMIC) | skip | dynamic_only)
        news = traced & ((unblocked & ~knows_unblocked) | (~unblocked & ~knows_blocked))
        while news != 0:
            lane = lowest_bit(news)
            news &= news - 1
            mode = NON_SHADOW if (unblocked >> lane) & 1 else FULL_SHADOW
            add_shadow(modes.gained, found.unit[16 * v + lane], light, mode)


class Paper(ShadowMethod):
    """Culls by modes, and sets them."""

    culls = True
    finds_units = find

    def stages(self, frame: FrameView, worker: int, learns: bool) -> list[Stage]:
        modes = Modes(words_at(frame.words), words_at(frame.history.gained[worker]), frame.first)
        chooses, learns_from = choose if self.culls else None, learn if learns else None
        return [Stage(modes, find=self.finds_units, choose=chooses, learn=learns_from, rows=POINT_MODE_ROWS)]

    def because(self, answered: Answered) -> CullReason:
        return CullReason(Verdict.NON_SHADOW if answered.lit else Verdict.FULL_SHADOW)


class ModesBeside(Paper):
    """Sets the modes that the paper's method would have, beside a method that does not cull by them."""

    culls = False
