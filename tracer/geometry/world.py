"""The world at a moment: one tree for what never moves, one per dynamic object, placed for the frame.

Building happens once; `place` then only re-places rigid objects and rebuilds those that deform
(§3 of the paper; Hunt, Mark, Stoll 2006).  Whatever structure is below, rays ask two questions in
batches: `closest_hits` and `any_hits`.
"""

from __future__ import annotations

from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor, wait

import numpy as np
from numpy.typing import NDArray

from tracer.geometry.kdtree import traverse
from tracer.geometry.kdtree.build import CANCELLED, DONE, bounds_of, build_tree
from tracer.geometry.kdtree.tree import LEAF, Trees
from tracer.geometry.rays import Hits, Rays
from tracer.parallel import for_each_chunk, thread_count
from tracer.scene.animation import deformed
from tracer.scene.model import Progress, Quadrics, Scene, SceneObject

ACCELERATORS = ("kdtree",)
CHUNK = 4096  # rays a thread takes at a time

Tree = tuple[Trees, NDArray[np.float32]]  # with the box around it


def triangle_rows(corners: NDArray[np.float32]) -> NDArray[np.float32]:
    """Corner and two edges, (n, 9) float32, of corners (n, 3, 3)."""
    first = corners[:, 0].astype(np.float64)
    edges = [corners[:, i] - first for i in (1, 2)]
    return np.concatenate([first, *edges], axis=1).astype(np.float32)


def quadric_rows(quadrics: Quadrics) -> NDArray[np.float32]:
    """Map from object to canonical space, kind, radii and side: (n, 16) float32."""
    rows = np.zeros((len(quadrics), 16), np.float32)
    for i in range(len(quadrics)):
        rows[i, :12] = _inverse(quadrics.to_object[i]).reshape(-1)
    rows[:, 12], rows[:, 13:15], rows[:, 15] = quadrics.kind, quadrics.radii, quadrics.inside
    return rows


def _inverse(affine: NDArray[np.float64]) -> NDArray[np.float64]:
    """Inverse (3, 4) of an affine map (3, 4) or (4, 4); raises LinAlgError where it squashes space."""
    linear = np.linalg.inv(affine[:3, :3])
    return np.concatenate([linear, -(linear @ affine[:3, 3:4])], axis=1)


def _triangle_boxes(rows: NDArray[np.float32]) -> NDArray[np.float32]:
    corners = np.stack([rows[:, :3], rows[:, :3] + rows[:, 3:6], rows[:, :3] + rows[:, 6:]], axis=1)
    return np.concatenate([corners.min(1), corners.max(1)], axis=1)


def _quadric_boxes(quadrics: Quadrics) -> NDArray[np.float32]:
    """Boxes around the images of the canonical boxes: [-1, 1]^3, or [-r, r]^2 x [0, 1] of a cone."""
    boxes = np.empty((len(quadrics), 6), np.float32)
    for i, (kind, radii) in enumerate(zip(quadrics.kind, np.abs(quadrics.radii).max(1, initial=0), strict=True)):
        half = np.array([1.0, 1.0, 1.0]) if kind == 0 else np.array([radii, radii, 0.5])
        middle = np.zeros(3) if kind == 0 else np.array([0.0, 0.0, 0.5])
        boxes[i] = transform_box(np.concatenate([middle - half, middle + half]), quadrics.to_object[i])
    return boxes


def transform_box(box: NDArray, affine: NDArray[np.float64]) -> NDArray[np.float64]:
    """The box (6,) around the image of a box under an affine map (3, 4) or (4, 4) (Arvo 1990), a little larger."""
    middle, half = (box[3:] + box[:3]) * 0.5, (box[3:] - box[:3]) * 0.5
    centre = affine[:3, :3] @ middle + affine[:3, 3]
    reach = np.abs(affine[:3, :3]) @ half
    reach = reach + 2e-6 * (np.abs(centre).max() + reach.max())
    return np.concatenate([centre - reach, centre + reach])


