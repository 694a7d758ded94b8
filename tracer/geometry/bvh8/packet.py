"""Up to 128 rays through a BVH8 together: what one has read, all have.

A packet is eight vectors of sixteen rays.  At a node one interval test asks which of the eight children
any ray could enter at all (Wald et al. 2007, and for eight boxes at once); only those are tested
exactly, vector by vector.  A pending child is one int64: above, the bits of the distance where the
packet enters it, their lowest eight replaced by the set of vectors that do (which only makes the
distance less); below, its code.

Rays from one point are by far the cheaper: what is subtracted from that point is subtracted once.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba.core import types
from numba.extending import overload

from tracer.geometry.bvh8 import tree
from tracer.geometry.bvh8.intersect import ZERO, Terms, crossing, may_cross, terms_of, triangle_of, triangles_of
from tracer.geometry.bvh8.tree import BLOCK_SIZE, NODE_SIZE, QUADRIC
from tracer.geometry.intersect import hit_quadric
from tracer.geometry.queries import STEPS, TESTS
from tracer.geometry.rays import Ray
from tracer.kernels import inlined, subkernel
from tracer.simd import (
    any_lane,
    as_f32,
    as_i32,
    bits_of,
    f32x16,
    i32x16,
    lane_of,
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
    select,
    smallest,
    store,
    store_where,
)

LANES = 16
PACKET = 128  # rays
ROW = 4 * PACKET  # bytes of one number of each ray
NODE, BLOCK = 4 * NODE_SIZE, 4 * BLOCK_SIZE  # bytes
CHILDREN = 4 * tree.CHILDREN  # offset of the children's codes in a node
NUMBERS, BOX, COUNT = 4 * tree.PRIMITIVES, 4 * tree.BOX, 4 * tree.COUNT  # offsets in a block
STACK = 8 * 512
FAR = np.float32(1e30)  # no hit is farther, and every empty child is
TINY = np.float32(1e-20)
BLOCKED_T = -FAR  # t of a ray that is known to be blocked, and of none

# Rows of a packet's memory.
DX, DY, DZ, IX, IY, IZ, T_MIN, T, NUMBER, U, V, ENTER, LEAVE, OX, OY, OZ = range(16)
SCRATCH = 16 * ROW
TERMS = SCRATCH + 64
MEMORY = TERMS + 320


class Trees(NamedTuple):
    """A tree as a packet needs it: addresses of nodes and blocks, a pointer to quadrics as seen from the
    world, and the number of triangles, which is that of the first quadric."""

    nodes: Any
    blocks: Any
    quadrics: Any
    triangles: Any


class Interval(NamedTuple):
    """What all rays of a packet have in common: intervals of origins and inverse directions, by axis,
    offsets of the near and far planes in a node, and which axes have one sign of direction."""

    near_x: Any
    near_y: Any
    near_z: Any
    low_x: Any
    low_y: Any
    low_z: Any
    high_x: Any
    high_y: Any
    high_z: Any
    least_x: Any
    least_y: Any
    least_z: Any
    most_x: Any
    most_y: Any
    most_z: Any
    dx0: Any
    dy0: Any
    dz0: Any
    dx1: Any
    dy1: Any
    dz1: Any
    t_min: Any
    mixed_x: Any
    mixed_y: Any
    mixed_z: Any


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
def _axis(memory, row, vectors):
    """Least and greatest inverse of a packet's directions along an axis, and whether their signs are mixed."""
    low = high = load_f32x16(memory + row * ROW)
    for v in range(1, vectors):
        x = load_f32x16(memory + row * ROW + 64 * v)
        low, high = minimum(low, x), maximum(high, x)
    least, most = smallest(low), largest(high)
    return least, most, (least < ZERO) != (most < ZERO)


