"""Writing a topology into the nodes and blocks of a tree; boxes and triangles come later (`refit`)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tracer.geometry.bvh8.layout import CHILDREN, COUNT, EMPTY, NO_PRIMITIVE, PRIMITIVES, QUADRIC
from tracer.geometry.bvh8.refit import BLOCK_BYTES, NODE_BYTES
from tracer.geometry.wide_tree.topology import VACANT, WIDTH
from tracer.runtime.kernels import inlined, kernel, subkernel
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
    """Give nodes first to last - 1 eight empty slots each; `nodes` is an address."""
    for node in range(nodes + NODE_BYTES * first, nodes + NODE_BYTES * last, NODE_BYTES):
        for k in range(6):
            store(node + 32 * k, f32x8(EMPTY))
        store(node + 4 * CHILDREN, i32x8(~0))
        store(node + 4 * CHILDREN + 32, i32x8(0))


@kernel
def clear(tree):
    """Empty all nodes and blocks of a tree."""
    clear_nodes(address_of(tree.nodes), 0, len(tree.nodes))
    blocks = address_of(tree.blocks)
    for block in range(blocks, blocks + BLOCK_BYTES * len(tree.blocks), BLOCK_BYTES):
        for k in range(12):
            store(block + 32 * k, f32x8(0))
        store(block + 4 * PRIMITIVES, i32x8(NO_PRIMITIVE))


@inlined
def set_child(nodes, link, code):
    """Set the code of the child at a link (see Links); `nodes` is an address."""
    store(nodes + NODE_BYTES * (link // WIDTH) + 4 * (CHILDREN + link % WIDTH), np.int32(code))


@kernel
def write_topology(tree, links, topology, triangles, offsets):
    """Write a topology into empty nodes and blocks of a tree, from `offsets` on, and the links to parents.

    The first `triangles` items of the topology are triangles, the others quadrics.
    """
    nodes, block = address_of(tree.nodes), offsets.block
    links.nodes[offsets.node] = ~offsets.root
    for i in range(len(topology.children)):
        for slot in range(WIDTH):
            child, link = topology.children[i, slot], WIDTH * (offsets.node + i) + slot
            if child == VACANT:
                continue
            if child >= 0:
                set_child(nodes, link, offsets.node + child)
                links.nodes[offsets.node + child] = link
                continue
            first, count = topology.leaves[~child, 0], topology.leaves[~child, 1]
            if topology.order[first] >= triangles:
                quadric = offsets.quadric + topology.order[first] - triangles
                set_child(nodes, link, ~(QUADRIC + quadric))
                links.quadrics[quadric] = link
                continue
            place = address_of(tree.blocks) + BLOCK_BYTES * block
            for lane in range(count):
                store(place + 4 * (PRIMITIVES + lane), np.int32(offsets.triangle + topology.order[first + lane]))
            store(place + 4 * COUNT, np.int32(count))
            set_child(nodes, link, ~block)
            links.blocks[block] = link
            block += 1
