"""Find what may come between a light and a box of space, with all that a worker needs for that.

A ray that goes on beyond the box has larger functions still: U, V and D - U - V grow in step with their bounds, and
D - T by more than what the structures may be wrong by, where U, V and D - U - V clear their bounds.  So what is certain
of rays that end in the box is certain of those that enter it and go on.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.runtime.kernels import inlined, subkernel
from tracer.simd import address_of, any_lane, bits_of, f32x16, gather_f32x16, lanes_below, load_columns, load_i32x16
from tracer.visibility.budget import TESTS
from tracer.visibility.error_bounds import LANES, ROW, ZERO
from tracer.visibility.light_space import FARTHEST, LIGHT_ROW, D, U, V, in_all_lanes, judge
from tracer.visibility.search import HIDDEN, classifies, find_candidates
from tracer.visibility.shaft import Shaft, box_outside, make_shaft, put_box, triangle_outside

MOST = 64  # primitives that a box keeps for its parts, at most


class Light(NamedTuple):
    """Light `number` at place (3,) float32, in a slot of `Occluders`; no ray from it is longer than `longest`, and
    planes of shafts are wrong by less than `rounded` in float32, in units of the scene."""

    number: int
    slot: int
    place: NDArray[np.float32]
    longest: float
    rounded: float


def light_to(number: int, slot: int, place: NDArray[np.float32], around: NDArray[np.float64], largest: float) -> Light:
    """A light whose rays end in a box `around` (2, 3) all that is static, whose largest coordinate is `largest`."""
    longest = float(np.linalg.norm(np.abs(place - around).max(0))) * 1.001
    return Light(number, slot, place, longest, 2e-6 * max(largest, float(np.abs(place).max())))


class BoxQuestion(NamedTuple):
    """Which `Occluders` may come between a light, of a `number` there, and the cube around center (3,) float32 with
    half sides `half`, to which the shaft was put?"""

    occluders: Any
    number: Any
    light: Any
    shaft: Any
    center: Any
    half: Any


class Scratch(NamedTuple):
    """What a worker looks for candidates in.

    Attributes:
        shaft: of the box at hand.
        occluders: (LANES,) int32, what has hidden other boxes from the light, the newest of them.
        state: (2,) int64, how many of these there are, and which is replaced next.
    """

    shaft: Shaft
    occluders: NDArray[np.int32]
    state: NDArray[np.int64]


@inlined
def make_scratch():
    """Memory for a worker."""
    return Scratch(make_shaft(), np.zeros(LANES, np.int32), np.zeros(2, np.int64))


@inlined
def forget_occluders(scratch):
    """What is proved from now on does not depend on boxes that were asked about before."""
    scratch.state[0] = scratch.state[1] = 0


@subkernel
def classify_for_box(question, numbers):
    """Bits of the primitives, sixteen numbers at an address, that every ray which enters a cube is certain to hit, and
    of those that none hits before it leaves the cube."""
    o, light, shaft = question.occluders, question.light, question.shaft
    t = load_columns(address_of(o.light_space[question.number]), numbers, LIGHT_ROW)
    half = f32x16(question.half)
    longest = f32x16(np.float32(light.longest))
    hit, missed = judge(t, light.place, in_all_lanes(question.center), (half, half, half), longest)
    if any_lane(~hit & ~missed):
        # A primitive that hides nothing for certain is as large as the box that its row begins with.
        row, sure_side = load_columns(address_of(o.rows), numbers, ROW), t[FARTHEST] >= ZERO
        radius = gather_f32x16(address_of(o.error_radii[question.number]), load_i32x16(numbers))
        missed = missed | (sure_side & triangle_outside(shaft, row[0:3], row[3:6], row[6:9], radius))
        missed = missed | (~sure_side & box_outside(shaft, t[U:V], t[V:D]))
    return bits_of(hit), bits_of(missed)


classifies(BoxQuestion, classify_for_box)


@subkernel
def come_between(o, light, scratch, middle, half, given, given_count, found, counts):
    """Find what may come between a light and the cube around middle (3,) with half sides `half`: how many primitives,
    more than MOST for too many, or HIDDEN where one hides the whole cube.

    Their numbers go into found (MOST + 2 LANES,) int32.  They are among given (given_count,) int32, or anywhere where
    that is more than MOST; o are `Occluders`."""
    place = np.float64(light.place[0]), np.float64(light.place[1]), np.float64(light.place[2])
    put_box(scratch.shaft, place, middle, half, light.rounded)
    center = np.float32(middle[0]), np.float32(middle[1]), np.float32(middle[2])
    question = BoxQuestion(o, light.slot, light, scratch.shaft, center, np.float32(half))
    if scratch.state[0] > 0:  # what has hidden others may hide this one
        counts[TESTS] += scratch.state[0]
        hit, _missed = classify_for_box(question, address_of(scratch.occluders))
        if hit & lanes_below(scratch.state[0], 0) != 0:
            return np.int64(HIDDEN)
    count = find_candidates(question, given, given_count, found, MOST, counts)
    if count < 0:
        scratch.occluders[scratch.state[1]] = found[0]
        scratch.state[0], scratch.state[1] = min(LANES, scratch.state[0] + 1), (scratch.state[1] + 1) % LANES
    return count
