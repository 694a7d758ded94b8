"""Nearest hits of rays whose directions have nothing in common: up to 128 of them are under way at once.

A processor that follows one ray through a tree waits at every turn: for memory, and for branches that nobody can
predict.  So all rays of a packet take one step after another, each from where it stands.  A ray that has a node to open
next waits in one queue, a ray with a leaf to test in another, and a ray that has to go back to what it left behind in a
third.  Each queue is worked off in a loop of few branches, whose rays have nothing to do with each other, so that the
steps of several overlap.  (Queues by kind of work: Laine, Karras, Aila 2013.)

Every ray visits what it would visit alone, in the same order, and the answers are those of `packet_tree`, bit for bit.
A ray that waits is one int64: its number in the packet, the bit SECOND if it is in the second of two trees, and in the
upper half the code of the node or leaf.
"""

from __future__ import annotations

import numpy as np

from tracer.geometry.bvh8.eight_wide import Best, children_at, nearest_in_block, nearest_quadric, single_ray_at
from tracer.geometry.bvh8.layout import BLOCK, CHILDREN, NODE, SUBTREE
from tracer.geometry.bvh8.packet import LANES, NUMBER, PACKET, ROW, T, U, V
from tracer.geometry.bvh8.packet_tree import CLOSED, STACK, open_rays, open_root, quadrics_in
from tracer.geometry.bvh8.placed import STATIC_TREE, code_of, read_world, root_of, root_of_subtree, tree_of
from tracer.geometry.queries import STEPS, TESTS
from tracer.geometry.triangle_test import ZERO
from tracer.geometry.wide_tree.topology import WIDTH
from tracer.runtime.kernels import inlined, subkernel
from tracer.simd import (
    as_f32,
    bits_of,
    i32x16,
    load_f32,
    load_f32x16,
    load_i32,
    load_i32x8,
    load_i32x16,
    load_i64,
    lowest_bit,
    maximum,
    sort_columns,
    store,
)

MOST = 2 * WIDTH  # children of two roots
RAY, SECOND = PACKET - 1, 1 << 8  # bits of what waits in a queue
KEY_CHILD, KEY_SECOND = MOST - 1, WIDTH  # bits of a root's child's key: its number, and whether of the second root

# Offsets, in bytes, into the memory of a stream: of each vector the keys of the roots' children (`_open_roots`); the
# three queues; how many entries each ray has on its stack, and how many children of the roots it has taken; the codes
# of the roots' children; addresses of the nodes and blocks of both trees; scratch; and the stacks, the lowest entries
# of all rays first, for hardly any ray has more than a few.
KEYS_OF_VECTOR = 64 * (MOST + 1)
QUEUE = 8 * (PACKET + 1)
KEYS = 64
NODES = KEYS + PACKET // LANES * KEYS_OF_VECTOR
LEAVES = NODES + QUEUE
BACK = LEAVES + QUEUE
PENDING = BACK + QUEUE
TAKEN = PENDING + 4 * PACKET
CODES = TAKEN + 4 * PACKET
PLACES = CODES + 64
SCRATCH = PLACES + 40
STACKS = SCRATCH + 128
LEVEL = 8 * PACKET  # from an entry to the next of the same ray
STREAM_MEMORY = STACKS + PACKET * STACK


@inlined
def _describe(stream, trees, second):
    """Note where one of the two trees lies, and the codes of its root's children."""
    store(stream + CODES + 32 * second, load_i32x8(root_of(trees) + 4 * CHILDREN))
    store(stream + PLACES + 16 * second, trees.nodes)
    store(stream + PLACES + 16 * second + 8, trees.blocks)


@inlined
def _place(stream, ray):
    """Address of where the addresses of the nodes and blocks of a ray's tree are."""
    return stream + PLACES + (ray & SECOND) // SECOND * 16


