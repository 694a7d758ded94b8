"""The items of a face: which primitives a ray through it may hit, and the functions that tell where.

All is taken from `tracer.visibility.error_bounds`: U, V, D - U - V and D - T, linear in the way d from the light to
where a ray ends, each with its bound m.  On a face d = z (x, y, 1) in the order of its axes, and |d| is no more than
sqrt(3) z.  So U, V and D - U - V become linear functions of (x, y), whose bounds, for z = 1, are constants.

D - T is what tells near from far.  With |P - a| <= |d| + |s| its bound is no more than A + B z.  A ray can only be
blocked where D - T >= -(A + B z), that is z (D(x, y) + B) / (T - A) >= 1: the *near* function.  It surely passes the
triangle's plane where D - T > A + B z: z (D(x, y) - B) / (T + A) > 1, which is the near function times
(T - A) / (T + A), less 2 B / (T + A): the *far* function.  Here they are computed in float64, and kernels evaluate them
in float32; either is moved by what that may be wrong by, OWN times the sum of its coefficients, and as these are the
same on all of a face, so is that.

Of a primitive that is no triangle, or in whose plane the light lies as far as float32 can tell, only the box is known
outside of which no hit is reported: no ray that ends nearer than the box begins is blocked.  That is so of all others,
too, and of those also that hits lie no further from the triangle than the error radius.
"""

from __future__ import annotations

import numpy as np

from tracer.geometry.memory import without_refcount
from tracer.neighbours.lightbuffer.cube import (
    COVERS,
    HIGH_X,
    HIGH_Y,
    HUGE,
    KEEP,
    LESS,
    LOW_X,
    LOW_Y,
    NEAR,
    NEAREST,
    NEVER,
    NUMBER,
    OF_U,
    OF_V,
    U,
    V,
    W,
    axes_of,
    box_on_face,
    widened,
)
from tracer.runtime.kernels import inlined, kernel, subkernel
from tracer.simd import (
    address_of,
    bits_of,
    i32x16,
    lane_numbers_x16,
    lanes_below,
    load_f32x16,
    local_memory,
    mask16,
    maximum,
    minimum,
    ones,
    pack,
    store,
)
from tracer.visibility.error_bounds import (
    BOX,
    CORNER_ERROR,
    EPSILON,
    LAMP,
    LANES,
    LARGE,
    LARGER,
    REPORTED,
    SMALL,
    ZERO,
    cross,
    factors,
    length,
    rows_at,
    unsure_of_t,
)
from tracer.visibility.light_space import put_light_space
from tracer.visibility.occluders import find_error_radii

DIAGONAL = 1.733  # of a cube whose edge is 2: half of it
OWN = 32 * EPSILON  # of all coefficients, by which a plane in float32 may be wrong
LEAST = 1e-6  # no point is nearer to the light, along the axis of its face, for planes to be asked about it
TINY = float(SMALL) / LEAST  # what volumes must exceed at z = 1
_WIDE, _ROUNDING = 2 * REPORTED, 1e-6


@kernel
def put_error_radii(rows, light, farthest, rounded, radii):
    """How far from each of rows (n, ROW) rays from light (3,), no longer than `farthest`, report hits, into radii
    (n rounded up to LANES,) float32."""
    find_error_radii(rows, light, ZERO, farthest, rounded, radii)


@kernel
def put_rows_of_light(rows, farthest, light, light_space):
    """Prepare rows (n, ROW) for a light at (3,), so that rays can be tested (`put_light_space`)."""
    put_light_space(rows, farthest, (light[0], light[1], light[2]), light_space)


@subkernel
def _may_be_seen(rows, radii, light, face, numbers):
    """Write the numbers of the primitives of which something may lie in the pyramid of a face; how many there are."""
    ax, ay, az, sign = axes_of(face)
    at, n, turn = local_memory(64), 0, np.float32(sign)
    for first in range(0, len(rows), LANES):
        which = minimum(lane_numbers_x16() + np.int32(first), i32x16(np.int32(len(rows) - 1)))
        store(at, which)
        row, beyond = rows_at(rows, at), np.float32(0)
        # Of the triangle's corners, as of the box, the one farthest on a side.
        x, y, z = row[ax] - light[ax], row[ay] - light[ay], (row[az] - light[az]) * turn
        x1, y1, z1 = x + row[3 + ax], y + row[3 + ay], z + row[3 + az] * turn
        x2, y2, z2 = x + row[6 + ax], y + row[6 + ay], z + row[6 + az] * turn
        away = maximum(x, -x) + maximum(y, -y) + maximum(z, -z)
        room = np.float32(2.1) * load_f32x16(address_of(radii) + 4 * first) + np.float32(1e-6) * away
        seen = maximum(z, maximum(z1, z2)) + room > beyond
        seen = seen & (maximum(z - x, maximum(z1 - x1, z2 - x2)) + room > beyond)
        seen = seen & (maximum(z + x, maximum(z1 + x1, z2 + x2)) + room > beyond)
        seen = seen & (maximum(z - y, maximum(z1 - y1, z2 - y2)) + room > beyond)
        seen = seen & (maximum(z + y, maximum(z1 + y1, z2 + y2)) + room > beyond)
        there = bits_of(seen) & lanes_below(len(rows), first >> 4)
        store(address_of(numbers) + 4 * n, pack(which, mask16(there)))
        n += ones(there)
    return n


@inlined
def _turned(v, axes):
    """A vector's components in the order of a face, the last with its sign."""
    return v[axes[0]], v[axes[1]], axes[3] * v[axes[2]]


@inlined
def _put(row, first, v, factor):
    row[first], row[first + 1], row[first + 2] = v[0] * factor, v[1] * factor, v[2] * factor


