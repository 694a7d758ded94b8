"""Watch what becomes of one pixel's rays, by stages that stand between those of a method and change nothing.

A shadow ray that was open before a stage and is not open after it has been answered by that stage.  So a tile is shaded
once more with a watcher before the first stage and one after each: what they see is what culling does, whatever the
method.  The last of them takes every ray out of those that are to be traced, and gives the answers that it is told to
give instead.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.culling.shadow_testing import shadow_batch_in
from tracer.culling.stages import call_at, vectors
from tracer.geometry.memory import aligned_rows
from tracer.methods.interface import Stage
from tracer.runtime.kernels import kernel, native_callback
from tracer.scene.arrays import Float32
from tracer.shading.bounce import next_wave
from tracer.shading.points import LIFTED_ROW, LIGHT_ROW, POINT_ROWS, POSITION_ROW, Points, points_in
from tracer.shading.wave import DIRECTION, HIT_PRIMITIVE, ORIGIN, WAVE_ROWS, WEIGHT, wave_in
from tracer.simd.records import I32, I64, F32x2D, I32x2D, reading, row_number

# Of what is noted for a shadow ray: bits, and how many stages had been watched when it was answered, from 1 on; 0 for
# one that no stage answers.
DUE, LIT, SETTLED = 1, 2, 4
ANSWERED = 8  # bits to the left
FIRST, END, WANTED = range(3)  # of `state`: the rows of the wave, and how many rows there should be
ROOM = 64  # rays to begin with
_ENTERING_ROW = row_number(Points, "entering")


class Seen(NamedTuple):
    """What watchers see of a pixel's rays that hit something, r of them, in the order of waves.

    state (3,) says which of them the wave has.  Of each ray: lane (r,), its number in the wave; bounce (r,); wave
    (r, WAVE_ROWS) and point (r, POINT_ROWS), what shading knows of the ray and its hit (`tracer.shading.wave.Wave`,
    `tracer.shading.points.Points`); entering (r,), whether it comes from outside; and light (r, 3), what goes from the
    point to where the ray came from.  Of each of its shadow rays, (r, samples): noted, what became of it; kept, what
    the stage that answered it keeps for the point; and given, whether it is lit, for who wants to see the light."""

    state: I64
    lane: I32
    bounce: I32
    wave: F32x2D
    point: F32x2D
    entering: I32
    light: F32x2D
    noted: I32x2D
    kept: I32x2D
    given: I32x2D

    def primitive(self, row: int) -> int:
        """What a ray hits."""
        return int(self.wave.view(np.int32)[row, HIT_PRIMITIVE])

    def position(self, row: int) -> Float32:
        """(3,) where a ray hits it."""
        return self.point[row, POSITION_ROW : POSITION_ROW + 3]

    def end(self, row: int) -> Float32:
        """(3,) where the shadow rays of that point end, a little above it."""
        return self.point[row, LIFTED_ROW : LIFTED_ROW + 3]

    def ray(self, row: int) -> SentRay:
        """A ray itself."""
        return SentRay(False, *_vectors(self.wave[row]))


class Watch(NamedTuple):
    """What a watcher gets: how many stages come before it; the row of the stages' memory in which the last of these
    keeps a number for each point, or -1; whether it is the last watcher; where the pixel is in the picture; and what
    all of them see."""

    number: int
    row: int
    last: bool
    place: int
    seen: Seen


watch_at = reading(Watch)


@native_callback
def find(data, call, light, count, counts):
    """Which points of the wave are the pixel's?"""
    given, watch = call_at(call), watch_at(data)
    wave, points, seen = wave_in(given.rays, count), points_in(given.points), watch.seen
    row = seen.state[END]
    seen.state[FIRST] = row
    for i in range(count):
        if given.place[wave.pixel[i]] != watch.place:
            continue
        seen.state[WANTED] += 1
        if row == len(seen.lane):
            continue
        seen.lane[row], seen.bounce[row] = i, given.bounce
        seen.entering[row] = (points.entering[i >> 4] >> (i & 15)) & 1
        for k in range(WAVE_ROWS):
            seen.wave[row, k] = given.rays[k, i]
        for k in range(POINT_ROWS):
            seen.point[row, k] = given.points[k, i]
        row += 1
    seen.state[END] = row


