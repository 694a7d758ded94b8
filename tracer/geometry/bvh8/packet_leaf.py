"""Leaves for a packet: a block of eight triangles, or a quadric, against the vectors that come to it.

Rays from one point are by far cheaper, since what the test takes from origin and triangle alone is found once a block.
So whatever depends on the origins has two versions: `origin` is the point that all rays share, or None.
"""

from __future__ import annotations

import numpy as np
from numba.core import types
from numba.extending import overload

from tracer.geometry.bvh8.eight_wide import any_of_eight, single_ray_at
from tracer.geometry.bvh8.layout import COUNT, PRIMITIVES
from tracer.geometry.bvh8.packet import (
    BLOCKED_T,
    DIRECTION,
    ENTER,
    FAR,
    INLINED,
    LEAVE,
    NUMBER,
    ORIGIN,
    ROW,
    T_MIN,
    TERMS,
    T,
    U,
    V,
    lanes_inside,
    origin_of,
    three_of,
    three_of_16,
)
from tracer.geometry.bvh8.placed import block_planes, child_planes, triangle_of, triangles_of
from tracer.geometry.intersect import hit_quadric
from tracer.geometry.rays import MISS, Ray
from tracer.geometry.triangle_test import ZERO, Terms, crossing, crossing_ahead, may_cross_ahead, terms_of, towards
from tracer.runtime.kernels import inlined, subkernel
from tracer.simd import (
    any_lane,
    as_f32,
    as_i32,
    bits_of,
    f32x16,
    i32x16,
    lane_of,
    load_f32,
    load_f32x8,
    load_f32x16,
    load_i32,
    load_i32x16,
    lowest_bit,
    ones,
    select,
    store,
    store_where,
)


@inlined
def _inside_block(origin, memory, block, active):
    """Find where rays of active vectors enter and leave a block's box; how many do, and the vectors that hold any."""
    planes = block_planes(block)
    result, rays = np.int64(0), np.int64(0)
    while active != 0:
        v = lowest_bit(active)
        enter, leave = lanes_inside(origin, memory, v, planes)
        store(memory + ENTER * ROW + 64 * v, enter)
        store(memory + LEAVE * ROW + 64 * v, leave)
        inside = bits_of(enter <= leave)
        result |= np.int64(inside != 0) << v
        rays += ones(inside)
        active &= active - 1
    return rays, result


@inlined
def _prepare_common(origin, group, memory, block):
    m = towards(terms_of(origin[0], origin[1], origin[2], triangles_of(block)))
    a = memory + TERMS
    store(a, m.nx)
    store(a + 32, m.ny)
    store(a + 64, m.nz)
    store(a + 96, m.ax)
    store(a + 128, m.ay)
    store(a + 160, m.az)
    store(a + 192, m.bx)
    store(a + 224, m.by)
    store(a + 256, m.bz)
    store(a + 288, m.height)
    return bits_of(may_cross_ahead(group.low, group.high, m))


def prepare(origin, group, memory, block):
    """Do what can be done once for a block; the triangles, as bits, that may be hit."""
    raise NotImplementedError("only kernels call this")


@overload(prepare, jit_options=INLINED)
def _prepare(origin, group, memory, block):
    if isinstance(origin, types.NoneType):
        return lambda origin, group, memory, block: (np.int64(1) << load_i32(block + 4 * COUNT)) - 1
    return lambda origin, group, memory, block: _prepare_common(origin, group, memory, block)


@inlined
def _crossing_separate(memory, block, v, k):
    dx, dy, dz = three_of_16(memory + 64 * v, DIRECTION)
    ox, oy, oz = three_of_16(memory + 64 * v, ORIGIN)
    m = terms_of(ox, oy, oz, triangle_of(block, k))
    crosses, sign, u, w, area = crossing(dx, dy, dz, m)
    return crosses, as_f32(as_i32(m.height) ^ sign), u, w, area


