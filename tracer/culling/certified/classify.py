"""Classify sixteen primitives against a shaft: which hide the whole cell from the light, and which none of it.

The four functions U, V, D - U - V and D - T of `error_bounds` are linear in where a ray ends, so their extremes over
the shaft lie at its six corners.  What cannot be decided there is tried against the shaft's planes and boxes, and what
is undecided then remains a candidate.
"""

from __future__ import annotations

import numpy as np

from tracer.culling.certified.error_bounds import (
    BOX,
    INSIDE,
    LAMP,
    ONE,
    REPORTED,
    ZERO,
    dot,
    error_bounds,
    functions,
    length16,
    rows_at,
    seen_from,
    sure_hit_length,
)
from tracer.culling.certified.shaft import CORNERS, PLANES
from tracer.runtime.kernels import inlined, subkernel
from tracer.simd import any_lane, bits_of, f32x16, maximum, minimum, select, store

HUGE, ROUNDING = np.float32(3e38), np.float32(4e-7)
FUNCTIONS, BELOW = 4, CORNERS // 2


@inlined
def _short(a):
    """Three numbers, in float32."""
    return np.float32(a[0]), np.float32(a[1]), np.float32(a[2])


@inlined
def _at(shaft, k):
    """The direction to a shaft's k-th corner, and that corner, in float32."""
    d, p = shaft.directions, shaft.corners
    return _short((d[0, k], d[1, k], d[2, k])), _short((p[0, k], p[1, k], p[2, k]))


@inlined
def _both(extreme, x):
    """The least and the greatest so far."""
    return minimum(extreme[0], x), maximum(extreme[1], x)


@inlined
def _over(t, shaft):
    """Extremes over a shaft's corners.

    (least and greatest U, V, D - U - V, D - T and D; their error bounds; the greatest |D|), of triangles as seen."""
    start = f32x16(HUGE), f32x16(-HUGE)
    us, vs, ws, bs, ds, near, coordinates = start, start, start, start, start, f32x16(ZERO), ZERO
    for k in range(CORNERS):
        direction, end = _at(shaft, k)
        u, v, w, b, d = functions(t, direction, end)
        us, vs, ws, bs, ds = _both(us, u), _both(vs, v), _both(ws, w), _both(bs, b), _both(ds, d)
        near = maximum(near, length16((end[0] - t.corner[0], end[1] - t.corner[1], end[2] - t.corner[2])))
        coordinates = max(coordinates, abs(end[0]) + abs(end[1]) + abs(end[2]))
    along = maximum(ds[1], -ds[0])
    return us, vs, ws, bs, ds, error_bounds(t, np.float32(shaft.longest[0]), near, along, coordinates), along


@inlined
def _parting(x, y, low, high):
    """Narrow the range of factors for which x + factor y is negative by one more corner.

    x and y are two functions there, error bounds added to both."""
    ratio = -x / y
    low = maximum(low, select(y < ZERO, ratio, ZERO))
    high = minimum(high, select(y > ZERO, ratio, HUGE))
    return low, select((x >= ZERO) & (y >= ZERO), -ONE, high)


@inlined
def _parted_by_two(t, shaft, m):
    """Mask of triangles of which some sum of two functions with positive factors is negative at all corners."""
    start = f32x16(ZERO), f32x16(HUGE)
    ub, vb, wb, uv, uw, vw = start, start, start, start, start, start
    for k in range(CORNERS):
        direction, end = _at(shaft, k)
        u, v, w, b, _d = functions(t, direction, end)
        u, v, w, b = u + m.u, v + m.v, w + m.w, b + m.behind
        ub, vb, wb = _parting(u, b, ub[0], ub[1]), _parting(v, b, vb[0], vb[1]), _parting(w, b, wb[0], wb[1])
        uv, uw, vw = _parting(u, v, uv[0], uv[1]), _parting(u, w, uw[0], uw[1]), _parting(v, w, vw[0], vw[1])
    parted = (ub[0] < ub[1]) | (vb[0] < vb[1]) | (wb[0] < wb[1])
    return parted | (uv[0] < uv[1]) | (uw[0] < uw[1]) | (vw[0] < vw[1])


@inlined
def _before_planes(t, m, depth, light, shaft):
    """Mask of triangles that lie before a plane of the shaft, by more than a reported hit may lie beyond them."""
    # Twice m / depth: the bounds are doubled for our own errors, which do not count here.
    part, beyond = maximum(m.u, maximum(m.v, m.w)) / depth, m.behind / depth * np.float32(shaft.longest[0])
    parted = depth < ZERO
    for k in range(PLANES):
        plane = shaft.planes[k]
        n, offset = _short(plane), np.float32(plane[3] - dot(plane, light))
        g = -dot(t.s, n) - offset
        g1, g2 = g + dot(t.e1, n), g + dot(t.e2, n)
        least, most = minimum(g, minimum(g1, g2)), maximum(g, maximum(g1, g2))
        rounded = ROUNDING * (t.away + t.first + t.second + abs(offset))
        parted = parted | (least > part * (most - least) + beyond + t.blur + rounded)
    return parted & (depth > ZERO)


