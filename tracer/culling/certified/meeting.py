"""Sixteen primitives against a beam: which hide the whole cell from the light, and which none of it (`margins`)."""

from __future__ import annotations

import numpy as np

from tracer.culling.certified.beam import CORNERS, PLANES
from tracer.culling.certified.margins import (
    BOX,
    INSIDE,
    LAMP,
    ONE,
    REPORTED,
    ZERO,
    dot,
    farthest_of,
    functions,
    length16,
    margins,
    rows_at,
    seen_from,
)
from tracer.kernels import inlined, subkernel
from tracer.simd import any_lane, bits_of, f32x16, maximum, minimum, select, store

HUGE, ROUNDING = np.float32(3e38), np.float32(4e-7)
FUNCTIONS, BELOW = 4, CORNERS // 2


@inlined
def _short(a):
    return np.float32(a[0]), np.float32(a[1]), np.float32(a[2])


@inlined
def _at(beam, k):
    """Direction to a beam's corner, and that corner."""
    d, p = beam.directions, beam.corners
    return _short((d[0, k], d[1, k], d[2, k])), _short((p[0, k], p[1, k], p[2, k]))


@inlined
def _both(extreme, x):
    return minimum(extreme[0], x), maximum(extreme[1], x)


@inlined
def _over(t, beam):
    """(least and greatest U, V, D - U - V, D - T and D over a beam's corners, their margins, greatest |D|)."""
    start = f32x16(HUGE), f32x16(-HUGE)
    us, vs, ws, bs, ds, near, coordinates = start, start, start, start, start, f32x16(ZERO), ZERO
    for k in range(CORNERS):
        direction, end = _at(beam, k)
        u, v, w, b, d = functions(t, direction, end)
        us, vs, ws, bs, ds = _both(us, u), _both(vs, v), _both(ws, w), _both(bs, b), _both(ds, d)
        near = maximum(near, length16((end[0] - t.corner[0], end[1] - t.corner[1], end[2] - t.corner[2])))
        coordinates = max(coordinates, abs(end[0]) + abs(end[1]) + abs(end[2]))
    along = maximum(ds[1], -ds[0])
    return us, vs, ws, bs, ds, margins(t, np.float32(beam.reach[0]), near, along, coordinates), along


@inlined
def _parting(x, y, low, high):
    """Between which factors of y the sum of two functions, margins added to both, stays negative at one more corner."""
    ratio = -x / y
    low = maximum(low, select(y < ZERO, ratio, ZERO))
    high = minimum(high, select(y > ZERO, ratio, HUGE))
    return low, select((x >= ZERO) & (y >= ZERO), -ONE, high)


@inlined
def _parted_by_two(t, beam, m):
    """Mask of those of which some sum of two functions with positive factors is negative at all corners."""
    start = f32x16(ZERO), f32x16(HUGE)
    ub, vb, wb, uv, uw, vw = start, start, start, start, start, start
    for k in range(CORNERS):
        direction, end = _at(beam, k)
        u, v, w, b, _d = functions(t, direction, end)
        u, v, w, b = u + m.u, v + m.v, w + m.w, b + m.behind
        ub, vb, wb = _parting(u, b, ub[0], ub[1]), _parting(v, b, vb[0], vb[1]), _parting(w, b, wb[0], wb[1])
        uv, uw, vw = _parting(u, v, uv[0], uv[1]), _parting(u, w, uw[0], uw[1]), _parting(v, w, vw[0], vw[1])
    parted = (ub[0] < ub[1]) | (vb[0] < vb[1]) | (wb[0] < wb[1])
    return parted | (uv[0] < uv[1]) | (uw[0] < uw[1]) | (vw[0] < vw[1])


@inlined
def _before_planes(t, m, depth, light, beam):
    """Mask of triangles that lie before a plane of the beam by more than a hit on them may lie beyond."""
    # Twice the part that margins are of the depth, without our own errors.
    part, beyond = maximum(m.u, maximum(m.v, m.w)) / depth, m.behind / depth * np.float32(beam.reach[0])
    parted = depth < ZERO
    for k in range(PLANES):
        plane = beam.planes[k]
        n, offset = _short(plane), np.float32(plane[3] - dot(plane, light))
        g = -dot(t.s, n) - offset
        g1, g2 = g + dot(t.e1, n), g + dot(t.e2, n)
        least, most = minimum(g, minimum(g1, g2)), maximum(g, maximum(g1, g2))
        rounded = ROUNDING * (t.away + t.first + t.second + abs(offset))
        parted = parted | (least > part * (most - least) + beyond + t.blur + rounded)
    return parted & (depth > ZERO)


