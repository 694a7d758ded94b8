"""Laying out the primitives of a scene as rows, a part after the other: millions of triangles take seconds, and whoever
waits for them may give up in between.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from tracer.geometry.attributes import (
    COLUMNS,
    CORNER_NORMALS,
    FACE_NORMAL,
    MATERIAL,
    OBJECT,
    TEXTURE,
    edge_products,
)
from tracer.geometry.memory import aligned_rows
from tracer.scene.arrays import Float32, Float64, Int32
from tracer.scene.framing import extent
from tracer.scene.model import Scene, Triangles

BLOCK = 1 << 18
"""Triangles that are worked on at once."""

Report = Callable[[float], None]
"""Is given the part that is done, again and again, and may raise Cancelled."""


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
