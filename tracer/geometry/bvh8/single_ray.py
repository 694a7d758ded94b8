"""Whether rays meet anything, one by one, where their directions have nothing in common.

They do share the roots.  So the sixteen rays of a vector are tested together against a root's children, and then each
ray goes alone below the nearest child that it has not visited, until it is blocked or no child is left.  (For nearest
hits see `stream`.)
"""

from __future__ import annotations

import numpy as np

from tracer.geometry.bvh8.eight_wide import any_in_block, any_quadric, children_of, single_ray_at
from tracer.geometry.bvh8.layout import BLOCK, NODE
from tracer.geometry.bvh8.packet import BLOCKED_T, NUMBER, ROW, T, mark_static
from tracer.geometry.bvh8.packet_tree import CLOSED, STACK, code_of, open_rays, open_root, quadrics_in
from tracer.geometry.bvh8.placed import MOVING_TREE, opened, root_of, tree_of, trees_asked
from tracer.geometry.queries import STEPS, TESTS
from tracer.geometry.rays import MISS
from tracer.geometry.wide_tree.topology import WIDTH
from tracer.runtime.kernels import inlined, subkernel
from tracer.simd import (
    as_f32,
    bits_of,
    i32x16,
    load_f32,
    load_f32x16,
    load_i32,
    load_i32x16,
    load_i64,
    lowest_bit,
    minimum,
    select,
    store,
)

ROOM = 64 * (WIDTH + 1)  # bytes of the keys of a root's children, and of those last chosen, for sixteen rays
SINGLE_MEMORY = ROOM + STACK  # keys, then the stack


@inlined
def _next_children(memory, v, room):
    """Find the nearest child of a root that each of sixteen rays has still to visit, and write its key into the row
    after the keys of all children; the rays that have such a child, as bits."""
    last, best = load_i32x16(room + 64 * WIDTH), i32x16(CLOSED)
    for c in range(WIDTH):
        key = load_i32x16(room + 64 * c)
        best = minimum(best, select(key > last, key, CLOSED))
    store(room + 64 * WIDTH, best)
    return bits_of(as_f32(best & np.int32(~15)) <= load_f32x16(memory + T * ROW + 64 * v))


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
        node = trees.nodes + NODE * opened(trees.subtrees, code)
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


@subkernel
def any_one_by_one(memory, v, data, which, stack, counts):
    """Which rays of a packet's v-th vector meet what is asked for; their t says so."""
    room, rays, todo = stack - ROOM, open_rays(memory, v), trees_asked(data, which)
    while todo != 0:
        # Test all sixteen rays against the children of the root.
        number = lowest_bit(todo)
        todo &= todo - 1
        tree = tree_of(data, number)
        counts[STEPS] += rays
        open_root(memory, v, tree, 0, room, False, counts)
        # Send each ray below the nearest child that it has not visited yet, until none could matter.
        keys = room + 64 * WIDTH
        store(keys, i32x16(-1))
        rest = _next_children(memory, v, room)
        while rest != 0:
            while rest != 0:
                lane = lowest_bit(rest)
                rest &= rest - 1
                child = np.int64(load_i32(keys + 4 * lane)) & (WIDTH - 1)
                _any_below(memory + 64 * v + 4 * lane, code_of(root_of(tree), child), tree, stack, counts)
            rest = _next_children(memory, v, room)
        if number != MOVING_TREE:
            mark_static(memory, np.int64(1) << v)
