"""Rays through 8-wide trees one by one, where their directions have nothing in common.

They do share the root.  So the sixteen rays of a vector are tested together against the root's children, and then each
ray goes alone below the nearest child that it has not visited, until no child is left that could change its answer.
The answers are those of `packet_tree`, bit for bit.
"""

from __future__ import annotations

import numpy as np

from tracer.geometry.bvh8.eight_wide import (
    Best,
    any_in_block,
    any_quadric,
    children_of,
    nearest_in_block,
    nearest_quadric,
    single_ray_at,
)
from tracer.geometry.bvh8.layout import QUADRIC
from tracer.geometry.bvh8.packet import (
    BLOCKED_T,
    NUMBER,
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
from tracer.geometry.bvh8.placed import BLOCK, MOVING_TREE, NODE, TREES, child_planes, root_of, tree_of, trees_asked
from tracer.geometry.queries import STEPS, TESTS
from tracer.geometry.rays import MISS
from tracer.geometry.triangle_test import ZERO
from tracer.geometry.wide_tree.topology import WIDTH
from tracer.kernels import inlined, subkernel
from tracer.simd import (
    as_f32,
    as_i32,
    bits_of,
    i32x16,
    load_f32,
    load_f32x16,
    load_i32,
    load_i32x16,
    load_i64,
    lowest_bit,
    maximum,
    minimum,
    ones,
    select,
    store,
)

NOTHING = np.int64(-0x80000000)  # code of no child
CLOSED = np.int32(0x7FFFFFFF)  # key of a child that a ray does not enter: no distance at all
ROOM = 64 * (2 * WIDTH + 1)  # bytes of the keys of two roots' children, and of those last chosen, for sixteen rays
SINGLE_MEMORY = ROOM + 64 + STACK  # keys, scratch, then the stack


@inlined
def _entry(distance, code):
    """A pending child: the bits of its distance, and its code."""
    return (np.int64(distance) << 32) | (code & 0xFFFFFFFF)


@inlined
def _open_root(memory, v, trees, first, room, nearest, counts):
    """Test sixteen rays against the children of a root and write a row of keys for each child.

    A key is the bits of the distance at which the ray enters the child, the lowest four replaced by the child's
    number, counted from `first` (which only makes the distance less); or CLOSED.  Quadrics among the children are
    tested right away."""
    root = root_of(trees)
    quadrics = quadrics_in(root)
    for c in range(WIDTH):
        box, key = root + 4 * c, i32x16(CLOSED)
        if (quadrics >> c) & 1:
            counts[TESTS] += 1
            quadric_in_child(None, memory, box, np.int64(1) << v, trees, ~code_of(root, c) - QUADRIC, nearest)
        else:
            enter, leave = lanes_inside(None, memory, v, child_planes(box))
            distance = as_i32(maximum(enter, ZERO)) & np.int32(~15)
            key = select(enter <= leave, distance | np.int32(first + c), CLOSED)
        store(room + 64 * (first + c), key)


@inlined
def _next_children(memory, v, room, children):
    """Find the nearest child that each of sixteen rays has still to visit, and write its key into the row after the
    keys of all children; the rays that have such a child, as bits."""
    last, best = load_i32x16(room + 64 * children), i32x16(CLOSED)
    for c in range(children):
        key = load_i32x16(room + 64 * c)
        best = minimum(best, select(key > last, key, CLOSED))
    store(room + 64 * children, best)
    return bits_of(as_f32(best & np.int32(~15)) <= load_f32x16(memory + T * ROW + 64 * v))


@subkernel
def _closest_below(a, code, trees, stack, counts):
    """The nearest hit of one ray below a child; `a` is the address of the ray's column in the packet's memory.

    `_any_below` is no variant of this: to find the nearest hit, children are visited in order of distance, and the
    nearest of them is never put on the stack."""
    r = single_ray_at(a)
    best = Best(load_f32(a + T * ROW), load_i32(a + NUMBER * ROW), load_f32(a + U * ROW), load_f32(a + V * ROW))
    pending, scratch = np.int64(0), stack - 64
    while code != NOTHING:
        while code >= 0:
            # Test the ray against the node's children, and against quadrics among them right away.
            counts[STEPS] += 1
            node = trees.nodes + NODE * code
            enter, leave = children_of(node, r, best.t)
            children = bits_of(enter <= leave)
            quadrics = children & quadrics_in(node)
            if quadrics != 0:
                counts[TESTS] += 1
                best = nearest_quadric(r, best, trees, node, quadrics, enter, leave)
                children ^= quadrics
            if children == 0:
                code = NOTHING
                break
            c = lowest_bit(children)
            children &= children - 1
            code = code_of(node, c)
            if children == 0:
                continue
            # Go on to the nearest child, and put the others on the stack in order of distance.
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
        # Test the triangles of a leaf, and take the nearest pending child that is not beyond the nearest hit.
        if code != NOTHING:
            counts[TESTS] += 1
            best = nearest_in_block(trees.blocks + BLOCK * ~code, r, best)
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


@inlined
def _block(a, number):
    store(a + T * ROW, BLOCKED_T)
    store(a + NUMBER * ROW, number)


@subkernel
def _any_below(a, code, trees, stack, counts):
    """Whether one ray meets anything below a child, and what; `a` is the address of the ray's column in the packet's
    memory."""
    r, far = single_ray_at(a), load_f32(a + T * ROW)
    store(stack, code)
    pending = np.int64(1)
    while pending > 0:
        pending -= 1
        code = load_i64(stack + 8 * pending)
        if code < 0:
            counts[TESTS] += 1
            number = any_in_block(trees.blocks + BLOCK * ~code, r, far)
            if number != MISS:
                _block(a, number)
                return
            continue
        counts[STEPS] += 1
        node = trees.nodes + NODE * code
        enter, leave = children_of(node, r, far)
        children = bits_of(enter <= leave)
        quadrics = children & quadrics_in(node)
        if quadrics != 0:
            counts[TESTS] += 1
            number = any_quadric(r, far, trees, node, quadrics, enter, leave)
            if number != MISS:
                _block(a, number)
                return
            children ^= quadrics
        while children != 0:
            store(stack + 8 * pending, code_of(node, lowest_bit(children)))
            children &= children - 1
            pending += 1


@inlined
def _open_rays(memory, v):
    """How many rays of a vector there are to trace."""
    a = memory + 64 * v
    return ones(bits_of(load_f32x16(a + T * ROW) > load_f32x16(a + T_MIN * ROW)))


@inlined
def _one_by_one(memory, v, data, todo, stack, counts, nearest):
    """The rays of a packet's v-th vector through the trees `todo`, bits, for the nearest hits or else for any.

    `nearest` is a constant, so that each of the two is compiled without the other."""
    room, rays = stack - 64 - ROOM, _open_rays(memory, v)
    while todo != 0:
        # Take two trees at a time for the nearest hits: a key has room for the children of no more.
        first = lowest_bit(todo)
        todo &= todo - 1
        last = first
        if nearest and todo != 0:
            last = lowest_bit(todo)
            todo &= todo - 1
        # Test all sixteen rays against the children of the roots.
        children = 0
        for which in range(first, last + 1, max(1, last - first)):
            counts[STEPS] += rays
            _open_root(memory, v, tree_of(data, which), children, room, nearest, counts)
            children += WIDTH
        # Send each ray below the nearest child that it has not visited yet, until none could matter.
        keys = room + 64 * children
        store(keys, i32x16(-1))
        rest = _next_children(memory, v, room, children)
        while rest != 0:
            while rest != 0:
                lane = lowest_bit(rest)
                rest &= rest - 1
                a, key = memory + 64 * v + 4 * lane, np.int64(load_i32(keys + 4 * lane))
                tree = tree_of(data, first if key & WIDTH == 0 else last)
                code = code_of(root_of(tree), key & 7)
                if nearest:
                    _closest_below(a, code, tree, stack, counts)
                else:
                    _any_below(a, code, tree, stack, counts)
            rest = _next_children(memory, v, room, children)
        if not nearest and first != MOVING_TREE:
            mark_static(memory, np.int64(1) << v)


@subkernel
def closest_one_by_one(memory, v, data, stack, counts):
    """Nearest hits of the rays of a packet's v-th vector."""
    _one_by_one(memory, v, data, load_i64(data + TREES), stack, counts, True)


@subkernel
def any_one_by_one(memory, v, data, which, stack, counts):
    """Which rays of a packet's v-th vector meet what is asked for; their t says so."""
    _one_by_one(memory, v, data, trees_asked(data, which), stack, counts, False)
