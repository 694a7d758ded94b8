"""Triangles that change their shape by keyframes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tracer.scene.arrays import Float32, Float64
from tracer.scene.normals import unit_normals


@dataclass(frozen=True)
class Deformation:
    """Keyframed triangles (AFF `tpa`), all n of one object with the same number of keys.

    times (n, k) float64, ascending; corners and normals (n, k, 3, 3) float32, in the space
    that the object's transform chain takes to the world.
    """

    times: Float64
    corners: Float32
    normals: Float32


def deformed(deformation: Deformation, time: float) -> tuple[Float32, Float32]:
    """Corners and unit normals, (n, 3, 3) float32 each, of keyframed triangles at a time.

    Linear between keys and clamped at the ends; a normal that comes out as zero becomes the
    triangle's own.
    """
    times = deformation.times
    rows = np.arange(len(times))
    index = np.clip(np.sum(times <= time, axis=1) - 1, 0, max(times.shape[1] - 2, 0))
    after = np.minimum(index + 1, times.shape[1] - 1)
    length = times[rows, after] - times[rows, index]
    u = np.clip((time - times[rows, index]) / np.where(length > 0, length, 1.0), 0.0, 1.0)
    u = np.where(length > 0, u, (time >= times[rows, after]).astype(np.float64)).astype(np.float32)[:, None, None]
    corners = (1 - u) * deformation.corners[rows, index] + u * deformation.corners[rows, after]
    normals = (1 - u) * deformation.normals[rows, index] + u * deformation.normals[rows, after]
    return corners, unit_normals(normals, corners)