@inlined
def interval_of(memory, vectors, low, high):
    """The interval of a packet whose rows are filled; low and high are the box of its origins."""
    lx, mx, bx = _axis(memory, IX, vectors)
    ly, my, by = _axis(memory, IY, vectors)
    lz, mz, bz = _axis(memory, IZ, vectors)
    dx0, dx1, _ = _axis(memory, DX, vectors)
    dy0, dy1, _ = _axis(memory, DY, vectors)
    dz0, dz1, _ = _axis(memory, DZ, vectors)
    t_min = load_f32x16(memory + T_MIN * ROW)
    for v in range(1, vectors):
        t_min = minimum(t_min, load_f32x16(memory + T_MIN * ROW + 64 * v))
    return Interval(
        np.int64(96 if lx < ZERO else 0), np.int64(96 if ly < ZERO else 0), np.int64(96 if lz < ZERO else 0),
        low[0], low[1], low[2], high[0], high[1], high[2],
        lx, ly, lz, mx, my, mz, dx0, dy0, dz0, dx1, dy1, dz1, maximum(smallest(t_min), ZERO), bx, by, bz,
    )  # fmt: skip


@inlined
def _axis_interval(node, axis, near, low, high, least, most):
    """Least entry and greatest exit of eight children along an axis, for origins and inverses in these intervals."""
    first = low if near > 0 else high
    last = high if near > 0 else low
    a = load_f32x8(node + 32 * axis + near) - first
    b = load_f32x8(node + 32 * axis + 96 - near) - last
    return minimum(a * least, a * most), maximum(b * least, b * most)


@inlined
def _open(node, s, far):
    """(entry, mask) of the children of a node that some ray of the packet may enter before `far`."""
    enter, leave = load_f32x8(node) * ZERO + s.t_min, load_f32x8(node) * ZERO + far
    if not s.mixed_x:
        a, b = _axis_interval(node, 0, s.near_x, s.low_x, s.high_x, s.least_x, s.most_x)
        enter, leave = maximum(enter, a), minimum(leave, b)
    if not s.mixed_y:
        a, b = _axis_interval(node, 1, s.near_y, s.low_y, s.high_y, s.least_y, s.most_y)
        enter, leave = maximum(enter, a), minimum(leave, b)
    if not s.mixed_z:
        a, b = _axis_interval(node, 2, s.near_z, s.low_z, s.high_z, s.least_z, s.most_z)
        enter, leave = maximum(enter, a), minimum(leave, b)
    return enter, bits_of(enter <= leave)


@inlined
def _lanes_inside(origin, memory, v, x0, y0, z0, x1, y1, z1):
    """Where sixteen rays enter and leave a box."""
    ox, oy, oz = origin_of(origin, memory, v)
    a = memory + 64 * v
    ix, iy, iz = load_f32x16(a + IX * ROW), load_f32x16(a + IY * ROW), load_f32x16(a + IZ * ROW)
    ax, bx = (x0 - ox) * ix, (x1 - ox) * ix
    ay, by = (y0 - oy) * iy, (y1 - oy) * iy
    az, bz = (z0 - oz) * iz, (z1 - oz) * iz
    enter = maximum(maximum(minimum(ax, bx), minimum(ay, by)), maximum(minimum(az, bz), load_f32x16(a + T_MIN * ROW)))
    leave = minimum(minimum(maximum(ax, bx), maximum(ay, by)), minimum(maximum(az, bz), load_f32x16(a + T * ROW)))
    return enter, leave


@inlined
def _lanes_inside_uniform(origin, memory, v, x0, y0, z0, x1, y1, z1):
    """The same where all rays meet the planes x0, y0, z0 first."""
    ox, oy, oz = origin_of(origin, memory, v)
    a = memory + 64 * v
    ix, iy, iz = load_f32x16(a + IX * ROW), load_f32x16(a + IY * ROW), load_f32x16(a + IZ * ROW)
    enter = maximum(maximum((x0 - ox) * ix, (y0 - oy) * iy), maximum((z0 - oz) * iz, load_f32x16(a + T_MIN * ROW)))
    leave = minimum(minimum((x1 - ox) * ix, (y1 - oy) * iy), minimum((z1 - oz) * iz, load_f32x16(a + T * ROW)))
    return enter, leave


