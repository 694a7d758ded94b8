"""The 8-wide trees of a scene as an acceleration structure: one of what never moves, and one for each dynamic object.

Rays are traced in the world only, and so the triangles of dynamic objects are moved there for each frame.  Topologies
are built once and kept.  An object that deforms has a topology for each of some times along its animation, and uses
that of the nearest.  So topologies stay good, and do not depend on which frames came before.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tracer.geometry.accelerators import MAX_PACKET_SIZE
from tracer.geometry.boxes import NO_BOX, PADDING, union_of
from tracer.geometry.building import watched
from tracer.geometry.bvh8 import subtrees, traverse
from tracer.geometry.bvh8.build import build_tree
from tracer.geometry.bvh8.layout import BOX, CHILDREN, PRIMITIVES, Tree
from tracer.geometry.bvh8.object_trees import blocks_of, build_object_trees, build_top_level, load_corners, move_objects
from tracer.geometry.bvh8.placed import MOVING_TREE, RESTING_TREE, STATIC_TREE, PlacedTree, World8, pack_world
from tracer.geometry.bvh8.subtrees import LargeTree
from tracer.geometry.poses import Poses, products
from tracer.geometry.primitives import Primitives, WorldTriangles, triangle_rows
from tracer.geometry.queries import Placed
from tracer.geometry.structure import BuiltPart, placed_by
from tracer.geometry.wide_tree.build import build_topology
from tracer.geometry.wide_tree.topology import WIDTH, Topology
from tracer.runtime.parallel import thread_count
from tracer.scene.arrays import Float32, Float64
from tracer.scene.deformation import deformed
from tracer.scene.model import Progress

STEPS, MOST_KEYS = 8, 64  # topologies from one key of a deforming object to the next, and of one object at most


class Bvh8:
    """See `tracer.geometry.structure`; raises Cancelled if `progress` does while trees are being built."""

    closest, any_hit = traverse.closest, traverse.any_hit
    hit_padding = PADDING
    max_packet_size = MAX_PACKET_SIZE

    def __init__(
        self, primitives: Primitives, objects: int, progress: Progress | None = None, lazy: bool = False
    ) -> None:
        self._primitives, self._objects = primitives, objects
        triangles, quadrics = primitives.triangles_of(0), primitives.quadrics_of(0)
        boxes = primitives.quadric_boxes(quadrics, primitives.to_object[quadrics])
        count = triangles.stop + quadrics.stop
        rows = primitives.triangles[triangles]
        self._large: LargeTree | None = None
        self._lazy = lazy and count > subtrees.LARGE

        def build(control: NDArray[np.int64]) -> Tree:
            if count <= subtrees.LARGE:
                return build_tree(rows, boxes, control, thread_count())
            self._large = large = LargeTree(rows, boxes, control, thread_count())
            if not lazy:
                large.build_all(control, thread_count())
            return large.tree

        self.static = watched(build, "building the tree", count, 1.2 * count, progress)
        self._keys = {index: _keys(d.times) for index, d in primitives.deformations.items()}
        self._at = dict.fromkeys(self._keys, 0)
        self._topologies: dict[tuple[int, int], Topology] = {}
        self._build_object_trees(progress)
        self.world_quadrics = primitives.quadrics.copy()
        self._quadric_boxes = np.zeros((len(primitives.quadrics), 6), np.float32)

    @staticmethod
    def make_ready() -> None:
        """Compile, or load, what only large trees need."""
        triangle, box = np.eye(1, 9, 3, np.float32), np.ones((1, 6), np.float32)
        tree = LargeTree(triangle, box, np.zeros(2, np.int64), 1)
        tree.build_all()

    def _topology(self, index: int, progress: Progress | None = None) -> Topology:
        """The topology of a dynamic object's tree; of one that deforms, that for the time it is nearest to."""
        known = (index, self._at.get(index, 0))
        if known not in self._topologies:
            primitives, quadrics = self._primitives, self._primitives.quadrics_of(index)
            rows = primitives.triangles[primitives.triangles_of(index)]
            if index in self._keys:
                time = self._keys[index][self._at[index]]
                rows = triangle_rows(deformed(primitives.deformations[index], time)[0])
            boxes = primitives.quadric_boxes(quadrics, primitives.to_object[quadrics])
            count = len(rows) + len(boxes)
            self._topologies[known] = watched(
                lambda control: build_topology(rows, boxes, control, thread_count()),
                "building the tree",
                count,
                1.2 * count,
                progress,
            )
        return self._topologies[known]

    def _build_object_trees(self, progress: Progress | None = None) -> None:
        """Lay out the trees of all dynamic objects side by side."""
        primitives = self._primitives
        topologies = [self._topology(index, progress) for index in range(1, self._objects)]
        self._object_trees = build_object_trees(topologies, primitives.triangle_starts, primitives.quadric_starts)
        load_corners(self._object_trees, primitives.corners.reshape(-1, 9), 1, self._objects)

    def _deform(self, time: float) -> None:
        at = {index: int(np.argmin(np.abs(keys - time))) for index, keys in self._keys.items()}
        if at != self._at:
            self._at = at
            self._build_object_trees()
        for index in self._keys:
            load_corners(self._object_trees, self._primitives.corners.reshape(-1, 9), index, index + 1)

    def place(self, poses: Poses, resting: NDArray[np.bool_]) -> Placed:
        """Move all objects that are present, as the primitives are now, to their poses."""
        primitives, present = self._primitives, poses.present.copy()
        present[0] = False
        moving = present & ~resting
        self._deform(poses.time)
        self._move_quadrics(poses)
        to_world = poses.to_world.reshape(-1, 12).astype(np.float32)
        move_objects(self._object_trees, to_world, present, self._quadric_boxes)
        self.resting_root = build_top_level(self._object_trees, moving, 0)
        build_top_level(self._object_trees, resting, self.resting_root)
        self.dynamic = self._object_trees.tree
        there_now = [tree_box(self.dynamic, root) for root in (0, self.resting_root)]
        self.extent = float(np.abs(there_now).max())
        there = 1 << STATIC_TREE | bool(resting.any()) << RESTING_TREE | bool(moving.any()) << MOVING_TREE
        table, count = 0 if self._large is None else self._large.table.ctypes.data, len(primitives.triangles)
        trees = [
            PlacedTree(tree.nodes.ctypes.data, tree.blocks.ctypes.data, root, self.world_quadrics, count, subtrees)
            for tree, root, subtrees in (
                (self.static, 0, table), (self.dynamic, self.resting_root, 0), (self.dynamic, 0, 0)
            )
        ]  # fmt: skip
        self._data = pack_world(World8(there, self.max_packet_size), trees)
        to_object = poses.to_object.reshape(-1, 12).astype(np.float32)
        return placed_by(self, primitives, to_object, self._data, bool(moving.any()), there_now[0])

    def _move_quadrics(self, poses: Poses) -> None:
        """Find maps from the world and boxes in the world for dynamic quadrics."""
        primitives = self._primitives
        which = slice(primitives.quadrics_of(0).stop, len(primitives.quadrics))
        if which.start == which.stop:
            return
        owners = primitives.object_of[len(primitives.triangles) :][which]
        maps = products(primitives.to_canonical[which], poses.to_object[owners])
        self.world_quadrics[which, :12] = maps.reshape(-1, 12)
        self._quadric_boxes[which] = primitives.placed_quadric_boxes(which, poses)

    def certain(self, poses: Poses) -> NDArray[np.bool_]:
        """All, as triangles are moved to the world."""
        return np.ones_like(poses.present)

    def triangles_of(self, index: int, to_world: Float64) -> WorldTriangles:
        """The triangles of an object in the world, just as they are intersected, with the boxes of their blocks."""
        triangles = self._primitives.triangles_of(index)
        blocks = self._static_blocks() if index == 0 else blocks_of(self._object_trees, index)
        numbers = blocks.view(np.int32)[:, PRIMITIVES : PRIMITIVES + WIDTH]
        block, lane = np.nonzero((numbers >= triangles.start) & (numbers < triangles.stop))
        where, count = numbers[block, lane] - triangles.start, triangles.stop - triangles.start
        rows, boxes = np.zeros((count, 9), np.float32), np.zeros((count, 6), np.float32)
        rows[where] = blocks[:, : 9 * WIDTH].reshape(-1, 9, WIDTH)[block, :, lane]
        boxes[where] = blocks[block, BOX : BOX + 6]
        return WorldTriangles(rows, np.zeros(count, np.float32), boxes)

    def build(self) -> None:
        """Build the subtrees that wait for rays, in all threads."""
        if self._large is not None:
            self._large.build_all(threads=thread_count())

    def _static_blocks(self) -> Float32:
        """The blocks of what never moves, all of which is built now."""
        self.build()
        return (self.static if self._large is None else self._large.used).blocks

    def built(self) -> BuiltPart | None:
        """What rays have had built of a large tree of what never moves, with the trees of all that moves."""
        if self._large is None or not self._lazy:
            return None
        large, moving, total = self._large, self._object_trees.tree, len(self._primitives.object_of)
        large.check()
        starts = self._primitives.triangle_starts[1] + self._primitives.quadric_starts[1]
        size = large.memory_bytes + moving.nodes.nbytes + moving.blocks.nbytes
        return BuiltPart(len(large.used.nodes) + len(moving.nodes), large.built + total - int(starts), total, size)

    def bounds(self) -> Float32:
        """Box (6,) around everything that is there now; inverted for an empty world."""
        roots = (0, self.resting_root)
        return union_of(np.stack([tree_box(self.static), *(tree_box(self.dynamic, root) for root in roots)]))


def _keys(times: Float64) -> Float64:
    """STEPS times from each key of an animation to the next; MOST_KEYS evenly spaced times where those were more."""
    keys = np.unique(times)
    if STEPS * len(keys) > MOST_KEYS:
        return np.linspace(keys[0], keys[-1], MOST_KEYS)
    return np.interp(np.arange(STEPS * (len(keys) - 1) + 1) / STEPS, np.arange(len(keys)), keys)


def tree_box(tree: Tree, root: int = 0) -> NDArray[np.float32]:
    """Box (6,) around everything below a node of a tree; inverted where there is nothing."""
    used = tree.nodes.view(np.int32)[root, CHILDREN : CHILDREN + WIDTH] != ~0
    if not used.any():
        return NO_BOX.copy()
    boxes = tree.nodes[root, : 6 * WIDTH].reshape(6, WIDTH)[:, used]
    return np.concatenate([boxes[:3].min(1), boxes[3:].max(1)])
