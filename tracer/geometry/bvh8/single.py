"""One ray through a BVH8: its eight children, and a block's eight triangles, are the lanes.

For rays that have nothing in common.  The answers are those of `packet_tree`, bit for bit.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from tracer.geometry.bvh8.intersect import ZERO, crossing, terms_of, triangles_of
from tracer.geometry.bvh8.packet import (
    BLOCKED_T,
    DX,
    DY,
    DZ,
    FAR,
    IX,
    IY,
    IZ,
    LANES,
    NUMBER,
    OX,
    OY,
    OZ,
    ROW,
    T_MIN,
    T,
    U,
    V,
    lanes_inside,
    mark_static,
)
from tracer.geometry.bvh8.packet_leaf import quadric_in_child
from tracer.geometry.bvh8.packet_tree import STACK, code_of, prefetch_child, push_sorted, quadrics_in
from tracer.geometry.bvh8.tree import QUADRIC, WIDTH
from tracer.geometry.bvh8.trees import BLOCK, BOX, HAS_DYNAMIC, NODE, NUMBERS, tree_of
from tracer.geometry.intersect import hit_quadric
from tracer.geometry.queries import STEPS, TESTS
from tracer.geometry.rays import Ray
from tracer.kernels import inlined, subkernel
from tracer.simd import (
    any_lane,
    as_f32,
    as_i32,
    bits_of,
    i32x16,
    lane_of,
    load_f32,
    load_f32x8,
    load_f32x16,
    load_i32,
    load_i32x8,
    load_i32x16,
    load_i64,
    lowest_bit,
    mask8,
    maximum,
    minimum,
    select,
    smallest,
    store,
)

NOBODY = np.int32(0x7FFFFFFF)
NOTHING = np.int64(-0x80000000)  # code of no child
CLOSED = np.int32(0x7FFFFFFF)  # key of a child that a ray does not enter: no distance at all
ROOM = 64 * (2 * WIDTH + 1)  # bytes of the keys of both roots' children, and of those last chosen, for sixteen rays
SINGLE_MEMORY = ROOM + 64 + STACK  # keys, scratch, then the stack


class Line(NamedTuple):
    """A ray with its inverse direction and the offsets of near planes in a node."""

    ox: Any
    oy: Any
    oz: Any
    dx: Any
    dy: Any
    dz: Any
    ix: Any
    iy: Any
    iz: Any
    near_x: Any
    near_y: Any
    near_z: Any
    t_min: Any


class Best(NamedTuple):
    """The nearest hit so far."""

    t: Any
    number: Any
    u: Any
    v: Any


@inlined
def _near(inverse):
    """Offset, from a box's low plane, of the plane that is met first."""
    return np.int64(as_i32(inverse) >> 31) & 96


@inlined
def _line_at(a):
    """The ray whose column in a packet's memory begins at an address."""
    ix, iy, iz = load_f32(a + IX * ROW), load_f32(a + IY * ROW), load_f32(a + IZ * ROW)
    return Line(
        load_f32(a + OX * ROW), load_f32(a + OY * ROW), load_f32(a + OZ * ROW),
        load_f32(a + DX * ROW), load_f32(a + DY * ROW), load_f32(a + DZ * ROW), ix, iy, iz,
        _near(ix), _near(iy), _near(iz), load_f32(a + T_MIN * ROW),
    )  # fmt: skip


@inlined
def _children(node, r, far):
    """Where a ray enters and leaves eight children."""
    ax, bx = (load_f32x8(node + r.near_x) - r.ox) * r.ix, (load_f32x8(node + 96 - r.near_x) - r.ox) * r.ix
    ay, by = (load_f32x8(node + 32 + r.near_y) - r.oy) * r.iy, (load_f32x8(node + 128 - r.near_y) - r.oy) * r.iy
    az, bz = (load_f32x8(node + 64 + r.near_z) - r.oz) * r.iz, (load_f32x8(node + 160 - r.near_z) - r.oz) * r.iz
    return maximum(maximum(ax, ay), maximum(az, r.t_min)), minimum(minimum(bx, by), minimum(bz, far))


@inlined
def _inside_block(block, r, t):
    """Which of eight distances lie where a ray is in a block's box."""
    x0, y0, z0 = load_f32(block + BOX), load_f32(block + BOX + 4), load_f32(block + BOX + 8)
    x1, y1, z1 = load_f32(block + BOX + 12), load_f32(block + BOX + 16), load_f32(block + BOX + 20)
    ax, bx = (x0 - r.ox) * r.ix, (x1 - r.ox) * r.ix
    ay, by = (y0 - r.oy) * r.iy, (y1 - r.oy) * r.iy
    az, bz = (z0 - r.oz) * r.iz, (z1 - r.oz) * r.iz
    enter = maximum(maximum(minimum(ax, bx), minimum(ay, by)), minimum(az, bz))
    leave = minimum(minimum(maximum(ax, bx), maximum(ay, by)), maximum(az, bz))
    return (t >= enter) & (t <= leave)