@inlined
def _vectors_entering(origin, memory, s, node, c, active):
    """The active vectors of which some lane enters the c-th child of a node."""
    a = node + 4 * c
    result = np.int64(0)
    if s.mixed_x | s.mixed_y | s.mixed_z:
        x0, y0, z0 = load_f32(a), load_f32(a + 32), load_f32(a + 64)
        x1, y1, z1 = load_f32(a + 96), load_f32(a + 128), load_f32(a + 160)
        while active != 0:
            v = lowest_bit(active)
            enter, leave = _lanes_inside(origin, memory, v, x0, y0, z0, x1, y1, z1)
            result |= np.int64(any_lane(enter <= leave)) << v
            active &= active - 1
        return result
    x0, y0, z0 = load_f32(a + s.near_x), load_f32(a + 32 + s.near_y), load_f32(a + 64 + s.near_z)
    x1, y1, z1 = load_f32(a + 96 - s.near_x), load_f32(a + 128 - s.near_y), load_f32(a + 160 - s.near_z)
    while active != 0:
        v = lowest_bit(active)
        enter, leave = _lanes_inside_uniform(origin, memory, v, x0, y0, z0, x1, y1, z1)
        result |= np.int64(any_lane(enter <= leave)) << v
        active &= active - 1
    return result


@inlined
def _push_sorted(stack, pending, bottom, entry):
    """Put an entry among those from bottom on, which lie nearest last; the new number of pending ones."""
    at = pending
    while at > bottom and load_i64(stack + 8 * (at - 1)) < entry:
        store(stack + 8 * at, load_i64(stack + 8 * (at - 1)))
        at -= 1
    store(stack + 8 * at, entry)
    return pending + 1


@inlined
def _inside_block(origin, memory, block, active):
    """Note where the rays of active vectors are in a block's box; the vectors of which some lane is."""
    x0, y0, z0 = load_f32(block + BOX), load_f32(block + BOX + 4), load_f32(block + BOX + 8)
    x1, y1, z1 = load_f32(block + BOX + 12), load_f32(block + BOX + 16), load_f32(block + BOX + 20)
    result = np.int64(0)
    while active != 0:
        v = lowest_bit(active)
        enter, leave = _lanes_inside(origin, memory, v, x0, y0, z0, x1, y1, z1)
        store(memory + ENTER * ROW + 64 * v, enter)
        store(memory + LEAVE * ROW + 64 * v, leave)
        result |= np.int64(any_lane(enter <= leave)) << v
        active &= active - 1
    return result


def prepare(origin, s, memory, block):
    """What can be done once for a block; the triangles, as bits, that may be hit."""
    raise NotImplementedError("only kernels call this")


@overload(prepare, jit_options={"forceinline": True, "error_model": "numpy"})
def _prepare(origin, s, memory, block):
    if isinstance(origin, types.NoneType):
        return lambda origin, s, memory, block: (np.int64(1) << load_i32(block + COUNT)) - 1

    def common(origin, s, memory, block):
        m = terms_of(origin[0], origin[1], origin[2], triangles_of(block))
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
        return bits_of(may_cross((s.dx0, s.dy0, s.dz0), (s.dx1, s.dy1, s.dz1), m))

    return common


def terms_at(origin, memory, block, v, k):
    """Terms of the k-th triangle of a block for a packet's v-th vector."""
    raise NotImplementedError("only kernels call this")


@overload(terms_at, jit_options={"forceinline": True, "error_model": "numpy"})
def _terms_at(origin, memory, block, v, k):
    if isinstance(origin, types.NoneType):

        def separate(origin, memory, block, v, k):
            ox, oy, oz = origin_of(origin, memory, v)
            return terms_of(ox, oy, oz, triangle_of(block, k))

        return separate

    def common(origin, memory, block, v, k):
        a = memory + TERMS + 4 * k
        return Terms(
            load_f32(a), load_f32(a + 32), load_f32(a + 64), load_f32(a + 96), load_f32(a + 128),
            load_f32(a + 160), load_f32(a + 192), load_f32(a + 224), load_f32(a + 256), load_f32(a + 288),
        )  # fmt: skip

    return common


@inlined
def _crossing(origin, memory, block, v, k):
    """`crossing` of the rays of the v-th vector and the k-th triangle of a block, and the height of its terms."""
    a = memory + 64 * v
    m = terms_at(origin, memory, block, v, k)
    dx, dy, dz = load_f32x16(a + DX * ROW), load_f32x16(a + DY * ROW), load_f32x16(a + DZ * ROW)
    crosses, sign, u, w, area = crossing(dx, dy, dz, m)
    return crosses, sign, u, w, area, m.height


