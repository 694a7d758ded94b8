"""Triangles prepared for a lamp, sixteen at a time: all that does not depend on where its rays end."""

from __future__ import annotations

from typing import Any, NamedTuple

from tracer.runtime.kernels import inlined, subkernel
from tracer.simd import (
    address_of,
    bits_of,
    f32x16,
    gather_f32x16,
    load_f32,
    load_f32x16,
    load_i32x16,
    select,
    store,
    store_three,
)
from tracer.visibility.error_bounds import (
    ONE,
    ZERO,
    factors_of,
    reported_box,
    rows_at,
    scaled,
    seen_from,
    sure_hit_length,
)
from tracer.visibility.shaft import box_outside, triangle_outside

# Columns of sixteen prepared triangles, vectors one after the other: corner and edges; the edges, and the vectors that
# give U, V and D from the centre, times the sign of T; factors of the error bounds; by how much |D| changes within the
# lamp; |T| at least, and by how much it must differ from 0 for its sign to be certain; how long rays may be to be sure
# of a hit; 1 where T's sign is the same for all of the lamp, 0 where it is not, -1 where float32 can tell nothing; how
# far from the triangle a hit may be reported; and a box outside of which none is.
(CORNER, FIRST, SECOND, SIGNED_FIRST, SIGNED_SECOND, U, V, D) = range(0, 24, 3)
(OF_U, OF_V, OF_W, NEAR, FAR, FIXED, REACH, HEIGHT, UNSURE, SURE, SURE_SIDE, RADIUS, LOW) = range(24, 37)
HIGH = LOW + 3
PREPARED = 64 * (HIGH + 3)  # bytes


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
    store_three(made + 64 * SIGNED_FIRST, 64, scaled(t.e1, t.side))
    store_three(made + 64 * SIGNED_SECOND, 64, scaled(t.e2, t.side))
    store_three(made + 64 * U, 64, t.u)
    store_three(made + 64 * V, 64, t.v)
    store_three(made + 64 * D, 64, t.d)

    f = factors_of(t)
    store(made + 64 * OF_U, f.u)
    store(made + 64 * OF_V, f.v)
    store(made + 64 * OF_W, f.w)
    store(made + 64 * NEAR, f.near)
    store(made + 64 * FAR, f.far)
    store(made + 64 * FIXED, f.fixed)
    store(made + 64 * REACH, radius * t.across)
    store(made + 64 * HEIGHT, t.height)
    store(made + 64 * UNSURE, t.unsure)
    store(made + 64 * SURE, sure_hit_length(farthest, numbers))
    store(made + 64 * SURE_SIDE, select(t.sure_side, ONE, select(t.in_range, ZERO, -ONE)))

    # The box in which hits are reported, with room for rounding.
    low, high = reported_box(t, row)
    store_three(made + 64 * LOW, 64, low)
    store_three(made + 64 * HIGH, 64, high)


@inlined
def prepare_in_tree(o, lamp, numbers, made):
    """Prepare sixteen primitives of `Occluders`, with how far from each a hit may be reported."""
    prepare(o.rows, o.farthest, lamp, numbers, made)
    store(made + 64 * RADIUS, gather_f32x16(address_of(o.error_radii[lamp.number]), load_i32x16(numbers)))


@subkernel
def prepared_met(made, beam):
    """Bits of the sixteen prepared primitives that may come into a beam."""
    corner, e1, e2 = columns_at(made, CORNER, False), columns_at(made, FIRST, False), columns_at(made, SECOND, False)
    outside = triangle_outside(beam, corner, e1, e2, column_at(made, RADIUS, False))
    return bits_of(~(outside | box_outside(beam, columns_at(made, LOW, False), columns_at(made, HIGH, False))))


@inlined
def number_at(at, column):
    """A number of the prepared triangle whose numbers are at an address."""
    return load_f32(at + 64 * column)


@inlined
def column_at(at, column, one):
    """A column of the sixteen prepared triangles at an address, or of the `one` whose numbers are there in all
    lanes."""
    at = at + 64 * column
    return f32x16(load_f32(at)) if one else load_f32x16(at)


@inlined
def columns_at(at, column, one):
    """Three columns."""
    return column_at(at, column, one), column_at(at, column + 1, one), column_at(at, column + 2, one)
