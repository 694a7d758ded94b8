"""What of the one kd-tree over everything lies at points of space (`tracer.geometry.tree_parts`)."""

from __future__ import annotations

import math
import weakref
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tracer.geometry.accelerators import LAZY
from tracer.geometry.building import NO_CONTROL, in_chunks
from tracer.geometry.kdtree.tree import LEAF
from tracer.geometry.lazy_tree.node import FIRST, HEADER, PLANE, SECOND, SUBTREE
from tracer.geometry.shared_memory import read_shared
from tracer.geometry.tree_parts import PartsAt, most_of, nothing_at
from tracer.runtime.kernels import kernel
from tracer.runtime.parallel import thread_count
from tracer.simd import i32_at, load_f32, load_i64

if TYPE_CHECKING:
    from tracer.geometry.lazy_tree.structure import LazyKdTree

_IDENTITY = np.eye(3, 4, dtype=np.float32).reshape(-1)


@kernel
def _locate(root, bounds, to_object, scale, across, owner, points, numbers, owners, levels, built, widths, held):
    """Write what lies at points (n, 3) where they are within the bounds (6,) of the tree with this root, which is in
    the space that to_object (12,) leads to, and whose sides are so much longer in the world.  across is an axis, or 3
    where none is left out."""
    cell, at = np.empty(6, np.float32), np.empty(3, np.float32)
    known = False
    number, level, there, width, many = np.int64(0), 0, 0, np.float32(0), np.int64(0)
    for i in range(len(points)):
        inside, same = True, known
        for k in range(3):
            at[k] = (
                to_object[4 * k] * points[i, 0]
                + to_object[4 * k + 1] * points[i, 1]
                + to_object[4 * k + 2] * points[i, 2]
                + to_object[4 * k + 3]
            )
            inside = inside and at[k] >= bounds[k] and at[k] <= bounds[k + 3]
            same = same and at[k] >= cell[k] and at[k] < cell[k + 3]
        if not inside:
            continue
        if not same:
            # Go down to the node that the point is in, as far as there are nodes.
            node, level, known = root, 0, True
            for k in range(6):
                cell[k] = bounds[k]
            word = read_shared(node)
            while 0 <= word < SUBTREE:
                plane = load_f32(node + PLANE)
                if at[word] < plane:
                    cell[word + 3] = plane
                    node = load_i64(node + FIRST)
                else:
                    cell[word] = plane
                    node = load_i64(node + SECOND)
                level += 1
                word = read_shared(node)
            number, there, many = node, 1 if word == SUBTREE else 0, np.int64(-1)
            if there:
                words, place = load_i64(node + FIRST) + HEADER, np.int64(0)
                while True:
                    second = np.int64(i32_at(words)[2 * place + 1])
                    axis = second & 3
                    if axis == LEAF:
                        break
                    plane = load_f32(words + 8 * place)
                    if at[axis] < plane:
                        cell[axis + 3], place = plane, place + 1
                    else:
                        cell[axis], place = plane, second >> 2
                    level += 1
                number, many = words + 8 * place, second >> 2
            width = np.float32(np.inf)
            for k in range(3):
                if k != across:
                    width = min(width, cell[k + 3] - cell[k])
        numbers[i], owners[i], levels[i], built[i] = number, owner, min(level, 255), there
        widths[i], held[i] = width * scale, many


class LazyParts:
    """See `TreeParts`; a moving object has a tree of its own, which is shown where its box is."""

    name, owner = LAZY, "object"

    def __init__(self, structure: LazyKdTree, present: NDArray[np.int32], primitives: int) -> None:
        self._structure = weakref.ref(structure)
        self._present, self._to_object = present, structure.world.to_object
        self._boxes = structure.world_boxes
        self.levels = round(8 + 1.3 * math.log2(max(primitives, 1)))  # as kd-trees are mostly deep

    @property
    def alive(self) -> bool:
        """Whether the tree is still there."""
        return self._structure() is not None

    @cached_property
    def extent(self) -> NDArray[np.float32]:
        """A box around most primitives; zeros once the tree is no more."""
        structure = self._structure()
        trees = structure.trees if structure is not None else []
        boxes, weights = trees[0].groups if trees else (self._boxes[:0], np.zeros(0, np.int64))
        moving = np.array([trees[o].primitives for o in self._present.tolist()] if trees else [], np.int64)
        return most_of(np.concatenate([boxes, self._boxes[: len(moving)]]), np.concatenate([weights, moving]))

    def at(self, points: NDArray[np.float32], across: int) -> PartsAt | None:
        """What lies at points (n, 3)."""
        structure = self._structure()
        if structure is None:
            return None
        trees, found = structure.trees, nothing_at(len(points))

        def find(first: int, last: int) -> None:
            part = slice(first, last)
            rows = tuple(column[part] for column in found)
            _locate(trees[0].root, trees[0].box, _IDENTITY, np.float32(1), across, -1, points[part], *rows)
            for o in self._present.tolist():
                to_object = self._to_object[o]
                _locate(trees[o].root, trees[o].box, to_object, _scale(to_object), 3, o, points[part], *rows)

        in_chunks(find, len(points), NO_CONTROL, thread_count())
        return found


def _scale(to_object: NDArray[np.float32]) -> np.float32:
    """How much longer what is 1 in an object's space is in the world."""
    return np.float32(1.0 / np.cbrt(max(abs(np.linalg.det(to_object.reshape(3, 4)[:, :3].astype(np.float64))), 1e-30)))