@inlined
def _distance(memory, v, crosses, height, sign, area):
    """(mask, t, 1 / area) of those crossings that lie where the rays are in the block's box."""
    a = memory + 64 * v
    scale = np.float32(1) / area
    t = as_f32(as_i32(height) ^ sign) * scale
    mask = crosses & (t >= load_f32x16(a + ENTER * ROW)) & (t <= load_f32x16(a + LEAVE * ROW))
    return mask & (t > load_f32x16(a + T_MIN * ROW)), t, scale


@subkernel
def _closest_in_block(origin, memory, s, block, active):
    """Nearest hits in a block of triangles; whether there was a nearer one."""
    active = _inside_block(origin, memory, block, active)
    found = False
    triangles = prepare(origin, s, memory, block)
    while triangles != 0:
        k = lowest_bit(triangles)
        triangles &= triangles - 1
        number = load_i32(block + NUMBERS + 4 * k)
        rest = active
        while rest != 0:
            v = lowest_bit(rest)
            rest &= rest - 1
            a = memory + 64 * v
            crosses, sign, u, w, area, height = _crossing(origin, memory, block, v, k)
            if not any_lane(crosses):
                continue
            mask, t, scale = _distance(memory, v, crosses, height, sign, area)
            best = load_f32x16(a + T * ROW)
            mask = mask & ((t < best) | ((t == best) & (i32x16(number) < load_i32x16(a + NUMBER * ROW))))
            if any_lane(mask):
                found = True
                store(a + T * ROW, select(mask, t, best))
                store_where(a + NUMBER * ROW, i32x16(number), mask)
                store_where(a + U * ROW, u * scale, mask)
                store_where(a + V * ROW, w * scale, mask)
    return found


@subkernel
def _any_in_block(origin, memory, s, block, active):
    """Rays that meet any of a block's triangles: their t becomes BLOCKED_T; whether there were any."""
    active = _inside_block(origin, memory, block, active)
    found = False
    triangles = prepare(origin, s, memory, block)
    while triangles != 0:
        k = lowest_bit(triangles)
        triangles &= triangles - 1
        rest = active
        while rest != 0:
            v = lowest_bit(rest)
            rest &= rest - 1
            a = memory + 64 * v
            crosses, sign, _u, _w, area, height = _crossing(origin, memory, block, v, k)
            if not any_lane(crosses):
                continue
            mask, t, _scale = _distance(memory, v, crosses, height, sign, area)
            before = load_f32x16(a + T * ROW)
            mask = mask & (t < before)
            if any_lane(mask):
                found = True
                store_where(a + T * ROW, f32x16(BLOCKED_T), mask)
    return found


@inlined
def _lane_origin(origin, memory, lane):
    """Origin of one ray."""
    ox, oy, oz = origin_of(origin, memory, lane >> 4)
    x, y, z = f32x16(ZERO) + ox, f32x16(ZERO) + oy, f32x16(ZERO) + oz
    return lane_of(x, lane & 15), lane_of(y, lane & 15), lane_of(z, lane & 15)


@subkernel
def _quadric_in_child(origin, memory, node, c, active, trees, i, nearest):
    """Rays on the quadric that is a node's c-th child, one by one; whether any hit (nearer than before)."""
    a = node + 4 * c
    found = False
    while active != 0:
        v = lowest_bit(active)
        active &= active - 1
        enter, leave = _lanes_inside(
            origin, memory, v, load_f32(a), load_f32(a + 32), load_f32(a + 64),
            load_f32(a + 96), load_f32(a + 128), load_f32(a + 160),
        )  # fmt: skip
        rest = bits_of(enter <= leave)
        while rest != 0:
            lane = lowest_bit(rest)
            rest &= rest - 1
            r = memory + 64 * v + 4 * lane
            ox, oy, oz = _lane_origin(origin, memory, 16 * v + lane)
            d = (load_f32(r + DX * ROW), load_f32(r + DY * ROW), load_f32(r + DZ * ROW))
            ray = Ray(ox, oy, oz, d[0], d[1], d[2], load_f32(r + T_MIN * ROW), FAR)
            t = hit_quadric(ray, trees.quadrics, i)
            best, number = load_f32(r + T * ROW), trees.triangles + i
            inside = t >= lane_of(enter, lane) and t <= lane_of(leave, lane)
            if not inside or t > best or (t == best and not (nearest and number < load_i32(r + NUMBER * ROW))):
                continue
            found = True
            if nearest:
                store(r + T * ROW, t)
                store(r + NUMBER * ROW, np.int32(number))
                store(r + U * ROW, ZERO)
                store(r + V * ROW, ZERO)
            else:
                store(r + T * ROW, BLOCKED_T)
    return found


