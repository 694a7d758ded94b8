"""Light-space triangles: each prepared once for a light, so that a shadow ray can ask it quickly.

`error_bounds` tells what is certain of a triangle and any light.  All of that which does not depend on the ray is
gathered here in a row of sixteen numbers, one cache line: the coefficients of U, V and D, the corner that D - T is
taken from, and three numbers for the error bounds,

    U:            of_u |d| + 2.5 (enlarged) |D|
    V:            of_v |d| + 2.5 (enlarged) |D|
    D - U - V:    (of_u + of_v) |d| + 2.5 (enlarged) |D|
    D - T:        behind (19 |P - a| + 11 |d| + 2 |P|)

These are no narrower than those of `error_bounds`.  What D - U - V has for D, beyond what it has for U and for V, is
split between of_u and of_v.  For D - T, |e1| |e2| stands for the normal's length, which is never more, |n| |s| for
|T|, and |d| + |P - a| for |s|.

A row whose `FARTHEST` is negative is that of a primitive that hides no light for certain: a quadric, or a triangle
whose plane the light may lie in.  It begins with the box outside of which no hit is reported.
"""

from __future__ import annotations

import numpy as np

from tracer.culling.certified.error_bounds import (
    BOX,
    ENLARGED,
    EPSILON,
    FIVE,
    FOUR,
    INSIDE,
    LAMP,
    LANES,
    LARGE,
    REPORTED,
    ROW,
    SMALL,
    ZERO,
    length16,
    rows_at,
    seen_from,
    sure_hit_length,
)
from tracer.geometry.boxes import segments_miss_box
from tracer.runtime.kernels import inlined, subkernel
from tracer.simd import (
    any_lane,
    bits_of,
    f32_at,
    i32x16,
    lane_numbers_x16,
    load_columns,
    local_memory,
    maximum,
    minimum,
    select,
    size_of,
    store,
)

# Columns of a row: three coefficients each of U, V and D, a corner, three error bounds, and how long a ray may be.
U, V, D, CORNER, OF_U, OF_V, BEHIND, FARTHEST = 0, 3, 6, 9, 12, 13, 14, 15
LIGHT_ROW = 16
COLUMNS = 64 * LIGHT_ROW  # bytes of sixteen rows
_ENLARGED = np.float32(2.5 * (ENLARGED + 7 * EPSILON))
_NINE, _HALF_D, _BEHIND = np.float32(2.5 * 9.01 * EPSILON), np.float32(1.251 * EPSILON), np.float32(1.26 * EPSILON)
_BLURRED, _BLURRED_BEHIND = np.float32(2.5 * 5.01), np.float32(5.01 / 11)
_NEAR, _LONGEST, _AT = np.float32(19), np.float32(11), np.float32(2)
_PAST, _NONE = np.float32(0.999 / LAMP), np.float32(-1)
_INSIDE = np.float32(INSIDE)
_WIDE, _ROUNDING = np.float32(2 * REPORTED), np.float32(1e-6)


@subkernel
def put_light_space(rows, farthest, light, light_space):
    """Prepare all primitives for a light at (3,) float32.

    rows (n, ROW) are prepared into light_space (n, LIGHT_ROW) float32, or into nothing where that is (0, LIGHT_ROW)
    because no ray tests candidates.  Rays that are certain of a hit are no longer than `farthest` (SureHitLength)."""
    numbers, columns = local_memory(64), local_memory(COLUMNS)
    made = f32_at(columns)
    for first in range(0, len(light_space), LANES):
        store(numbers, minimum(lane_numbers_x16() + np.int32(first), i32x16(np.int32(len(rows) - 1))))
        row = rows_at(rows, numbers)
        t = seen_from(light, ZERO, row)
        edges = t.first * t.second
        half_d = _HALF_D * (FOUR * edges + FIVE * t.across)
        blurred = _BLURRED * t.blur * maximum(t.first, t.second)
        sure = minimum(sure_hit_length(farthest, numbers), minimum(t.height / t.across * _PAST, LARGE))
        box, room = row[BOX:ROW], _WIDE * t.away
        for axis in range(3):
            room = room + _ROUNDING * (box[3 + axis] - box[axis])
        for axis in range(3):
            low, high = box[axis] - room, box[3 + axis] + room
            store(columns + 64 * (U + axis), select(t.firm, t.u[axis], low))
            store(columns + 64 * (V + axis), select(t.firm, t.v[axis], high))
            store(columns + 64 * (D + axis), t.d[axis])
            store(columns + 64 * (CORNER + axis), t.corner[axis])
        store(columns + 64 * OF_U, _NINE * t.away * t.second + blurred + half_d)
        store(columns + 64 * OF_V, _NINE * t.away * t.first + blurred + half_d)
        store(columns + 64 * BEHIND, _BEHIND * edges + _BLURRED_BEHIND * t.blur * t.across / t.away)
        store(columns + 64 * FARTHEST, select(t.firm, sure, _NONE))
        for k in range(min(LANES, len(rows) - first)):
            for column in range(LIGHT_ROW):
                light_space[first + k, column] = made[LANES * column + k]


@inlined
def verdicts(light_space, numbers, light, direction, end):
    """What sixteen shadow rays, each asking one primitive, are certain of: bits of hits, and of misses.

    Rays go from a light (3,) in a direction to their end, three vectors of sixteen each.  The primitives' numbers,
    int32, are at an address, their rows (n, LIGHT_ROW) at the address `light_space`."""
    return verdicts_on(load_columns(light_space, numbers, LIGHT_ROW), light, direction, end)


@inlined
def verdicts_on(t, light, direction, end):
    """The same of primitives whose columns are `t`, LIGHT_ROW vectors of sixteen."""
    x, y, z = direction
    ax, ay, az = end[0] - t[CORNER], end[1] - t[CORNER + 1], end[2] - t[CORNER + 2]
    longest, near = size_of(direction), length16((ax, ay, az))

    # Evaluate the functions.
    u = t[U] * x + t[U + 1] * y + t[U + 2] * z
    v = t[V] * x + t[V + 1] * y + t[V + 2] * z
    d = t[D] * x + t[D + 1] * y + t[D + 2] * z
    w, behind = d - u - v, t[D] * ax + t[D + 1] * ay + t[D + 2] * az

    # Bound the errors of each.
    of_d = _ENLARGED * maximum(d, -d) + SMALL
    of_u, of_v, of_w = t[OF_U] * longest + of_d, t[OF_V] * longest + of_d, (t[OF_U] + t[OF_V]) * longest + of_d
    of_behind = t[BEHIND] * (_NEAR * near + _LONGEST * longest + _AT * size_of(end)) + SMALL

    # Compare each function with its bound.
    missed = (behind < -of_behind) | (u < -of_u) | (v < -of_v) | (w < -of_w)
    hit = (behind > of_behind) & (t[FARTHEST] > longest)
    hit = hit & (u > _INSIDE * of_u) & (v > _INSIDE * of_v) & (w > _INSIDE * of_w)

    # Test the box of primitives that hide nothing for certain.
    boxed = t[FARTHEST] < ZERO
    missed = missed & ~boxed & (longest < LARGE)
    if any_lane(boxed):
        missed = missed | (boxed & segments_miss_box(light, direction, t[U:V], t[V:D]))
    return bits_of(hit), bits_of(missed)
