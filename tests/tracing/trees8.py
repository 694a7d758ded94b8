"""What every 8-wide tree must be: everything in one leaf, inside all boxes above it, laid out as kernels want it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tracer.geometry.boxes import PADDING
from tracer.geometry.bvh8.layout import EMPTY, NO_PRIMITIVE, QUADRIC, Tree
from tracer.geometry.wide_tree.topology import MAX_DEPTH

NO_BOXES = np.empty((0, 6), np.float32)


class Leaf(NamedTuple):
    box: np.ndarray  # (6,), as its parent stores it
    block: int  # 0 for a quadric
    quadric: int  # -1 for a block


class Found(NamedTuple):
    leaves: list[Leaf]
    nodes: list[int]
    depth: int


def walk(tree: Tree) -> Found:
    """Everything that hangs on the root; on the way, that boxes hold what they should, and empty slots nothing."""
    codes = tree.nodes.view(np.int32)[:, 48:56]
    found, pending, deepest = Found([], [], 0), [(0, 1)], 0
    while pending:
        node, depth = pending.pop()
        found.nodes.append(node)
        deepest = max(deepest, depth)
        assert not tree.nodes[node, 56:].any()
        boxes = tree.nodes[node, :48].reshape(6, 8).T
        for box, code in zip(boxes, codes[node], strict=True):
            if code == ~0:
                assert (box == EMPTY).all()
            elif code >= 0:
                assert code > node, "parents come before children"
                inside = tree.nodes[code, :48].reshape(6, 8)[:, codes[code] != ~0]
                assert np.array_equal(box, np.concatenate([inside[:3].min(1), inside[3:].max(1)]))
                pending.append((code, depth + 1))
            elif ~code < QUADRIC:
                found.leaves.append(Leaf(box, ~code, -1))
            else:
                found.leaves.append(Leaf(box, 0, ~code - QUADRIC))
    assert len(set(found.nodes)) == len(found.nodes)
    return found._replace(depth=deepest)


def triangles_of(tree: Tree, block: int) -> tuple[np.ndarray, np.ndarray]:
    """Numbers (k,) and rows (k, 9) of a block; on the way, that its unused lanes are as they should be."""
    words = tree.blocks[block].view(np.int32)
    count, rows = words[86], tree.blocks[block, :72].reshape(9, 8).T
    assert 1 <= count <= 8
    assert (words[72 + count : 80] == NO_PRIMITIVE).all()
    assert not rows[count:].any()
    assert not words[87:].any()
    return words[72 : 72 + count], rows[:count]


def corners_of(rows: np.ndarray) -> np.ndarray:
    """(n, 3, 3) float64."""
    first = rows[:, :3].astype(np.float64)
    return np.stack([first, first + rows[:, 3:6], first + rows[:, 6:]], axis=1)


def assert_sound(tree: Tree, rows: np.ndarray, boxes: np.ndarray = NO_BOXES, rounding: float = 0.0) -> Found:
    """Every triangle and box of these, and nothing else, is in one leaf each, and in all boxes above it.

    rows (t, 9) are what blocks should hold, and boxes (q, 6) what the leaves of quadrics should, but for
    `rounding`; NaN for what is not to be found.
    """
    assert tree.nodes.ctypes.data % 64 == tree.blocks.ctypes.data % 64 == 0
    assert tree.nodes.flags.c_contiguous and tree.blocks.flags.c_contiguous
    empty = tree.blocks[0].view(np.int32)
    assert empty[86] == 0 and (empty[72:80] == NO_PRIMITIVE).all()
    found = walk(tree)
    assert found.depth <= MAX_DEPTH
    triangles = [triangles_of(tree, leaf.block) for leaf in found.leaves if leaf.block]
    numbers = np.concatenate([n for n, _ in triangles]) if triangles else np.empty(0, int)
    held = np.concatenate([r for _, r in triangles]) if triangles else np.empty((0, 9))
    assert np.array_equal(np.sort(numbers), np.flatnonzero(~np.isnan(rows[:, 0])))
    assert np.abs(corners_of(held) - corners_of(rows[numbers])).max(initial=0) <= rounding
    owned = [leaf.quadric for leaf in found.leaves if not leaf.block]
    assert sorted(owned) == np.flatnonzero(~np.isnan(boxes[:, 0])).tolist()

    extent = max(np.abs(corners_of(held)).max(initial=0), np.nanmax(np.abs(boxes), initial=0))
    padding, ulp = PADDING * extent, 3e-7 * extent
    for leaf in found.leaves:
        if leaf.block:
            corners = corners_of(triangles_of(tree, leaf.block)[1]).reshape(-1, 3)
            exact, error = np.concatenate([corners.min(0), corners.max(0)]), ulp
            assert np.array_equal(tree.blocks[leaf.block, 80:86], leaf.box)
        else:
            exact, error = boxes[leaf.quadric].astype(np.float64), ulp + padding + 3 * rounding
        grown = (leaf.box - exact) * np.repeat([-1, 1], 3)
        assert (grown >= padding - ulp).all() and (grown <= padding + error).all()
    return found


def same(a: Tree, b: Tree) -> bool:
    return all(np.array_equal(x.view(np.int32), y.view(np.int32)) for x, y in zip(a, b, strict=True))


def cost(tree: Tree) -> float:
    """How many children a long ray through the root's box is expected to enter, nodes and leaves alike."""
    boxes = tree.nodes[:, :48].reshape(-1, 6, 8).astype(np.float64)
    used = tree.nodes.view(np.int32)[:, 48:56] != ~0
    sides = boxes[:, 3:] - boxes[:, :3]
    root = boxes[0][3:, used[0]].max(1) - boxes[0][:3, used[0]].min(1)
    areas = (sides * np.roll(sides, 1, axis=1)).sum(1)
    return float(areas[used].sum() / (root * np.roll(root, 1)).sum())
