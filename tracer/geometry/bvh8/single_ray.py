"""Whether rays meet anything, one by one, where their directions have nothing in common.

They do share the roots.  So the sixteen rays of a vector are tested together against a root's children, and then each
ray goes alone below those that it enters, until it is blocked or nothing is left.  It takes children as they come, but
leaves first.  Not the nearest first: rays from surfaces would search through what lies around them, and visit three
times as many nodes.  (For nearest hits see `stream`.)
"""

from __future__ import annotations

import numpy as np

from tracer.geometry.bvh8.eight_wide import any_of_eight, any_quadric, children_of, single_ray_at
from tracer.geometry.bvh8.layout import BLOCK, CHILDREN, NODE, QUADRIC
from tracer.geometry.bvh8.packet import BLOCKED_T, NUMBER, ROW, T, lanes_inside, mark_static
from tracer.geometry.bvh8.packet_leaf import quadric_in_child
from tracer.geometry.bvh8.packet_tree import STACK, open_rays, quadrics_in
from tracer.geometry.bvh8.placed import MOVING_TREE, child_planes, code_of, opened, root_of, tree_of, trees_asked
from tracer.geometry.queries import STEPS, TESTS
from tracer.geometry.rays import MISS
from tracer.geometry.wide_tree.topology import WIDTH
from tracer.runtime.kernels import inlined, subkernel
from tracer.simd import bits_of, i32x16, load_f32, load_i32, load_i32x8, load_i64, lowest_bit, select, store

ROOM = 64  # bytes of which children of a root sixteen rays enter
SINGLE_MEMORY = ROOM + STACK


@inlined
def _open_root(memory, v, trees, entered, counts):
    """Test sixteen rays against the children of a root, write a row of which each ray enters, as bits, and return the
    rays that enter any, as bits; quadrics among the children are tested right away."""
    root, children = root_of(trees), i32x16(0)
    quadrics = quadrics_in(root)
    for c in range(WIDTH):
        box = root + 4 * c
        if (quadrics >> c) & 1:
            counts[TESTS] += 1
            quadric_in_child(None, memory, box, np.int64(1) << v, trees, ~code_of(root, c) - QUADRIC, False)
        else:
            enter, leave = lanes_inside(None, memory, v, child_planes(box))
            children = select(enter <= leave, children | np.int32(1 << c), children)
    store(entered, children)
    return bits_of(children > 0)


@inlined
def _leaves_in(node):
    """Which children of a node are leaves, as bits."""
    return bits_of(load_i32x8(node + 4 * CHILDREN) < np.int32(0))


@inlined
def _any_in_leaf(node, c, r, far, trees):
    """The number of what a ray hits nearer than far in the leaf that is a node's c-th child, or MISS."""
    code = code_of(node, c)
    if code <= ~QUADRIC:
        return any_quadric(r, far, trees, node, c)
    return any_of_eight(trees.blocks + BLOCK * ~code, r, far)


@subkernel
def _any_below(a, children, trees, stack, counts):
    """What one ray meets below those children of a root that it enters, given as bits, or MISS; `a` is the address of
    the ray's column in the packet's memory."""
    r, far = single_ray_at(a), load_f32(a + T * ROW)
    node, pending, steps, tests, number = root_of(trees), np.int64(0), np.int64(0), np.int64(0), np.int32(MISS)
    while True:
        # Test the leaves among the children that the ray enters.
        leaves = children & _leaves_in(node)
        children ^= leaves
        while leaves != 0 and number == MISS:
            tests += 1
            number = _any_in_leaf(node, lowest_bit(leaves), r, far, trees)
            leaves &= leaves - 1
        if number != MISS:
            break
        # Go on to one of the others, or else to one left behind.
        if children != 0:
            code = code_of(node, lowest_bit(children))
            children &= children - 1
            while children != 0:
                store(stack + 8 * pending, code)
                pending += 1
                code = code_of(node, lowest_bit(children))
                children &= children - 1
        elif pending != 0:
            pending -= 1
            code = load_i64(stack + 8 * pending)
        else:
            break
        steps += 1
        node = trees.nodes + NODE * opened(trees.subtrees, code)
        enter, leave = children_of(node, r, far)
        children = bits_of(enter <= leave)
    counts[STEPS] += steps
    counts[TESTS] += tests
    return number


@subkernel
def any_one_by_one(memory, v, data, which, stack, counts):
    """Which rays of a packet's v-th vector meet what is asked for; their t says so."""
    entered, todo = stack - ROOM, trees_asked(data, which)
    while todo != 0:
        which_tree = lowest_bit(todo)
        todo &= todo - 1
        tree = tree_of(data, which_tree)
        counts[STEPS] += open_rays(memory, v)
        rest = _open_root(memory, v, tree, entered, counts)
        while rest != 0:
            lane = lowest_bit(rest)
            rest &= rest - 1
            a = memory + 64 * v + 4 * lane
            number = _any_below(a, np.int64(load_i32(entered + 4 * lane)), tree, stack, counts)
            if number != MISS:
                store(a + T * ROW, BLOCKED_T)
                store(a + NUMBER * ROW, number)
        if which_tree != MOVING_TREE:
            mark_static(memory, np.int64(1) << v)
