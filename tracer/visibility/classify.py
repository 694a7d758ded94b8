"""Classify sixteen primitives against a shaft: which hide the whole cell from the light, and which none of it.

The four functions U, V, D - U - V and D - T of `error_bounds` are linear in where a ray ends, so their extremes over
the shaft lie at its six corners.  They are linear in where it starts, too: over a ball around the light they differ
from their values in its middle by the radius times their gradient at most.  What cannot be decided there is tried
against the shaft's planes and boxes, and what is undecided then remains a candidate.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from tracer.runtime.kernels import inlined, subkernel
from tracer.simd import any_lane, bits_of, f32x16, maximum, minimum, select, store
from tracer.visibility.error_bounds import (
    BOX,
    INSIDE,
    LAMP,
    ONE,
    REPORTED,
    ROW,
    SMALL,
    SURPLUS,
    ZERO,
    Functions,
    beside,
    bounds,
    cross,
    dot,
    factors_of,
    functions,
    grown,
    length16,
    rows_at,
    seen_from,
    spread_in_ball,
    sure_hit_length,
    surely_hit,
    surely_missed,
)
from tracer.visibility.search import classifies
from tracer.visibility.shaft import CORNERS, box_outside
from tracer.visibility.shaft import PRISM_PLANES as PLANES

HUGE, ROUNDING = np.float32(3e38), np.float32(4e-7)
_ROUNDED = np.float32(1.00001)
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
def _both(extreme, low, high):
    """The least and the greatest so far."""
    return minimum(extreme[0], low), maximum(extreme[1], high)


@inlined
def _at_corner(t, shaft, k):
    """The least and the greatest `Functions` of triangles as seen, wherever the light is, at a shaft's k-th corner; D
    for its middle, and that corner."""
    direction, end = _at(shaft, k)
    f, d = functions(t, direction, end)
    if shaft.radius[0] > 0.0:
        p = end[0] - t.corner[0], end[1] - t.corner[1], end[2] - t.corner[2]
        to_u, to_v, n = cross(p, t.e2), cross(t.e1, p), cross(t.e1, t.e2)
        to_w = n[0] - to_u[0] - to_v[0], n[1] - to_u[1] - to_v[1], n[2] - to_u[2] - to_v[2]
        radius = np.float32(shaft.radius[0]) * _ROUNDED
        u, v, w = spread_in_ball(to_u, radius), spread_in_ball(to_v, radius), spread_in_ball(to_w, radius)
        return Functions(f.u - u, f.v - v, f.w - w, f.b), Functions(f.u + u, f.v + v, f.w + w, f.b), d, end
    return f, f, d, end


class _Extremes(NamedTuple):
    """Of triangles as seen: the least and the greatest `Functions` over a prism's corners, and D; the greatest |D|; and
    error bounds, those of D besides."""

    least: Any
    most: Any
    d: Any
    along: Any
    bounds: Any
    of_d: Any


@inlined
def _over(t, shaft):
    """Extremes over a shaft's corners."""
    start = f32x16(HUGE), f32x16(-HUGE)
    us, vs, ws, bs, ds, near, coordinates = start, start, start, start, start, f32x16(ZERO), ZERO
    for k in range(CORNERS):
        f, g, d, end = _at_corner(t, shaft, k)
        us, vs, ws = _both(us, f.u, g.u), _both(vs, f.v, g.v), _both(ws, f.w, g.w)
        bs, ds = _both(bs, f.b, g.b), _both(ds, d, d)
        near = maximum(near, length16((end[0] - t.corner[0], end[1] - t.corner[1], end[2] - t.corner[2])))
        coordinates = max(coordinates, abs(end[0]) + abs(end[1]) + abs(end[2]))
    if shaft.radius[0] > 0.0:
        spread = np.float32(shaft.radius[0]) * _ROUNDED * t.across
        ds = ds[0] - spread, ds[1] + spread
    along, longest, f = maximum(ds[1], -ds[0]), f32x16(np.float32(shaft.longest[0])), factors_of(t)
    of_d = longest * (f.d + np.float32(2 * SURPLUS) * t.corner_error * (t.first + t.second)) + SMALL
    least, most = Functions(us[0], vs[0], ws[0], bs[0]), Functions(us[1], vs[1], ws[1], bs[1])
    return _Extremes(least, most, ds, along, bounds(f, longest, near, along, coordinates), of_d)


@inlined
def _separating(x, y, low, high):
    """Narrow the range of factors for which x + factor y is negative by one more corner.

    x and y are two functions there, error bounds added to both; the range is empty where either is NaN."""
    ratio = -x / y
    low = maximum(low, select(y < ZERO, ratio, ZERO))
    high = minimum(high, select(y > ZERO, ratio, HUGE))
    return low, select((x < ZERO) & (y == y) | (y < ZERO) & (x == x), high, -ONE)


