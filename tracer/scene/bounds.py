"""Boxes around what is in a scene, as the files' readers and the camera need them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from tracer.scene.animation import Animation
from tracer.scene.arrays import Float32, Float64
from tracer.scene.deformation import deformed
from tracer.scene.limits import SMALLEST
from tracer.scene.model import CONE, SceneObject

_BLOCK = 1 << 18  # triangles that are moved at once
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
        for start in range(0, len(corners), _BLOCK):
            points: Float32 | Float64 = corners[start : start + _BLOCK].reshape(-1, 3)
            if not at_rest:
                points = points @ matrix[:3, :3].T + matrix[:3, 3]
            boxes.append(extent(points))
        for kind, placed, radii in zip(o.quadrics.kind, o.quadrics.to_object, o.quadrics.radii, strict=True):
            boxes.append(quadric_box(int(kind), matrix @ np.vstack([placed, (0, 0, 0, 1)]), radii))
    if not boxes:
        return None
    return np.stack([np.min([b[0] for b in boxes], axis=0), np.max([b[1] for b in boxes], axis=0)]).astype(np.float64)


def extent(points: Float32 | Float64) -> tuple[Float32 | Float64, Float32 | Float64]:
    """Least and greatest corner, (3,) each, of points (n, 3), n > 0: many of a row at once, which is ten times as fast
    as three numbers at a time."""
    whole = len(points) // _ROW * _ROW
    rows = np.ascontiguousarray(points[:whole]).reshape(-1, 3 * _ROW)
    parts = [points[whole:], *(least(rows, axis=0).reshape(-1, 3) for least in (np.min, np.max) if whole)]
    few = np.concatenate(parts)
    return few.min(axis=0), few.max(axis=0)


def quadric_box(kind: int, placed: Float64, radii: Float64) -> tuple[Float64, Float64]:
    """Least and greatest corner, (3,) each, of a sphere or cone under a map (4, 4) from its canonical space."""
    linear, centre = placed[:3, :3], placed[:3, 3]
    if kind != CONE:
        reach = np.linalg.norm(linear, axis=1)
        return centre - reach, centre + reach
    across = np.linalg.norm(linear[:, :2], axis=1)  # how far a unit circle reaches along each axis
    ends = [(centre, across * radii[0]), (centre + linear[:, 2], across * radii[1])]
    return np.min([c - r for c, r in ends], axis=0), np.max([c + r for c, r in ends], axis=0)