@inlined
def _crossing_common(memory, v, k):
    a = memory + TERMS + 4 * k
    m = Terms(
        load_f32(a), load_f32(a + 32), load_f32(a + 64), load_f32(a + 96), load_f32(a + 128),
        load_f32(a + 160), load_f32(a + 192), load_f32(a + 224), load_f32(a + 256), load_f32(a + 288),
    )  # fmt: skip
    dx, dy, dz = three_of_16(memory + 64 * v, DIRECTION)
    crosses, u, w, area = crossing_ahead(dx, dy, dz, m)
    return crosses, f32x16(m.height), u, w, area


def crossing_of(origin, memory, block, v, k):
    """(mask, t area, u area, v area, area) of the rays of a packet's v-th vector on the k-th triangle of a block."""
    raise NotImplementedError("only kernels call this")


@overload(crossing_of, jit_options=INLINED)
def _crossing_of(origin, memory, block, v, k):
    if isinstance(origin, types.NoneType):
        return lambda origin, memory, block, v, k: _crossing_separate(memory, block, v, k)
    return lambda origin, memory, block, v, k: _crossing_common(memory, v, k)


@inlined
def _distance(memory, v, crosses, height, area):
    """(mask, t, 1 / area) of those crossings that lie inside the block's box."""
    a = memory + 64 * v
    scale = np.float32(1) / area
    t = height * scale
    mask = crosses & (t >= load_f32x16(a + ENTER * ROW)) & (t <= load_f32x16(a + LEAVE * ROW))
    return mask & (t > load_f32x16(a + T_MIN * ROW)), t, scale


@inlined
def _terms_of_eight(memory):
    a = memory + TERMS
    return Terms(
        load_f32x8(a), load_f32x8(a + 32), load_f32x8(a + 64), load_f32x8(a + 96), load_f32x8(a + 128),
        load_f32x8(a + 160), load_f32x8(a + 192), load_f32x8(a + 224), load_f32x8(a + 256), load_f32x8(a + 288),
    )  # fmt: skip


@inlined
def _any_of_prepared(memory, block, a):
    (dx, dy, dz), m = three_of(a, DIRECTION), _terms_of_eight(memory)
    crosses, _u, _w, area = crossing_ahead(dx, dy, dz, m)
    if not any_lane(crosses):
        return np.int32(MISS)
    t = m.height * (np.float32(1) / area)
    mask = crosses & (t >= load_f32(a + ENTER * ROW)) & (t <= load_f32(a + LEAVE * ROW))
    bits = bits_of(mask & (t > load_f32(a + T_MIN * ROW)) & (t < load_f32(a + T * ROW)))
    return load_i32(block + 4 * (PRIMITIVES + lowest_bit(bits))) if bits != 0 else np.int32(MISS)


def any_for_one(origin, memory, block, a):
    """The number of the first triangle in a block, after `prepare`, that one ray inside its box hits; or MISS."""
    raise NotImplementedError("only kernels call this")


@overload(any_for_one, jit_options=INLINED)
def _any_for_one(origin, memory, block, a):
    if isinstance(origin, types.NoneType):
        return lambda origin, memory, block, a: any_of_eight(block, single_ray_at(a), load_f32(a + T * ROW))
    return lambda origin, memory, block, a: _any_of_prepared(memory, block, a)


@inlined
def _any_one_by_one(origin, memory, block, active):
    """Test each ray inside a block's box against its eight triangles at once, for any hits; the vectors that hit."""
    found = np.int64(0)
    while active != 0:
        v = lowest_bit(active)
        active &= active - 1
        row = memory + 64 * v
        rays = bits_of(load_f32x16(row + ENTER * ROW) <= load_f32x16(row + LEAVE * ROW))
        while rays != 0:
            a = row + 4 * lowest_bit(rays)
            rays &= rays - 1
            number = any_for_one(origin, memory, block, a)
            if number != MISS:
                found |= np.int64(1) << v
                store(a + NUMBER * ROW, number)
                store(a + T * ROW, BLOCKED_T)
    return found