class World:
    """A scene's geometry for rays: `place` it for a time, then ask.

    Raises Cancelled if `progress` does while the static tree is being built, ValueError for an
    accelerator that does not exist.  `placed` is what kernels are given; `normals` (t, 9) float32
    holds the corners' normals in the space of each triangle's object.
    """

    def __init__(
        self, scene: Scene, time: float = 0.0, accelerator: str = "kdtree", progress: Progress | None = None
    ) -> None:
        if accelerator not in ACCELERATORS:
            raise ValueError(f"there is no accelerator {accelerator!r}; there is {', '.join(ACCELERATORS)}")
        self.scene = scene
        objects = scene.objects
        corners = [o.triangles.corners for o in objects]
        self._triangles = triangle_rows(np.concatenate(corners))
        self.normals = np.concatenate([o.triangles.normals for o in objects]).reshape(-1, 9)
        self._quadrics = np.concatenate([quadric_rows(o.quadrics) for o in objects])
        counts = [[len(o.triangles) for o in objects], [len(o.quadrics) for o in objects]]
        owners = [np.repeat(np.arange(len(objects)), n) for n in counts]
        self.object_of = np.concatenate(owners).astype(np.int32)
        self._trees: list[Tree] = []
        for index in range(len(objects)):
            self._trees.append(self._build(index, progress))
        self._static = self._globalised([0])[0]
        self._dynamic, self._roots = self._globalised(range(1, len(objects)))
        self.place(time)

    def _build(self, index: int, progress: Progress | None) -> Tree:
        """The tree of one object; its items count the object's own primitives."""
        scene, item = self.scene, self.scene.objects[index]
        offsets = scene.triangle_offsets
        rows = self._triangles[offsets[index] : offsets[index + 1]]
        boxes = np.concatenate([_triangle_boxes(rows), _quadric_boxes(item.quadrics)])
        control = np.zeros(2, np.int64)
        if progress is None or len(boxes) < 5000:
            return build_tree(boxes, rows, control)
        with ThreadPoolExecutor(1, thread_name_prefix="tree") as builder:
            tree = builder.submit(build_tree, boxes, rows, control)
            try:
                while not tree.done():
                    progress("building the kd-tree", min(0.99, control[DONE] / (2.5 * len(boxes))))
                    wait([tree], 0.05)
            finally:
                control[CANCELLED] = 1
        return tree.result()

    def _globalised(self, indices: Iterable[int]) -> tuple[Trees, NDArray[np.int32]]:
        """Trees of several objects back to back, their items numbers of the whole scene; and all objects' roots."""
        scene = self.scene
        words, items = [], []
        roots = np.zeros(len(scene.objects), np.int32)
        node_offset = item_offset = 0
        for index in indices:
            tree = self._trees[index][0]
            moved = tree.words.reshape(-1, 2).copy()
            leaf = (moved[:, 1] & 3) == LEAF
            moved[leaf, 0] += item_offset
            moved[~leaf, 1] += node_offset << 2
            triangles = len(scene.objects[index].triangles)
            first_triangle, first_quadric = scene.triangle_offsets[index], scene.quadric_offsets[index] - triangles
            words.append(moved.reshape(-1))
            items.append(tree.items + np.where(tree.items < triangles, first_triangle, first_quadric).astype(np.int32))
            roots[index] = node_offset
            node_offset += len(moved)
            item_offset += len(tree.items)
        flat = np.concatenate(words) if words else np.array([0, LEAF], np.int32)
        return Trees(flat, flat.view(np.float32), np.concatenate(items) if items else np.empty(0, np.int32)), roots

    def _deform(self, index: int, item: SceneObject, time: float) -> None:
        assert item.deformation is not None
        rows = slice(self.scene.triangle_offsets[index], self.scene.triangle_offsets[index + 1])
        corners, normals = deformed(item.deformation, time)
        self._triangles[rows] = triangle_rows(corners)
        self.normals[rows] = normals.reshape(-1, 9)
        self._trees[index] = self._build(index, None)

    def place(self, time: float) -> None:
        """Move dynamic objects to where they are at `time` seconds, and rebuild the trees of those that deform."""
        objects = self.scene.objects
        deforming = [i for i, item in enumerate(objects) if item.deformation is not None]
        for i in deforming:
            self._deform(i, objects[i], time)
        if deforming:
            self._dynamic, self._roots = self._globalised(range(1, len(objects)))
        to_object = np.zeros((len(objects), 12), np.float32)
        to_object[0, [0, 5, 10]] = 1.0
        present, boxes = [], []
        for i in range(1, len(objects)):
            if not self.scene.animation.visible(objects[i].chain, time) or self._is_empty(i):
                continue
            matrix = self.scene.animation.matrix(objects[i].chain, time)
            try:
                to_object[i] = _inverse(matrix).reshape(-1)
            except np.linalg.LinAlgError:
                continue  # scaled to nothing: not to be seen, and no ray can be carried there
            present.append(i)
            boxes.append(transform_box(self._trees[i][1].astype(np.float64), matrix))
        top_boxes = np.asarray(boxes, np.float32).reshape(-1, 6)
        top, top_box = build_tree(top_boxes, self._triangles[:0])
        top = Trees(top.words, top.planes, np.asarray(present, np.int32)[top.items])
        self.placed = traverse.Placed(
            self._triangles,
            self._quadrics,
            self._static,
            self._dynamic,
            top,
            self._roots,
            np.stack([box for _, box in self._trees]),
            to_object,
            top_box,
            self.object_of,
        )

    def _is_empty(self, index: int) -> bool:
        return len(self.scene.objects[index].triangles) + len(self.scene.objects[index].quadrics) == 0

    def closest_hits(self, rays: Rays, threads: int = 0) -> Hits:
        """Nearest hits of a batch (see `tracer.geometry.rays`)."""
        n = len(rays.t_min)
        hits = Hits(np.empty(n, np.float32), np.empty(n, np.int32), np.empty(n, np.float32), np.empty(n, np.float32))
        counts = np.zeros((thread_count(threads), 2), np.int64)

        def work(chunk: int, worker: int) -> None:
            last = min(n, (chunk + 1) * CHUNK)
            traverse.closest_hits(self.placed, rays, hits, chunk * CHUNK, last, counts[worker])

        for_each_chunk(work, -(-n // CHUNK), len(counts))
        return hits

    def any_hits(self, rays: Rays, threads: int = 0) -> NDArray[np.bool_]:
        """(n,) whether anything, static or dynamic, lies in each ray's interval."""
        n = len(rays.t_min)
        blocked, counts = np.zeros(n, np.bool_), np.zeros((thread_count(threads), 2), np.int64)

        def work(chunk: int, worker: int) -> None:
            last = min(n, (chunk + 1) * CHUNK)
            traverse.any_hits(self.placed, rays, blocked, chunk * CHUNK, last, counts[worker])

        for_each_chunk(work, -(-n // CHUNK), len(counts))
        return blocked

    def bounds(self) -> NDArray[np.float32]:
        """Box (6,) around everything that is there now; inverted for an empty world."""
        boxes = np.stack([self.placed.boxes[0], self.placed.top_box])
        return bounds_of(boxes[boxes[:, 0] <= boxes[:, 3]])
