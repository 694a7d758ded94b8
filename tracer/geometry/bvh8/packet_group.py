"""Groups: which vectors of a packet go through a tree together, and the frusta that bound them.

The first vector chooses an axis.  All vectors join it whose rays head the same way along that axis and do not spread
too far.  A frustum ends where the last of its rays stops looking, and so shrinks as rays hit.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from tracer.geometry.boxes import TINY
from tracer.geometry.bvh8.packet import DIRECTION, FRUSTA, INVERSE, ORIGIN, ROW, T_MIN, T
from tracer.geometry.triangle_test import ZERO
from tracer.runtime.kernels import inlined, subkernel
from tracer.simd import (
    bits_of,
    f32x8,
    largest,
    load_f32,
    load_f32x8,
    load_f32x16,
    lowest_bit,
    maximum,
    minimum,
    smallest,
    store,
)

# Slopes of sixteen rays that differ by more are not worth a frustum: each ray goes its own way in less time.  Any hits
# of one light's rays in random order take 295 ns at 4, 205 at 2, 123 at 1 and at 0.5 (Kitchen, 14 s, one thread).
WIDEST = np.float32(1)
NARROW = np.float32(0.02)  # by less, and the frustum alone will do
HUGE = np.float32(1e18)

# Rows of eight numbers, one for each vector: six of starts, four of slopes, and the distances it looks from and to.
START, SLOPE, NEAR, REACH = 0, 6, 10, 11


class Group(NamedTuple):
    """Vectors of a packet that go together: which, as bits, and which of those have so wide a frustum that their rays
    had better be tested too; the axes of their frusta; a frustum around them all, but for where it ends; and the lower
    and upper corner of the box around their directions."""

    vectors: Any
    wide: Any
    axes: Any
    frustum: Any
    low: Any
    high: Any


@inlined
def _along(memory, rows, v, axis):
    """The v-th vector's numbers in that of three rows which belongs to an axis."""
    return load_f32x16(memory + (rows + axis) * ROW + 64 * v)


@inlined
def _slopes(memory, v, axis, way):
    """Least and greatest slopes of the v-th vector along the other two axes; HUGE where some ray goes the other way.

    A component so small that its inverse is cut short (`boxes.inverse`) may count as much as TINY."""
    if smallest(_along(memory, DIRECTION, v, axis) * way) <= TINY:
        return -HUGE, HUGE, -HUGE, HUGE
    scale = _along(memory, INVERSE, v, axis) * way
    slope_u = _along(memory, DIRECTION, v, (axis + 1) % 3) * scale
    slope_v = _along(memory, DIRECTION, v, (axis + 2) % 3) * scale
    least = np.float32(2) * TINY * largest(scale)
    return smallest(slope_u) - least, largest(slope_u) + least, smallest(slope_v) - least, largest(slope_v) + least


@inlined
def _width(u0, u1, v0, v1):
    """By how much slopes differ; HUGE if that is too much for a frustum, or not a number."""
    return maximum(u1 - u0, v1 - v0) if u1 - u0 <= WIDEST and v1 - v0 <= WIDEST else HUGE


@subkernel
def lead_of(memory, v):
    """The axis that suits the v-th vector best, the way along it (1 or -1), and whether its frustum is worth having,
    for its slopes differ by no more than WIDEST."""
    best, axis, way = ZERO, 0, ZERO
    for k in range(3):
        d = _along(memory, DIRECTION, v, k)
        up, down = smallest(d), -largest(d)
        if up > best:
            best, axis, way = up, k, np.float32(1)
        if down > best:
            best, axis, way = down, k, np.float32(-1)
    u0, u1, v0, v1 = _slopes(memory, v, axis, way)
    return axis, way, _width(u0, u1, v0, v1) <= WIDEST


@inlined
def _put(memory, row, v, value):
    store(memory + FRUSTA + 32 * row + 4 * v, value)


@inlined
def _put_bounds(memory, row, v, x):
    """Store the least of sixteen numbers in a row for the v-th vector, and the greatest in the next row."""
    _put(memory, row, v, smallest(x))
    _put(memory, row + 1, v, largest(x))


