"""The crown of a large tree: what lies above its pieces, of some thousand triangles each.

Triangles are sorted into cells of a grid, and a tree is built over the cells by the surface area heuristic, down to
pieces.  So the crown costs three passes over the triangles, and takes no look at any of them again.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.geometry.boxes import NO_BOX
from tracer.geometry.building import CANCELLED
from tracer.geometry.bvh8.layout import CHILDREN, PIECE, Tree
from tracer.geometry.bvh8.write import clear
from tracer.geometry.wide_tree.binary import NUMBER, UPPER, WEIGHT, grow, make_items
from tracer.geometry.wide_tree.cells import Cells, cells_over
from tracer.geometry.wide_tree.collapse import collapse, plan
from tracer.geometry.wide_tree.topology import TOP_LEVEL_DEPTH, VACANT, WIDTH
from tracer.scene.arrays import Float32
from tracer.scene.model import Cancelled

ALL = 1 << 62


class Crown(NamedTuple):
    """children (n, 8) int32 as in a `Topology`, whose leaves are p pieces; boxes (p, 6) float32 around these; items,
    the numbers of each piece's triangles and, counted from their number on, quadrics."""

    children: NDArray[np.int32]
    boxes: Float32
    items: list[NDArray[np.int32]]


def crown_over(rows: Float32, boxes: Float32, piece: int, control: NDArray[np.int64], threads: int = 1) -> Crown:
    """The crown over triangles (t, 9), corner and edges, and boxes (q, 6) of quadrics, with pieces of at most so many
    triangles (WIDTH at least) where their centres differ.

    control (2,) int64: raises Cancelled once control[CANCELLED] is set."""
    cells = cells_over(rows, piece, control, threads)
    # Grow a binary tree over the cells and the quadrics.
    count = len(cells.boxes) + len(boxes)
    around = np.concatenate([cells.boxes, boxes])
    items, words = make_items(count), slice(NUMBER // 4, WEIGHT // 4 + 1)
    items.items[0, :count, :3] = around[:, :3]
    items.items[0, :count, UPPER // 4 : NUMBER // 4] = -around[:, 3:]
    weights = np.concatenate([np.diff(cells.starts), np.full(len(boxes), WIDTH)])
    items.items[0, :count].view(np.int32)[:, words] = np.stack([np.arange(count), weights], axis=1)
    stack = np.zeros((TOP_LEVEL_DEPTH + 2, 5), np.int64)
    stack[0, 1] = count
    grow(items, stack, 1, ALL, TOP_LEVEL_DEPTH, piece, control)
    if control[CANCELLED]:
        raise Cancelled
    # Give it eight children a node; its leaves are the pieces.
    children, leaves = np.empty((count, WIDTH), np.int32), np.empty((count, 2), np.int32)
    plan(items.nodes, TOP_LEVEL_DEPTH)
    nodes, pieces = collapse(items.nodes, children, leaves, TOP_LEVEL_DEPTH)
    first = leaves[:pieces, 0]
    ends = np.append(np.sort(first), count)
    last = ends[np.searchsorted(ends, first) + 1]
    parts = [items.order[a:b] for a, b in zip(first.tolist(), last.tolist(), strict=True)]
    piece_boxes = [np.concatenate([around[part, :3].min(0), around[part, 3:].max(0)]) for part in parts]
    return Crown(
        children[:nodes].copy(),
        np.stack(piece_boxes),
        [_items_of(cells, part, len(rows)) for part in parts],
    )


def _items_of(cells: Cells, part: NDArray[np.int32], triangles: int) -> NDArray[np.int32]:
    """The numbers of what is in some cells and quadrics, triangles first."""
    known = len(cells.boxes)
    inside = [cells.order[cells.starts[c] : cells.starts[c + 1]] for c in np.sort(part[part < known])]
    quadrics = np.sort(part[part >= known]) - known + triangles
    return np.concatenate([*inside, quadrics.astype(np.int32)])


def write_crown(tree: Tree, crown: Crown, padding: np.float32) -> None:
    """Write a crown into the first nodes of a tree; boxes are padded."""
    count = len(crown.children)
    clear(Tree(tree.nodes[:count], tree.blocks[:1]))
    padded = np.concatenate([crown.boxes[:, :3] - padding, crown.boxes[:, 3:] + padding], axis=1)
    around = np.tile(NO_BOX, (count, 1))
    codes = tree.nodes.view(np.int32)
    for node in range(count - 1, -1, -1):
        slots = np.flatnonzero(crown.children[node] != VACANT)
        children = crown.children[node, slots]
        inner = children >= 0
        boxes = np.where(inner[:, None], around[children * inner], padded[~children * ~inner])
        tree.nodes[node, : 6 * WIDTH].reshape(6, WIDTH)[:, slots] = boxes.T
        codes[node, CHILDREN + slots] = np.where(inner, children, PIECE + ~children)
        around[node] = np.concatenate([boxes[:, :3].min(0), boxes[:, 3:].max(0)])