@inlined
def _open_roots(memory, vectors, data, first, last, stream, counts):
    """Test the rays of some vectors, given as bits, with the children of two roots, or of one that is given twice; how
    many rays enter any.  They are queued to go back: to the nearest of these children.

    The keys of a vector become rows, each ray's least key in the first, and a row of CLOSED ones at the end."""
    back = np.int64(0)
    one, other = tree_of(data, first), tree_of(data, last)
    _describe(stream, one, 0)
    _describe(stream, other, 1)
    while vectors != 0:
        v = lowest_bit(vectors)
        vectors &= vectors - 1
        keys, rays = stream + KEYS + KEYS_OF_VECTOR * v, open_rays(memory, v)
        counts[STEPS] += rays
        open_root(memory, v, one, 0, keys, counts)
        if first == last:
            sort_columns(keys, WIDTH)
            store(keys + 64 * WIDTH, i32x16(CLOSED))
        else:
            counts[STEPS] += rays
            open_root(memory, v, other, WIDTH, keys, counts)
            sort_columns(keys, MOST)
            store(keys + 64 * MOST, i32x16(CLOSED))
        store(stream + PENDING + 64 * v, i32x16(0))
        store(stream + TAKEN + 64 * v, i32x16(0))
        nearest = as_f32(load_i32x16(keys) & np.int32(~KEY_CHILD))
        entering = bits_of(nearest <= load_f32x16(memory + T * ROW + 64 * v))
        for lane in range(LANES):
            store(stream + BACK + 8 * back, np.int64(LANES * v + lane))
            back += (entering >> lane) & 1
    return back


