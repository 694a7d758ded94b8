"""A packet of rays through an 8-wide tree: a node is read once for all its rays.

At a node the frustum around the packet is tested against all eight children at once, and then each child that it may
enter against the frusta of the packet's eight vectors at once.  Rays themselves are tested only where the answer
depends on it: in leaves.  A pending child is one int64.  Its upper half has the bits of the distance where the packet
may enter the child, the lowest eight replaced by the set of vectors that may (which only makes the distance less); its
lower half has the child's code.
"""

from __future__ import annotations

import numpy as np

from tracer.geometry.bvh8.layout import BLOCK, CHILDREN, NODE, QUADRIC
from tracer.geometry.bvh8.packet import ROW, SCRATCH, T_MIN, T, lanes_inside
from tracer.geometry.bvh8.packet_group import box_at, boxes_at, entering, frusta_of, looking, put_reaches, reaches_of
from tracer.geometry.bvh8.packet_leaf import any_in_block, closest_in_block, quadric_in_child
from tracer.geometry.bvh8.placed import child_planes, code_of, opened, root_of
from tracer.geometry.queries import STEPS, TESTS
from tracer.geometry.triangle_test import ZERO
from tracer.geometry.wide_tree.topology import MAX_DEPTH, WIDTH
from tracer.runtime.kernels import inlined, subkernel
from tracer.simd import (
    any_lane,
    as_f32,
    as_i32,
    bits_of,
    i32x16,
    largest,
    load_f32x16,
    load_i32,
    load_i32x8,
    load_i64,
    lowest_bit,
    maximum,
    ones,
    prefetch,
    select,
    store,
)

STACK = 8 * (1 + (WIDTH - 1) * MAX_DEPTH)  # bytes


@inlined
def quadrics_in(node):
    """Which children of a node are quadrics, as bits."""
    return bits_of(load_i32x8(node + 4 * CHILDREN) <= np.int32(~QUADRIC))


@inlined
def prefetch_child(trees, code):
    """Fetch a child's memory into the cache before it is needed; for a subtree, nothing is at that address."""
    if code < 0:
        a = trees.blocks + BLOCK * ~code
        prefetch(a + 320)
        for line in range(0, 320, 64):
            prefetch(a + line)
    else:
        a = trees.nodes + NODE * code
        for line in range(0, NODE, 64):
            prefetch(a + line)


@inlined
def push_sorted(stack, pending, bottom, entry):
    """Insert an entry among those from `bottom` on, which are sorted, the nearest last; how many are pending then."""
    at = pending
    while at > bottom and load_i64(stack + 8 * (at - 1)) < entry:
        store(stack + 8 * at, load_i64(stack + 8 * (at - 1)))
        at -= 1
    store(stack + 8 * at, entry)
    return pending + 1


@inlined
def _open(memory, node, group):
    """(distances, bits) of the children of a node that some ray of the group may enter."""
    enter, mask = entering(boxes_at(node, group.axes), group.frustum, largest(reaches_of(memory)))
    return enter, bits_of(mask)


@inlined
def _vectors_entering(origin, memory, group, box, active):
    """The active vectors of which some ray may enter the box at an address."""
    _enter, mask = entering(box_at(box, group.axes), frusta_of(memory), reaches_of(memory))
    active &= bits_of(mask)
    wide = active & group.wide
    while wide != 0:
        v = lowest_bit(wide)
        wide &= wide - 1
        enter, leave = lanes_inside(origin, memory, v, child_planes(box))
        if not any_lane(enter <= leave):
            active ^= np.int64(1) << v
    return active


@subkernel
def _ask_quadrics(origin, memory, group, trees, node, quadrics, active, nearest, counts):
    """Test the group against children of a node, given as bits, that are quadrics: for the nearest hits or for any."""
    while quadrics != 0:
        c = lowest_bit(quadrics)
        quadrics &= quadrics - 1
        on = _vectors_entering(origin, memory, group, node + 4 * c, active)
        counts[TESTS] += 1
        found = quadric_in_child(origin, memory, node + 4 * c, on, trees, ~code_of(node, c) - QUADRIC, nearest)
        put_reaches(memory, found, group.axes)


