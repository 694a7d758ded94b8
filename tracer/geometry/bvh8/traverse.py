"""The queries on a placed world: batches cut into packets, and these traced together or ray by ray.

Coherent rays go through the trees 128 at a time.  Whether a packet is coherent its directions say;
as a ray's answer does not depend on who it travels with, nothing but time hangs on that.
"""

from __future__ import annotations

import numpy as np

from tracer.geometry.bvh8.intersect import ZERO
from tracer.geometry.bvh8.packet import (
    BLOCKED_T,
    DX,
    IX,
    LANES,
    MEMORY,
    NUMBER,
    OX,
    PACKET,
    ROW,
    STACK,
    T_MIN,
    T,
    Trees,
    U,
    V,
    any_in_tree,
    closest_in_tree,
    interval_of,
    inverse,
)
from tracer.geometry.bvh8.single import SINGLE_MEMORY, Best, any_of_one, closest_of_one, line_of
from tracer.geometry.queries import (
    BLOCKED,
    DIRECTION,
    HIT_PRIMITIVE,
    HIT_T,
    HIT_U,
    HIT_V,
    ORIGIN,
    STRIDE,
    T_MAX,
    rays_of,
)
from tracer.geometry.queries import T_MIN as BATCH_T_MIN
from tracer.geometry.rays import INFINITY, MISS, ray_at
from tracer.kernels import entry, inlined, subkernel
from tracer.simd import (
    all_lanes,
    f32_at,
    f32x16,
    i32_at,
    i32x16,
    i64_at,
    largest,
    load_f32,
    load_f32x16,
    load_i32,
    load_i32x16,
    load_i64,
    local_memory,
    maximum,
    minimum,
    select,
    smallest,
    store,
    store_mask,
    u8_at,
)

# A placed world as the entries get it: addresses of both trees' nodes and blocks and of the quadrics as seen from the
# world, the number of triangles, and whether the second tree holds anything.
STATIC_NODES, STATIC_BLOCKS, DYNAMIC_NODES, DYNAMIC_BLOCKS, QUADRICS, TRIANGLE_COUNT, HAS_DYNAMIC = range(0, 56, 8)
LARGEST = np.float32(1e29)  # of t_max, short of what stands for a blocked ray


@inlined
def _trees(data, nodes, blocks):
    return Trees(
        load_i64(data + nodes),
        load_i64(data + blocks),
        f32_at(load_i64(data + QUADRICS)),
        load_i64(data + TRIANGLE_COUNT),
    )


@inlined
def _row(memory, row, source, count, rest):
    """Copy a row of `count` numbers into a packet's memory, and fill its last vector up with `rest`."""
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
def _fill(memory, batch, first, count):
    """Rays first to first + count - 1 as a packet; how many vectors they are, the box of their origins, and whether
    all are finite: of others no interval can be told."""
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
    ly = hy = load_f32x16(memory + (OX + 1) * ROW)
    lz = hz = load_f32x16(memory + (OX + 2) * ROW)
    nothing = f32x16(ZERO)
    for v in range(vectors):
        a = memory + 64 * v
        dx, dy, dz = load_f32x16(a + DX * ROW), load_f32x16(a + (DX + 1) * ROW), load_f32x16(a + (DX + 2) * ROW)
        for axis in range(3):
            store(a + (IX + axis) * ROW, inverse(load_f32x16(a + (DX + axis) * ROW)))
        store(a + T * ROW, minimum(load_f32x16(a + T * ROW), LARGEST))
        store(a + NUMBER * ROW, i32x16(MISS))
        x, y, z = load_f32x16(a + OX * ROW), load_f32x16(a + (OX + 1) * ROW), load_f32x16(a + (OX + 2) * ROW)
        lx, ly, lz = minimum(lx, x), minimum(ly, y), minimum(lz, z)
        hx, hy, hz = maximum(hx, x), maximum(hy, y), maximum(hz, z)
        nothing = nothing + ((x + y + z) + (dx + dy + dz)) * ZERO
    low = (smallest(lx), smallest(ly), smallest(lz))
    high = (largest(hx), largest(hy), largest(hz))
    return vectors, low, high, all_lanes(nothing == ZERO)


@inlined
def _from_one_point(low, high):
    return low[0] == high[0] and low[1] == high[1] and low[2] == high[2]


@inlined
def _coherent(s):
    """Whether packets pay: the rays have a sign of direction in common along two axes at least."""
    return np.int64(s.mixed_x) + np.int64(s.mixed_y) + np.int64(s.mixed_z) <= 1