@inlined
def _farthest(memory, vectors):
    """Greatest t of all rays."""
    far = load_f32x16(memory + T * ROW)
    for v in range(1, vectors):
        far = maximum(far, load_f32x16(memory + T * ROW + 64 * v))
    return largest(far)


@inlined
def _open_vectors(memory, vectors):
    """The vectors that still hold a ray to trace."""
    result = np.int64(0)
    for v in range(vectors):
        a = memory + 64 * v
        result |= np.int64(any_lane(load_f32x16(a + T * ROW) > load_f32x16(a + T_MIN * ROW))) << v
    return result


@subkernel
def closest_in_tree(origin, memory, vectors, s, trees, stack, counts):
    """Nearest hits of a packet in a tree."""
    far = _farthest(memory, vectors)
    everyone = _open_vectors(memory, vectors)
    store(stack, everyone << 32)
    pending = 1
    while pending > 0:
        pending -= 1
        entry = load_i64(stack + 8 * pending)
        above = entry >> 32
        active = above & 0xFF
        if as_f32(np.int32(above & 0xFFFFFF00)) > far:
            continue
        code = np.int64(np.int32(entry & 0xFFFFFFFF))
        if code < 0:
            counts[TESTS] += 1
            if _closest_in_block(origin, memory, s, trees.blocks + BLOCK * ~code, active):
                far = _farthest(memory, vectors)
            continue
        counts[STEPS] += 1
        node = trees.nodes + NODE * code
        enter, children = _open(node, s, far)
        store(memory + SCRATCH, enter)
        bottom = pending
        while children != 0:
            c = lowest_bit(children)
            children &= children - 1
            entering = _vectors_entering(origin, memory, s, node, c, active)
            if entering == 0:
                continue
            code = np.int64(load_i32(node + CHILDREN + 4 * c))
            if ~code >= QUADRIC:
                if _quadric_in_child(origin, memory, node, c, entering, trees, ~code - QUADRIC, True):
                    far = _farthest(memory, vectors)
                counts[TESTS] += 1
                continue
            bits = np.int64(load_i32(memory + SCRATCH + 4 * c)) & 0x7FFFFF00
            pending = _push_sorted(stack, pending, bottom, ((bits | entering) << 32) | (code & 0xFFFFFFFF))


@subkernel
def any_in_tree(origin, memory, vectors, s, trees, stack, counts):
    """Which rays of a packet meet anything in a tree: their t becomes BLOCKED_T."""
    far = _farthest(memory, vectors)
    everyone = _open_vectors(memory, vectors)
    if everyone == 0:
        return
    store(stack, everyone << 32)
    pending = 1
    while pending > 0:
        pending -= 1
        entry = load_i64(stack + 8 * pending)
        active = (entry >> 32) & everyone
        if active == 0:
            continue
        code = np.int64(np.int32(entry & 0xFFFFFFFF))
        if code < 0:
            counts[TESTS] += 1
            if _any_in_block(origin, memory, s, trees.blocks + BLOCK * ~code, active):
                everyone = _open_vectors(memory, vectors)
                if everyone == 0:
                    return
            continue
        counts[STEPS] += 1
        node = trees.nodes + NODE * code
        _enter, children = _open(node, s, far)
        while children != 0:
            c = lowest_bit(children)
            children &= children - 1
            entering = _vectors_entering(origin, memory, s, node, c, active)
            if entering == 0:
                continue
            code = np.int64(load_i32(node + CHILDREN + 4 * c))
            if ~code >= QUADRIC:
                if _quadric_in_child(origin, memory, node, c, entering, trees, ~code - QUADRIC, False):
                    everyone = _open_vectors(memory, vectors)
                counts[TESTS] += 1
                continue
            store(stack + 8 * pending, (entering << 32) | (code & 0xFFFFFFFF))
            pending += 1
