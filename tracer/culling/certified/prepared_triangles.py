"""Triangles prepared for a lamp, sixteen at a time: all that does not depend on where its rays end."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from tracer.culling.certified.error_bounds import (
    BOX,
    EPSILON,
    FIVE,
    FOUR,
    NINE,
    ONE,
    REPORTED,
    ROW,
    SMALL,
    SURPLUS,
    THREE,
    ZERO,
    dot,
    rows_at,
    scaled,
    seen_from,
    sure_hit_length,
)
from tracer.runtime.kernels import inlined, subkernel
from tracer.simd import (
    address_of,
    bits_of,
    gather_f32x16,
    load_f32,
    load_f32x16,
    load_i32x16,
    maximum,
    minimum,
    select,
    store,
    store_three,
)

# Columns of sixteen prepared triangles, vectors one after the other: corner and edges; the edges, and the vectors that
# give U, V and D from the centre, times the sign of T; factors of the error bounds; by how much |D| changes within the
# lamp; |T| at least, and by how much it must differ from 0 for its sign to be certain; how long rays may be to be sure
# of a hit; 1 where T's sign is the same for all of the lamp, 0 where it is not, -1 where float32 can tell nothing; how
# far from the triangle a hit may be reported; and a box outside of which none is.
(CORNER, FIRST, SECOND, TURNED_FIRST, TURNED_SECOND, U, V, D) = range(0, 24, 3)
(OF_U, OF_V, OF_W, NEAR, FAR, BEHIND, REACH, HEIGHT, UNSURE, SURE, FIRM, RADIUS, LOW) = range(24, 37)
HIGH = LOW + 3
PREPARED = 64 * (HIGH + 3)  # bytes
_EPSILON, _SURPLUS, _TWICE = np.float32(EPSILON), np.float32(SURPLUS), np.float32(2 * SURPLUS)
_WIDE, _ROUNDING = np.float32(2 * REPORTED), np.float32(1e-6)


class Lamp(NamedTuple):
    """A lamp as kernels know it: its number; a ball of a radius around light (3,); and how many vectors of sixteen its
    samples make."""

    number: int
    light: Any
    radius: Any
    groups: int


@subkernel
def prepare(rows, farthest, lamp, numbers, made):
    """Prepare sixteen primitives, whose numbers are at an address, for a `Lamp`: at the address `made`, PREPARED bytes.
    rows and farthest are as in `Occluders`."""
    row, radius = rows_at(rows, numbers), lamp.radius
    t = seen_from(lamp.light, radius, row)
    store_three(made + 64 * CORNER, 64, t.corner)
    store_three(made + 64 * FIRST, 64, t.e1)
    store_three(made + 64 * SECOND, 64, t.e2)
    store_three(made + 64 * TURNED_FIRST, 64, scaled(t.e1, t.turned))
    store_three(made + 64 * TURNED_SECOND, 64, scaled(t.e2, t.turned))
    store_three(made + 64 * U, 64, t.u)
    store_three(made + 64 * V, 64, t.v)
    store_three(made + 64 * D, 64, t.d)

    # What does not depend on the points in `error_bounds`.
    blurred = FIVE * t.blur * maximum(t.first, t.second)
    u, v = NINE * _EPSILON * t.away * t.second + blurred, NINE * _EPSILON * t.away * t.first + blurred
    tilt = FOUR * _EPSILON * t.first * t.second
    store(made + 64 * OF_U, _TWICE * u)
    store(made + 64 * OF_V, _TWICE * v)
    store(made + 64 * OF_W, _TWICE * (u + v + tilt + FIVE * _EPSILON * t.across))
    store(made + 64 * NEAR, _SURPLUS * THREE * tilt)
    store(made + 64 * FAR, _SURPLUS * FOUR * _EPSILON * t.across)
    behind = FOUR * t.across * (t.blur + _EPSILON * t.away) + THREE * _EPSILON * t.highest
    store(made + 64 * BEHIND, _SURPLUS * behind + SMALL)
    store(made + 64 * REACH, radius * t.across)
    store(made + 64 * HEIGHT, t.height)
    store(made + 64 * UNSURE, t.unsure)
    store(made + 64 * SURE, sure_hit_length(farthest, numbers))
    store(made + 64 * FIRM, select(t.firm, ONE, select(t.sane, ZERO, -ONE)))

    # The box in which hits are reported, with room for rounding.
    box, room = row[BOX:ROW], _WIDE * t.away
    for axis in range(3):
        room = room + _ROUNDING * (box[3 + axis] - box[axis])
    for axis in range(3):
        store(made + 64 * (LOW + axis), box[axis] - room)
        store(made + 64 * (HIGH + axis), box[3 + axis] + room)


@inlined
def prepare_in_tree(o, lamp, numbers, made):
    """Prepare sixteen primitives of `Occluders`, with how far from each a hit may be reported."""
    prepare(o.rows, o.farthest, lamp, numbers, made)
    store(made + 64 * RADIUS, gather_f32x16(address_of(o.error_radii[lamp.number]), load_i32x16(numbers)))


@inlined
def three_at(at, column):
    """Three vectors of prepared triangles."""
    at = at + 64 * column
    return load_f32x16(at), load_f32x16(at + 64), load_f32x16(at + 128)


@subkernel
def prepared_met(made, beam):
    """Bits of the sixteen prepared primitives that may come into a beam."""
    corner, first, second = three_at(made, CORNER), three_at(made, FIRST), three_at(made, SECOND)
    low, high, radius = three_at(made, LOW), three_at(made, HIGH), vector_at(made, RADIUS)
    met = radius > ZERO
    for axis in range(3):
        least, most = (
            minimum(ZERO, minimum(first[axis], second[axis])),
            maximum(ZERO, maximum(first[axis], second[axis])),
        )
        least, most = (
            maximum(corner[axis] + least - radius, low[axis]),
            minimum(corner[axis] + most + radius, high[axis]),
        )
        met = met & (least <= beam.box[3 + axis]) & (most >= beam.box[axis])
    for k in range(len(beam.planes)):
        n, offset = (beam.planes[k, 0], beam.planes[k, 1], beam.planes[k, 2]), beam.planes[k, 3]
        triangle = dot(n, corner) + minimum(ZERO, minimum(dot(n, first), dot(n, second))) - radius
        box = dot(n, (low[0] if n[0] > ZERO else high[0], low[1] if n[1] > ZERO else high[1],
                      low[2] if n[2] > ZERO else high[2]))  # fmt: skip
        met = met & (triangle <= offset) & (box <= offset)
    return bits_of(met)


@inlined
def vector_at(at, column):
    return load_f32x16(at + 64 * column)


@inlined
def number_at(at, column):
    return load_f32(at + 64 * column)


@inlined
def numbers_at(at, column):
    at = at + 64 * column
    return load_f32(at), load_f32(at + 64), load_f32(at + 128)