@subkernel
def _keep_hits(memory, batch, first, count):
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
def _closest_packet(origin, memory, vectors, s, data, stack, counts):
    closest_in_tree(origin, memory, vectors, s, _trees(data, STATIC_NODES, STATIC_BLOCKS), stack, counts)
    if load_i64(data + HAS_DYNAMIC) != 0:
        closest_in_tree(origin, memory, vectors, s, _trees(data, DYNAMIC_NODES, DYNAMIC_BLOCKS), stack, counts)


@subkernel
def _closest_singles(data, batch, first, last, stack, counts):
    """Nearest hits one by one."""
    static = _trees(data, STATIC_NODES, STATIC_BLOCKS)
    dynamic = _trees(data, DYNAMIC_NODES, DYNAMIC_BLOCKS)
    rays = rays_of(batch)
    hit_t, hit_primitive = f32_at(load_i64(batch + HIT_T)), i32_at(load_i64(batch + HIT_PRIMITIVE))
    hit_u, hit_v = f32_at(load_i64(batch + HIT_U)), f32_at(load_i64(batch + HIT_V))
    for i in range(first, last):
        ray = ray_at(rays, i)
        line = line_of(ray)
        best = closest_of_one(line, Best(min(ray.t_max, LARGEST), np.int32(MISS), ZERO, ZERO), static, stack, counts)
        if load_i64(data + HAS_DYNAMIC) != 0:
            best = closest_of_one(line, best, dynamic, stack, counts)
        hit_primitive[i], hit_t[i] = best.number, best.t if best.number != MISS else INFINITY
        hit_u[i], hit_v[i] = best.u, best.v


@entry
def closest(data, batch, first, last, counts):
    """Nearest hits of rays first to last - 1."""
    memory, stack, count = local_memory(MEMORY), local_memory(STACK), i64_at(counts)
    single_stack = local_memory(SINGLE_MEMORY) + 64
    for start in range(first, last, PACKET):
        n = min(PACKET, last - start)
        vectors, low, high, finite = _fill(memory, batch, start, n)
        s = interval_of(memory, vectors, low, high)
        if not (finite and _coherent(s)):
            _closest_singles(data, batch, start, start + n, single_stack, count)
            continue
        if _from_one_point(low, high):
            _closest_packet(low, memory, vectors, s, data, stack, count)
        else:
            _closest_packet(None, memory, vectors, s, data, stack, count)
        _keep_hits(memory, batch, start, n)


@subkernel
def _any_singles(data, nodes, blocks, batch, first, last, stack, counts):
    """Whether anything lies in the interval of each ray, one by one."""
    trees, rays, blocked = _trees(data, nodes, blocks), rays_of(batch), u8_at(load_i64(batch + BLOCKED))
    for i in range(first, last):
        ray = ray_at(rays, i)
        blocked[i] = np.uint8(
            ray.t_min < ray.t_max and any_of_one(line_of(ray), min(ray.t_max, LARGEST), trees, stack, counts)
        )


@subkernel
def _any(data, nodes, blocks, batch, first, last, counts):
    memory, stack, count = local_memory(MEMORY), local_memory(STACK), i64_at(counts)
    trees, blocked = _trees(data, nodes, blocks), load_i64(batch + BLOCKED)
    for start in range(first, last, PACKET):
        n = min(PACKET, last - start)
        vectors, low, high, finite = _fill(memory, batch, start, n)
        s = interval_of(memory, vectors, low, high)
        if not (finite and _coherent(s)):
            _any_singles(data, nodes, blocks, batch, start, start + n, stack, count)
            continue
        if _from_one_point(low, high):
            any_in_tree(low, memory, vectors, s, trees, stack, count)
        else:
            any_in_tree(None, memory, vectors, s, trees, stack, count)
        i = 0
        while i + LANES <= n:
            store_mask(blocked + start + i, load_f32x16(memory + T * ROW + 4 * i) == BLOCKED_T)
            i += LANES
        answers = u8_at(blocked + start)
        while i < n:
            answers[i] = np.uint8(load_f32(memory + T * ROW + 4 * i) == BLOCKED_T)
            i += 1


@entry
def any_static(data, batch, first, last, counts):
    """Whether static geometry lies in the interval of rays first to last - 1."""
    _any(data, STATIC_NODES, STATIC_BLOCKS, batch, first, last, counts)


@entry
def any_dynamic(data, batch, first, last, counts):
    """Whether a dynamic object lies in the interval of rays first to last - 1."""
    _any(data, DYNAMIC_NODES, DYNAMIC_BLOCKS, batch, first, last, counts)
