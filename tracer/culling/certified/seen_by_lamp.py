"""What a lamp sees of triangles: whether they hide it from points, all of its samples or which of them.

Sixteen triangles are prepared together for a lamp (`prepare`).  Then each is asked about sixteen points and all of the
lamp at once (`ask_points`), by the functions of `error_bounds`, at the lamp's centre, and how much they may change
within its ball.  Points of which that cannot tell are asked about one after the other, for sixteen samples at a time
(`ask_samples`): there, functions are those at the centre and their gradient times where the sample is.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from tracer.culling.certified.error_bounds import (
    BOX,
    ENLARGED,
    EPSILON,
    FIVE,
    FOUR,
    INSIDE,
    LAMP,
    NINE,
    ONE,
    REPORTED,
    ROW,
    SMALL,
    SURPLUS,
    THREE,
    ZERO,
    cross,
    dot,
    length16,
    rows_at,
    scaled,
    seen_from,
    sure_hit_length,
)
from tracer.geometry.boxes import segments_miss_box
from tracer.kernels import inlined, subkernel
from tracer.simd import (
    address_of,
    bits_of,
    f32x16,
    fma,
    gather_f32x16,
    load_f32,
    load_f32x16,
    load_i32,
    load_i32x16,
    maximum,
    minimum,
    select,
    size_of,
    square_root,
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
# Vectors that are kept of sixteen points and one triangle: U, V and D at the centre, the gradients of U and V, D - T,
# error bounds of U, V, W and D - T, and the points.
AT_U, AT_V, AT_D, GRADIENT_U, GRADIENT_V, AT_BEHIND = 0, 1, 2, 3, 6, 9
BOUND_U, BOUND_V, BOUND_W, BOUND_BEHIND, POINT = range(10, 15)
KEPT = 64 * (POINT + 3)  # bytes
MOST_SAMPLES = 1024
PLACES = 4 * MOST_SAMPLES  # bytes between rows of samples: three of offsets from the centre, then three of places
SAMPLES = 6 * PLACES
_EPSILON, _SURPLUS, _TWICE = np.float32(EPSILON), np.float32(SURPLUS), np.float32(2 * SURPLUS)
_LARGER = np.float32(2 * SURPLUS * (ENLARGED + 6 * EPSILON))
_INSIDE, _LAMP, _HALF = np.float32(INSIDE), np.float32(LAMP), np.float32(0.5)
_WIDE, _ROUNDING = np.float32(2 * REPORTED), np.float32(1e-6)


class Lamp(NamedTuple):
    """A lamp as kernels know it: its number; a ball of a radius around light (3,); and how many vectors of sixteen its
    samples make."""

    number: int
    light: Any
    radius: Any
    groups: int


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


@subkernel
def prepare(o, lamp, numbers, made):
    """Prepare sixteen primitives, whose numbers are at an address, for a `Lamp`: at the address `made`, PREPARED bytes.
    o are the `Occluders`."""
    row, radius = rows_at(o.rows, numbers), lamp.radius
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
    store(made + 64 * SURE, sure_hit_length(o.farthest, numbers))
    store(made + 64 * FIRM, select(t.firm, ONE, select(t.sane, ZERO, -ONE)))
    store(made + 64 * RADIUS, gather_f32x16(address_of(o.error_radii[lamp.number]), load_i32x16(numbers)))

    # The box in which hits are reported, with room for rounding.
    box, room = row[BOX:ROW], _WIDE * t.away
    for axis in range(3):
        room = room + _ROUNDING * (box[3 + axis] - box[axis])
    for axis in range(3):
        store(made + 64 * (LOW + axis), box[axis] - room)
        store(made + 64 * (HIGH + axis), box[3 + axis] + room)


@inlined
def _three(at, column):
    """Three vectors of prepared triangles."""
    at = at + 64 * column
    return load_f32x16(at), load_f32x16(at + 64), load_f32x16(at + 128)


@subkernel
def prepared_met(made, beam):
    """Bits of the sixteen prepared primitives that may come into a beam."""
    corner, first, second = _three(made, CORNER), _three(made, FIRST), _three(made, SECOND)
    low, high, radius = _three(made, LOW), _three(made, HIGH), load_f32x16(made + 64 * RADIUS)
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
def _number(at, column):
    return load_f32(at + 64 * column)


@inlined
def _three_numbers(at, column):
    at = at + 64 * column
    return load_f32(at), load_f32(at + 64), load_f32(at + 128)


@subkernel
def ask_points(triangle, end, light, radius, kept):
    """What the rays from a lamp, a ball of a radius around light (3,) float32, to sixteen points `end` are certain of.

    The prepared triangle's numbers are at an address.  (bits of the points from which it hides all of the lamp, of
    those from which none, and of those from which it may hide a sample for certain).  For `ask_samples` what is known
    of the points goes to the address `kept`, KEPT bytes, unless the triangle hides no sample from any."""
    t = triangle
    corner, of_d, firm = _three_numbers(t, CORNER), _three_numbers(t, D), _number(t, FIRM)
    near = end[0] - corner[0], end[1] - corner[1], end[2] - corner[2]
    way = end[0] - light[0], end[1] - light[1], end[2] - light[2]
    longest, behind = length16(way) + radius, dot(of_d, near)
    bound = length16(near) * _number(t, NEAR) + _number(t, BEHIND)
    bound = bound + (longest + _HALF * size_of(end)) * _number(t, FAR)
    if firm > ZERO and bits_of(behind < -bound) == 0xFFFF:
        return 0, 0xFFFF, 0

    # Evaluate the functions at the centre, and how much they change within the ball.
    u, v, d = dot(_three_numbers(t, U), way), dot(_three_numbers(t, V), way), dot(of_d, way)
    w = d - u - v
    to_u, to_v = cross(near, _three_numbers(t, TURNED_SECOND)), cross(_three_numbers(t, TURNED_FIRST), near)
    to_w = -of_d[0] - to_u[0] - to_v[0], -of_d[1] - to_u[1] - to_v[1], -of_d[2] - to_u[2] - to_v[2]
    by_u, by_v, by_w = radius * length16(to_u), radius * length16(to_v), radius * length16(to_w)
    by_d = _number(t, REACH)

    # Bound the errors of each.
    along = maximum(d, -d) + by_d
    larger = _LARGER * along + SMALL
    of_u, of_v = _number(t, OF_U) * longest + larger, _number(t, OF_V) * longest + larger
    of_w = _number(t, OF_W) * longest + larger
    store(kept + 64 * AT_U, u)
    store(kept + 64 * AT_V, v)
    store(kept + 64 * AT_D, d)
    store_three(kept + 64 * GRADIENT_U, 64, to_u)
    store_three(kept + 64 * GRADIENT_V, 64, to_v)
    store(kept + 64 * BOUND_U, of_u)
    store(kept + 64 * BOUND_V, of_v)
    store(kept + 64 * BOUND_W, of_w)
    store(kept + 64 * AT_BEHIND, behind)
    store(kept + 64 * BOUND_BEHIND, bound)
    store_three(kept + 64 * POINT, 64, end)

    # Compare them.
    short = _number(t, SURE) > longest
    if firm > ZERO:
        can = (behind > bound) & short
        inside = (u - by_u > _INSIDE * of_u) & (v - by_v > _INSIDE * of_v) & (w - by_w > _INSIDE * of_w)
        hidden = can & inside & (_number(t, HEIGHT) > _LAMP * along)
        missed = (u + by_u < -of_u) | (v + by_v < -of_v) | (w + by_w < -of_w) | (behind < -bound)
        return bits_of(hidden), bits_of(missed), bits_of(can)
    if firm < ZERO:
        return 0, 0, 0
    side, certain = select(behind >= ZERO, ONE, -ONE), maximum(behind, -behind) > bound
    missed = (side * u + by_u < -of_u) | (side * v + by_v < -of_v) | (side * w + by_w < -of_w)
    missed = certain & (missed | (side * (_number(t, HEIGHT) + by_d) + by_d < -_number(t, UNSURE)))
    return 0, bits_of(missed), bits_of(certain & short)


@subkernel
def ask_triangles(made, end, light, radius, kept):
    """What the rays from a lamp, a ball of a radius around light (3,) float32, to one point `end`, three float32, are
    certain of.

    (bits of the sixteen prepared triangles that hide all of the lamp, of those that hide nothing of it, and of those
    that may hide a sample for certain).  For `ask_samples` what is known goes to the address `kept`, KEPT bytes, a
    lane for each triangle."""
    corner, of_d, firm = _three(made, CORNER), _three(made, D), load_f32x16(made + 64 * FIRM)
    near = end[0] - corner[0], end[1] - corner[1], end[2] - corner[2]
    way = end[0] - light[0], end[1] - light[1], end[2] - light[2]
    longest, behind = square_root(dot(way, way)) + radius, dot(of_d, near)
    bound = length16(near) * load_f32x16(made + 64 * NEAR) + load_f32x16(made + 64 * BEHIND)
    bound = bound + (longest + _HALF * (abs(end[0]) + abs(end[1]) + abs(end[2]))) * load_f32x16(made + 64 * FAR)

    # Evaluate the functions at the centre, and how much they change within the ball.
    u, v, d = dot(way, _three(made, U)), dot(way, _three(made, V)), dot(way, of_d)
    w = d - u - v
    to_u, to_v = cross(near, _three(made, TURNED_SECOND)), cross(_three(made, TURNED_FIRST), near)
    to_w = ZERO - of_d[0] - to_u[0] - to_v[0], ZERO - of_d[1] - to_u[1] - to_v[1], ZERO - of_d[2] - to_u[2] - to_v[2]
    by_u, by_v, by_w = radius * length16(to_u), radius * length16(to_v), radius * length16(to_w)
    by_d = load_f32x16(made + 64 * REACH)

    # Bound the errors of each.
    along = maximum(d, ZERO - d) + by_d
    larger = _LARGER * along + SMALL
    of_u, of_v = longest * load_f32x16(made + 64 * OF_U) + larger, longest * load_f32x16(made + 64 * OF_V) + larger
    of_w = longest * load_f32x16(made + 64 * OF_W) + larger
    store(kept + 64 * AT_U, u)
    store(kept + 64 * AT_V, v)
    store(kept + 64 * AT_D, d)
    store_three(kept + 64 * GRADIENT_U, 64, to_u)
    store_three(kept + 64 * GRADIENT_V, 64, to_v)
    store(kept + 64 * BOUND_U, of_u)
    store(kept + 64 * BOUND_V, of_v)
    store(kept + 64 * BOUND_W, of_w)
    store(kept + 64 * AT_BEHIND, behind)
    store(kept + 64 * BOUND_BEHIND, bound)
    store_three(kept + 64 * POINT, 64, (f32x16(end[0]), f32x16(end[1]), f32x16(end[2])))

    # Compare them.
    short = load_f32x16(made + 64 * SURE) > longest
    firmly, at_all = bits_of(firm > ZERO), bits_of(firm >= ZERO)
    can = (behind > bound) & short
    height = load_f32x16(made + 64 * HEIGHT)
    inside = (u - by_u > _INSIDE * of_u) & (v - by_v > _INSIDE * of_v) & (w - by_w > _INSIDE * of_w)
    hidden = bits_of(can & inside & (height > _LAMP * along)) & firmly
    missed = firmly & bits_of((u + by_u < -of_u) | (v + by_v < -of_v) | (w + by_w < -of_w) | (behind < -bound))
    able = firmly & bits_of(can)
    rest = at_all & ~firmly
    if rest != 0:
        side, certain = select(behind >= ZERO, f32x16(ONE), f32x16(-ONE)), maximum(behind, ZERO - behind) > bound
        past = (side * u + by_u < -of_u) | (side * v + by_v < -of_v) | (side * w + by_w < -of_w)
        past = certain & (past | (side * (height + by_d) + by_d < -load_f32x16(made + 64 * UNSURE)))
        missed |= rest & bits_of(past)
        able |= rest & bits_of(certain & short)
    return hidden, missed, able


@subkernel
def ask_samples(triangle, kept, lane, can, samples, groups, blocked, unsure):
    """Which of a lamp's samples does a triangle hide from one point, that in a lane of what `ask_points` kept?

    Samples, as `put_samples` put them, are `groups` of sixteen.  Those that are hidden for certain join the bits at the
    address `blocked`, int32 for sixteen samples each, if the triangle `can` hide any for certain; those of which
    nothing is certain join `unsure`.  Whether all are blocked."""
    t, k = triangle, kept + 4 * lane
    behind, firm, every = _number(k, AT_BEHIND), _number(t, FIRM), np.int64(0xFFFF)
    side = ONE if firm > ZERO or behind >= ZERO else -ONE
    if firm > ZERO or (firm == ZERO and abs(behind) > _number(k, BOUND_BEHIND)):
        u0, v0, d0 = side * _number(k, AT_U), side * _number(k, AT_V), side * _number(k, AT_D)
        w0 = d0 - u0 - v0
        to_u, to_v = scaled(_three_numbers(k, GRADIENT_U), side), scaled(_three_numbers(k, GRADIENT_V), side)
        of_d = scaled(_three_numbers(t, D), -side)
        to_w = of_d[0] - to_u[0] - to_v[0], of_d[1] - to_u[1] - to_v[1], of_d[2] - to_u[2] - to_v[2]
        of_u, of_v, of_w = _number(k, BOUND_U), _number(k, BOUND_V), _number(k, BOUND_W)
        least, reach, of_height = _number(t, HEIGHT), _number(t, REACH), _number(t, UNSURE)
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
    x, y, z = _three_numbers(k, POINT)
    low, high = _three_numbers(t, LOW), _three_numbers(t, HIGH)
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
