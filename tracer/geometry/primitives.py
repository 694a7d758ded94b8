"""A scene's primitives as kernels read them: what every acceleration structure is built over.

Their attributes are what shading reads of each, in a row of 64 bytes, the size of a cache line; rows of quadrics hold
no normals, since those depend on the point.  Millions of triangles are laid out a part after the other: it takes
seconds, and whoever waits may give up in between.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.geometry.boxes import OUTWARDS
from tracer.geometry.memory import aligned_rows
from tracer.geometry.poses import Poses, inverses, products
from tracer.runtime.kernels import kernel
from tracer.scene.arrays import BLOCK, Float32, Float64, Int32, Report
from tracer.scene.bounds import extent, quadric_boxes
from tracer.scene.deformation import deformed
from tracer.scene.model import Scene, SceneObject, Triangles

# Columns of attributes: the normals of three corners; the triangle's own normal, of any length; and, as the bits of
# int32, the numbers of its object, its material and its texture (-1 for none).
CORNER_NORMALS, FACE_NORMAL, OBJECT, MATERIAL, TEXTURE = 0, 9, 12, 13, 14
COLUMNS = 16


def edge_products(triangles: NDArray[np.float32]) -> NDArray[np.float32]:
    """Cross products (t, 3) float32 of the two edges of triangles (t, 9), corner and edges: normals of any length."""
    a, b = triangles[:, 3:6].T, triangles[:, 6:9].T
    return np.stack([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]], axis=1)


def triangle_rows(corners: Float32) -> Float32:
    """Triangles as rows (n, 9) float32, a corner and two edges, from their corners (n, 3, 3)."""
    first = corners[:, 0].astype(np.float64)
    edges = [corners[:, i] - first for i in (1, 2)]
    return np.concatenate([first, *edges], axis=1).astype(np.float32)


def laid_out(scene: Scene, object_of: Int32, report: Report) -> tuple[Float32, Float32]:
    """Triangles (t, 9), corner and edges, and attributes (t + q, COLUMNS) of all primitives, whose objects are
    object_of (t + q,)."""
    count = scene.triangle_count
    triangles, rows = np.empty((count, 9), np.float32), aligned_rows(len(object_of), COLUMNS)
    numbers = rows.view(np.int32)
    for part, of, some in _parts(scene):
        report(part.start / count)
        triangles[part] = triangle_rows(of.corners[some])
        rows[part, TEXTURE + 1 :] = 0
        rows[part, CORNER_NORMALS:FACE_NORMAL] = of.normals[some].reshape(-1, 9)
        rows[part, FACE_NORMAL:OBJECT] = edge_products(triangles[part])
        numbers[part, OBJECT] = object_of[part]
        numbers[part, MATERIAL] = of.material[some]
        numbers[part, TEXTURE] = of.texture[some]
    rows[count:] = 0
    numbers[count:, OBJECT] = object_of[count:]
    numbers[count:, MATERIAL] = np.concatenate([o.quadrics.material for o in scene.objects])
    numbers[count:, TEXTURE] = -1
    return triangles, rows


def _parts(scene: Scene) -> Iterator[tuple[slice, Triangles, slice]]:
    """Some triangles at a time: their numbers, and where they are among those of their object."""
    for first, one in zip(scene.triangle_offsets.tolist(), scene.objects, strict=False):
        for start in range(0, len(one.triangles), BLOCK):
            stop = min(start + BLOCK, len(one.triangles))
            yield slice(first + start, first + stop), one.triangles, slice(start, stop)


def box_of(points: Float32, report: Callable[[], None]) -> Float64:
    """The box (6,) around points (n, 3), inverted around none; `report` is called again and again."""
    ends = [np.full(3, np.inf), np.full(3, -np.inf)]
    for start in range(0, len(points), 3 * BLOCK):
        report()
        lower, upper = extent(points[start : start + 3 * BLOCK])
        ends = [np.minimum(ends[0], lower), np.maximum(ends[1], upper)]
    return np.concatenate(ends)


@kernel
def _bound(corners, starts, to_world, which, boxes):
    """Boxes (k, 6) around the triangles of objects (k,), of whose corners (n, 3) three each are those of
    triangles starts[1] and on, where they are in the world; inverted for those that have none."""
    for k in range(len(which)):
        o = which[k]
        boxes[k, :3], boxes[k, 3:] = np.inf, -np.inf
        for i in range(3 * (starts[o] - starts[1]), 3 * (starts[o + 1] - starts[1])):
            for axis in range(3):
                m = to_world[o, 4 * axis : 4 * axis + 4]
                x = m[0] * corners[i, 0] + m[1] * corners[i, 1] + m[2] * corners[i, 2] + m[3]
                boxes[k, axis], boxes[k, axis + 3] = min(boxes[k, axis], x), max(boxes[k, axis + 3], x)


class Outlines(NamedTuple):
    """Where primitives are in the world.

    triangles (t, 9) float32, corner and edges, are in the space of their object, from which to_world (objects, 12)
    float64 leads; object_of (t + q,) int32 tells whose each primitive is.  boxes (q, 6) float32 are around quadrics,
    in the world.
    """

    triangles: Float32
    to_world: Float64
    object_of: Int32
    boxes: Float32


class WorldTriangles(NamedTuple):
    """Triangles in the world, just as a structure intersects them: rows (n, 9) float32, corner and edges; blurs (n,),
    how far from there their corners may truly be; and boxes (n, 6), outside of which no hit on them is reported, but
    for roundings of no more than 4e-5 of the distance between ray origin and corner."""

    rows: Float32
    blurs: Float32
    boxes: Float32


class Primitives:
    """All primitives of a scene's n objects, in the space of their object.

    triangles (t, 9) float32, corner and two edges; attributes (t + q, 16) float32 (`tracer.geometry.primitives`), of
    which normals (t, 9) are the corners'; corners (d, 3, 3) float32 are those of dynamic triangles.
    quadrics (q, 16) float32: map to canonical space, kind, radii and side; the same map in float64 is
    to_canonical (q, 3, 4), its inverse to_object.  Those of object i begin at triangle_starts[i] and
    quadric_starts[i], (n + 1,) int32, and end before the next object's; object_of (t + q,) int32 tells whose
    each is.  boxes (n, 6) float64 are around objects, whatever shape those take that deform; inverted around none.
    `report` is given the part that is laid out, again and again, and may raise Cancelled.
    """

    def __init__(self, scene: Scene, report: Report = lambda done: None) -> None:
        objects = scene.objects
        self.corners = np.concatenate([objects[0].triangles.corners[:0], *(o.triangles.corners for o in objects[1:])])
        quadrics = [o.quadrics for o in objects]
        self.to_object = np.concatenate([q.to_object for q in quadrics])
        self.to_canonical = inverses(self.to_object)
        self.quadrics = np.zeros((len(self.to_object), 16), np.float32)
        self.quadrics[:, :12] = self.to_canonical.reshape(-1, 12)
        self.quadrics[:, 12] = np.concatenate([q.kind for q in quadrics])
        self.quadrics[:, 13:15] = np.concatenate([q.radii for q in quadrics])
        self.quadrics[:, 15] = np.concatenate([q.inside for q in quadrics])
        self.triangle_starts: Int32 = scene.triangle_offsets
        self.quadric_starts: Int32 = scene.quadric_offsets - scene.quadric_offsets[0]
        counts = np.diff(self.triangle_starts), np.diff(self.quadric_starts)
        self.object_of = np.concatenate([np.repeat(np.arange(len(objects)), n) for n in counts]).astype(np.int32)
        self.triangles, self.attributes = laid_out(scene, self.object_of, lambda done: report(0.9 * done))
        self.normals = self.attributes[: len(self.triangles), CORNER_NORMALS:FACE_NORMAL]
        self.deformations = {i: o.deformation for i, o in enumerate(objects) if o.deformation is not None}
        self._parts = [o.part_of for o in objects]
        self.boxes = np.array([self._box(i, o, lambda: report(0.9)) for i, o in enumerate(objects)])

    def _box(self, index: int, one: SceneObject, report: Callable[[], None]) -> Float64:
        which, corners = (
            self.quadrics_of(index),
            one.triangles.corners if one.deformation is None else one.deformation.corners,
        )
        around, boxes = box_of(corners.reshape(-1, 3), report), self.quadric_boxes(which, self.to_object[which])
        lower, upper = boxes[:, :3].min(0, initial=np.inf), boxes[:, 3:].max(0, initial=-np.inf)
        return np.concatenate([np.minimum(around[:3], lower), np.maximum(around[3:], upper)])

    def triangles_of(self, index: int) -> slice:
        """The numbers of an object's triangles."""
        return slice(int(self.triangle_starts[index]), int(self.triangle_starts[index + 1]))

    def quadrics_of(self, index: int) -> slice:
        """The rows of an object's quadrics, counted from the first quadric on."""
        return slice(int(self.quadric_starts[index]), int(self.quadric_starts[index + 1]))

    def pieces_of(self, index: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Where runs of an object's primitives begin that are of one piece of a file, and how many are in each."""
        part_of, starts, sizes = self._parts[index], [], []
        triangles, quadrics = self.triangles_of(index), self.quadrics_of(index)
        count = triangles.stop - triangles.start
        for first, n, skipped in (
            (triangles.start, count, 0),
            (len(self.triangles) + quadrics.start, quadrics.stop - quadrics.start, count),
        ):
            parts = np.zeros(n, np.int32) if part_of is None else part_of[skipped : skipped + n]
            begin = np.flatnonzero(np.diff(parts, prepend=-1)) if n else np.empty(0, np.int64)
            starts.append(first + begin)
            sizes.append(np.diff(begin, append=n))
        return np.concatenate(starts), np.concatenate(sizes)

    def corners_of(self, index: int) -> Float32:
        """Corners (n, 3, 3) of a dynamic object's triangles, as they are now; a view."""
        rows, first_dynamic = self.triangles_of(index), int(self.triangle_starts[1])
        return self.corners[rows.start - first_dynamic : rows.stop - first_dynamic]

    def deform(self, time: float) -> None:
        """Give all objects that deform their shape at a time in seconds."""
        for index, deformation in self.deformations.items():
            rows = self.triangles_of(index)
            corners, normals = deformed(deformation, time)
            self.corners_of(index)[:] = corners
            self.triangles[rows], self.normals[rows] = triangle_rows(corners), normals.reshape(-1, 9)
            self.attributes[rows, FACE_NORMAL:OBJECT] = edge_products(self.triangles[rows])

    def outlines(self, poses: Poses) -> Outlines:
        """Where all primitives are in these poses."""
        boxes = self.placed_quadric_boxes(slice(0, len(self.quadrics)), poses)
        return Outlines(self.triangles, poses.to_world.reshape(-1, 12), self.object_of, boxes)

    def object_boxes(self, which: NDArray[np.int64], poses: Poses) -> NDArray[np.float32]:
        """Boxes (k, 6) in the world around dynamic objects (k,) that are present."""
        boxes = np.empty((len(which), 6))
        _bound(self.corners.reshape(-1, 3), self.triangle_starts, poses.to_world.reshape(-1, 12), which, boxes)
        for k in np.flatnonzero(np.diff(self.quadric_starts)[which]):
            round_ones = self.placed_quadric_boxes(self.quadrics_of(int(which[k])), poses)
            boxes[k, :3] = np.minimum(boxes[k, :3], round_ones[:, :3].min(0))
            boxes[k, 3:] = np.maximum(boxes[k, 3:], round_ones[:, 3:].max(0))
        slack = 2e-6 * np.abs(boxes).max(axis=1, keepdims=True, initial=0.0)
        return (boxes + slack * OUTWARDS).astype(np.float32)

    def placed_quadric_boxes(self, which: slice, poses: Poses) -> NDArray[np.float32]:
        """Boxes (n, 6) in the world around quadrics."""
        owners = self.object_of[len(self.triangles) :][which]
        return self.quadric_boxes(which, products(poses.to_world[owners], self.to_object[which]))

    def quadric_boxes(self, which: slice, maps: Float64) -> NDArray[np.float32]:
        """Boxes (n, 6) around quadrics in the space to which maps (n, 3, 4) take their canonical spaces."""
        radii = np.abs(self.quadrics[which, 13:15].astype(np.float64))
        lower, upper = quadric_boxes(self.quadrics[which, 12], radii, maps)
        slack = 2e-6 * np.maximum(np.abs(lower), np.abs(upper)).max(1, initial=0)[:, None]
        return np.concatenate([lower - slack, upper + slack], axis=1).astype(np.float32)
