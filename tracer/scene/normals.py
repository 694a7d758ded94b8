"""Normals that can be relied on: always of unit length, whatever a file says.

Files leave normals out, give them without length, or belong to triangles without area; what
shades and classifies surfaces later must not meet any of these cases.
"""

from __future__ import annotations

import numpy as np

from tracer.scene.arrays import Float32, Float64


def geometric_normals(corners: Float32 | Float64) -> Float64:
    """(n, 3) float64 unit normals of triangles (n, 3, 3), on the side from which the corners run
    counter-clockwise; (0, 0, 1) where there is no area."""
    wide = corners.astype(np.float64)
    normal = np.cross(wide[:, 1] - wide[:, 0], wide[:, 2] - wide[:, 0])
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    flat = ~(length > 0)
    return np.where(flat, (0.0, 0.0, 1.0), normal / np.where(flat, 1.0, length))


def unit_normals(normals: Float32 | Float64, corners: Float32 | Float64) -> Float32:
    """(n, 3, 3) float32 of unit length; one without length becomes the geometric normal of its triangle."""
    wide = normals.astype(np.float64)
    length = np.linalg.norm(wide, axis=2, keepdims=True)
    known = np.isfinite(length) & (length > 1e-30)
    unit = np.where(known, wide, 0.0) / np.where(known, length, 1.0)
    lost = ~known.all(axis=(1, 2))
    if lost.any():
        unit[lost] = np.where(known[lost], unit[lost], geometric_normals(corners[lost])[:, None, :])
    return unit.astype(np.float32)