@inlined
def _put_starts(memory, v, axes):
    """Store where the rays of the v-th vector start."""
    _put_bounds(memory, START, v, _along(memory, ORIGIN, v, axes.along) * axes.way)
    _put_bounds(memory, START + 2, v, _along(memory, ORIGIN, v, (axes.along + 1) % 3))
    _put_bounds(memory, START + 4, v, _along(memory, ORIGIN, v, (axes.along + 2) % 3))


@inlined
def _put_reach(memory, v, axes):
    """Store how far along the axis the rays of the v-th vector still look."""
    reach = largest(load_f32x16(memory + T * ROW + 64 * v) * _along(memory, DIRECTION, v, axes.along) * axes.way)
    _put(memory, REACH, v, reach + MARGIN * reach)


@subkernel
def put_reaches(memory, vectors, axes):
    """Store how far the rays of several vectors, given as bits, still look."""
    while vectors != 0:
        _put_reach(memory, lowest_bit(vectors), axes)
        vectors &= vectors - 1


@inlined
def _put_frustum(memory, v, axes):
    """Store the frustum of the v-th vector if it is worth having; by how much its slopes differ."""
    u0, u1, v0, v1 = _slopes(memory, v, axes.along, axes.way)
    width = _width(u0, u1, v0, v1)
    if width > WIDEST:
        return width
    u0, u1 = wider(u0, u1)
    v0, v1 = wider(v0, v1)
    _put(memory, SLOPE, v, u0)
    _put(memory, SLOPE + 1, v, u1)
    _put(memory, SLOPE + 2, v, v0)
    _put(memory, SLOPE + 3, v, v1)
    near = smallest(load_f32x16(memory + T_MIN * ROW + 64 * v) * _along(memory, DIRECTION, v, axes.along) * axes.way)
    _put(memory, NEAR, v, maximum(near - MARGIN * near, ZERO))
    _put_reach(memory, v, axes)
    _put_starts(memory, v, axes)
    return width


@inlined
def frusta_of(memory):
    """The frusta of all eight vectors."""
    a = memory + FRUSTA
    return Frustum(
        load_f32x8(a), load_f32x8(a + 32), load_f32x8(a + 64), load_f32x8(a + 96), load_f32x8(a + 128),
        load_f32x8(a + 160), load_f32x8(a + 192), load_f32x8(a + 224), load_f32x8(a + 256), load_f32x8(a + 288),
        load_f32x8(a + 320),
    )  # fmt: skip


@inlined
def _around(f):
    """The frustum around eight."""
    return Frustum(
        smallest(f.start0), largest(f.start1), smallest(f.u_start0), largest(f.u_start1),
        smallest(f.v_start0), largest(f.v_start1), smallest(f.u0), largest(f.u1), smallest(f.v0), largest(f.v1),
        smallest(f.near),
    )  # fmt: skip


@inlined
def _least_and_greatest(memory, row, vectors):
    first = load_f32x16(memory + row * ROW + 64 * lowest_bit(vectors))
    low, high, rest = first, first, vectors & (vectors - 1)
    while rest != 0:
        x = load_f32x16(memory + row * ROW + 64 * lowest_bit(rest))
        low, high = minimum(low, x), maximum(high, x)
        rest &= rest - 1
    return smallest(low), largest(high)


@subkernel
def group_of(memory, vectors, axis, way):
    """The group of those vectors, of some given as bits, that can go together along an axis, for their slopes differ by
    no more than WIDEST; at least one can."""
    for row in (START, START + 2, START + 4, SLOPE, SLOPE + 2):  # bounds of no ray: they leave others' as they are
        store(memory + FRUSTA + 32 * row, f32x8(HUGE))
        store(memory + FRUSTA + 32 * row + 32, f32x8(-HUGE))
    store(memory + FRUSTA + 32 * NEAR, f32x8(HUGE))
    store(memory + FRUSTA + 32 * REACH, f32x8(NO_RAYS))
    axes = axes_of(axis, way)
    members, wide, rest = np.int64(0), np.int64(0), vectors
    while rest != 0:
        v = lowest_bit(rest)
        rest &= rest - 1
        width = _put_frustum(memory, v, axes)
        members |= np.int64(width <= WIDEST) << v
        wide |= np.int64(width > NARROW) << v
    dx = _least_and_greatest(memory, DIRECTION, members)
    dy = _least_and_greatest(memory, DIRECTION + 1, members)
    dz = _least_and_greatest(memory, DIRECTION + 2, members)
    low, high = (dx[0], dy[0], dz[0]), (dx[1], dy[1], dz[1])
    return Group(members, wide, axes, _around(frusta_of(memory)), low, high)


