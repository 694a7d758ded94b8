"""Boxes around what is in a scene, as the files' readers and the camera need them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from tracer.scene.animation import Animation
from tracer.scene.arrays import BLOCK, Float32, Float64, Int32
from tracer.scene.deformation import deformed
from tracer.scene.limits import SMALLEST
from tracer.scene.model import CONE, SceneObject

_ROW = 64  # points


def bounds(objects: Sequence[SceneObject], animation: Animation, time: float) -> Float64 | None:
    """(2, 3) float64, least and greatest corner of everything at a time, or None where there is nothing.

    Objects that a track moves beyond all numbers are nowhere."""
    boxes: list[tuple[Float32 | Float64, Float32 | Float64]] = []
    for o in objects:
        matrix = animation.matrix(o.chain, time)
        if not (np.abs(matrix) <= 1 / SMALLEST).all():
            continue
        corners = o.triangles.corners if o.deformation is None else deformed(o.deformation, time)[0]
        at_rest = np.array_equal(matrix, np.eye(4))
        for start in range(0, len(corners), BLOCK):
            points: Float32 | Float64 = corners[start : start + BLOCK].reshape(-1, 3)
            if not at_rest:
                points = points @ matrix[:3, :3].T + matrix[:3, 3]
            boxes.append(extent(points))
        if len(o.quadrics):
            maps = np.stack([matrix @ np.vstack([placed, (0, 0, 0, 1)]) for placed in o.quadrics.to_object])
            least, greatest = quadric_boxes(o.quadrics.kind, o.quadrics.radii, maps[:, :3])
            boxes.append((least.min(axis=0), greatest.max(axis=0)))
    if not boxes:
        return None
    return np.stack([np.min([b[0] for b in boxes], axis=0), np.max([b[1] for b in boxes], axis=0)]).astype(np.float64)


def ball_of(box: Float64 | None) -> tuple[Float64, float]:
    """The centre (3,) of a box (2, 3), and half its diagonal; 1 for that of a single point.  None is a box around 0."""
    low, high = (np.full(3, -1.0), np.full(3, 1.0)) if box is None else box
    return (low + high) / 2, float(np.linalg.norm(high - low)) / 2 or 1.0


def extent(points: Float32 | Float64) -> tuple[Float32 | Float64, Float32 | Float64]:
    """Least and greatest corner, (3,) each, of points (n, 3), n > 0: many of a row at once, which is ten times as fast
    as three numbers at a time."""
    whole = len(points) // _ROW * _ROW
    rows = np.ascontiguousarray(points[:whole]).reshape(-1, 3 * _ROW)
    parts = [points[whole:], *(least(rows, axis=0).reshape(-1, 3) for least in (np.min, np.max) if whole)]
    few = np.concatenate(parts)
    return few.min(axis=0), few.max(axis=0)


def quadric_boxes(kinds: Int32 | Float32, radii: Float64 | Float32, maps: Float64) -> tuple[Float64, Float64]:
    """Least and greatest corners, (n, 3) each, of spheres and cones, (n,) and (n, 2), under maps (n, 3, 4) from their
    canonical space."""
    sphere, axis, start = (kinds != CONE)[:, None], maps[:, :, 2], maps[:, :, 3]
    across = maps[:, :, 0] ** 2 + maps[:, :, 1] ** 2
    across = np.sqrt(np.where(sphere, across + axis**2, across))  # how far a unit sphere or circle reaches
    first, second = (np.where(sphere, 1.0, radii[:, i, None]) * across for i in (0, 1))
    end = np.where(sphere, start, start + axis)
    return np.minimum(start - first, end - second), np.maximum(start + first, end + second)
