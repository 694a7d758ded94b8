"""What of a large 8-wide tree, whose subtrees are built where rays arrive, lies at points of space
(`tracer.geometry.tree_parts`).

Boxes overlap, and most of space lies in inner nodes alone: the part at a point is the deepest box around it.
"""

from __future__ import annotations

import math
import weakref
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tracer.geometry.accelerators import BVH8
from tracer.geometry.building import NO_CONTROL, in_chunks
from tracer.geometry.bvh8.layout import CHILDREN, COUNT, QUADRIC, SUBTREE
from tracer.geometry.tree_parts import PartsAt, most_of, nothing_at
from tracer.geometry.wide_tree.topology import WIDTH
from tracer.runtime.kernels import kernel
from tracer.runtime.parallel import thread_count

if TYPE_CHECKING:
    from tracer.geometry.bvh8.subtrees import LargeTree

_WAITING = 1024  # room for nodes that are still to be entered


@kernel
def _locate(nodes, codes, counts, table, across, points, numbers, owners, levels, built, widths, held):
    """Write what lies at points (n, 3): nodes (m, 64) float32, the same memory as int32, codes, and that of the blocks,
    counts; table (1 + subtrees,) int64 as rays read it."""
    waiting = np.empty((_WAITING, 3), np.int64)  # nodes, their levels, and the subtrees that they belong to
    for i in range(len(points)):
        best, left = 0, 1
        waiting[0, 0], waiting[0, 1], waiting[0, 2] = 0, 0, -1
        while left > 0:
            left -= 1
            node, level, subtree = waiting[left, 0], waiting[left, 1] + 1, waiting[left, 2]
            for c in range(WIDTH):
                inside, width = True, np.float32(np.inf)
                for k in range(3):
                    low, high = nodes[node, WIDTH * k + c], nodes[node, WIDTH * (k + 3) + c]
                    inside = inside and points[i, k] >= low and points[i, k] <= high
                    if k != across:
                        width = min(width, high - low)
                if not inside:
                    continue
                code, owner = np.int64(codes[node, CHILDREN + c]), subtree
                child, there = code, 1
                if code >= SUBTREE:
                    owner = code - SUBTREE
                    child = table[1 + owner]
                    there = 1 if child >= 0 else 0
                if level > best:
                    best = level
                    numbers[i], owners[i], levels[i], built[i] = WIDTH * node + c, owner, min(level, 255), there
                    widths[i], held[i] = width, -1
                    if code < 0:
                        held[i] = counts[~code, COUNT] if ~code < QUADRIC else 1
                if code >= 0 and there and left < _WAITING:
                    waiting[left, 0], waiting[left, 1], waiting[left, 2] = child, level, owner
                    left += 1


class SubtreeParts:
    """See `TreeParts`; it shows what never moves."""

    name, owner = BVH8, "subtree"

    def __init__(self, tree: LargeTree, primitives: int) -> None:
        self._tree = weakref.ref(tree)
        self.levels = round(math.log2(max(primitives, 8)) / 2)  # half-full nodes of eight children, down to leaves

    @property
    def alive(self) -> bool:
        """Whether the tree is still there."""
        return self._tree() is not None

    @cached_property
    def extent(self) -> NDArray[np.float32]:
        """A box around most primitives; zeros once the tree is no more."""
        tree = self._tree()
        return most_of(tree.boxes, tree.sizes) if tree is not None else np.zeros(6, np.float32)

    def at(self, points: NDArray[np.float32], across: int) -> PartsAt | None:
        """What lies at points (n, 3)."""
        tree = self._tree()
        if tree is None:
            return None
        nodes, blocks = tree.tree
        codes, counts, found = nodes.view(np.int32), blocks.view(np.int32), nothing_at(len(points))

        def find(first: int, last: int) -> None:
            part = slice(first, last)
            _locate(nodes, codes, counts, tree.table, across, points[part], *(column[part] for column in found))

        in_chunks(find, len(points), NO_CONTROL, thread_count())
        return found
