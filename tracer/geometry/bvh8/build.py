"""Building a tree: a binary one by the surface area heuristic, collapsed to 8 children a node, then filled.

The binary tree's first levels are split range by range, and below that whole subtrees are grown,
in as many threads as there are; the tree is the same for any number of them.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from tracer.geometry.building import CANCELLED, DONE
from tracer.geometry.bvh8.binary import FIRST, LAST, Items, grow, make_items, put_boxes, put_triangles
from tracer.geometry.bvh8.collapse import VACANT, Shape, collapse, plan
from tracer.geometry.bvh8.refit import fill_blocks, make_links, pad_blocks, pad_quadrics, unite_nodes
from tracer.geometry.bvh8.shape import Offsets, clear, write_shape
from tracer.geometry.bvh8.tree import BLOCK_SIZE, MAX_DEPTH, NODE_SIZE, PADDING, WIDTH, Tree
from tracer.geometry.memory import aligned_rows
from tracer.parallel import for_each_chunk
from tracer.scene.model import Cancelled, Float32

CROWN_DEPTH = 24  # of a tree over trees, which have the rest of MAX_DEPTH; enough for 16 million of them
SMALL = 1 << 14  # items; a subtree of no more is grown by one thread
CHUNK = 1 << 12  # blocks or triangles that a thread takes at a time
ALL = 1 << 62


def _in_chunks(work: Callable[[int, int], None], count: int, control: NDArray[np.int64], threads: int) -> None:
    """work(first, last) over all numbers below count."""

    def one(chunk: int, worker: int) -> None:
        work(chunk * CHUNK, min(count, (chunk + 1) * CHUNK))

    for_each_chunk(one, -(-count // CHUNK), threads, lambda: bool(control[CANCELLED]))


def _grow(items: Items, count: int, depth: int, control: NDArray[np.int64], threads: int) -> None:
    """A binary tree over all items, at most so deep; raises Cancelled when control[CANCELLED] is set."""

    def run(tasks: list[NDArray[np.int64]], splits: int) -> list[NDArray[np.int64]]:
        """Work off tasks in parallel; those that are left in each."""
        left: list[list[NDArray[np.int64]]] = [[] for _ in tasks]

        def one(chunk: int, worker: int) -> None:
            stack = np.zeros((depth + 2, 5), np.int64)
            stack[0] = tasks[chunk]
            pending = grow(items, stack, 1, splits, depth, control)
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


def build_shape(
    rows: Float32, boxes: Float32, control: NDArray[np.int64], threads: int = 1, depth: int = MAX_DEPTH - CROWN_DEPTH
) -> Shape:
    """The shape of a tree over triangles (t, 9), corner and edges, and boxes (q, 6), numbered in this order.

    No way down has more than `depth` nodes, which must do for a balanced binary tree.  Raises Cancelled
    when control[CANCELLED] is set; counts items that have found their leaf in control[DONE].
    """
    triangles, count = len(rows), len(rows) + len(boxes)
    if count == 0:
        return Shape(np.full((1, WIDTH), VACANT, np.int32), np.empty((0, 2), np.int32), np.empty(0, np.int32))
    threads = threads if count > SMALL else 1
    items = make_items(count)
    _in_chunks(lambda first, last: put_triangles(items, rows, first, last), triangles, control, threads)
    put_boxes(items, boxes, triangles)
    _grow(items, count, depth, control, threads)
    children, leaves = np.empty((count, WIDTH), np.int32), np.empty((count, 2), np.int32)
    plan(items.nodes, depth)
    used_nodes, used_leaves = collapse(items.nodes, children, leaves, depth)
    return Shape(children[:used_nodes].copy(), leaves[:used_leaves].copy(), items.order)


def count_blocks(shape: Shape, triangles: int) -> int:
    """How many of a shape's leaves are blocks, the first so many items being triangles."""
    return int(np.count_nonzero(shape.order[shape.leaves[:, 0]] < triangles))


def build_tree(rows: Float32, boxes: Float32, control: NDArray[np.int64] | None = None, threads: int = 1) -> Tree:
    """A tree over triangles (t, 9) float32, corner and two edges, and boxes (q, 6) float32 of quadrics.

    Numbers count both from 0.  `control` (2,) int64: the build ends with Cancelled once
    control[CANCELLED] is set, and counts items that have found their leaf in control[DONE].
    """
    control = np.zeros(2, np.int64) if control is None else control
    shape = build_shape(rows, boxes, control, threads)
    tree = empty_tree(len(shape.children), count_blocks(shape, len(rows)))
    links = make_links(len(tree.nodes), len(tree.blocks), len(boxes), 1)
    write_shape(tree, links, shape, len(rows), Offsets(0, 1, 0, 0, 0))
    count = len(tree.blocks) - 1  # without the empty one
    extents = np.zeros(1 + -(-count // CHUNK), np.float32)
    extents[-1] = np.abs(boxes).max(initial=0)

    def fill(first: int, last: int) -> None:
        extents[first // CHUNK] = fill_blocks(tree.blocks, rows, 1 + first, 1 + last)

    _in_chunks(fill, count, control, threads)
    padding = np.float32(PADDING * extents.max())
    _in_chunks(lambda first, last: pad_blocks(tree, links, padding, 1 + first, 1 + last), count, control, threads)
    pad_quadrics(tree, links, boxes.copy(), padding, 0, len(boxes))
    unite_nodes(tree, links, 0, len(tree.nodes))
    return tree


def empty_tree(nodes: int, blocks: int) -> Tree:
    """A tree over nothing, with room for so many nodes, one at least, and blocks beside the empty one."""
    tree = Tree(aligned_rows(nodes, NODE_SIZE), aligned_rows(1 + blocks, BLOCK_SIZE))
    clear(tree)
    return tree