@inlined
def _beside(row, away, beam):
    """Mask of those whose boxes, in which hits on them are reported, the beam passes by."""
    room = np.float32(REPORTED) * away
    apart = room < ZERO
    for axis in range(3):
        low, high = row[BOX + axis] - room, row[BOX + 3 + axis] + room
        apart = apart | (low > np.float32(beam.box[3 + axis])) | (high < np.float32(beam.box[axis]))
    for k in range(PLANES):
        nearest = f32x16(ZERO)
        for axis in range(3):
            n, low, high = np.float32(beam.planes[k, axis]), row[BOX + axis] - room, row[BOX + 3 + axis] + room
            nearest = nearest + n * (low if n > ZERO else high)
        apart = apart | (nearest > np.float32(beam.planes[k, 3]))
    return apart


@subkernel
def meet_beam(rows, numbers, farthest, light, beam):
    """Of sixteen of rows (n, ROW), whose numbers, int32, are at an address: bits of those that every ray of a beam from
    the light (3,) is certain to hit, and of those that none is.

    A hit is certain only of rays shorter than `farthest`."""
    row = rows_at(rows, numbers)
    t = seen_from(_short(light), row)
    us, vs, ws, bs, ds, m, along = _over(t, beam)
    hit = (
        t.firm
        & (us[0] > np.float32(INSIDE) * m.u)
        & (vs[0] > np.float32(INSIDE) * m.v)
        & (ws[0] > np.float32(INSIDE) * m.w)
        & (bs[0] > m.behind)
    )
    hit = hit & (t.height > np.float32(LAMP) * along)
    beyond = (us[1] < -m.u) | (vs[1] < -m.v) | (ws[1] < -m.w)
    missed = t.firm & (beyond | (bs[1] < -m.behind))
    # Where the light lies in a triangle's plane, as far as one can tell, D may have either sign.
    least, most, of_d = ds[0], ds[1], m.behind + m.w
    backwards = (us[0] > m.u) | (vs[0] > m.v) | (ws[0] > m.w) | (least > of_d)
    missed = missed | (t.sane & (beyond | (most < -of_d)) & backwards)
    depth = maximum(select(t.firm, t.height - m.behind, ZERO), maximum(least - m.d, -most - m.d))
    missed = missed | (t.sane & _before_planes(t, m, depth, light, beam)) | _beside(row, t.away, beam)
    if any_lane(t.firm & ~missed & ~hit):
        missed = missed | (t.firm & _parted_by_two(t, beam, m))
    hit = hit & (farthest_of(farthest, numbers) > np.float32(beam.reach[0]))
    return bits_of(hit), bits_of(missed)


@subkernel
def put_parts(rows, numbers, farthest, light, beam, parts):
    """Functions less their margins at a cell's three corners, whatever the height above, into parts (FUNCTIONS, 3, 16);
    bits of those rows (n, ROW), whose numbers, int32, are at an address, of which these tell what they hide."""
    t = seen_from(_short(light), rows_at(rows, numbers))
    _us, _vs, _ws, _bs, _ds, m, along = _over(t, beam)
    for k in range(BELOW):
        (near, low), (far, high) = _at(beam, k), _at(beam, BELOW + k)
        below, above = functions(t, near, low), functions(t, far, high)
        store(parts + 64 * k, minimum(below[0], above[0]) - np.float32(INSIDE) * m.u)
        store(parts + 64 * (BELOW + k), minimum(below[1], above[1]) - np.float32(INSIDE) * m.v)
        store(parts + 64 * (2 * BELOW + k), minimum(below[2], above[2]) - np.float32(INSIDE) * m.w)
        store(parts + 64 * (3 * BELOW + k), minimum(below[3], above[3]) - m.behind)
    return bits_of(
        t.firm & (t.height > np.float32(LAMP) * along) & (farthest_of(farthest, numbers) > np.float32(beam.reach[0]))
    )
