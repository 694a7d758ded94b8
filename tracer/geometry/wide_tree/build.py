"""Building the topology of an 8-wide tree: a binary tree by the surface area heuristic, collapsed to 8 children a node.

The binary tree's first levels are split range by range.  Below that whole subtrees are grown, in as many threads as
there are; the tree is the same for any number of them.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tracer.geometry.building import CANCELLED, DONE, in_chunks
from tracer.geometry.wide_tree.binary import FIRST, LAST, LEAF_WEIGHT, Items, grow, make_items, put_boxes, put_triangles
from tracer.geometry.wide_tree.collapse import collapse, plan
from tracer.geometry.wide_tree.topology import MAX_DEPTH, TOP_LEVEL_DEPTH, VACANT, WIDTH, Topology
from tracer.runtime.parallel import for_each_chunk
from tracer.scene.arrays import Float32
from tracer.scene.model import Cancelled

SMALL = 1 << 14  # items; a subtree of no more is grown by one thread
ALL = 1 << 62


def _grow(items: Items, count: int, depth: int, control: NDArray[np.int64], threads: int) -> None:
    """Build a binary tree over all items, at most so deep; raises Cancelled when control[CANCELLED] is set."""

    def run(tasks: list[NDArray[np.int64]], splits: int) -> list[NDArray[np.int64]]:
        """Work on tasks in parallel, each for so many splits; the tasks that are left of them."""
        left: list[list[NDArray[np.int64]]] = [[] for _ in tasks]

        def one(chunk: int, worker: int) -> None:
            stack = np.zeros((depth + 2, 5), np.int64)
            stack[0] = tasks[chunk]
            pending = grow(items, stack, 1, splits, depth, LEAF_WEIGHT, control)
            left[chunk] = list(stack[:pending])
            if not pending:
                control[DONE] += tasks[chunk][LAST] - tasks[chunk][FIRST]

        for_each_chunk(one, len(tasks), threads, lambda: bool(control[CANCELLED]))
        return [task for tasks in left for task in tasks]

    small = max(SMALL, count // (8 * threads)) if threads > 1 else SMALL
    tasks, subtrees = [np.array([0, count, 0, 0, 0], np.int64)], []
    while tasks:
        subtrees += [t for t in tasks if t[LAST] - t[FIRST] <= small]
        tasks = run([t for t in tasks if t[LAST] - t[FIRST] > small], 1)
    run(sorted(subtrees, key=lambda t: t[FIRST] - t[LAST]), ALL)
    if control[CANCELLED]:
        raise Cancelled


def build_topology(
    rows: Float32,
    boxes: Float32,
    control: NDArray[np.int64],
    threads: int = 1,
    depth: int = MAX_DEPTH - TOP_LEVEL_DEPTH,
) -> Topology:
    """The topology of a tree over triangles (t, 9), corner and edges, and boxes (q, 6), numbered in this order.

    No way from the root to a leaf has more than `depth` nodes, which must be enough for a balanced binary tree.
    control (2,) int64: raises Cancelled once control[CANCELLED] is set, and counts the items that have found
    their leaf in control[DONE].
    """
    triangles, count = len(rows), len(rows) + len(boxes)
    if count == 0:
        return Topology(np.full((1, WIDTH), VACANT, np.int32), np.empty((0, 2), np.int32), np.empty(0, np.int32))
    threads = threads if count > SMALL else 1
    items = make_items(count)
    in_chunks(lambda first, last: put_triangles(items, rows, first, last), triangles, control, threads)
    put_boxes(items, boxes, triangles)
    _grow(items, count, depth, control, threads)
    return Topology(*collapsed(items, depth), items.order)


def collapsed(items: Items, depth: int) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Children and leaves, as in a `Topology`, of a binary tree that has been grown at most so deep."""
    count = len(items.order)
    children, leaves = np.empty((count, WIDTH), np.int32), np.empty((count, 2), np.int32)
    plan(items.nodes, depth)
    used_nodes, used_leaves = collapse(items.nodes, children, leaves, depth)
    return children[:used_nodes].copy(), leaves[:used_leaves].copy()
