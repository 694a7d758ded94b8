"""A packet: up to 128 rays in local memory, as eight vectors of sixteen.

Each number of a ray has a row: its direction, its interval and so on.  Hits are written into rows as well, whether the
rays go through a tree together (`packet_tree`) or one by one (`single_ray`), so that `traverse` need not know.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba.core import types
from numba.extending import overload

from tracer.geometry.accelerators import MAX_PACKET_SIZE
from tracer.geometry.boxes import inverse
from tracer.geometry.queries import DYNAMIC_OBJECTS, STATIC_GEOMETRY, read_batch
from tracer.geometry.rays import INFINITY, MISS
from tracer.geometry.triangle_test import ZERO
from tracer.runtime.kernels import inlined, subkernel
from tracer.simd import (
    all_lanes,
    any_lane,
    f32x16,
    i32x16,
    largest,
    load_f32,
    load_f32x16,
    load_i32,
    load_i32x16,
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

INLINED: Any = {"forceinline": True, "error_model": "numpy"}  # as `inlined`, for what has two versions
LANES = 16
PACKET = MAX_PACKET_SIZE  # rays
ROW = 4 * PACKET  # bytes of one number of each ray
FAR = np.float32(1e30)  # no hit is farther, and every empty child is
LARGEST = np.float32(1e29)  # of t_max, short of what stands for a blocked ray
BLOCKED_T = -FAR  # t of a ray that is known to be blocked
CLOSED_T = -LARGEST  # t of a ray with nothing to ask
STATIC_T = np.float32(2) * BLOCKED_T  # t of a ray that something static blocks, once the static tree is done

# Rows of a packet's memory: the numbers of all rays, their eight frusta (`packet_group`), and scratch.
# Directions, their inverses and origins have three rows each.
DIRECTION, INVERSE, T_MIN, T, NUMBER, U, V, ENTER, LEAVE, ORIGIN = 0, 3, 6, 7, 8, 9, 10, 11, 12, 13
FRUSTA = 16 * ROW
SCRATCH = FRUSTA + 12 * 32  # twelve rows of eight
TERMS = SCRATCH + 64
MEMORY = TERMS + 320


@inlined
def three_of(a, row):
    """Three rows from this one on, of the ray whose column begins at an address."""
    return load_f32(a + row * ROW), load_f32(a + (row + 1) * ROW), load_f32(a + (row + 2) * ROW)


@inlined
def three_of_16(a, row):
    """The same of the sixteen rays whose columns begin there."""
    return load_f32x16(a + row * ROW), load_f32x16(a + (row + 1) * ROW), load_f32x16(a + (row + 2) * ROW)


def origin_of(origin, memory, v):
    """Origins of the rays of a packet's v-th vector: the point that all share, or, where that is None, what the
    packet's memory holds."""
    raise NotImplementedError("only kernels call this")


@overload(origin_of, jit_options=INLINED)
def _origin_of(origin, memory, v):
    if isinstance(origin, types.NoneType):
        return lambda origin, memory, v: three_of_16(memory + 64 * v, ORIGIN)
    return lambda origin, memory, v: origin


