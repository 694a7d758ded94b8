"""The kd-trees of a scene as an acceleration structure: one of what never moves, and one for each dynamic object.

The tree of a rigid object is built once, and rays are transformed to the object's space.  Built anew for each frame are
only the trees of objects that deform and two small ones over the boxes of objects where they are now: one over the
objects that rest, and one over those that move (§3 of the paper; Hunt, Mark, Stoll 2006).
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from tracer.geometry.boxes import transform_boxes, triangle_boxes
from tracer.geometry.building import in_chunks, watched
from tracer.geometry.kdtree import traverse
from tracer.geometry.kdtree.build import bounds_of, build_tree
from tracer.geometry.kdtree.object_space import InObjectSpace
from tracer.geometry.kdtree.tree import LEAF, Parts, Trees
from tracer.geometry.poses import Poses
from tracer.geometry.primitives import Primitives
from tracer.geometry.queries import Placed
from tracer.scene.arrays import Float32
from tracer.scene.model import Progress

Tree = tuple[Trees, NDArray[np.float32]]  # with the box around it


class KdTree(InObjectSpace):
    """See `tracer.geometry.structure`; raises Cancelled if `progress` does while trees are being built."""

    closest, any_hit = traverse.closest, traverse.any_hit

    def __init__(
        self, primitives: Primitives, objects: int, progress: Progress | None = None, lazy: bool = False
    ) -> None:
        super().__init__(primitives)
        self._objects = objects
        self._trees = [self._build(index, progress) for index in range(objects)]
        self._static = self._side_by_side([0])[0]
        self._dynamic, self._roots = self._side_by_side(range(1, objects))

    def _build(self, index: int, progress: Progress | None = None) -> Tree:
        """Build the tree of one object; its items are numbers of the object's own primitives."""
        primitives, quadrics = self._primitives, self._primitives.quadrics_of(index)
        rows = primitives.triangles[primitives.triangles_of(index)]
        count = len(rows) + quadrics.stop - quadrics.start
        boxes = np.empty((count, 6), np.float32)
        boxes[len(rows) :] = primitives.quadric_boxes(quadrics, primitives.to_object[quadrics])

        def bound(first: int, last: int) -> None:
            boxes[first:last] = triangle_boxes(rows[first:last])

        def build(control: NDArray[np.int64]) -> Tree:
            in_chunks(bound, len(rows), control, 1)
            return build_tree(boxes, rows, control)

        return watched(build, "building the kd-tree", count, 2.5 * count, progress)

    def _side_by_side(self, indices: Iterable[int]) -> tuple[Trees, NDArray[np.int32]]:
        """Trees of several objects side by side, with the items of the whole scene; and the roots of all objects."""
        words, items = [], []
        roots = np.zeros(self._objects, np.int32)
        node_offset = item_offset = 0
        for index in indices:
            tree = self._trees[index][0]
            moved = tree.words.reshape(-1, 2).copy()
            leaf = (moved[:, 1] & 3) == LEAF
            moved[leaf, 0] += item_offset
            moved[~leaf, 1] += node_offset << 2
            primitives, triangles = self._primitives, self._primitives.triangles_of(index)
            count = triangles.stop - triangles.start
            first_quadric = len(primitives.triangles) + primitives.quadric_starts[index] - count
            words.append(moved.reshape(-1))
            items.append(tree.items + np.where(tree.items < count, triangles.start, first_quadric).astype(np.int32))
            roots[index] = node_offset
            node_offset += len(moved)
            item_offset += len(tree.items)
        flat = np.concatenate(words) if words else np.array([0, LEAF], np.int32)
        return Trees(flat, flat.view(np.float32), np.concatenate(items) if items else np.empty(0, np.int32)), roots

    def _top(self, which: NDArray[np.bool_], boxes: Float32, poses: Poses) -> Tree:
        """Build a tree over some of n objects, (n,) bool, where they are; boxes (n, 6) are in their own spaces."""
        numbers = np.flatnonzero(which)
        placed = transform_boxes(boxes[numbers].astype(np.float64), poses.to_world[numbers]).astype(np.float32)
        tree, box = build_tree(placed, self._primitives.triangles[:0])
        return Trees(tree.words, tree.planes, numbers.astype(np.int32)[tree.items]), box

    def place(self, poses: Poses, resting: NDArray[np.bool_]) -> Placed:
        """Build the trees of objects that deform anew, and those over the objects that are present."""
        primitives = self._primitives
        for index in primitives.deformations:
            self._trees[index] = self._build(index)
        if primitives.deformations:
            self._dynamic, self._roots = self._side_by_side(range(1, self._objects))
        moving = poses.present & ~resting
        moving[0] = False
        boxes = np.stack([box for _, box in self._trees])
        resting_tree, resting_box = self._top(resting, boxes, poses)
        moving_tree, moving_box = self._top(moving, boxes, poses)
        self.parts = parts = Parts(
            primitives.triangles,
            primitives.quadrics,
            self._static,
            self._dynamic,
            resting_tree,
            moving_tree,
            self._roots,
            boxes,
            poses.to_object.reshape(-1, 12).astype(np.float32),
            resting_box,
            moving_box,
        )
        arrays = [a for part in parts for a in ((part.words, part.items) if isinstance(part, Trees) else (part,))]
        there = len(primitives.triangles), resting.any(), moving.any()
        self._data = np.array([*(a.ctypes.data for a in arrays), *there], np.int64)
        return Placed(
            primitives.triangles, primitives.quadrics, parts.to_object, primitives.object_of, self.closest.address,
            self.any_hit.address, self._data.ctypes.data, bool(moving.any()), moving_box,
        )  # fmt: skip

    def build(self) -> None:
        """Nothing waits for rays."""

    def built(self) -> None:
        """All of it is built before rays come."""

    def parts_built(self) -> None:
        """None of it waits."""

    def bounds(self) -> Float32:
        """Box (6,) around everything that is there now; inverted for an empty world."""
        boxes = np.stack([self.parts.boxes[0], self.parts.resting_box, self.parts.moving_box])
        return bounds_of(boxes[boxes[:, 0] <= boxes[:, 3]])