@inlined
def _walk(origin, memory, group, trees, stack, occluder, nearest, counts):
    """Send a packet through a tree, for the nearest hits, nearer children first, or for any; the block hit last.

    `nearest` is a constant, so that either walk is compiled without the other."""
    store(stack, (group.vectors << 32) | trees.root)
    pending = 1
    while pending > 0:
        # Take the nearest pending child, and the vectors that may enter it and still look that far.
        pending -= 1
        entry = load_i64(stack + 8 * pending)
        above = entry >> 32
        active = above & looking(memory, as_f32(np.int32(above & 0xFFFFFF00)) if nearest else np.float32(0))
        if active == 0:
            continue
        # Test the triangles of a leaf.
        code = np.int64(np.int32(entry & 0xFFFFFFFF))
        if code < 0:
            counts[TESTS] += 1
            block = trees.blocks + BLOCK * ~code
            if nearest:
                found = closest_in_block(origin, memory, group, block, active)
            else:
                found = any_in_block(origin, memory, group, block, active)
            if found != 0:
                occluder = ~code
                put_reaches(memory, found, group.axes)
            continue
        # Open a node: test its quadrics right away.
        counts[STEPS] += 1
        node = trees.nodes + NODE * opened(trees.subtrees, code)
        enter, children = _open(memory, node, group)
        quadrics = children & quadrics_in(node)
        children ^= quadrics
        if quadrics != 0:
            _ask_quadrics(origin, memory, group, trees, node, quadrics, active, nearest, counts)
        # Put the other children that some vector may enter on the stack.
        if nearest:
            store(memory + SCRATCH, enter)
        bottom = pending
        while children != 0:
            c = lowest_bit(children)
            children &= children - 1
            on = _vectors_entering(origin, memory, group, node + 4 * c, active)
            if on == 0:
                continue
            prefetch_child(trees, code_of(node, c))
            below = code_of(node, c) & 0xFFFFFFFF
            if nearest:
                above = (np.int64(load_i32(memory + SCRATCH + 4 * c)) & 0x7FFFFF00) | on
                pending = push_sorted(stack, pending, bottom, (above << 32) | below)
            else:
                store(stack + 8 * pending, (on << 32) | below)
                pending += 1
    return occluder


@subkernel
def closest_in_tree(origin, memory, group, trees, stack, counts):
    """Nearest hits of a packet in a tree."""
    _walk(origin, memory, group, trees, stack, np.int64(0), True, counts)


@subkernel
def any_in_tree(origin, memory, group, trees, stack, occluder, counts):
    """Find the rays of a packet that hit anything in a tree: their t becomes BLOCKED_T.

    The block `occluder`, which the rays before these hit, is tested first (Haines and Greenberg 1986); the
    block that the next rays had better test first is returned."""
    counts[TESTS] += 1
    found = any_in_block(origin, memory, group, trees.blocks + BLOCK * occluder, group.vectors)
    if found != 0:
        put_reaches(memory, found, group.axes)
        if looking(memory, np.float32(0)) == 0:
            return occluder
    return _walk(origin, memory, group, trees, stack, occluder, False, counts)


CLOSED = np.int32(0x7FFFFFFF)  # key of a child that a ray does not enter: no distance at all


@inlined
def open_rays(memory, v):
    """How many rays of a vector there are to trace."""
    a = memory + 64 * v
    return ones(bits_of(load_f32x16(a + T * ROW) > load_f32x16(a + T_MIN * ROW)))


@inlined
def open_root(memory, v, trees, first, room, counts):
    """Test sixteen rays against the children of a root, for the nearest hits, and write a row of keys for each child.

    A key is the bits of the distance at which the ray enters the child, the lowest four replaced by the child's
    number, counted from `first` (which only makes the distance less); or CLOSED.  Quadrics among the children are
    tested right away."""
    root = root_of(trees)
    quadrics = quadrics_in(root)
    for c in range(WIDTH):
        box, key = root + 4 * c, i32x16(CLOSED)
        if (quadrics >> c) & 1:
            counts[TESTS] += 1
            quadric_in_child(None, memory, box, np.int64(1) << v, trees, ~code_of(root, c) - QUADRIC, True)
        else:
            enter, leave = lanes_inside(None, memory, v, child_planes(box))
            distance = as_i32(maximum(enter, ZERO)) & np.int32(~15)
            key = select(enter <= leave, distance | np.int32(first + c), CLOSED)
        store(room + 64 * (first + c), key)