@inlined
def _row(memory, row, source, count, rest):
    """Copy `count` numbers into a row of a packet's memory, and fill the last vector up with `rest`; the numbers of the
    next packet are fetched into the cache."""
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
    """Read rays first to first + count - 1 into a packet; how many vectors they are, the lower and upper corner of the
    box around their origins, and whether all numbers are finite: rays that are not have no frustum."""
    rays = read_batch(batch)
    n, at, last = 4 * rays.stride, 4 * first, 4 * (count - 1)
    o, d, t_min, t_max = rays.origin + at, rays.direction + at, rays.t_min + at, rays.t_max + at
    for axis in range(3):
        _row(memory, ORIGIN + axis, o + axis * n, count, load_f32(o + axis * n + last))
        _row(memory, DIRECTION + axis, d + axis * n, count, load_f32(d + axis * n + last))
    _row(memory, T_MIN, t_min, count, load_f32(t_min + last))
    _row(memory, T, t_max, count, CLOSED_T)
    vectors = (count + LANES - 1) // LANES
    lx, ly, lz = three_of_16(memory, ORIGIN)
    hx, hy, hz = lx, ly, lz
    nothing = f32x16(ZERO)
    for v in range(vectors):
        a = memory + 64 * v
        dx, dy, dz = three_of_16(a, DIRECTION)
        store(a + INVERSE * ROW, inverse(dx))
        store(a + (INVERSE + 1) * ROW, inverse(dy))
        store(a + (INVERSE + 2) * ROW, inverse(dz))
        t = load_f32x16(a + T * ROW)
        store(a + T * ROW, select(t > BLOCKED_T, minimum(t, LARGEST), CLOSED_T))
        store(a + NUMBER * ROW, i32x16(MISS))
        x, y, z = three_of_16(a, ORIGIN)
        lx, ly, lz = minimum(lx, x), minimum(ly, y), minimum(lz, z)
        hx, hy, hz = maximum(hx, x), maximum(hy, y), maximum(hz, z)
        nothing = nothing + ((x + y + z) + (dx + dy + dz) + load_f32x16(a + T_MIN * ROW)) * ZERO
    low = (smallest(lx), smallest(ly), smallest(lz))
    high = (largest(hx), largest(hy), largest(hz))
    return vectors, low, high, all_lanes(nothing == ZERO)


@inlined
def open_vectors(memory, vectors):
    """Which of so many vectors, as bits, hold a ray to trace."""
    result = np.int64(0)
    for v in range(vectors):
        a = memory + 64 * v
        result |= np.int64(any_lane(load_f32x16(a + T * ROW) > load_f32x16(a + T_MIN * ROW))) << v
    return result


@inlined
def lanes_inside(origin, memory, v, planes):
    """t where each of the sixteen rays of the v-th vector enters and leaves a box, given by its six planes."""
    x0, y0, z0, x1, y1, z1 = planes
    ox, oy, oz = origin_of(origin, memory, v)
    a = memory + 64 * v
    ix, iy, iz = three_of_16(a, INVERSE)
    ax, bx = (x0 - ox) * ix, (x1 - ox) * ix
    ay, by = (y0 - oy) * iy, (y1 - oy) * iy
    az, bz = (z0 - oz) * iz, (z1 - oz) * iz
    enter = maximum(maximum(minimum(ax, bx), minimum(ay, by)), maximum(minimum(az, bz), load_f32x16(a + T_MIN * ROW)))
    leave = minimum(minimum(maximum(ax, bx), maximum(ay, by)), minimum(maximum(az, bz), load_f32x16(a + T * ROW)))
    return enter, leave


@subkernel
def keep_hits(memory, batch, first, count):
    """Write a packet's hits to the arrays that the batch names."""
    at, hits = 4 * first, read_batch(batch)
    t, primitive, u, v = hits.t + at, hits.primitive + at, hits.u + at, hits.v + at
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
    """Note that the blocked rays of these vectors, given as bits, are blocked by static geometry."""
    while vectors != 0:
        a = memory + T * ROW + 64 * lowest_bit(vectors)
        vectors &= vectors - 1
        t = load_f32x16(a)
        store(a, select(t == BLOCKED_T, STATIC_T, t))


@subkernel
def keep_blocked(memory, batch, first, count):
    """Write what blocks the rays of a packet, and its number, to the arrays that the batch names."""
    found, a = read_batch(batch), memory + T * ROW
    blocked = found.blocked + first
    i = 0
    while i + LANES <= count:
        t = load_f32x16(a + 4 * i)
        store_bytes(blocked + i, select(t == STATIC_T, STATIC_GEOMETRY, select(t == BLOCKED_T, DYNAMIC_OBJECTS, 0)))
        i += LANES
    answers = u8_at(blocked)
    while i < count:
        t = load_f32(a + 4 * i)
        answers[i] = np.uint8(STATIC_GEOMETRY if t == STATIC_T else (DYNAMIC_OBJECTS if t == BLOCKED_T else 0))
        i += 1
    if found.occluders != 0:
        for k in range(0, 4 * count, 4):
            store(found.occluders + 4 * first + k, load_i32(memory + NUMBER * ROW + k))