@inlined
def _beside(row, away, shaft):
    """Mask of primitives whose box, outside of which no hit on them is reported, the shaft passes by."""
    room = np.float32(REPORTED) * away
    apart = room < ZERO
    for axis in range(3):
        low, high = row[BOX + axis] - room, row[BOX + 3 + axis] + room
        apart = apart | (low > np.float32(shaft.box[3 + axis])) | (high < np.float32(shaft.box[axis]))
    for k in range(PLANES):
        nearest = f32x16(ZERO)
        for axis in range(3):
            n, low, high = np.float32(shaft.planes[k, axis]), row[BOX + axis] - room, row[BOX + 3 + axis] + room
            nearest = nearest + n * (low if n > ZERO else high)
        apart = apart | (nearest > np.float32(shaft.planes[k, 3]))
    return apart


@subkernel
def classify_occluders(rows, numbers, farthest, light, shaft):
    """Which of sixteen primitives every ray of a shaft is certain to hit, and which none is: bits of both.

    rows (n, ROW); the primitives' numbers, int32, are at an address; light (3,); only rays that are shorter than
    `farthest` (SureHitLength) are certain of a hit."""
    row = rows_at(rows, numbers)
    t = seen_from(_short(light), ZERO, row)
    us, vs, ws, bs, ds, m, along = _over(t, shaft)
    # Hit for certain: all functions clear their bounds at all corners.
    hit = (
        t.firm
        & (us[0] > np.float32(INSIDE) * m.u)
        & (vs[0] > np.float32(INSIDE) * m.v)
        & (ws[0] > np.float32(INSIDE) * m.w)
        & (bs[0] > m.behind)
    )
    hit = hit & (t.height > np.float32(LAMP) * along)

    # Missed for certain: one function is negative by more than its bound at all corners.
    beyond = (us[1] < -m.u) | (vs[1] < -m.v) | (ws[1] < -m.w)
    missed = t.firm & (beyond | (bs[1] < -m.behind))

    # Where the light lies in a triangle's plane, as far as float32 can tell, D may have either sign: try both.
    least, most, of_d = ds[0], ds[1], m.behind + m.w
    backwards = (us[0] > m.u) | (vs[0] > m.v) | (ws[0] > m.w) | (least > of_d)
    missed = missed | (t.sane & (beyond | (most < -of_d)) & backwards)

    # Or a plane or box parts the triangle from the shaft.
    depth = maximum(select(t.firm, t.height - m.behind, ZERO), maximum(least - m.d, -most - m.d))
    missed = missed | (t.sane & _before_planes(t, m, depth, light, shaft)) | _beside(row, t.away, shaft)

    # Or, which takes longest, a plane through one of the triangle's edges does.
    if any_lane(t.firm & ~missed & ~hit):
        missed = missed | (t.firm & _parted_by_two(t, shaft, m))
    hit = hit & (sure_hit_length(farthest, numbers) > np.float32(shaft.longest[0]))
    return bits_of(hit), bits_of(missed)


@subkernel
def put_hidden_parts(rows, numbers, farthest, light, shaft, parts):
    """The parts of a cell that each of sixteen triangles hides, where all four functions are positive.

    Functions less their error bounds go into parts (FUNCTIONS, 3, 16) float32 at the address `parts`, at the cell's
    three corners, of floor and ceiling whichever is less.  Bits of the triangles of which they hold.  The numbers,
    int32, of the triangles among rows (n, ROW) are at an address."""
    t = seen_from(_short(light), ZERO, rows_at(rows, numbers))
    _us, _vs, _ws, _bs, _ds, m, along = _over(t, shaft)
    for k in range(BELOW):
        (near, low), (far, high) = _at(shaft, k), _at(shaft, BELOW + k)
        below, above = functions(t, near, low), functions(t, far, high)
        store(parts + 64 * k, minimum(below[0], above[0]) - np.float32(INSIDE) * m.u)
        store(parts + 64 * (BELOW + k), minimum(below[1], above[1]) - np.float32(INSIDE) * m.v)
        store(parts + 64 * (2 * BELOW + k), minimum(below[2], above[2]) - np.float32(INSIDE) * m.w)
        store(parts + 64 * (3 * BELOW + k), minimum(below[3], above[3]) - m.behind)
    return bits_of(
        t.firm
        & (t.height > np.float32(LAMP) * along)
        & (sure_hit_length(farthest, numbers) > np.float32(shaft.longest[0]))
    )
