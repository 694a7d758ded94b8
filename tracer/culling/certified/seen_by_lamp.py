"""What a lamp sees of triangles: whether they hide it from points, all of its samples or which of them.

Sixteen triangles are prepared together for a lamp (`prepared_triangles`).  Then each is asked about sixteen points and
all of the lamp at once (`ask_points`), by the functions of `error_bounds`, at the lamp's centre, and how much they may
change within its ball; or all sixteen are asked about one point (`ask_triangles`).  Where that cannot tell, a triangle
is asked about one point and sixteen samples at a time (`ask_samples`): there, functions are those at the centre and
their gradient times where the sample is.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from tracer.culling.certified.error_bounds import (
    ENLARGED,
    EPSILON,
    INSIDE,
    LAMP,
    ONE,
    SMALL,
    SURPLUS,
    ZERO,
    cross,
    dot,
    length16,
    scaled,
)
from tracer.culling.certified.prepared_triangles import (
    BEHIND,
    CORNER,
    FAR,
    FIRM,
    HEIGHT,
    HIGH,
    LOW,
    NEAR,
    OF_U,
    OF_V,
    OF_W,
    REACH,
    SURE,
    TURNED_FIRST,
    TURNED_SECOND,
    UNSURE,
    D,
    U,
    V,
    number_at,
    numbers_at,
    three_at,
    vector_at,
)
from tracer.geometry.boxes import segments_miss_box
from tracer.runtime.kernels import inlined, subkernel
from tracer.simd import (
    bits_of,
    f32x16,
    fma,
    load_f32x16,
    load_i32,
    maximum,
    select,
    size_of,
    store,
    store_three,
)

# Vectors that are kept of sixteen points and one triangle, or of one point and sixteen triangles: U, V and D at the
# centre, the gradients of U and V, D - T, error bounds of U, V, W and D - T, and the points.
AT_U, AT_V, AT_D, GRADIENT_U, GRADIENT_V, AT_BEHIND = 0, 1, 2, 3, 6, 9
BOUND_U, BOUND_V, BOUND_W, BOUND_BEHIND, POINT = range(10, 15)
KEPT = 64 * (POINT + 3)  # bytes
MOST_SAMPLES = 1024
PLACES = 4 * MOST_SAMPLES  # bytes between rows of samples: three of offsets from the centre, then three of places
SAMPLES = 6 * PLACES
_LARGER = np.float32(2 * SURPLUS * (ENLARGED + 6 * EPSILON))
_INSIDE, _LAMP, _HALF = np.float32(INSIDE), np.float32(LAMP), np.float32(0.5)


@subkernel
def put_samples(samples, first, count, light, room):
    """Put `count` of a lamp's samples (any, 3) float32, from the first on, to the address `room`, as offsets from light
    (3,) and as they are; how many vectors of sixteen they make.  The last is filled up by others again."""
    groups = (count + 15) // 16
    for k in range(16 * groups):
        sample = first + k % count
        for axis in range(3):
            at = room + PLACES * axis + 4 * k
            store(at, samples[sample, axis] - light[axis])
            store(at + 3 * PLACES, samples[sample, axis])
    return groups


class _Columns(NamedTuple):
    """Columns of one prepared triangle as numbers, or of sixteen as vectors."""

    corner: Any
    turned_first: Any
    turned_second: Any
    u: Any
    v: Any
    d: Any
    of_u: Any
    of_v: Any
    of_w: Any
    near: Any
    far: Any
    behind: Any
    reach: Any
    height: Any
    unsure: Any
    sure: Any


@inlined
def _of_one(at):
    """The columns of the triangle whose numbers are at an address."""
    vectors = numbers_at(at, CORNER), numbers_at(at, TURNED_FIRST), numbers_at(at, TURNED_SECOND)
    functions = numbers_at(at, U), numbers_at(at, V), numbers_at(at, D)
    bounds = number_at(at, OF_U), number_at(at, OF_V), number_at(at, OF_W)
    bounds_behind = number_at(at, NEAR), number_at(at, FAR), number_at(at, BEHIND)
    heights = number_at(at, REACH), number_at(at, HEIGHT), number_at(at, UNSURE), number_at(at, SURE)
    return _Columns(*vectors, *functions, *bounds, *bounds_behind, *heights)


@inlined
def _of_all(at):
    """The columns of the sixteen triangles at an address."""
    vectors = three_at(at, CORNER), three_at(at, TURNED_FIRST), three_at(at, TURNED_SECOND)
    functions = three_at(at, U), three_at(at, V), three_at(at, D)
    bounds = vector_at(at, OF_U), vector_at(at, OF_V), vector_at(at, OF_W)
    bounds_behind = vector_at(at, NEAR), vector_at(at, FAR), vector_at(at, BEHIND)
    heights = vector_at(at, REACH), vector_at(at, HEIGHT), vector_at(at, UNSURE), vector_at(at, SURE)
    return _Columns(*vectors, *functions, *bounds, *bounds_behind, *heights)


class _Rays(NamedTuple):
    """Rays from a lamp to points, as triangles see them: from the triangle's corner and from the lamp's centre to the
    point; how long they are at most; D - T, and by how much that may be wrong."""

    near: Any
    way: Any
    longest: Any
    behind: Any
    bound: Any


@inlined
def _rays(t, end, light, radius):
    """The rays from a lamp, a ball of a radius around light (3,), to `end`."""
    near = end[0] - t.corner[0], end[1] - t.corner[1], end[2] - t.corner[2]
    way = end[0] - light[0], end[1] - light[1], end[2] - light[2]
    longest = length16(way) + radius
    bound = length16(near) * t.near + t.behind + (longest + _HALF * size_of(end)) * t.far
    return _Rays(near, way, longest, dot(t.d, near), bound)


class _Answers(NamedTuple):
    """What triangles do to rays, as masks of lanes, and in brackets where the sign of T is not certain: `hidden` is all
    of the lamp; `missed` (`missed_here`) nothing of it; and a hit `can` (`can_here`) be certain."""

    hidden: Any
    missed: Any
    can: Any
    missed_here: Any
    can_here: Any


@inlined
def _compare(t, rays, end, radius, kept):
    """Evaluate the functions at the lamp's centre, bound how much they change within its ball and how wrong they may
    be, and compare them; what `ask_samples` wants to know goes to the address `kept`."""
    u, v, d = dot(t.u, rays.way), dot(t.v, rays.way), dot(t.d, rays.way)
    w = d - u - v
    to_u, to_v = cross(rays.near, t.turned_second), cross(t.turned_first, rays.near)
    to_w = -t.d[0] - to_u[0] - to_v[0], -t.d[1] - to_u[1] - to_v[1], -t.d[2] - to_u[2] - to_v[2]
    by_u, by_v, by_w = radius * length16(to_u), radius * length16(to_v), radius * length16(to_w)

    along = maximum(d, -d) + t.reach
    larger = _LARGER * along + SMALL
    of_u, of_v, of_w = t.of_u * rays.longest + larger, t.of_v * rays.longest + larger, t.of_w * rays.longest + larger
    store(kept + 64 * AT_U, u)
    store(kept + 64 * AT_V, v)
    store(kept + 64 * AT_D, d)
    store_three(kept + 64 * GRADIENT_U, 64, to_u)
    store_three(kept + 64 * GRADIENT_V, 64, to_v)
    store(kept + 64 * BOUND_U, of_u)
    store(kept + 64 * BOUND_V, of_v)
    store(kept + 64 * BOUND_W, of_w)
    store(kept + 64 * AT_BEHIND, rays.behind)
    store(kept + 64 * BOUND_BEHIND, rays.bound)
    store_three(kept + 64 * POINT, 64, end)

    short = t.sure > rays.longest
    can = (rays.behind > rays.bound) & short
    inside = (u - by_u > _INSIDE * of_u) & (v - by_v > _INSIDE * of_v) & (w - by_w > _INSIDE * of_w)
    hidden = can & inside & (t.height > _LAMP * along)
    missed = (u + by_u < -of_u) | (v + by_v < -of_v) | (w + by_w < -of_w) | (rays.behind < -rays.bound)
    side = select(rays.behind >= ZERO, f32x16(ONE), f32x16(-ONE))
    certain = maximum(rays.behind, -rays.behind) > rays.bound
    past = (side * u + by_u < -of_u) | (side * v + by_v < -of_v) | (side * w + by_w < -of_w)
    past = certain & (past | (side * (t.height + t.reach) + t.reach < -t.unsure))
    return _Answers(hidden, missed, can, past, certain & short)


@subkernel
def ask_points(triangle, end, light, radius, kept):
    """What the rays from a lamp, a ball of a radius around light (3,) float32, to sixteen points `end` are certain of.

    The prepared triangle's numbers are at an address.  (bits of the points from which it hides all of the lamp, of
    those from which none, and of those from which it may hide a sample for certain).  For `ask_samples` what is known
    of the points goes to the address `kept`, KEPT bytes, unless the triangle hides no sample from any."""
    t, firm = _of_one(triangle), number_at(triangle, FIRM)
    rays = _rays(t, end, light, radius)
    if firm > ZERO and bits_of(rays.behind < -rays.bound) == 0xFFFF:
        return 0, 0xFFFF, 0
    a = _compare(t, rays, end, radius, kept)
    if firm > ZERO:
        return bits_of(a.hidden), bits_of(a.missed), bits_of(a.can)
    if firm < ZERO:
        return 0, 0, 0
    return 0, bits_of(a.missed_here), bits_of(a.can_here)


@subkernel
def ask_triangles(made, point, light, radius, kept):
    """What the rays from a lamp, a ball of a radius around light (3,) float32, to one `point`, three float32, are
    certain of.

    (bits of the sixteen prepared triangles that hide all of the lamp, of those that hide nothing of it, and of those
    that may hide a sample for certain).  For `ask_samples` what is known of each triangle goes to the address `kept`,
    KEPT bytes."""
    t, firm = _of_all(made), vector_at(made, FIRM)
    end = f32x16(point[0]), f32x16(point[1]), f32x16(point[2])
    a = _compare(t, _rays(t, end, light, radius), end, radius, kept)
    firmly, here = bits_of(firm > ZERO), bits_of(firm == ZERO)
    missed = firmly & bits_of(a.missed) | here & bits_of(a.missed_here)
    return firmly & bits_of(a.hidden), missed, firmly & bits_of(a.can) | here & bits_of(a.can_here)


@subkernel
def ask_samples(triangle, kept, lane, can, samples, groups, blocked, unsure):
    """Which of a lamp's samples does a triangle hide from one point?  `kept` has in a lane what `ask_points`, or
    `ask_triangles`, found of both.

    Samples, as `put_samples` put them, are `groups` of sixteen.  Those that are hidden for certain join the bits at the
    address `blocked`, int32 for sixteen samples each, if the triangle `can` hide any for certain; those of which
    nothing is certain join `unsure`.  Whether all are blocked."""
    t, k = triangle, kept + 4 * lane
    behind, firm, every = number_at(k, AT_BEHIND), number_at(t, FIRM), np.int64(0xFFFF)
    side = ONE if firm > ZERO or behind >= ZERO else -ONE
    if firm > ZERO or (firm == ZERO and abs(behind) > number_at(k, BOUND_BEHIND)):
        u0, v0, d0 = side * number_at(k, AT_U), side * number_at(k, AT_V), side * number_at(k, AT_D)
        w0 = d0 - u0 - v0
        to_u, to_v = scaled(numbers_at(k, GRADIENT_U), side), scaled(numbers_at(k, GRADIENT_V), side)
        of_d = scaled(numbers_at(t, D), -side)
        to_w = of_d[0] - to_u[0] - to_v[0], of_d[1] - to_u[1] - to_v[1], of_d[2] - to_u[2] - to_v[2]
        of_u, of_v, of_w = number_at(k, BOUND_U), number_at(k, BOUND_V), number_at(k, BOUND_W)
        least, reach, of_height = number_at(t, HEIGHT), number_at(t, REACH), number_at(t, UNSURE)
        # Is the lamp so high above the triangle's plane, everywhere, that its height decides nothing?
        high = firm > ZERO and least > _LAMP * (abs(d0) + reach)
        for group in range(groups):
            if load_i32(blocked + 4 * group) == 0xFFFF:
                continue
            at = samples + 64 * group
            offset = load_f32x16(at), load_f32x16(at + PLACES), load_f32x16(at + 2 * PLACES)
            u, v, w = _further(u0, to_u, offset), _further(v0, to_v, offset), _further(w0, to_w, offset)
            missed = (u < -of_u) | (v < -of_v) | (w < -of_w)
            inside = (u > _INSIDE * of_u) & (v > _INSIDE * of_v) & (w > _INSIDE * of_w)
            if not high:
                less = _further(ZERO, of_d, offset)
                d, height = d0 + less, side * (least + reach) + less
                missed = missed | (height < -of_height)
                inside = inside & (height > of_height) & (height > _LAMP * d)
            every &= _note(blocked + 4 * group, unsure + 4 * group, bits_of(inside) if can else 0, bits_of(missed))
        return every == 0xFFFF
    x, y, z = numbers_at(k, POINT)
    low, high = numbers_at(t, LOW), numbers_at(t, HIGH)
    for group in range(groups):
        at = samples + 64 * group + 3 * PLACES
        start = load_f32x16(at), load_f32x16(at + PLACES), load_f32x16(at + 2 * PLACES)
        missed = segments_miss_box(start, (x - start[0], y - start[1], z - start[2]), low, high)
        every &= _note(blocked + 4 * group, unsure + 4 * group, np.int64(0), bits_of(missed) if firm == ZERO else 0)
    return every == 0xFFFF


@inlined
def _further(at_centre, gradient, offset):
    """A linear function at places that are off the centre of a lamp."""
    nearly = fma(gradient[1], offset[1], fma(gradient[2], offset[2], f32x16(at_centre)))
    return fma(gradient[0], offset[0], nearly)


@inlined
def _note(blocked, unsure, hit, missed):
    """Join bits of sixteen samples at two addresses: those that are hit, which are returned with those that were
    before, and those that are neither that nor missed."""
    hit |= np.int64(load_i32(blocked))
    store(blocked, np.int32(hit))
    store(unsure, np.int32(np.int64(load_i32(unsure)) | (0xFFFF & ~(hit | missed))))
    return hit
