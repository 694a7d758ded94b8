"""One kd-tree over everything, built where rays arrive (`tracer.geometry.structure`)."""

from __future__ import annotations

import ctypes
import sys
import weakref

import numpy as np
from numpy.typing import NDArray

from tracer.geometry.boxes import NO_BOX, transform_boxes, union_of
from tracer.geometry.building import LONG
from tracer.geometry.kdtree.build import bounds_of
from tracer.geometry.kdtree.structure import InObjectSpace
from tracer.geometry.lazy_tree import traverse
from tracer.geometry.lazy_tree.build import free_tree, new_root, open_node
from tracer.geometry.lazy_tree.hierarchy import bounds_of_roots, hierarchy_over
from tracer.geometry.lazy_tree.node import Building
from tracer.geometry.lazy_tree.references import BYTES, NODES, Source
from tracer.geometry.lazy_tree.traverse import LazyWorld
from tracer.geometry.lazy_tree.upper import raise_over
from tracer.geometry.poses import Poses
from tracer.geometry.primitives import Primitives
from tracer.geometry.queries import Placed
from tracer.geometry.structure import BuiltPart, placed_by
from tracer.scene.arrays import Float32
from tracer.scene.model import Progress
from tracer.simd.records import pack


def _pause() -> int:
    """The address of what lets another thread go on; 0 where the system's is not known."""
    if sys.platform == "win32":
        return 0
    yielding = getattr(ctypes.CDLL(None), "sched_yield", None)
    return (ctypes.cast(yielding, ctypes.c_void_p).value or 0) if yielding is not None else 0


PAUSE = _pause()


class LazyTree:
    """The tree of one object in its own space: its root's address, the box (6,) float32 around it, and what is counted
    while it grows.  Its memory is freed with it."""

    def __init__(self, primitives: Primitives, quadric_boxes: Float32, index: int, touched: NDArray[np.uint8]) -> None:
        triangles, quadrics = primitives.triangles_of(index), primitives.quadrics_of(index)
        starts, sizes = primitives.pieces_of(index)
        self._held = hierarchy = hierarchy_over(primitives.triangles, quadric_boxes, starts, sizes)
        self.primitives = triangles.stop - triangles.start + quadrics.stop - quadrics.start
        roots = np.arange(len(hierarchy.boxes) - hierarchy.roots, len(hierarchy.boxes), dtype=np.int32)
        self.box = bounds_of(bounds_of_roots(hierarchy)) if self.primitives else NO_BOX.copy()
        self._grown = np.zeros(2, np.int64)
        self._source = Source(
            primitives.triangles, quadric_boxes, hierarchy.boxes, hierarchy.first, hierarchy.counts, hierarchy.weights,
            touched, self._grown,
        )  # fmt: skip
        self._table = pack(self._source)
        box, table = self.box.astype(np.float64), self._table.ctypes.data
        self.root = new_root(box, ~roots, np.ascontiguousarray(hierarchy.boxes[roots]), self.primitives, table)
        free_tree.compile()  # now: something else may be being compiled when a tree goes
        weakref.finalize(self, free_tree.call, self.root, 0, 0, 0, 0).atexit = False

    @property
    def groups(self) -> tuple[Float32, NDArray[np.int64]]:
        """Boxes (g, 6) around its primitives, some together, and how many are in each."""
        lowest = self._held.first >= 0
        return self._held.boxes[lowest], self._held.weights[lowest].astype(np.int64)

    def counted(self, what: int) -> int:
        """NODES that are built, or BYTES."""
        return int(self._grown[what])


class LazyKdTree(InObjectSpace):
    """See `tracer.geometry.structure`.  Nothing but groups is made before rays arrive."""

    closest, any_hit = traverse.closest, traverse.any_hit

    def __init__(
        self, primitives: Primitives, objects: int, progress: Progress | None = None, lazy: bool = True
    ) -> None:
        super().__init__(primitives)
        everything = slice(0, len(primitives.quadrics))
        self._quadric_boxes = primitives.quadric_boxes(everything, primitives.to_object)
        self._touched = np.zeros(len(primitives.object_of), np.uint8)
        self._trees = [self._new_tree(index, progress) for index in range(objects)]

    def _new_tree(self, index: int, progress: Progress | None = None) -> LazyTree:
        if progress is not None and index == 0 and len(self._touched) >= LONG:
            progress("grouping primitives", 0.0)
        return LazyTree(self._primitives, self._quadric_boxes, index, self._touched)

    def place(self, poses: Poses, resting: NDArray[np.bool_]) -> Placed:
        """Make the trees of objects that deform anew, and make the upper nodes over the objects that are present."""
        primitives = self._primitives
        for index in primitives.deformations:
            self._touched[primitives.triangles_of(index)] = 0
            self._trees[index] = self._new_tree(index)
        present, moving = poses.present.copy(), poses.present & ~resting
        present[0] = moving[0] = False
        self._present = objects = np.flatnonzero(present).astype(np.int32)
        object_boxes = np.stack([tree.box for tree in self._trees])
        boxes = transform_boxes(object_boxes[objects].astype(np.float64), poses.to_world[objects])
        boxes = boxes.astype(np.float32)
        self.world_boxes = boxes  # of those that are present
        moves = moving[objects]
        bounds = bounds_of(union_of(np.concatenate([object_boxes[:1], boxes]))[None])
        root, building = self._trees[0].root, Building(open_node.address, PAUSE)
        if len(objects):
            self._upper = raise_over(boxes, objects, moves, bounds.astype(np.float64), root, building)
            root = self._upper[0].ctypes.data
        roots = np.array([tree.root for tree in self._trees], np.int64)
        to_object, rests = poses.to_object.reshape(-1, 12).astype(np.float32), (present & ~moving).astype(np.uint8)
        has, moving_box = bool(moves.any()), bounds_of(boxes[moves])
        self.world = LazyWorld(
            primitives.triangles, len(primitives.triangles), primitives.quadrics, root, bounds, roots, object_boxes,
            to_object, rests, moving_box, has, building,
        )  # fmt: skip
        self._data = pack(self.world)
        return placed_by(self, primitives, to_object, self._data, has, moving_box)

    def build(self) -> None:
        """Nodes wait for rays by nature."""

    def built(self) -> BuiltPart:
        """What rays have had built of the trees that there are now."""
        nodes, size = (sum(tree.counted(what) for tree in self._trees) for what in (NODES, BYTES))
        return BuiltPart(nodes, int(np.count_nonzero(self._touched)), len(self._touched), size)

    @property
    def trees(self) -> list[LazyTree]:
        """The tree of each object, as it is now."""
        return list(self._trees)

    def bounds(self) -> Float32:
        """Box (6,) around everything that is there now; inverted for an empty world."""
        return self.world.bounds
