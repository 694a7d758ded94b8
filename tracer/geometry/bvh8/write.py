"""Writing the shape of a tree, all but the boxes and triangles, into nodes and blocks."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tracer.geometry.bvh8.layout import CHILDREN, COUNT, EMPTY, NO_PRIMITIVE, PRIMITIVES, QUADRIC
from tracer.geometry.bvh8.refit import BLOCK_BYTES, NODE_BYTES
from tracer.geometry.wide_tree.topology import VACANT, WIDTH
from tracer.kernels import inlined, kernel, subkernel
from tracer.simd import address_of, f32x8, i32x8, store


class Offsets(NamedTuple):
    """The first node, block, triangle, quadric and root of a tree among several in the same arrays."""

    node: int
    block: int
    triangle: int
    quadric: int
    root: int


@subkernel
def clear_nodes(nodes, first, last):
    """Nodes with eight empty slots; all arrays are given as addresses."""
    for node in range(nodes + NODE_BYTES * first, nodes + NODE_BYTES * last, NODE_BYTES):
        for k in range(6):
            store(node + 32 * k, f32x8(EMPTY))
        store(node + 4 * CHILDREN, i32x8(~0))
        store(node + 4 * CHILDREN + 32, i32x8(0))


@kernel
def clear(tree):
    """Make all nodes and blocks empty ones."""
    clear_nodes(address_of(tree.nodes), 0, len(tree.nodes))
    blocks = address_of(tree.blocks)
    for block in range(blocks, blocks + BLOCK_BYTES * len(tree.blocks), BLOCK_BYTES):
        for k in range(12):
            store(block + 32 * k, f32x8(0))
        store(block + 4 * PRIMITIVES, i32x8(NO_PRIMITIVE))


@inlined
def set_child(nodes, link, code):
    """Let the child at a link (see Links) be another."""
    store(nodes + NODE_BYTES * (link // WIDTH) + 4 * (CHILDREN + link % WIDTH), np.int32(code))


@kernel
def write_topology(tree, links, shape, triangles, offsets):
    """Write a shape into nodes and blocks that are empty, from `offsets` on, with links to and fro.

    The first `triangles` items of the shape are triangles, the others quadrics.
    """
    nodes, block = address_of(tree.nodes), offsets.block
    links.nodes[offsets.node] = ~offsets.root
    for i in range(len(shape.children)):
        for slot in range(WIDTH):
            child, link = shape.children[i, slot], WIDTH * (offsets.node + i) + slot
            if child == VACANT:
                continue
            if child >= 0:
                set_child(nodes, link, offsets.node + child)
                links.nodes[offsets.node + child] = link
                continue
            first, count = shape.leaves[~child, 0], shape.leaves[~child, 1]
            if shape.order[first] >= triangles:
                quadric = offsets.quadric + shape.order[first] - triangles
                set_child(nodes, link, ~(QUADRIC + quadric))
                links.quadrics[quadric] = link
                continue
            place = address_of(tree.blocks) + BLOCK_BYTES * block
            for lane in range(count):
                store(place + 4 * (PRIMITIVES + lane), np.int32(offsets.triangle + shape.order[first + lane]))
            store(place + 4 * COUNT, np.int32(count))
            set_child(nodes, link, ~block)
            links.blocks[block] = link
            block += 1
