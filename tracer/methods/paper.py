"""The method of the paper: culling by the shadow modes of primitives that were seen whole (§2.4, §2.5).

Occlusion testing and occlusion-mode setting (§2.3, §2.6) are phases of every frame that keeps modes, and stand in
`tracer.culling.occlusion`.  The kernels here are those two of shadow testing, wave by wave: `choose` answers the rays
whose primitives can be trusted, and `learn` sets the shadow modes.
"""

from __future__ import annotations

from typing import NamedTuple

from tracer.culling.cells import cells_at
from tracer.culling.shadow_batch import shadow_batch_in
from tracer.culling.shadow_modes import (
    POINT_WORD_ROWS,
    Words,
    cull,
    point_words_in,
    set_shadow_modes,
    start_wave,
    words_at,
)
from tracer.culling.stages import call_at, scratch_of, vectors
from tracer.culling.verdicts import Answered, CullReason, Verdict
from tracer.methods.interface import FrameView, ShadowMethod, Stage
from tracer.runtime.kernels import entry
from tracer.shading.points import points_in
from tracer.shading.wave import wave_in
from tracer.simd import address_of, i64_at, load_f32x16, load_i32x16, store
from tracer.simd.records import I32, reading


class Modes(NamedTuple):
    """Words of all units as the last frame left them; what this worker gains for the next; and the first unit of each
    primitive, or nothing where primitives are the units."""

    words: Words
    gained: Words
    first: I32


modes_at = reading(Modes)


@entry
def find(data, call, light, count, counts):
    """Which unit is each point of the wave on?  Nothing has been looked up for it yet."""
    given, first = call_at(call), modes_at(data).first
    points, wave = points_in(given.points), wave_in(given.rays, count)
    found = point_words_in(scratch_of(given))
    start_wave(found, count)
    for v in range(vectors(count)):
        at = 64 * v
        unit = load_i32x16(address_of(points.primitive) + at)
        if len(first) > 0:
            unit = cells_at(first, unit, load_f32x16(address_of(wave.u) + at), load_f32x16(address_of(wave.v) + at))
        store(address_of(found.unit) + at, unit)


@entry
def choose(data, call, light, count, counts):
    """§2.4: answer the rays of points on units that can be trusted."""
    given, modes = call_at(call), modes_at(data)
    found = point_words_in(scratch_of(given))
    cull(modes.words, found, light, count, shadow_batch_in(given.shadows), i64_at(counts))


@entry
def learn(data, call, light, count, counts):
    """§2.5: set shadow modes by what static geometry has answered."""
    given, modes = call_at(call), modes_at(data)
    found, batch = point_words_in(scratch_of(given)), shadow_batch_in(given.shadows)
    set_shadow_modes(modes.words, modes.gained, found, light, count, batch, i64_at(counts))


class Paper(ShadowMethod):
    """Culls by modes, and sets them."""

    culls = True

    def stages(self, frame: FrameView, worker: int, learns: bool) -> list[Stage]:
        modes = Modes(words_at(frame.words), words_at(frame.history.gained[worker]), frame.first)
        chooses, learns_from = choose if self.culls else None, learn if learns else None
        return [Stage(modes, find=find, choose=chooses, learn=learns_from, rows=POINT_WORD_ROWS)]

    def because(self, answered: Answered) -> CullReason:
        return CullReason(Verdict.NON_SHADOW if answered.lit else Verdict.FULL_SHADOW)


class ModesBeside(Paper):
    """Sets the modes that the paper's method would have, beside a method that does not cull by them."""

    culls = False