@inlined
def _first_lane(block, t, bits):
    """The nearest of several lanes, given as bits; of equals that of the lowest number."""
    if bits & (bits - 1) == 0:
        return lowest_bit(bits)
    mask = mask8(bits)
    mask = mask & (t == smallest(select(mask, t, FAR)))
    numbers = load_i32x8(block + NUMBERS)
    return lowest_bit(bits_of(mask & (numbers == smallest(select(mask, numbers, NOBODY)))))


@inlined
def _nearest_in_block(block, r, best):
    m = terms_of(r.ox, r.oy, r.oz, triangles_of(block))
    crosses, sign, u, v, area = crossing(r.dx, r.dy, r.dz, m)
    if not any_lane(crosses):
        return best
    scale = np.float32(1) / area
    t = as_f32(as_i32(m.height) ^ sign) * scale
    bits = bits_of(crosses & (t > r.t_min) & (t <= best.t) & _inside_block(block, r, t))
    if bits == 0:
        return best
    lane = _first_lane(block, t, bits)
    nearest, number = lane_of(t, lane), load_i32(block + NUMBERS + 4 * lane)
    if nearest == best.t and number >= best.number:
        return best
    return Best(nearest, number, lane_of(u * scale, lane), lane_of(v * scale, lane))


@inlined
def _any_in_block(block, r, far):
    m = terms_of(r.ox, r.oy, r.oz, triangles_of(block))
    crosses, sign, _u, _v, area = crossing(r.dx, r.dy, r.dz, m)
    if not any_lane(crosses):
        return False
    t = as_f32(as_i32(m.height) ^ sign) * (np.float32(1) / area)
    return any_lane(crosses & (t > r.t_min) & (t < far) & _inside_block(block, r, t))


@inlined
def _quadric(r, trees, i, enter, leave):
    """t of a ray on a quadric inside its box, or FAR."""
    t = hit_quadric(Ray(r.ox, r.oy, r.oz, r.dx, r.dy, r.dz, r.t_min, FAR), trees.quadrics, i)
    return t if t >= enter and t <= leave else FAR


@subkernel
def _nearest_quadric(r, best, trees, node, quadrics, enter, leave):
    """The nearest of best and those children of a node that are quadrics, given as bits."""
    while quadrics != 0:
        c = lowest_bit(quadrics)
        quadrics &= quadrics - 1
        i = ~code_of(node, c) - QUADRIC
        t = _quadric(r, trees, i, lane_of(enter, c), lane_of(leave, c))
        if t < best.t or (t == best.t and trees.triangles + i < best.number):
            best = Best(t, np.int32(trees.triangles + i), ZERO, ZERO)
    return best


@subkernel
def _any_quadric(r, far, trees, node, quadrics, enter, leave):
    """Whether a ray meets those children of a node that are quadrics nearer than far."""
    while quadrics != 0:
        c = lowest_bit(quadrics)
        quadrics &= quadrics - 1
        if _quadric(r, trees, ~code_of(node, c) - QUADRIC, lane_of(enter, c), lane_of(leave, c)) < far:
            return True
    return False


@inlined
def _entry(distance, code):
    """A pending child: the bits of its distance, and its code."""
    return (np.int64(distance) << 32) | (code & 0xFFFFFFFF)


@inlined
def _open_root(memory, v, trees, first, room, nearest):
    """Sixteen rays into the children of a root, at which all begin: into rows of keys, one for each child.

    A key is the bits of the distance, the lowest four replaced by first and the child's number (which only makes
    the distance less), or CLOSED.  Quadrics among the children are asked at once."""
    quadrics = quadrics_in(trees.nodes)
    for c in range(WIDTH):
        box, key = trees.nodes + 4 * c, i32x16(CLOSED)
        if (quadrics >> c) & 1:
            quadric_in_child(None, memory, box, np.int64(1) << v, trees, ~code_of(trees.nodes, c) - QUADRIC, nearest)
        else:
            enter, leave = lanes_inside(
                None, memory, v, load_f32(box), load_f32(box + 32), load_f32(box + 64),
                load_f32(box + 96), load_f32(box + 128), load_f32(box + 160),
            )  # fmt: skip
            distance = as_i32(maximum(enter, ZERO)) & np.int32(~15)
            key = select(enter <= leave, distance | np.int32(first + c), CLOSED)
        store(room + 64 * (first + c), key)


@inlined
def _next_children(memory, v, room, children):
    """Of sixteen rays, one after `room`'s rows of keys, the next nearest child of the roots that each has still to
    visit: into the row after them; the rays that have one, as bits."""
    last, best = load_i32x16(room + 64 * children), i32x16(CLOSED)
    for c in range(children):
        key = load_i32x16(room + 64 * c)
        best = minimum(best, select(key > last, key, CLOSED))
    store(room + 64 * children, best)
    return bits_of(as_f32(best & np.int32(~15)) <= load_f32x16(memory + T * ROW + 64 * v))


