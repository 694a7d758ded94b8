"""Building the tree of what never moves: triangles go into its leaves, and boxes are united from there up."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tracer.geometry.boxes import PADDING
from tracer.geometry.building import CHUNK, in_chunks
from tracer.geometry.bvh8.layout import BLOCK_SIZE, NODE_SIZE, Offsets, Tree, clear, write_topology
from tracer.geometry.bvh8.refit import fill_blocks, make_links, pad_blocks, pad_quadrics, unite_nodes
from tracer.geometry.memory import aligned_rows
from tracer.geometry.wide_tree.build import build_topology
from tracer.geometry.wide_tree.topology import Topology
from tracer.scene.arrays import Float32


def count_blocks(topology: Topology, triangles: int) -> int:
    """How many leaves of a topology are blocks, where the first so many items are triangles."""
    return int(np.count_nonzero(topology.order[topology.leaves[:, 0]] < triangles))


def build_tree(rows: Float32, boxes: Float32, control: NDArray[np.int64] | None = None, threads: int = 1) -> Tree:
    """A tree over triangles (t, 9) float32, corner and two edges, and boxes (q, 6) float32 of quadrics.

    Numbers count both from 0.  `control` (2,) int64: the build ends with Cancelled once
    control[CANCELLED] is set, and counts items that have found their leaf in control[DONE].
    """
    control = np.zeros(2, np.int64) if control is None else control
    topology = build_topology(rows, boxes, control, threads)
    tree = empty_tree(len(topology.children), count_blocks(topology, len(rows)))
    links = make_links(len(tree.nodes), len(tree.blocks), len(boxes), 1)
    write_topology(tree, links, topology, len(rows), Offsets(0, 1, 0, 0, 0))
    count = len(tree.blocks) - 1  # without the empty one
    extents = np.zeros(1 + -(-count // CHUNK), np.float32)
    extents[-1] = np.abs(boxes).max(initial=0)

    def fill(first: int, last: int) -> None:
        extents[first // CHUNK] = fill_blocks(tree.blocks, rows, 1 + first, 1 + last)

    in_chunks(fill, count, control, threads)
    padding = np.float32(PADDING * extents.max())
    in_chunks(lambda first, last: pad_blocks(tree, links, padding, 1 + first, 1 + last), count, control, threads)
    pad_quadrics(tree, links, boxes.copy(), padding, 0, len(boxes))
    unite_nodes(tree, links, 0, len(tree.nodes))
    return tree


def empty_tree(nodes: int, blocks: int) -> Tree:
    """A tree over nothing, with room for so many nodes (one at least) and for so many blocks besides the empty one."""
    tree = Tree(aligned_rows(nodes, NODE_SIZE), aligned_rows(1 + blocks, BLOCK_SIZE))
    clear(tree)
    return tree
