"""What a lamp sees of triangles: whether they hide it from points, all of its samples or which of them.

Sixteen triangles are prepared together for a lamp (`prepared_triangles`).  Then each is asked about sixteen points and
all of the lamp at once (`ask_points`), by the functions of `error_bounds`, at the lamp's centre, and how much they may
change within its ball; or all sixteen are asked about one point (`ask_triangles`).  Where that cannot tell, a triangle
is asked about one point and sixteen samples at a time (`ask_samples`), or about one sample and sixteen points
(`hide_samples`): there, functions are those at the centre and their gradient times where the sample is.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from tracer.geometry.boxes import segments_miss_box
from tracer.runtime.kernels import inlined, subkernel
from tracer.simd import (
    bits_of,
    f32x16,
    fma,
    load_f32,
    load_f32x16,
    load_i32,
    maximum,
    select,
    size_of,
    store,
    store_three,
)
from tracer.visibility.error_bounds import (
    LAMP,
    ONE,
    ZERO,
    Factors,
    Functions,
    beside,
    bound_of_b,
    bounds,
    cross,
    dot,
    inside,
    length16,
    scaled,
    spread_in_ball,
    surely_hit,
    surely_missed,
)
from tracer.visibility.prepared_triangles import (
    CORNER,
    FAR,
    FIXED,
    HEIGHT,
    HIGH,
    LOW,
    NEAR,
    OF_U,
    OF_V,
    OF_W,
    REACH,
    SIGNED_FIRST,
    SIGNED_SECOND,
    SURE,
    SURE_SIDE,
    UNSURE,
    D,
    U,
    V,
    column_at,
    columns_at,
    number_at,
)

# Vectors that are kept of sixteen points and one triangle, or of one point and sixteen triangles: U, V and D at the
# centre, the gradients of U and V, B, error bounds of U, V, W and B, and the points.
AT_U, AT_V, AT_D, GRADIENT_U, GRADIENT_V, AT_B = 0, 1, 2, 3, 6, 9
BOUND_U, BOUND_V, BOUND_W, BOUND_B, POINT = range(10, 15)
KEPT = 64 * (POINT + 3)  # bytes
MOST_SAMPLES = 1024
PLACES = 4 * MOST_SAMPLES  # bytes between rows of samples: three of offsets from the centre, then three of places
SAMPLES = 6 * PLACES
_LAMP = np.float32(LAMP)


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
    """Columns of sixteen prepared triangles, or of one in all lanes."""

    corner: Any
    signed_first: Any
    signed_second: Any
    u: Any
    v: Any
    d: Any
    factors: Factors
    reach: Any
    height: Any
    unsure: Any
    sure: Any


@inlined
def _columns(at, one):
    """The columns of prepared triangles at an address (`column_at`)."""
    corner, edges = (
        columns_at(at, CORNER, one),
        (columns_at(at, SIGNED_FIRST, one), columns_at(at, SIGNED_SECOND, one)),
    )
    u, v, w = column_at(at, OF_U, one), column_at(at, OF_V, one), column_at(at, OF_W, one)
    factors = Factors(u, v, w, w, column_at(at, NEAR, one), column_at(at, FAR, one), column_at(at, FIXED, one))
    functions = columns_at(at, U, one), columns_at(at, V, one), columns_at(at, D, one)
    reach, height = column_at(at, REACH, one), column_at(at, HEIGHT, one)
    unsure, sure = column_at(at, UNSURE, one), column_at(at, SURE, one)
    return _Columns(corner, *edges, *functions, factors, reach, height, unsure, sure)


class _Rays(NamedTuple):
    """Rays from a lamp to points, as triangles see them: from the triangle's corner and from the lamp's centre to the
    point; how long they are at most; and B, and by how much that may be wrong."""

    near: Any
    way: Any
    longest: Any
    b: Any
    of_b: Any


@inlined
def _rays(t, end, light, radius):
    """The rays from a lamp, a ball of a radius around light (3,), to `end`."""
    near = end[0] - t.corner[0], end[1] - t.corner[1], end[2] - t.corner[2]
    way = end[0] - light[0], end[1] - light[1], end[2] - light[2]
    longest = length16(way) + radius
    return _Rays(near, way, longest, dot(t.d, near), bound_of_b(t.factors, longest, length16(near), size_of(end)))


class _Answers(NamedTuple):
    """What triangles do to rays, as masks of lanes: `hidden` is all of the lamp, `missed` nothing of it, and a hit
    `can` be certain; `missed_here` and `can_here` hold where it is not certain on which side of them the lamp is."""

    hidden: Any
    missed: Any
    can: Any
    missed_here: Any
    can_here: Any


@inlined
def _compare(t, rays, end, radius, kept):
    """Compare the extremes of the functions over the lamp's ball with their bounds; what `ask_samples` wants to know
    goes to the address `kept`."""
    u, v, d, b = dot(t.u, rays.way), dot(t.v, rays.way), dot(t.d, rays.way), rays.b
    w, along = d - u - v, maximum(d, -d) + t.reach
    to_u, to_v = cross(rays.near, t.signed_second), cross(t.signed_first, rays.near)
    to_w = -t.d[0] - to_u[0] - to_v[0], -t.d[1] - to_u[1] - to_v[1], -t.d[2] - to_u[2] - to_v[2]
    by_u, by_v, by_w = spread_in_ball(to_u, radius), spread_in_ball(to_v, radius), spread_in_ball(to_w, radius)
    m = bounds(t.factors, rays.longest, length16(rays.near), along, size_of(end))
    store(kept + 64 * AT_U, u)
    store(kept + 64 * AT_V, v)
    store(kept + 64 * AT_D, d)
    store_three(kept + 64 * GRADIENT_U, 64, to_u)
    store_three(kept + 64 * GRADIENT_V, 64, to_v)
    store(kept + 64 * BOUND_U, m.u)
    store(kept + 64 * BOUND_V, m.v)
    store(kept + 64 * BOUND_W, m.w)
    store(kept + 64 * AT_B, b)
    store(kept + 64 * BOUND_B, m.b)
    store_three(kept + 64 * POINT, 64, end)

    short = t.sure > rays.longest
    hidden = short & surely_hit(Functions(u - by_u, v - by_v, w - by_w, b), m) & (t.height > _LAMP * along)
    missed = surely_missed(Functions(u + by_u, v + by_v, w + by_w, b), m)
    # Where the sign of T is not certain, B has that of D.
    side, certain = select(b >= ZERO, f32x16(ONE), f32x16(-ONE)), maximum(b, -b) > m.b
    past = beside(Functions(side * u + by_u, side * v + by_v, side * w + by_w, b), m)
    past = certain & (past | (side * (t.height + t.reach) + t.reach < -t.unsure))
    return _Answers(hidden, missed, (b > m.b) & short, past, certain & short)


@subkernel
def ask_points(triangle, end, light, radius, kept):
    """What the rays from a lamp, a ball of a radius around light (3,) float32, to sixteen points `end` are certain of.

    The prepared triangle's numbers are at an address.  (bits of the points from which it hides all of the lamp, of
    those from which none, and of those from which it may hide a sample for certain).  For `ask_samples` what is known
    of the points goes to the address `kept`, KEPT bytes, unless the triangle hides no sample from any."""
    t, sure_side = _columns(triangle, True), number_at(triangle, SURE_SIDE)
    rays = _rays(t, end, light, radius)
    if sure_side > ZERO and bits_of(rays.b < -rays.of_b) == 0xFFFF:
        return 0, 0xFFFF, 0
    a = _compare(t, rays, end, radius, kept)
    if sure_side > ZERO:
        return bits_of(a.hidden), bits_of(a.missed), bits_of(a.can)
    if sure_side < ZERO:
        return 0, 0, 0
    return 0, bits_of(a.missed_here), bits_of(a.can_here)


@subkernel
def ask_triangles(made, point, light, radius, kept):
    """What the rays from a lamp, a ball of a radius around light (3,) float32, to one `point`, three float32, are
    certain of.

    (bits of the sixteen prepared triangles that hide all of the lamp, of those that hide nothing of it, and of those
    that may hide a sample for certain).  For `ask_samples` what is known of each triangle goes to the address `kept`,
    KEPT bytes."""
    t, sure_side = _columns(made, False), column_at(made, SURE_SIDE, False)
    end = f32x16(point[0]), f32x16(point[1]), f32x16(point[2])
    a = _compare(t, _rays(t, end, light, radius), end, radius, kept)
    certain, here = bits_of(sure_side > ZERO), bits_of(sure_side == ZERO)
    missed = certain & bits_of(a.missed) | here & bits_of(a.missed_here)
    return certain & bits_of(a.hidden), missed, certain & bits_of(a.can) | here & bits_of(a.can_here)


# --- samples ----------------------------------------------------------------------------------------------


class _AtCentre(NamedTuple):
    """A triangle and points, or one in all lanes: the functions, D and T of rays from the lamp's centre, their
    gradients there, and what they may be wrong by, with such signs that the triangle is seen from its front."""

    at: Functions
    d: Any
    height: Any
    to_u: Any
    to_v: Any
    to_w: Any
    to_d: Any
    bounds: Functions
    of_height: Any


@inlined
def _at_centre(triangle, kept, one, side):
    """What is `kept` of a triangle and points, or of one, seen from one side of it, 1 or -1 in each lane."""
    u, v, d = side * column_at(kept, AT_U, one), side * column_at(kept, AT_V, one), side * column_at(kept, AT_D, one)
    to_u, to_v = scaled(columns_at(kept, GRADIENT_U, one), side), scaled(columns_at(kept, GRADIENT_V, one), side)
    to_d = scaled(columns_at(triangle, D, True), -side)
    to_w = to_d[0] - to_u[0] - to_v[0], to_d[1] - to_u[1] - to_v[1], to_d[2] - to_u[2] - to_v[2]
    of_u, of_v, of_w = column_at(kept, BOUND_U, one), column_at(kept, BOUND_V, one), column_at(kept, BOUND_W, one)
    height = side * (column_at(triangle, HEIGHT, True) + column_at(triangle, REACH, True))
    at, m = Functions(u, v, d - u - v, d), Functions(of_u, of_v, of_w, of_w)  # B has been compared
    return _AtCentre(at, d, height, to_u, to_v, to_w, to_d, m, column_at(triangle, UNSURE, True))


@inlined
def _further(at_centre, gradient, offset):
    """A linear function at places that are off the centre of a lamp."""
    return fma(gradient[0], offset[0], fma(gradient[1], offset[1], fma(gradient[2], offset[2], at_centre)))


@inlined
def _judge_samples(c, offset, high):
    """Masks of the samples, at an offset from the lamp's centre, that are hidden for certain, as far as that is not B's
    to say, and of those that are missed; of a lamp that is so `high` above the triangle that its height decides
    nothing."""
    u, v, w = _further(c.at.u, c.to_u, offset), _further(c.at.v, c.to_v, offset), _further(c.at.w, c.to_w, offset)
    f = Functions(u, v, w, c.at.b)
    hidden, missed = inside(f, c.bounds), beside(f, c.bounds)
    if not high:
        d, height = _further(c.d, c.to_d, offset), _further(c.height, c.to_d, offset)
        missed = missed | (height < -c.of_height)
        hidden = hidden & (height > c.of_height) & (height > _LAMP * d)
    return hidden, missed


@subkernel
def ask_samples(triangle, kept, lane, can, samples, groups, blocked, unsure):
    """Which of a lamp's samples does a triangle hide from one point?  `kept` has in a lane what `ask_points`, or
    `ask_triangles`, found of both.

    Samples, as `put_samples` put them, are `groups` of sixteen.  Those that are hidden for certain join the bits at the
    address `blocked`, int32 for sixteen samples each, if the triangle `can` hide any for certain; those of which
    nothing is certain join `unsure`.  Whether all are blocked."""
    k, b = kept + 4 * lane, number_at(kept + 4 * lane, AT_B)
    sure_side, every = number_at(triangle, SURE_SIDE), np.int64(0xFFFF)
    if sure_side > ZERO or (sure_side == ZERO and abs(b) > number_at(k, BOUND_B)):
        c = _at_centre(triangle, k, True, f32x16(ONE if sure_side > ZERO or b >= ZERO else -ONE))
        along = abs(number_at(k, AT_D)) + number_at(triangle, REACH)
        high = sure_side > ZERO and number_at(triangle, HEIGHT) > _LAMP * along
        for group in range(groups):
            if load_i32(blocked + 4 * group) == 0xFFFF:
                continue
            hidden, missed = _judge_samples(c, _places(samples + 64 * group), high)
            every &= _note(blocked + 4 * group, unsure + 4 * group, bits_of(hidden) if can else 0, bits_of(missed))
        return every == 0xFFFF
    (x, y, z), low = columns_at(k, POINT, True), columns_at(triangle, LOW, True)
    upper = columns_at(triangle, HIGH, True)
    for group in range(groups):
        start = _places(samples + 64 * group + 3 * PLACES)
        missed = segments_miss_box(start, (x - start[0], y - start[1], z - start[2]), low, upper)
        passed = bits_of(missed) if sure_side == ZERO else 0
        every &= _note(blocked + 4 * group, unsure + 4 * group, np.int64(0), passed)
    return every == 0xFFFF


@inlined
def _places(at):
    """Three rows of samples at an address, sixteen of each."""
    return load_f32x16(at), load_f32x16(at + PLACES), load_f32x16(at + 2 * PLACES)


@inlined
def _note(blocked, unsure, hit, missed):
    """Join bits of sixteen samples at two addresses: those that are hit, which are returned with those that were
    before, and those that are neither that nor missed."""
    hit |= np.int64(load_i32(blocked))
    store(blocked, np.int32(hit))
    store(unsure, np.int32(np.int64(load_i32(unsure)) | (0xFFFF & ~(hit | missed))))
    return hit


@subkernel
def hide_samples(triangle, kept, can, samples, count, bits):
    """Join the points from which a triangle certainly hides each of `count` samples to `bits`, int32 for each sample at
    an address; the points from which all are hidden by now.

    The prepared triangle, what `ask_points` kept of it and of sixteen points, of which some `can` (bits) be certain of
    a hit, and samples, as `put_samples` put them, are at addresses.  Points that are shaded together are neighbours: a
    triangle that hides much of a lamp from one hides much of it from all."""
    sure_side, every = number_at(triangle, SURE_SIDE), np.int64(0xFFFF)
    front = column_at(kept, AT_B, False) >= ZERO
    side = f32x16(ONE) if sure_side > ZERO else select(front, f32x16(ONE), f32x16(-ONE))
    c, least, reach = _at_centre(triangle, kept, False, side), number_at(triangle, HEIGHT), number_at(triangle, REACH)
    high = sure_side > ZERO and bits_of(_LAMP * (maximum(c.d, -c.d) + reach) < least) == 0xFFFF
    for k in range(count):
        at = samples + 4 * k
        hidden, _missed = _judge_samples(c, (load_f32(at), load_f32(at + PLACES), load_f32(at + 2 * PLACES)), high)
        hit = np.int64(load_i32(bits + 4 * k)) | (np.int64(bits_of(hidden)) & can)
        store(bits + 4 * k, np.int32(hit))
        every &= hit
    return every