@native_callback
def choose(data, call, light, count, counts):
    """Note which of the pixel's shadow rays have been answered."""
    given, watch = call_at(call), watch_at(data)
    batch, sample, seen = shadow_batch_in(given.shadows), given.sample, watch.seen
    for row in range(seen.state[FIRST], seen.state[END]):
        v, bit = seen.lane[row] >> 4, seen.lane[row] & 15
        noted = seen.noted[row, sample]
        if watch.number == 0:
            noted = (batch.due[v] >> bit) & 1
        if noted & DUE != 0 and noted >> ANSWERED == 0 and (batch.live[v] >> bit) & 1 == 0:
            noted |= ((batch.lit[v] >> bit) & 1) * LIT | ((batch.settled[v] >> bit) & 1) * SETTLED
            noted |= (watch.number + 1) << ANSWERED
            if watch.row >= 0:
                seen.kept[row, sample] = given.scratch[watch.row].view(np.int32)[seen.lane[row]]
        seen.noted[row, sample] = noted
    if watch.last:
        for v in range(vectors(count)):
            batch.live[v] = batch.lit[v] = 0
            batch.settled[v] = batch.due[v]
        for row in range(seen.state[FIRST], seen.state[END]):
            batch.lit[seen.lane[row] >> 4] |= np.int32(seen.given[row, sample]) << np.int32(seen.lane[row] & 15)


@native_callback
def finish(data, call, light, count, counts):
    """Note the light that goes from the pixel's points."""
    given, seen = call_at(call), watch_at(data).seen
    for row in range(seen.state[FIRST], seen.state[END]):
        for c in range(3):
            seen.light[row, c] = given.points[LIGHT_ROW + c, seen.lane[row]]


class Watchers:
    """Watch the pixel at a place, with room for so many rays, and shadow rays to so many samples."""

    def __init__(self, place: int, samples: int, rays: int = ROOM) -> None:
        self._place = place
        numbers, sampled = (rays,), (rays, samples)
        self._seen = Seen(
            state=np.zeros(3, np.int64),
            lane=np.zeros(numbers, np.int32),
            bounce=np.zeros(numbers, np.int32),
            wave=np.zeros((rays, WAVE_ROWS), np.float32),
            point=np.zeros((rays, POINT_ROWS), np.float32),
            entering=np.zeros(numbers, np.int32),
            light=np.zeros((rays, 3), np.float32),
            noted=np.zeros(sampled, np.int32),
            kept=np.full(sampled, -1, np.int32),
            given=np.zeros(sampled, np.int32),
        )

    def between(self, stages: list[Stage]) -> list[Stage]:
        """The stages with a watcher before the first, and after each."""
        watch = Watch(0, -1, not stages, self._place, self._seen)
        found, row = [Stage(watch, find=find, choose=choose, finish=finish)], 0
        for number, stage in enumerate(stages, 1):
            watch = Watch(number, row if stage.rows else -1, number == len(stages), self._place, self._seen)
            found += [stage, Stage(watch, choose=choose)]
            row += stage.rows
        return found

    def give(self, lit: NDArray[np.bool_]) -> None:
        """Give these answers from now on, (rays, samples), and see the rays anew."""
        self._seen.state[:] = 0
        self._seen.given[: len(lit)] = lit

    @property
    def wanted(self) -> int:
        """How many rays there are: more than there is room for, perhaps."""
        return int(self._seen.state[WANTED])

    @property
    def seen(self) -> Seen:
        """What has been seen, of the rays that there are."""
        end = int(self._seen.state[END])
        return Seen._make([self._seen.state, *(array[:end] for array in self._seen[1:])])


def make_ready() -> None:
    """Compile all that is here."""
    for watches in (find, choose, finish):
        watches.compile()
    secondary_rays(Watchers(0, 1)._seen, 0)


class SentRay(NamedTuple):
    """A ray on its way: whether it is a refracted one, and its origin, direction and weight (3,)."""

    refracted: bool
    origin: Float32
    direction: Float32
    weight: Float32

    @property
    def key(self) -> bytes:
        """Its origin and direction, to the bit."""
        return bytes(self.origin.tobytes() + self.direction.tobytes())


def _vectors(wave: Float32) -> list[Float32]:
    return [wave[first : first + 3].copy() for first in (ORIGIN, DIRECTION, WEIGHT)]


@kernel
def _send_on(rays, points, bounce, memory):
    """What the first of some points sends on: the memory of the rays, and how many they are."""
    wave, _ = next_wave(points_in(points), wave_in(rays, 1), bounce, memory)
    return wave.memory, wave.size


def secondary_rays(seen: Seen, row: int) -> list[SentRay]:
    """The rays that the hit of a ray sends on, as shading would; the refracted one comes first."""
    rays, points, memory = (aligned_rows(rows, 32) for rows in (WAVE_ROWS, POINT_ROWS, WAVE_ROWS))
    rays[:], points[:] = seen.wave[row][:, None], seen.point[row][:, None]
    points.view(np.int32)[_ENTERING_ROW] = seen.entering[row]
    sent, size = _send_on(rays, points, int(seen.bounce[row]), memory)
    found = [_vectors(sent[:, i]) for i in range(size)]
    made = [SentRay(not np.array_equal(vectors[0], seen.end(row)), *vectors) for vectors in found]
    return sorted(made, key=lambda ray: not ray.refracted)