@inlined
def reaches_of(memory):
    """How far along the axis each of the eight vectors still looks."""
    return load_f32x8(memory + FRUSTA + 32 * REACH)


@inlined
def looking(memory, distance):
    """The vectors, as bits, that still look beyond a distance along the axis."""
    return bits_of(reaches_of(memory) >= distance)


MARGIN = np.float32(2e-6)
NO_RAYS = np.float32(-1)  # where a frustum ends that holds no ray: before it begins


class Axes(NamedTuple):
    """The axis that frusta go along, 1 or -1 for the way, and, for a box whose six numbers lie 32 bytes
    apart, where its planes are: near and far along the axis, low and high along the other two."""

    along: Any
    way: Any
    near: Any
    far: Any
    low_u: Any
    high_u: Any
    low_v: Any
    high_v: Any


class Frustum(NamedTuple):
    """Bounds of rays: where they start, along the axis in the way they go and along the other two axes; their slopes;
    and the distance along the axis from which on they look."""

    start0: Any
    start1: Any
    u_start0: Any
    u_start1: Any
    v_start0: Any
    v_start1: Any
    u0: Any
    u1: Any
    v0: Any
    v1: Any
    near: Any


@inlined
def axes_of(axis, way):
    """Frusta along an axis, 0 to 2, upwards for 1 and downwards for -1."""
    u, v = 32 * ((axis + 1) % 3), 32 * ((axis + 2) % 3)
    near = 32 * axis + (96 if way < np.float32(0) else 0)
    return Axes(axis, way, near, 64 * axis + 96 - near, u, u + 96, v, v + 96)


@inlined
def wider(low, high):
    """An interval of slopes, by the margin wider."""
    least, greatest = maximum(low, -low), maximum(high, -high)
    return low - MARGIN * least, high + MARGIN * greatest


@inlined
def box_at(a, axes):
    """Planes of the box at an address, as `entering` wants them."""
    return (
        load_f32(a + axes.near) * axes.way, load_f32(a + axes.far) * axes.way,
        load_f32(a + axes.low_u), load_f32(a + axes.high_u), load_f32(a + axes.low_v), load_f32(a + axes.high_v),
    )  # fmt: skip


@inlined
def boxes_at(a, axes):
    """Planes of the eight boxes at an address."""
    return (
        load_f32x8(a + axes.near) * axes.way, load_f32x8(a + axes.far) * axes.way,
        load_f32x8(a + axes.low_u), load_f32x8(a + axes.high_u),
        load_f32x8(a + axes.low_v), load_f32x8(a + axes.high_v),
    )  # fmt: skip


@inlined
def entering(planes, f, reach):
    """(least distance along the axis, mask): which boxes some ray of which frustum may enter, if it looks as far as
    `reach` along the axis."""
    near, far, low_u, high_u, low_v, high_v = planes
    enter, leave = maximum(near - f.start1, f.near), minimum(far - f.start0, reach)
    low_side = minimum(enter * f.u0, leave * f.u0) <= high_u - f.u_start0
    high_side = maximum(enter * f.u1, leave * f.u1) >= low_u - f.u_start1
    bottom = minimum(enter * f.v0, leave * f.v0) <= high_v - f.v_start0
    top = maximum(enter * f.v1, leave * f.v1) >= low_v - f.v_start1
    return enter, (enter <= leave) & low_side & high_side & bottom & top
