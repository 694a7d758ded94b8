"""A packet: up to 128 rays in local memory, as eight vectors of sixteen, and the frusta that bound these.

Each of a ray's numbers has a row.  What is found is written into the rows too, whether the rays go
through a tree together (`packet_tree`) or one by one (`single`), so that `traverse` need not know.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba.core import types
from numba.extending import overload

from tracer.geometry.bvh8.frustum import NO_RAYS, Frustum, axes_of, wider
from tracer.geometry.bvh8.intersect import ZERO
from tracer.geometry.queries import (
    BLOCKED,
    DIRECTION,
    DYNAMIC,
    HIT_PRIMITIVE,
    HIT_T,
    HIT_U,
    HIT_V,
    ORIGIN,
    STATIC,
    STRIDE,
    T_MAX,
)
from tracer.geometry.queries import T_MIN as BATCH_T_MIN
from tracer.geometry.rays import INFINITY, MISS
from tracer.kernels import inlined, subkernel
from tracer.simd import (
    all_lanes,
    any_lane,
    as_f32,
    as_i32,
    bits_of,
    f32x8,
    f32x16,
    i32x16,
    largest,
    load_f32,
    load_f32x8,
    load_f32x16,
    load_i32,
    load_i32x16,
    load_i64,
    lowest_bit,
    maximum,
    minimum,
    prefetch,
    select,
    smallest,
    store,
    store_bytes,
    u8_at,
)

LANES = 16
PACKET = 128  # rays
ROW = 4 * PACKET  # bytes of one number of each ray
FAR = np.float32(1e30)  # no hit is farther, and every empty child is
LARGEST = np.float32(1e29)  # of t_max, short of what stands for a blocked ray
TINY = np.float32(1e-20)
BLOCKED_T = -FAR  # t of a ray that is known to be blocked, and of none
STATIC_T = np.float32(2) * BLOCKED_T  # of one that something static blocks, once the static tree is done
WIDE = np.float32(4)  # slopes of sixteen rays that differ by more are not worth a frustum
NARROW = np.float32(0.02)  # by less, and the frustum alone will do
HUGE = np.float32(1e18)

# Rows of a packet's memory: of all rays, of their eight frusta, and room to work in.
DX, DY, DZ, IX, IY, IZ, T_MIN, T, NUMBER, U, V, ENTER, LEAVE, OX, OY, OZ = range(16)
FRUSTA = 16 * ROW
START, SLOPE, NEAR, REACH = 0, 6, 10, 11  # rows of eight: of starts there are six, of slopes four
SCRATCH = FRUSTA + 12 * 32
TERMS = SCRATCH + 64
MEMORY = TERMS + 320


class Group(NamedTuple):
    """Vectors of a packet that go together: which, as bits, and which of those have so wide a frustum that
    rays had better be asked too; their frusta's axes, a frustum around them all but for where it ends, and
    the box of their directions."""

    vectors: Any
    wide: Any
    axes: Any
    frustum: Any
    low: Any
    high: Any


def origin_of(origin, memory, v):
    """Origins of a packet's v-th vector: the point they share, or from the packet's memory."""
    raise NotImplementedError("only kernels call this")


@overload(origin_of, jit_options={"forceinline": True, "error_model": "numpy"})
def _origin_of(origin, memory, v):
    if isinstance(origin, types.NoneType):

        def separate(origin, memory, v):
            a = memory + 64 * v
            return load_f32x16(a + OX * ROW), load_f32x16(a + OY * ROW), load_f32x16(a + OZ * ROW)

        return separate

    def common(origin, memory, v):
        return origin

    return common


@inlined
def inverse(x):
    """1/x with a huge number for 0."""
    sign = as_i32(x) & np.int32(-0x80000000)
    size = maximum(as_f32(as_i32(x) ^ sign), TINY)
    return as_f32(as_i32(np.float32(1) / size) | sign)


@inlined
def _row(memory, row, source, count, rest):
    """Copy a row of `count` numbers into a packet's memory, and fill its last vector up with `rest`; what the
    next packet will copy is asked for."""
    for line in range(ROW, 2 * ROW, 64):
        prefetch(source + line)
    i = 0
    while i + LANES <= count:
        store(memory + row * ROW + 4 * i, load_f32x16(source + 4 * i))
        i += LANES
    while i < count:
        store(memory + row * ROW + 4 * i, load_f32(source + 4 * i))
        i += 1
    while i % LANES != 0:
        store(memory + row * ROW + 4 * i, rest)
        i += 1


@subkernel
def fill(memory, batch, first, count):
    """Rays first to first + count - 1 as a packet; how many vectors they are, the box of their origins, and whether
    all are finite: of others no bounds can be told."""
    n, at, last = 4 * load_i64(batch + STRIDE), 4 * first, 4 * (count - 1)
    o, d = load_i64(batch + ORIGIN) + at, load_i64(batch + DIRECTION) + at
    t_min, t_max = load_i64(batch + BATCH_T_MIN) + at, load_i64(batch + T_MAX) + at
    for axis in range(3):
        _row(memory, OX + axis, o + axis * n, count, load_f32(o + axis * n + last))
        _row(memory, DX + axis, d + axis * n, count, load_f32(d + axis * n + last))
    _row(memory, T_MIN, t_min, count, load_f32(t_min + last))
    _row(memory, T, t_max, count, BLOCKED_T)
    vectors = (count + LANES - 1) // LANES
    lx = hx = load_f32x16(memory + OX * ROW)
    ly = hy = load_f32x16(memory + OY * ROW)
    lz = hz = load_f32x16(memory + OZ * ROW)
    nothing = f32x16(ZERO)
    for v in range(vectors):
        a = memory + 64 * v
        dx, dy, dz = load_f32x16(a + DX * ROW), load_f32x16(a + DY * ROW), load_f32x16(a + DZ * ROW)
        store(a + IX * ROW, inverse(dx))
        store(a + IY * ROW, inverse(dy))
        store(a + IZ * ROW, inverse(dz))
        store(a + T * ROW, minimum(load_f32x16(a + T * ROW), LARGEST))
        store(a + NUMBER * ROW, i32x16(MISS))
        x, y, z = load_f32x16(a + OX * ROW), load_f32x16(a + OY * ROW), load_f32x16(a + OZ * ROW)
        lx, ly, lz = minimum(lx, x), minimum(ly, y), minimum(lz, z)
        hx, hy, hz = maximum(hx, x), maximum(hy, y), maximum(hz, z)
        nothing = nothing + ((x + y + z) + (dx + dy + dz)) * ZERO
    low = (smallest(lx), smallest(ly), smallest(lz))
    high = (largest(hx), largest(hy), largest(hz))
    return vectors, low, high, all_lanes(nothing == ZERO)


@inlined
def open_vectors(memory, vectors):
    """The vectors, of so many, that hold a ray to trace."""
    result = np.int64(0)
    for v in range(vectors):
        a = memory + 64 * v
        result |= np.int64(any_lane(load_f32x16(a + T * ROW) > load_f32x16(a + T_MIN * ROW))) << v
    return result


@inlined
def _slopes(memory, v, axis, way):
    """Least and greatest slopes of the v-th vector along the other axes; HUGE where some ray does not go that way, or
    looks for hits behind its origin."""
    a = memory + 64 * v
    if smallest(load_f32x16(a + (DX + axis) * ROW) * way) <= ZERO or smallest(load_f32x16(a + T_MIN * ROW)) < ZERO:
        return -HUGE, HUGE, -HUGE, HUGE
    scale = load_f32x16(a + (IX + axis) * ROW) * way
    slope_u = load_f32x16(a + (DX + (axis + 1) % 3) * ROW) * scale
    slope_v = load_f32x16(a + (DX + (axis + 2) % 3) * ROW) * scale
    return smallest(slope_u), largest(slope_u), smallest(slope_v), largest(slope_v)


@subkernel
def lead_of(memory, v):
    """The axis, and which way along it, that suit the v-th vector best; whether its frustum is worth having."""
    best, axis, way = ZERO, 0, ZERO
    for k in range(3):
        d = load_f32x16(memory + (DX + k) * ROW + 64 * v)
        up, down = smallest(d), -largest(d)
        if up > best:
            best, axis, way = up, k, np.float32(1)
        if down > best:
            best, axis, way = down, k, np.float32(-1)
    u0, u1, v0, v1 = _slopes(memory, v, axis, way)
    return axis, way, maximum(u1 - u0, v1 - v0) <= WIDE


@inlined
def _put(memory, row, v, value):
    store(memory + FRUSTA + 32 * row + 4 * v, value)


@inlined
def _put_starts(memory, v, axes):
    """Where the rays of the v-th vector start."""
    u, w = (axes.along + 1) % 3, (axes.along + 2) % 3
    a = memory + 64 * v
    k = load_f32x16(a + (OX + axes.along) * ROW) * axes.way
    _put(memory, START, v, smallest(k))
    _put(memory, START + 1, v, largest(k))
    x = load_f32x16(a + (OX + u) * ROW)
    _put(memory, START + 2, v, smallest(x))
    _put(memory, START + 3, v, largest(x))
    x = load_f32x16(a + (OX + w) * ROW)
    _put(memory, START + 4, v, smallest(x))
    _put(memory, START + 5, v, largest(x))


@inlined
def _put_reach(memory, v, axes):
    """Note up to where along the axis the rays of the v-th vector are still looking."""
    a = memory + 64 * v
    k = load_f32x16(a + (DX + axes.along) * ROW) * axes.way
    reach = largest(load_f32x16(a + T * ROW) * k)
    _put(memory, REACH, v, reach + np.float32(2e-6) * reach)


@subkernel
def put_reaches(memory, vectors, axes):
    """The same for several vectors, given as bits."""
    while vectors != 0:
        _put_reach(memory, lowest_bit(vectors), axes)
        vectors &= vectors - 1


@inlined
def _put_frustum(memory, v, axes):
    """Bound the v-th vector along an axis, if that is worth it; by how much its slopes differ."""
    u0, u1, v0, v1 = _slopes(memory, v, axes.along, axes.way)
    width = maximum(u1 - u0, v1 - v0)
    if width > WIDE:
        return width
    u0, u1 = wider(u0, u1)
    v0, v1 = wider(v0, v1)
    _put(memory, SLOPE, v, u0)
    _put(memory, SLOPE + 1, v, u1)
    _put(memory, SLOPE + 2, v, v0)
    _put(memory, SLOPE + 3, v, v1)
    a = memory + 64 * v
    near = smallest(load_f32x16(a + T_MIN * ROW) * load_f32x16(a + (DX + axes.along) * ROW) * axes.way)
    _put(memory, NEAR, v, maximum(near - np.float32(2e-6) * near, ZERO))
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
        load_f32x8(a + 320), load_f32x8(a + 352),
    )  # fmt: skip


@inlined
def _around(f):
    """The frustum around eight."""
    return Frustum(
        smallest(f.start0), largest(f.start1), smallest(f.u_start0), largest(f.u_start1),
        smallest(f.v_start0), largest(f.v_start1), smallest(f.u0), largest(f.u1), smallest(f.v0), largest(f.v1),
        smallest(f.near), largest(f.far),
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
    """Those of these vectors (bits) that can go together along an axis; at least one."""
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
        members |= np.int64(width <= WIDE) << v
        wide |= np.int64(width > NARROW) << v
    dx = _least_and_greatest(memory, DX, members)
    dy = _least_and_greatest(memory, DY, members)
    dz = _least_and_greatest(memory, DZ, members)
    low, high = (dx[0], dy[0], dz[0]), (dx[1], dy[1], dz[1])
    return Group(members, wide, axes, _around(frusta_of(memory)), low, high)


@inlined
def farthest(memory):
    """Up to where along the axis any frustum goes."""
    return largest(load_f32x8(memory + FRUSTA + 32 * REACH))


@inlined
def looking(memory, distance):
    """The vectors that are still looking beyond a distance along the axis."""
    return bits_of(load_f32x8(memory + FRUSTA + 32 * REACH) >= distance)


@inlined
def lanes_inside(origin, memory, v, x0, y0, z0, x1, y1, z1):
    """Where the sixteen rays of the v-th vector enter and leave a box."""
    ox, oy, oz = origin_of(origin, memory, v)
    a = memory + 64 * v
    ix, iy, iz = load_f32x16(a + IX * ROW), load_f32x16(a + IY * ROW), load_f32x16(a + IZ * ROW)
    ax, bx = (x0 - ox) * ix, (x1 - ox) * ix
    ay, by = (y0 - oy) * iy, (y1 - oy) * iy
    az, bz = (z0 - oz) * iz, (z1 - oz) * iz
    enter = maximum(maximum(minimum(ax, bx), minimum(ay, by)), maximum(minimum(az, bz), load_f32x16(a + T_MIN * ROW)))
    leave = minimum(minimum(maximum(ax, bx), maximum(ay, by)), minimum(maximum(az, bz), load_f32x16(a + T * ROW)))
    return enter, leave


@subkernel
def keep_hits(memory, batch, first, count):
    """Write a packet's hits to where the batch wants them."""
    at = 4 * first
    t, primitive = load_i64(batch + HIT_T) + at, load_i64(batch + HIT_PRIMITIVE) + at
    u, v = load_i64(batch + HIT_U) + at, load_i64(batch + HIT_V) + at
    i = 0
    while i + LANES <= count:
        a = memory + 4 * i
        numbers = load_i32x16(a + NUMBER * ROW)
        missed = numbers == MISS
        store(primitive + 4 * i, numbers)
        store(t + 4 * i, select(missed, INFINITY, load_f32x16(a + T * ROW)))
        store(u + 4 * i, select(missed, ZERO, load_f32x16(a + U * ROW)))
        store(v + 4 * i, select(missed, ZERO, load_f32x16(a + V * ROW)))
        i += LANES
    while i < count:
        a = memory + 4 * i
        missed = load_i32(a + NUMBER * ROW) == MISS
        store(primitive + 4 * i, load_i32(a + NUMBER * ROW))
        store(t + 4 * i, INFINITY if missed else load_f32(a + T * ROW))
        store(u + 4 * i, ZERO if missed else load_f32(a + U * ROW))
        store(v + 4 * i, ZERO if missed else load_f32(a + V * ROW))
        i += 1


@subkernel
def mark_static(memory, vectors):
    """Note of the rays of these vectors, given as bits, that are blocked that it was by something static."""
    while vectors != 0:
        a = memory + T * ROW + 64 * lowest_bit(vectors)
        vectors &= vectors - 1
        t = load_f32x16(a)
        store(a, select(t == BLOCKED_T, STATIC_T, t))


@subkernel
def keep_blocked(memory, batch, first, count):
    """Write what blocks the rays of a packet to where the batch wants it."""
    blocked, a = load_i64(batch + BLOCKED) + first, memory + T * ROW
    i = 0
    while i + LANES <= count:
        t = load_f32x16(a + 4 * i)
        store_bytes(blocked + i, select(t == STATIC_T, STATIC, select(t == BLOCKED_T, DYNAMIC, 0)))
        i += LANES
    answers = u8_at(blocked)
    while i < count:
        t = load_f32(a + 4 * i)
        answers[i] = np.uint8(STATIC if t == STATIC_T else (DYNAMIC if t == BLOCKED_T else 0))
        i += 1
