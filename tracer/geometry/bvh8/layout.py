"""How an 8-wide tree lies in memory: nodes of 256 aligned bytes, and leaves that are blocks of 8 triangles.

A node holds the boxes of its eight children as structure of arrays, so that a handful of vector operations test them
all, and one code per child: the number of an inner node, of a block or of a quadric.  The box of an empty slot is a
point so far away that every slab test misses it; its code is that of block 0, which is empty.
(Wald, Benthin, Boulos 2008; Dammertz, Hanika, Keller 2008.)

A large tree is a top tree with subtrees below it (`subtrees`).  There, the code of a subtree stands for its root, which
a table tells once it is built; the code never changes, so that nobody's order depends on when that was.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.geometry.wide_tree.topology import VACANT, WIDTH
from tracer.runtime.kernels import inlined, kernel, subkernel
from tracer.simd import address_of, f32x8, i32x8, store

NODE_SIZE, BLOCK_SIZE = 64, 96  # float32 numbers
NODE, BLOCK = 4 * NODE_SIZE, 4 * BLOCK_SIZE  # bytes
QUADRIC = 1 << 30  # in a leaf's code: k < QUADRIC is block k, else quadric k - QUADRIC
SUBTREE = 1 << 30  # in a node's code: k < SUBTREE is node k, else the root of subtree k - SUBTREE
EMPTY = np.float32(3e37)  # every coordinate of the box of an empty slot
NO_PRIMITIVE = 0x7FFFFFFF  # in the unused lanes of a block

# Offsets, in numbers, into a node and into a block.
CHILDREN = 48
PRIMITIVES, BOX, COUNT = 72, 80, 86


class Tree(NamedTuple):
    """One tree, whose root is node 0.

    nodes (n, NODE_SIZE) and blocks (m, BLOCK_SIZE) are float32, C-contiguous and aligned to 64 bytes.
    A node has the boxes of its children (6, 8), lower x of all eight first, and from CHILDREN their codes, int32:
    c >= 0 is node c (see SUBTREE), c < 0 is leaf ~c (see QUADRIC).  A block has the corners and edges of its triangles
    (9, 8), from PRIMITIVES their numbers, int32, from BOX the box (6,) that its parent holds too, and at COUNT how many
    there are, int32.
    """

    nodes: NDArray[np.float32]
    blocks: NDArray[np.float32]


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
    for node in range(nodes + NODE * first, nodes + NODE * last, NODE):
        for k in range(6):
            store(node + 32 * k, f32x8(EMPTY))
        store(node + 4 * CHILDREN, i32x8(~0))
        store(node + 4 * CHILDREN + 32, i32x8(0))


@kernel
def clear(tree):
    """Empty all nodes and blocks of a tree."""
    clear_nodes(address_of(tree.nodes), 0, len(tree.nodes))
    blocks = address_of(tree.blocks)
    for block in range(blocks, blocks + BLOCK * len(tree.blocks), BLOCK):
        for k in range(12):
            store(block + 32 * k, f32x8(0))
        store(block + 4 * PRIMITIVES, i32x8(NO_PRIMITIVE))


@inlined
def set_child(nodes, link, code):
    """Set the code of the child at a link (see Links); `nodes` is an address."""
    store(nodes + NODE * (link // WIDTH) + 4 * (CHILDREN + link % WIDTH), np.int32(code))


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
            place = address_of(tree.blocks) + BLOCK * block
            for lane in range(count):
                store(place + 4 * (PRIMITIVES + lane), np.int32(offsets.triangle + topology.order[first + lane]))
            store(place + 4 * COUNT, np.int32(count))
            set_child(nodes, link, ~block)
            links.blocks[block] = link
            block += 1
