"""The kd-trees of a scene as an acceleration structure: one of what never moves, and one for each dynamic object.

The tree of a rigid object is built once, and rays are transformed to the object's space.  Built anew for each frame are
only the trees of objects that deform and two small ones over the boxes of objects where they are now: one over the
objects that rest, and one over those that move (§3 of the paper; Hunt, Mark, Stoll 2006).
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from tracer.geometry.accelerators import MAX_PACKET_SIZE
from tracer.geometry.boxes import OUTWARDS, transform_boxes, triangle_boxes
from tracer.geometry.building import in_chunks, watched
from tracer.geometry.kdtree import traverse
from tracer.geometry.kdtree.build import bounds_of, build_tree
from tracer.geometry.kdtree.tree import LEAF, KdWorld, Top, Trees
from tracer.geometry.poses import Poses
from tracer.geometry.primitives import Primitives, WorldTriangles
from tracer.geometry.queries import Placed
from tracer.geometry.structure import placed_by
from tracer.scene.arrays import Float32, Float64
from tracer.scene.model import Progress
from tracer.simd.records import pack

TRANSFORMED = 8 * 2.0**-24  # of the coordinates: by so much rays are wrong that are transformed to an object's space
EVEN = 1.1  # ratio of an object's axes at most, or else a little in its space may be much in the world


class InObjectSpace:
    """Primitives are tested one by one, each in the space of its object, and nothing but its own test decides."""

    max_packet_size = MAX_PACKET_SIZE  # of which they take no note: they trace rays one by one
    extent = 0.0  # boxes of dynamic objects are not padded
    hit_padding = 1e30  # and a hit need not lie in any

    def __init__(self, primitives: Primitives) -> None:
        self._primitives = primitives

    def certain(self, poses: Poses) -> NDArray[np.bool_]:
        """Those that are not flattened, stretched or sheared.

        What a ray is wrong by in an object's space is more in the world by the ratio of its longest to its shortest
        axis, and the errors of the triangle test there by its square."""
        scales = np.linalg.svd(poses.to_world[:, :, :3], compute_uv=False)
        return scales[:, 0] <= EVEN * scales[:, 2]

    def triangles_of(self, index: int, to_world: Float64) -> WorldTriangles:
        """The triangles of an object that to_world (3, 4) takes to the world; rays go to its space in float32.

        Blurs and boxes hold of objects that are `certain`."""
        local = self._primitives.triangles[self._primitives.triangles_of(index)]
        near = triangle_boxes(local).astype(np.float64)  # a hit lies no further outside than the box is wide
        near += (near[:, 3:] - near[:, :3]).max(1, initial=0.0)[:, None] * 1.0001 * OUTWARDS
        if index == 0:
            return WorldTriangles(local, np.zeros(len(local), np.float32), near.astype(np.float32))
        linear = to_world[:, :3]
        world = local.astype(np.float64).reshape(-1, 3, 3) @ linear.T
        world[:, 0] += to_world[:, 3]
        scales = np.linalg.svd(linear, compute_uv=False)
        reach = np.abs(local).max(initial=0.0) * 2 * scales[0]
        reach += np.abs(to_world[:, 3]).max() + np.abs(world).max(initial=0.0)
        blurs = np.full(len(local), TRANSFORMED * reach, np.float32)
        boxes = transform_boxes(near, np.broadcast_to(to_world, (len(local), 3, 4)))
        boxes = boxes + TRANSFORMED * reach * OUTWARDS
        return WorldTriangles(world.reshape(-1, 9).astype(np.float32), blurs, boxes.astype(np.float32))


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
        to_object = poses.to_object.reshape(-1, 12).astype(np.float32)
        self.world = KdWorld(
            primitives.triangles,
            len(primitives.triangles),
            primitives.quadrics,
            self._static,
            self._dynamic,
            Top(resting_tree, resting_box, bool(resting.any())),
            Top(moving_tree, moving_box, bool(moving.any())),
            self._roots,
            boxes,
            to_object,
        )
        self._data = pack(self.world)
        return placed_by(self, primitives, to_object, self._data, bool(moving.any()), moving_box)

    def build(self) -> None:
        """Nothing waits for rays."""

    def built(self) -> None:
        """All of it is built before rays come."""

    def bounds(self) -> Float32:
        """Box (6,) around everything that is there now; inverted for an empty world."""
        boxes = np.stack([self.world.boxes[0], self.world.resting.box, self.world.moving.box])
        return bounds_of(boxes[boxes[:, 0] <= boxes[:, 3]])