@inlined
def _separated_by_two(t, shaft, m):
    """Mask of triangles of which some sum of two functions with positive factors is negative at all corners."""
    start = f32x16(ZERO), f32x16(HUGE)
    ub, vb, wb, uv, uw, vw = start, start, start, start, start, start
    for k in range(CORNERS):
        _least, f, _d, _end = _at_corner(t, shaft, k)
        u, v, w, b = f.u + m.u, f.v + m.v, f.w + m.w, f.b + m.b
        ub, vb, wb = _separating(u, b, ub[0], ub[1]), _separating(v, b, vb[0], vb[1]), _separating(w, b, wb[0], wb[1])
        uv, uw, vw = _separating(u, v, uv[0], uv[1]), _separating(u, w, uw[0], uw[1]), _separating(v, w, vw[0], vw[1])
    separated = (ub[0] < ub[1]) | (vb[0] < vb[1]) | (wb[0] < wb[1])
    return separated | (uv[0] < uv[1]) | (uw[0] < uw[1]) | (vw[0] < vw[1])


@inlined
def _before_planes(t, m, depth, light, shaft):
    """Mask of triangles that lie before a plane of the shaft, by more than a reported hit may lie beyond them."""
    # Twice m / depth: the bounds are doubled for our own errors, which do not count here.
    part, beyond = maximum(m.u, maximum(m.v, m.w)) / depth, m.b / depth * np.float32(shaft.longest[0])
    separated = depth < ZERO
    for k in range(PLANES):
        plane = shaft.planes[k]
        n, offset = _short(plane), np.float32(plane[3] - dot(plane, light))
        g = -dot(t.s, n) - offset
        g1, g2 = g + dot(t.e1, n), g + dot(t.e2, n)
        least, most = minimum(g, minimum(g1, g2)), maximum(g, maximum(g1, g2))
        rounded = ROUNDING * (t.away + t.first + t.second + abs(offset))
        separated = separated | (least > part * (most - least) + beyond + t.corner_error + rounded)
    return separated & (depth > ZERO)


class PrismQuestion(NamedTuple):
    """Which `Occluders` may come between light `number` at light (3,) and a prism, to which the shaft was put?"""

    occluders: Any
    number: Any
    light: Any
    shaft: Any


@subkernel
def classify_for_prism(question, numbers):
    """Bits of the primitives, sixteen numbers at an address, that every ray into a prism is certain to hit, and of
    those that none hits."""
    rows, farthest, light, shaft = question.occluders.rows, question.occluders.farthest, question.light, question.shaft
    row = rows_at(rows, numbers)
    t = seen_from(_short(light), np.float32(shaft.radius[0]), row)
    over = _over(t, shaft)
    least, most, m = over.least, over.most, over.bounds
    hit = t.sure_side & surely_hit(least, m) & (t.height > np.float32(LAMP) * over.along)
    missed = t.sure_side & surely_missed(most, m)

    # Where the light lies in a triangle's plane, as far as float32 can tell, D may have either sign: try both.
    of_d = m.b + m.w
    backwards = (least.u > m.u) | (least.v > m.v) | (least.w > m.w) | (over.d[0] > of_d)
    missed = missed | (t.in_range & (beside(most, m) | (over.d[1] < -of_d)) & backwards)

    # Or a plane or box separates the triangle from the shaft.
    depth = maximum(select(t.sure_side, t.height - m.b, ZERO), maximum(over.d[0], -over.d[1]) - over.of_d)
    low, high = grown(row[BOX:ROW], np.float32(REPORTED) * t.away)
    missed = missed | (t.in_range & _before_planes(t, m, depth, light, shaft)) | box_outside(shaft, low, high)

    # Or, which takes longest, a plane through one of the triangle's edges does.
    if any_lane(t.sure_side & ~missed & ~hit):
        missed = missed | (t.sure_side & _separated_by_two(t, shaft, m))
    hit = hit & (sure_hit_length(farthest, numbers) > np.float32(shaft.longest[0]))
    return bits_of(hit), bits_of(missed)


classifies(PrismQuestion, classify_for_prism)


@subkernel
def put_hidden_parts(rows, numbers, farthest, light, shaft, parts):
    """The parts of a cell that each of sixteen triangles hides, where all four functions are positive.

    Functions less their error bounds go into parts (FUNCTIONS, 3, 16) float32 at the address `parts`, at the cell's
    three corners, of floor and ceiling whichever is less.  Bits of the triangles of which they hold.  The numbers,
    int32, of the triangles among rows (n, ROW) are at an address."""
    t = seen_from(_short(light), np.float32(shaft.radius[0]), rows_at(rows, numbers))
    over = _over(t, shaft)
    m = over.bounds
    for k in range(BELOW):
        below, above = _at_corner(t, shaft, k)[0], _at_corner(t, shaft, BELOW + k)[0]
        store(parts + 64 * k, minimum(below.u, above.u) - np.float32(INSIDE) * m.u)
        store(parts + 64 * (BELOW + k), minimum(below.v, above.v) - np.float32(INSIDE) * m.v)
        store(parts + 64 * (2 * BELOW + k), minimum(below.w, above.w) - np.float32(INSIDE) * m.w)
        store(parts + 64 * (3 * BELOW + k), minimum(below.b, above.b) - m.b)
    return bits_of(
        t.sure_side
        & (t.height > np.float32(LAMP) * over.along)
        & (sure_hit_length(farthest, numbers) > np.float32(shaft.longest[0]))
    )