@inlined
def _go_back(memory, stream, back, nodes, leaves):
    """Take what each of the rays that are to go back has last put on its stack or, where that is empty, the next child
    of the roots.  How many must go back again, having found it beyond their nearest hits, and how many nodes and leaves
    wait then; the other rays are done."""
    again = np.int64(0)
    for i in range(back):
        waiting = load_i64(stream + BACK + 8 * i)
        ray = waiting & RAY
        pending = np.int64(load_i32(stream + PENDING + 4 * ray))
        taken = np.int64(load_i32(stream + TAKEN + 4 * ray))
        stacked = pending > 0
        if stacked:
            entry = load_i64(stream + STACKS + LEVEL * (pending - 1) + 8 * ray)
            distance, code, second = entry >> 32, entry, waiting & SECOND
        else:
            column = stream + KEYS + KEYS_OF_VECTOR * (ray // LANES) + 4 * (ray % LANES)
            key = np.int64(load_i32(column + 64 * taken))
            distance, second = key & ~KEY_CHILD, (key & KEY_SECOND) // KEY_SECOND * SECOND
            code = np.int64(load_i32(stream + CODES + 4 * (key & KEY_CHILD)))
        near = np.int64(as_f32(np.int32(distance)) <= load_f32(memory + T * ROW + 4 * ray))
        store(stream + PENDING + 4 * ray, np.int32(pending - np.int64(stacked)))
        store(stream + TAKEN + 4 * ray, np.int32(taken + np.int64(not stacked)))
        waiting = code << 32 | second | ray
        leaf = np.int64(waiting < 0)
        store(stream + NODES + 8 * nodes, waiting)
        nodes += near & (leaf ^ 1)
        store(stream + LEAVES + 8 * leaves, waiting)
        leaves += near & leaf
        store(stream + BACK + 8 * again, waiting)
        again += np.int64(stacked) & (near ^ 1)
    return again, nodes, leaves


@subkernel
def _ask_quadrics(a, data, node, quadrics, enter, leave):
    """Test a ray, the address of whose column is a, with those children of a node, given as bits, that are quadrics."""
    best = Best(load_f32(a + T * ROW), load_i32(a + NUMBER * ROW), load_f32(a + U * ROW), load_f32(a + V * ROW))
    best = nearest_quadric(single_ray_at(a), best, tree_of(data, 0), node, quadrics, enter, leave)
    store(a + T * ROW, best.t)
    store(a + NUMBER * ROW, best.number)
    store(a + U * ROW, best.u)
    store(a + V * ROW, best.v)


@inlined
def _entry(distances, node, c):
    """A child for the stack: the bits of its distance, and its code."""
    return np.int64(load_i32(distances + 4 * c)) << 32 | (code_of(node, c) & 0xFFFFFFFF)


@inlined
def _nearest_of(stream, ray, node, children, enter):
    """The code of the nearest of several children of a node, given as bits, that a ray enters; the others are put on
    its stack in order of distance, equal ones in that of their codes."""
    distances, stack = stream + SCRATCH, stream + STACKS + 8 * ray
    store(distances, maximum(enter, ZERO))
    bottom = pending = np.int64(load_i32(stream + PENDING + 4 * ray))
    nearest = _entry(distances, node, lowest_bit(children))
    children &= children - 1
    while children != 0:
        entry = _entry(distances, node, lowest_bit(children))
        children &= children - 1
        other, nearest, at = max(entry, nearest), min(entry, nearest), pending
        while at > bottom and load_i64(stack + LEVEL * (at - 1)) < other:
            store(stack + LEVEL * at, load_i64(stack + LEVEL * (at - 1)))
            at -= 1
        store(stack + LEVEL * at, other)
        pending += 1
    store(stream + PENDING + 4 * ray, np.int32(pending))
    return nearest & 0xFFFFFFFF


@inlined
def _open_nodes(memory, data, stream, back, nodes, leaves, counts):
    """Open the nodes that wait: each ray goes on to the nearest child it enters, or back if it enters none.  How many
    are to go back then, and how many nodes and leaves wait."""
    opened, nodes, subtrees = nodes, np.int64(0), tree_of(data, STATIC_TREE).subtrees
    for i in range(opened):
        waiting = load_i64(stream + NODES + 8 * i)
        ray = waiting & RAY
        number = waiting >> 32
        if number >= SUBTREE:
            number = root_of_subtree(subtrees, number - SUBTREE)
        a, node = memory + 4 * ray, load_i64(_place(stream, waiting)) + NODE * number
        enter, leave = children_at(node, a)
        children = bits_of(enter <= leave)
        quadrics = children & quadrics_in(node)
        if quadrics != 0:
            counts[TESTS] += 1
            _ask_quadrics(a, data, node, quadrics, enter, leave)
            children ^= quadrics
        if children & (children - 1) != 0:
            code = _nearest_of(stream, ray, node, children, enter)
        else:
            code = code_of(node, lowest_bit(children) & (WIDTH - 1))
        some = np.int64(children != 0)
        waiting = code << 32 | (waiting & (SECOND | RAY))
        leaf = np.int64(waiting < 0)
        store(stream + NODES + 8 * nodes, waiting)  # overwrites none that still waits
        nodes += some & (leaf ^ 1)
        store(stream + LEAVES + 8 * leaves, waiting)
        leaves += some & leaf
        store(stream + BACK + 8 * back, waiting)
        back += some ^ 1
    return back, nodes, leaves


@inlined
def _test_leaves(memory, stream, back, leaves):
    """Test the triangles of the leaves that wait; how many rays are to go back then."""
    for i in range(leaves):
        waiting = load_i64(stream + LEAVES + 8 * i)
        block = load_i64(_place(stream, waiting) + 8) + BLOCK * ~(waiting >> 32)
        nearest_in_block(block, memory + 4 * (waiting & RAY))
        store(stream + BACK + 8 * back, waiting)
        back += 1
    return back


@subkernel
def closest_in_stream(memory, vectors, data, stream, counts):
    """Nearest hits of the rays of some of a packet's vectors, given as bits."""
    todo = read_world(data).trees
    while todo != 0:
        # Take two trees at a time: a key has room for the children of no more.
        first = lowest_bit(todo)
        todo &= todo - 1
        last = first
        if todo != 0:
            last = lowest_bit(todo)
            todo &= todo - 1
        back, nodes, leaves = _open_roots(memory, vectors, data, first, last, stream, counts), np.int64(0), np.int64(0)
        while back + nodes != 0:
            back, nodes, leaves = _go_back(memory, stream, back, nodes, leaves)
            counts[STEPS] += nodes
            back, nodes, leaves = _open_nodes(memory, data, stream, back, nodes, leaves, counts)
            counts[TESTS] += leaves
            back = _test_leaves(memory, stream, back, leaves)
            leaves = np.int64(0)