@inlined
def _meet_block(origin, memory, group, block, active, nearest):
    """Test the active vectors against a block's triangles, for the nearest hits or else for any; the vectors that hit.

    `nearest` is a constant, so that each of the two is compiled without the other."""
    rays, active = _inside_block(origin, memory, block, active)
    found = np.int64(0)
    if active == 0:
        return found
    triangles = prepare(origin, group, memory, block)
    if not nearest and rays <= ones(triangles) * ones(active):  # fewer tests than those of sixteen rays at once
        return _any_one_by_one(origin, memory, block, active)
    while triangles != 0:
        k = lowest_bit(triangles)
        triangles &= triangles - 1
        number = load_i32(block + 4 * (PRIMITIVES + k))
        rest = active
        while rest != 0:
            v = lowest_bit(rest)
            rest &= rest - 1
            a = memory + 64 * v
            crosses, height, u, w, area = crossing_of(origin, memory, block, v, k)
            if not any_lane(crosses):
                continue
            mask, t, scale = _distance(memory, v, crosses, height, area)
            best = load_f32x16(a + T * ROW)
            nearer = t < best
            if nearest:
                nearer = nearer | ((t == best) & (i32x16(number) < load_i32x16(a + NUMBER * ROW)))
            mask = mask & nearer
            if not any_lane(mask):
                continue
            found |= np.int64(1) << v
            store_where(a + NUMBER * ROW, i32x16(number), mask)
            if nearest:
                store(a + T * ROW, select(mask, t, best))
                store_where(a + U * ROW, u * scale, mask)
                store_where(a + V * ROW, w * scale, mask)
            else:
                store_where(a + T * ROW, f32x16(BLOCKED_T), mask)
    return found


@subkernel
def closest_in_block(origin, memory, group, block, active):
    """Keep the nearest hits on a block's triangles; the vectors with rays that hit nearer than before."""
    return _meet_block(origin, memory, group, block, active, True)


@subkernel
def any_in_block(origin, memory, group, block, active):
    """Mark the rays that hit any of a block's triangles: their t becomes BLOCKED_T, their number that of the triangle;
    the vectors they are in."""
    return _meet_block(origin, memory, group, block, active, False)


@inlined
def _lane_origin(origin, memory, lane):
    """Origin of one ray."""
    ox, oy, oz = origin_of(origin, memory, lane >> 4)
    x, y, z = f32x16(ZERO) + ox, f32x16(ZERO) + oy, f32x16(ZERO) + oz
    return lane_of(x, lane & 15), lane_of(y, lane & 15), lane_of(z, lane & 15)


@subkernel
def quadric_in_child(origin, memory, a, active, trees, i, nearest):
    """Test rays against a quadric, one by one; the vectors with rays that hit it (nearer than before, where `nearest`
    hits are asked for).  The planes of its box lie 32 bytes apart from the address `a` on."""
    found = np.int64(0)
    while active != 0:
        v = lowest_bit(active)
        active &= active - 1
        enter, leave = lanes_inside(origin, memory, v, child_planes(a))
        rest = bits_of(enter <= leave)
        while rest != 0:
            lane = lowest_bit(rest)
            rest &= rest - 1
            r = memory + 64 * v + 4 * lane
            ox, oy, oz = _lane_origin(origin, memory, 16 * v + lane)
            dx, dy, dz = three_of(r, DIRECTION)
            ray = Ray(ox, oy, oz, dx, dy, dz, load_f32(r + T_MIN * ROW), FAR)
            t = hit_quadric(ray, trees.quadrics, i)
            best, number = load_f32(r + T * ROW), trees.triangles + i
            inside = t >= lane_of(enter, lane) and t <= lane_of(leave, lane)
            if not inside or t > best or (t == best and not (nearest and number < load_i32(r + NUMBER * ROW))):
                continue
            found |= np.int64(1) << v
            store(r + NUMBER * ROW, np.int32(number))
            if nearest:
                store(r + T * ROW, t)
                store(r + U * ROW, ZERO)
                store(r + V * ROW, ZERO)
            else:
                store(r + T * ROW, BLOCKED_T)
    return found
