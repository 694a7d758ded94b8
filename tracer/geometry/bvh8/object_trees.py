"""The trees of all dynamic objects, and two top-level BVHs over them: of the objects that rest, and of those that move.

The topology of an object's tree is built once, in the object's space.  For a frame its triangles are moved to the
world and its boxes found from the leaves up.  Then the top-level BVHs, whose leaves are the roots of objects' trees,
are built anew, in the first nodes.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.geometry.boxes import PADDING
from tracer.geometry.bvh8.build import count_blocks, empty_tree
from tracer.geometry.bvh8.layout import BLOCK, BOX, Offsets, Tree, clear_nodes, set_child, write_topology
from tracer.geometry.bvh8.refit import Links, gather_corners, make_links, move_blocks, pad_box, unite
from tracer.geometry.wide_tree.build import build_topology
from tracer.geometry.wide_tree.topology import TOP_LEVEL_DEPTH, VACANT, WIDTH, Topology
from tracer.runtime.kernels import kernel
from tracer.simd import address_of, load_i32

NODES, BLOCKS, TRIANGLES, QUADRICS = 0, 1, 2, 3  # columns of `starts`


class ObjectTrees(NamedTuple):
    """The trees of n objects side by side in one array, after room for the top-level BVHs.

    corners (m, 72) float32 are those of the triangles in each of m blocks, in their object's space, as
    structure of arrays; starts (n + 1, 4) int32 tell where each object's nodes, blocks, triangles and
    quadrics begin.  Row i of links.roots is the box of object i, and row 0 the box of everything: object 0
    never moves, and is not in here.
    """

    tree: Tree
    links: Links
    corners: NDArray[np.float32]
    starts: NDArray[np.int32]


def build_object_trees(
    topologies: Sequence[Topology], triangles: NDArray[np.int32], quadrics: NDArray[np.int32]
) -> ObjectTrees:
    """Lay out trees of objects 1 to n - 1, without triangles yet.

    The triangles and quadrics of object i begin at triangles[i] and quadrics[i], (n + 1,) each."""
    counts = np.diff(triangles)
    sizes = [(len(s.children), count_blocks(s, n)) for s, n in zip(topologies, counts[1:], strict=True)]
    starts = np.zeros((len(triangles), 4), np.int32)
    starts[:2, :2] = max(2, 1 + len(topologies)), 1  # two top-level BVHs share these nodes, and either may be empty
    starts[2:, :2] = starts[1, :2] + np.cumsum(sizes, axis=0).reshape(-1, 2)
    starts[:, TRIANGLES], starts[:, QUADRICS] = triangles, quadrics
    tree = empty_tree(starts[-1, NODES], starts[-1, BLOCKS] - 1)
    links = make_links(len(tree.nodes), len(tree.blocks), quadrics[-1], len(counts))
    for i, topology in enumerate(topologies, 1):
        node, block, triangle, quadric = starts[i].tolist()
        write_topology(tree, links, topology, counts[i], Offsets(node, block, triangle, quadric, i))
    return ObjectTrees(tree, links, np.empty((len(tree.blocks), 9 * WIDTH), np.float32), starts)


def blocks_of(trees: ObjectTrees, index: int) -> NDArray[np.float32]:
    """The blocks (m, BLOCK_SIZE) of an object."""
    return trees.tree.blocks[trees.starts[index, BLOCKS] : trees.starts[index + 1, BLOCKS]]


@kernel
def load_corners(trees, corners, first, last):
    """Copy the corners of objects first to last - 1 from corners (d, 9) of the triangles of objects 1 to n - 1."""
    start, end = trees.starts[first, BLOCKS], trees.starts[last, BLOCKS]
    gather_corners(trees.corners, trees.tree.blocks, corners, trees.starts[1, TRIANGLES], start, end)


@kernel
def move_objects(trees, matrices, present, boxes):
    """Move the objects that are present to the world, by matrices (n, 12) float32, and find all boxes.

    present (n,) bool; boxes (q, 6) float32 are around quadrics, in the world already.
    """
    nodes, blocks, roots = address_of(trees.tree.nodes), address_of(trees.tree.blocks), address_of(trees.links.roots)
    node_links, block_links = address_of(trees.links.nodes), address_of(trees.links.blocks)
    starts, corners, extent = trees.starts, address_of(trees.corners), np.float32(0)
    for i in range(1, len(present)):
        if present[i]:
            matrix = address_of(matrices) + 48 * i
            moved = move_blocks(blocks, corners, matrix, starts[i, BLOCKS], starts[i + 1, BLOCKS])
            extent = max(extent, moved)
            for q in range(starts[i, QUADRICS], starts[i + 1, QUADRICS]):
                for k in range(6):
                    extent = max(extent, abs(boxes[q, k]))
    padding = np.float32(PADDING) * extent
    for i in range(1, len(present)):
        if present[i]:
            for b in range(starts[i, BLOCKS], starts[i + 1, BLOCKS]):
                box = blocks + BLOCK * b + 4 * BOX
                pad_box(nodes, roots, load_i32(block_links + 4 * b), box, padding)
            for q in range(starts[i, QUADRICS], starts[i + 1, QUADRICS]):
                pad_box(nodes, roots, trees.links.quadrics[q], address_of(boxes) + 24 * q, padding)
            unite(nodes, roots, node_links, starts[i, NODES], starts[i + 1, NODES])


@kernel
def _write_top_level(trees, topology, objects, first):
    """Write a top-level BVH over objects (p,) into nodes from `first` on; the rest of its room is emptied."""
    nodes, roots, links = address_of(trees.tree.nodes), address_of(trees.links.roots), trees.links.nodes
    clear_nodes(nodes, first, trees.starts[1, NODES])
    links[first] = ~0
    for i in range(len(topology.children)):
        for slot in range(WIDTH):
            child, link = topology.children[i, slot], WIDTH * (first + i) + slot
            if child >= 0:
                set_child(nodes, link, first + child)
                links[first + child] = link
            elif child != VACANT:
                item = objects[topology.order[topology.leaves[~child, 0]]]
                set_child(nodes, link, trees.starts[item, NODES])
                pad_box(nodes, roots, link, roots + 24 * item, np.float32(0))
    unite(nodes, roots, address_of(links), first, first + len(topology.children))


def build_top_level(trees: ObjectTrees, objects: NDArray[np.bool_], first: int) -> int:
    """Build the top-level BVH over those of n objects, (n,) bool, that have been moved: its root becomes node `first`;
    the number of the first node after it."""
    numbers = np.flatnonzero(objects)
    boxes = trees.links.roots[numbers]
    topology = build_topology(np.empty((0, 9), np.float32), boxes, np.zeros(2, np.int64), depth=TOP_LEVEL_DEPTH)
    _write_top_level(trees, topology, numbers, first)
    return first + len(topology.children)