@subkernel
def _closest_below(a, code, trees, stack, counts):
    """Into the column of a packet's memory that begins at an address: what its ray meets first below a child."""
    r = _line_at(a)
    best = Best(load_f32(a + T * ROW), load_i32(a + NUMBER * ROW), load_f32(a + U * ROW), load_f32(a + V * ROW))
    pending, scratch = np.int64(0), stack - 64
    while code != NOTHING:
        while code >= 0:
            counts[STEPS] += 1
            node = trees.nodes + NODE * code
            enter, leave = _children(node, r, best.t)
            children = bits_of(enter <= leave)
            quadrics = children & quadrics_in(node)
            if quadrics != 0:
                counts[TESTS] += 1
                best = _nearest_quadric(r, best, trees, node, quadrics, enter, leave)
                children ^= quadrics
            if children == 0:
                code = NOTHING
                break
            c = lowest_bit(children)
            children &= children - 1
            code = code_of(node, c)
            if children == 0:
                continue
            store(scratch, maximum(enter, ZERO))
            nearest = _entry(load_i32(scratch + 4 * c), code)
            bottom = pending
            while children != 0:
                c = lowest_bit(children)
                children &= children - 1
                prefetch_child(trees, code_of(node, c))
                entry = _entry(load_i32(scratch + 4 * c), code_of(node, c))
                pending = push_sorted(stack, pending, bottom, max(entry, nearest))
                nearest = min(entry, nearest)
            code = np.int64(np.int32(nearest & 0xFFFFFFFF))
        if code != NOTHING:
            counts[TESTS] += 1
            best = _nearest_in_block(trees.blocks + BLOCK * ~code, r, best)
        code = NOTHING
        while pending > 0 and code == NOTHING:
            pending -= 1
            entry = load_i64(stack + 8 * pending)
            if as_f32(np.int32(entry >> 32)) <= best.t:
                code = np.int64(np.int32(entry & 0xFFFFFFFF))
    store(a + T * ROW, best.t)
    store(a + NUMBER * ROW, best.number)
    store(a + U * ROW, best.u)
    store(a + V * ROW, best.v)


@subkernel
def _any_below(a, code, trees, stack, counts):
    """Whether the ray whose column in a packet's memory begins at an address meets anything below a child."""
    r, far = _line_at(a), load_f32(a + T * ROW)
    store(stack, code)
    pending = np.int64(1)
    while pending > 0:
        pending -= 1
        code = load_i64(stack + 8 * pending)
        if code < 0:
            counts[TESTS] += 1
            if _any_in_block(trees.blocks + BLOCK * ~code, r, far):
                return True
            continue
        counts[STEPS] += 1
        node = trees.nodes + NODE * code
        enter, leave = _children(node, r, far)
        children = bits_of(enter <= leave)
        quadrics = children & quadrics_in(node)
        if quadrics != 0:
            counts[TESTS] += 1
            if _any_quadric(r, far, trees, node, quadrics, enter, leave):
                return True
            children ^= quadrics
        while children != 0:
            store(stack + 8 * pending, code_of(node, lowest_bit(children)))
            children &= children - 1
            pending += 1
    return False


@subkernel
def closest_one_by_one(memory, v, data, stack, counts):
    """Nearest hits of the rays of a packet's v-th vector."""
    room, trees = stack - 64 - ROOM, 1 + load_i64(data + HAS_DYNAMIC)
    for dynamic in range(trees):
        counts[STEPS] += LANES
        _open_root(memory, v, tree_of(data, dynamic), WIDTH * dynamic, room, True)
    keys = room + 64 * WIDTH * trees
    store(keys, i32x16(-1))
    rest = _next_children(memory, v, room, WIDTH * trees)
    while rest != 0:
        while rest != 0:
            lane = lowest_bit(rest)
            rest &= rest - 1
            key = np.int64(load_i32(keys + 4 * lane))
            tree = tree_of(data, (key >> 3) & 1)
            _closest_below(memory + 64 * v + 4 * lane, code_of(tree.nodes, key & 7), tree, stack, counts)
        rest = _next_children(memory, v, room, WIDTH * trees)


@subkernel
def any_one_by_one(memory, v, data, which, stack, counts):
    """Which rays of a packet's v-th vector meet what is asked for: t tells it."""
    room = stack - 64 - ROOM
    for dynamic in range(2):
        if (which >> dynamic) & 1 == 0:
            continue
        tree = tree_of(data, dynamic)
        counts[STEPS] += LANES
        _open_root(memory, v, tree, 0, room, False)
        keys = room + 64 * WIDTH
        store(keys, i32x16(-1))
        rest = _next_children(memory, v, room, WIDTH)
        while rest != 0:
            while rest != 0:
                lane = lowest_bit(rest)
                rest &= rest - 1
                a = memory + 64 * v + 4 * lane
                if _any_below(a, code_of(tree.nodes, np.int64(load_i32(keys + 4 * lane)) & 7), tree, stack, counts):
                    store(a + T * ROW, BLOCKED_T)
            rest = _next_children(memory, v, room, WIDTH)
        if dynamic == 0:
            mark_static(memory, np.int64(1) << v)
