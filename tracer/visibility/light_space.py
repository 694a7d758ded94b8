"""Light-space triangles: each prepared once for a light, so that a shadow ray can ask it quickly.

All that does not depend on rays is gathered in a row of sixteen numbers, one cache line: the coefficients of U, V and
D, the corner that B is taken from, three factors of error bounds (`error_bounds.row_factors`), and how long a ray may
be to be certain of a hit.

A row whose `FARTHEST` is negative is that of a primitive that hides no light for certain: a quadric, or a triangle
whose plane the light may lie in.  It begins with the box outside of which no hit is reported.
"""

from __future__ import annotations

import numpy as np

from tracer.geometry.boxes import segments_miss_box
from tracer.runtime.kernels import inlined, subkernel
from tracer.simd import (
    any_lane,
    bits_of,
    f32_at,
    f32x16,
    i32x16,
    lane_numbers_x16,
    load_f32,
    local_memory,
    maximum,
    minimum,
    select,
    size_of,
    store,
)
from tracer.visibility.error_bounds import (
    LAMP,
    LANES,
    LARGE,
    ZERO,
    Functions,
    dot,
    factors_of,
    length16,
    reported_box,
    row_bounds,
    row_factors,
    rows_at,
    seen_from,
    spread_in_box,
    sure_hit_length,
    surely_hit,
    surely_missed,
)

# Columns of a row: three coefficients each of U, V and D, a corner, three error bounds, and how long a ray may be.
U, V, D, CORNER, OF_U, OF_V, BEHIND, FARTHEST = 0, 3, 6, 9, 12, 13, 14, 15
LIGHT_ROW = 16
COLUMNS = 64 * LIGHT_ROW  # bytes of sixteen rows
_PAST, _NONE = np.float32(0.999 / LAMP), np.float32(-1)


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
        of_u, of_v, of_b = row_factors(t, factors_of(t))
        sure = minimum(sure_hit_length(farthest, numbers), minimum(t.height / t.across * _PAST, LARGE))
        low, high = reported_box(t, row)
        for axis in range(3):
            store(columns + 64 * (U + axis), select(t.sure_side, t.u[axis], low[axis]))
            store(columns + 64 * (V + axis), select(t.sure_side, t.v[axis], high[axis]))
            store(columns + 64 * (D + axis), t.d[axis])
            store(columns + 64 * (CORNER + axis), t.corner[axis])
        store(columns + 64 * OF_U, of_u)
        store(columns + 64 * OF_V, of_v)
        store(columns + 64 * BEHIND, of_b)
        store(columns + 64 * FARTHEST, select(t.sure_side, sure, _NONE))
        for k in range(min(LANES, len(rows) - first)):
            for column in range(LIGHT_ROW):
                light_space[first + k, column] = made[LANES * column + k]


@inlined
def load_row(at):
    """The row of one primitive, at an address, for all lanes."""
    return (
        f32x16(load_f32(at)), f32x16(load_f32(at + 4)), f32x16(load_f32(at + 8)), f32x16(load_f32(at + 12)),
        f32x16(load_f32(at + 16)), f32x16(load_f32(at + 20)), f32x16(load_f32(at + 24)), f32x16(load_f32(at + 28)),
        f32x16(load_f32(at + 32)), f32x16(load_f32(at + 36)), f32x16(load_f32(at + 40)), f32x16(load_f32(at + 44)),
        f32x16(load_f32(at + 48)), f32x16(load_f32(at + 52)), f32x16(load_f32(at + 56)), f32x16(load_f32(at + 60)),
    )  # fmt: skip


@inlined
def in_all_lanes(a):
    """Three numbers as three vectors."""
    return f32x16(a[0]), f32x16(a[1]), f32x16(a[2])


@inlined
def _farthest(a, half):
    """No less than how far any point of a box is from the origin, as a sum of coordinates."""
    return size_of(a) if half is None else size_of(a) + (half[0] + half[1] + half[2])


@inlined
def _farthest_from_corner(a, half):
    """The same, or a length where the box is a point."""
    return length16(a) if half is None else size_of(a) + (half[0] + half[1] + half[2])


@inlined
def judge(t, light, end, half, longest):
    """Masks of the triangles that every ray from light (3,) is certain to hit, and of those that none hits before its
    end.

    Rays end in boxes around `end` with half sides `half`, three vectors each, or where that is None at the points
    `end`.  t are the columns of triangles' rows; primitives with a box instead are neither.  Rays may go on beyond
    their box until they are `longest`, a vector, or end there where that is None."""
    way = end[0] - light[0], end[1] - light[1], end[2] - light[2]
    from_corner = end[0] - t[CORNER], end[1] - t[CORNER + 1], end[2] - t[CORNER + 2]
    far, near, at = _farthest(way, half), _farthest_from_corner(from_corner, half), _farthest(end, half)

    # Find the least and the greatest of each function.
    to_u, to_v, to_d = t[U:V], t[V:D], t[D:CORNER]
    to_w = to_d[0] - to_u[0] - to_v[0], to_d[1] - to_u[1] - to_v[1], to_d[2] - to_u[2] - to_v[2]
    u, v, d, b = dot(to_u, way), dot(to_v, way), dot(to_d, way), dot(to_d, from_corner)
    ru, rv, rw = spread_in_box(to_u, half), spread_in_box(to_v, half), spread_in_box(to_w, half)
    w, rd = d - u - v, spread_in_box(to_d, half)

    # Compare them with what they may be wrong by.
    m = row_bounds(t[OF_U], t[OF_V], t[BEHIND], far, near, maximum(d, -d) + rd, at)
    hit = surely_hit(Functions(u - ru, v - rv, w - rw, b - rd), m)
    hit = hit & (t[FARTHEST] > (far if longest is None else longest))
    missed = surely_missed(Functions(u + ru, v + rv, w + rw, b + rd), m)
    return hit, missed & (t[FARTHEST] >= ZERO)


@inlined
def verdicts(t, light, direction, end):
    """Bits of the rays, sixteen, each asking one primitive, that are certain to hit it, and of those that miss it.

    Rays go from light (3,) in a direction to their end, three vectors each; t are the columns of the primitives' rows:
    those of others for each ray (`load_columns`), or the same for all (`load_row`)."""
    hit, missed = judge(t, light, end, None, None)
    boxed = t[FARTHEST] < ZERO
    if any_lane(boxed):
        missed = missed | (boxed & segments_miss_box(light, direction, t[U:V], t[V:D]))
    return bits_of(hit), bits_of(missed)
