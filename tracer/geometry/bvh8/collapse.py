"""From a binary tree to one of eight children a node, by opening the largest child first (Dammertz et al. 2008)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.geometry.bvh8.binary import ITEM, NUMBER, WEIGHT, half_area
from tracer.geometry.bvh8.refit import set_child, set_triangles
from tracer.geometry.bvh8.tree import QUADRIC, WIDTH
from tracer.kernels import kernel, subkernel
from tracer.simd import address_of, load_i32

VACANT = -0x80000000  # no child


class Offsets(NamedTuple):
    """The first node, block, triangle, quadric and root of a tree among several in the same arrays."""

    node: int
    block: int
    triangle: int
    quadric: int
    root: int


class Shape(NamedTuple):
    """A tree without boxes.  Parents come before their children, and leaves in the order of nodes.

    children (n, 8) int32: c >= 0 is node c, c < 0 leaf ~c, VACANT none; leaves (m, 2) int32: first
    place in the binary tree's order, and count.
    """

    children: NDArray[np.int32]
    leaves: NDArray[np.int32]


@subkernel
def _open(nodes, root, opened):
    """Fill `opened` (8,) with descendants of a node that make it up; how many."""
    opened[0] = root
    count, largest = 1, 0
    while largest >= 0 and count < WIDTH:
        child = opened[largest]
        opened[largest], opened[count] = child + 1, load_i32(nodes + ITEM * child + NUMBER)
        count += 1
        largest, area = -1, -1.0
        for i in range(count):
            child = nodes + ITEM * opened[i]
            if load_i32(child + WEIGHT) == 0 and half_area(child) > area:
                largest, area = i, half_area(child)
    return count


@kernel
def collapse(binary, children, leaves, stack):
    """Fill children and leaves, both with room for as many as there are items; (nodes, leaves) that were filled.

    `binary` is a tree's nodes (2 n, 8), of which there must be some; stack has room for 8 entries a level.
    """
    nodes = address_of(binary)
    opened = np.empty(WIDTH, np.int64)
    node_count, leaf_count, pending = 0, 0, 1
    stack[0, 0], stack[0, 1] = 0, -1
    while pending > 0:
        pending -= 1
        root, slot = stack[pending, 0], stack[pending, 1]
        node, node_count = node_count, node_count + 1
        if slot >= 0:
            children[slot // WIDTH, slot % WIDTH] = node
        count = 1
        opened[0] = root
        if load_i32(nodes + ITEM * root + WEIGHT) == 0:
            count = _open(nodes, root, opened)
        for i in range(WIDTH):
            children[node, i] = VACANT
        for i in range(count):
            child = nodes + ITEM * opened[i]
            size = load_i32(child + WEIGHT)
            if size > 0:
                leaves[leaf_count, 0], leaves[leaf_count, 1] = load_i32(child + NUMBER), size
                children[node, i] = ~leaf_count
                leaf_count += 1
        for i in range(count - 1, -1, -1):
            if children[node, i] == VACANT:
                stack[pending, 0], stack[pending, 1] = opened[i], WIDTH * node + i
                pending += 1
    return node_count, leaf_count


@kernel
def write_shape(tree, links, shape, order, triangles, offsets):
    """Write a shape into nodes and blocks that are empty, from `offsets` on, with links to and fro.

    `order` tells which items leaves hold; the first `triangles` items are triangles.
    """
    links.nodes[offsets.node] = ~offsets.root
    block = offsets.block
    for i in range(len(shape.children)):
        node = offsets.node + i
        for slot in range(WIDTH):
            link, child = WIDTH * node + slot, shape.children[i, slot]
            if child >= 0:
                set_child(tree.nodes, node, slot, offsets.node + child)
                links.nodes[offsets.node + child] = link
            elif child != VACANT:
                first, count = shape.leaves[~child, 0], shape.leaves[~child, 1]
                if order[first] < triangles:
                    set_child(tree.nodes, node, slot, ~block)
                    set_triangles(tree.blocks, block, order, first, count, offsets.triangle)
                    links.blocks[block] = link
                    block += 1
                else:
                    quadric = offsets.quadric + order[first] - triangles
                    set_child(tree.nodes, node, slot, ~(QUADRIC + quadric))
                    links.quadrics[quadric] = link
    return block