@subkernel
def _put_span(span, row, away, radius, light, s, e1, e2, axes):
    """Where on the face, and from what depth on, may hits on a primitive be?  s leads from its corner to the light; all
    in the order of the face's axes."""
    left, right, low, high, nearest = HUGE, -HUGE, HUGE, -HUGE, HUGE
    for k in range(3):
        x, y, z = -s[0], -s[1], -s[2]
        if k == 1:
            x, y, z = x + e1[0], y + e1[1], z + e1[2]
        elif k == 2:
            x, y, z = x + e2[0], y + e2[1], z + e2[2]
        nearest = min(nearest, z - radius)
        if z - radius <= 0.0:
            left, right, low, high = -HUGE, HUGE, -HUGE, HUGE
        else:
            left, right = widened(left, right, x - radius, x + radius, z - radius, z + radius)
            low, high = widened(low, high, y - radius, y + radius, z - radius, z + radius)
    # The box, seen from the light.
    room = _WIDE * away
    for axis in range(3):
        room += _ROUNDING * (row[BOX + 3 + axis] - row[BOX + axis])
    x0, x1, y0, y1, z0, z1 = box_on_face(row[BOX:], light, room, axes)
    if z1 <= 0.0:
        return False
    nearest, left, right = max(nearest, z0), max(left, x0), min(right, x1)
    low, high = max(low, y0), min(high, y1)
    span[LOW_X], span[HIGH_X] = left - 1e-6 * abs(left), right + 1e-6 * abs(right)
    span[LOW_Y], span[HIGH_Y] = low - 1e-6 * abs(low), high + 1e-6 * abs(high)
    span[NEAREST] = min(NEVER, 1.000001 / nearest) if nearest > 0.0 else NEVER
    return left <= 1.00001 and right >= -1.00001 and low <= 1.00001 and high >= -1.00001


@subkernel
def _put_functions(item, span, row, sure, farthest, s, e1, e2):
    """Put an item's functions, and whether it may cover anything; `sure` is how long rays may be to be sure of a hit,
    and `farthest` how long they are at most."""
    n, corner_error = cross(e1, e2), np.float64(row[CORNER_ERROR])
    facing = s[0] * n[0] + s[1] * n[1] + s[2] * n[2]
    side = 1.0 if facing >= 0.0 else -1.0
    height, first, second, across, away = abs(facing), length(e1), length(e2), length(n), length(s)
    longer, unsure = max(first, second), unsure_of_t(away, first, second, corner_error)
    f = factors(first, second, longer, across, away, height, corner_error)
    a, b = f.near * away + f.fixed + TINY, DIAGONAL * (f.near + f.far)
    span[COVERS] = 0.0
    if not (height > unsure and height > 2.0 * a and max(away, longer) < LARGE):
        for k in range(W + 3):
            item[k] = 0.0
        item[NEAR], item[NEAR + 1], item[NEAR + 2] = 0.0, 0.0, NEVER
        item[OF_U] = item[OF_V] = 1.0
        item[KEEP], item[LESS] = 0.0, NEVER
        return

    # U, V and D - U - V, all of a size that float32 can square.
    u, v, d = cross(e2, s), cross(s, e1), n
    unit = side / max(across * away, TINY)
    size = abs(unit)
    _put(item, U, u, unit)
    _put(item, V, v, unit)
    _put(item, W, (-d[0] - u[0] - v[0], -d[1] - u[1] - v[1], -d[2] - u[2] - v[2]), unit)
    common = 0.5 * f.d + LARGER * across
    item[OF_U] = size * (DIAGONAL * (f.u + common) + TINY)
    item[OF_V] = size * (DIAGONAL * (f.v + common) + TINY)

    # The near and the far function.
    scale = -side / (height - a)
    _put(item, NEAR, d, scale)
    own = OWN * (abs(d[0]) + abs(d[1]) + abs(d[2])) * abs(scale)
    item[NEAR + 2] += b / (height - a) + own
    item[KEEP] = (height - a) / (height + a)
    item[LESS] = 2.0 * b / (height + a) + 2.0 * own + 1e-12
    span[COVERS] = 1.0 if height > LAMP * across * min(farthest, sure) else 0.0


@kernel
def put_items(rows, radii, light, face, sure, farthest, numbers, items, spans):
    """Put the items of a face into items (n, ITEM) and spans (n, SPAN); how many there are.

    rows (n, ROW), with their error radii, as seen from light (3,) float32 by rays that are no longer than `farthest`;
    those that are shorter than `sure` are certain of hits.  numbers (n + LANES,) int32 is memory."""
    rows, radii, numbers, items, spans = without_refcount((rows, radii, numbers, items, spans))
    count, axes, n = _may_be_seen(rows, radii, light, face, numbers), axes_of(face), 0
    l0, l1, l2 = np.float64(light[0]), np.float64(light[1]), np.float64(light[2])
    for k in range(count):
        i = numbers[k]
        row, item, span = rows[i], items[n], spans[n]
        way = l0 - row[0], l1 - row[1], l2 - row[2]
        first = np.float64(row[3]), np.float64(row[4]), np.float64(row[5])
        second = np.float64(row[6]), np.float64(row[7]), np.float64(row[8])
        s, e1, e2 = _turned(way, axes), _turned(first, axes), _turned(second, axes)
        radius = np.float64(radii[i])
        if not _put_span(span, row, length(s), radius, (l0, l1, l2), s, e1, e2, axes):
            continue
        # Turned axes are a mirror of the world or none: the cross products bear it, as signs are taken of T.
        _put_functions(item, span, row, sure, farthest, s, e1, e2)
        store(address_of(span) + 4 * NUMBER, np.int32(i))
        n += 1
    return n
