"""A mesh is a soup of triangles, each corner with its own position, normal and texture coordinate.

Nothing is shared, so joining, moving and re-mapping are one-liners over arrays; the writer
(`generate.aff`) finds what is shared again when it indexes the file.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Mesh:
    """n triangles: corners and normals (n, 3, 3), counter-clockwise seen from outside; uvs (n, 3, 2), v upwards."""

    corners: Array
    normals: Array
    uvs: Array

    def __len__(self) -> int:
        return len(self.corners)

    def moved(self, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Mesh:
        return Mesh(self.corners + np.array([x, y, z]), self.normals, self.uvs)

    def scaled(self, x: float, y: float | None = None, z: float | None = None) -> Mesh:
        factors = np.array([x, x if y is None else y, x if z is None else z])
        normals = self.normals / factors
        normals = normals / np.linalg.norm(normals, axis=2, keepdims=True)
        return Mesh(self.corners * factors, normals, self.uvs)

    def turned(self, axis: str, degrees: float) -> Mesh:
        """Rotated about the x, y or z axis through the origin."""
        matrix = rotation({"x": (1, 0, 0), "y": (0, 1, 0), "z": (0, 0, 1)}[axis], degrees)
        return Mesh(self.corners @ matrix.T, self.normals @ matrix.T, self.uvs)

    def flat(self) -> Mesh:
        """The same triangles with their geometric normals."""
        return Mesh(self.corners, np.repeat(face_normals(self.corners)[:, None], 3, axis=1), self.uvs)

    def flipped(self) -> Mesh:
        """Seen from the other side."""
        return Mesh(self.corners[:, ::-1], -self.normals[:, ::-1], self.uvs[:, ::-1])

    def mapped(self, grain: str = "y", per_metre: float = 1.0, offset: tuple[float, float] = (0.0, 0.0)) -> Mesh:
        """Box-projected texture coordinates, v along the axis `grain` wherever a face allows it."""
        along = "xyz".index(grain)
        uvs = np.empty((len(self), 3, 2))
        dominant = np.abs(face_normals(self.corners)).argmax(axis=1)
        for axis in range(3):
            across = [a for a in range(3) if a != axis]
            v = along if along != axis else across[1]
            u = across[0] if across[1] == v else across[1]
            chosen = dominant == axis
            uvs[chosen] = self.corners[chosen][:, :, [u, v]] * per_metre
        return Mesh(self.corners, self.normals, uvs + np.array(offset))


def rotation(axis: Sequence[float], degrees: float) -> Array:
    """(3, 3) rotation about an axis through the origin, right-handed."""
    x, y, z = np.asarray(axis, np.float64) / np.linalg.norm(axis)
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    skew = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    outer = np.outer([x, y, z], [x, y, z])
    return c * np.eye(3) + s * skew + (1 - c) * outer


def face_normals(corners: Array) -> Array:
    """(n, 3) unit normals; zero for a triangle without area."""
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    return normals / np.where(lengths > 1e-14, lengths, 1.0)


def join(meshes: Iterable[Mesh]) -> Mesh:
    parts = list(meshes)
    return Mesh(
        np.concatenate([m.corners for m in parts]),
        np.concatenate([m.normals for m in parts]),
        np.concatenate([m.uvs for m in parts]),
    )


def lattice(points: ArrayLike, normals: ArrayLike, uvs: ArrayLike) -> Mesh:
    """Triangles of a lattice of points (rows, columns, 3); outside is columns x rows (right-handed)."""
    p, n, t = (np.asarray(a, np.float64) for a in (points, normals, uvs))

    def corners(a: Array) -> Array:
        a00, a01, a11, a10 = a[:-1, :-1], a[:-1, 1:], a[1:, 1:], a[1:, :-1]
        lower = np.stack([a00, a01, a11], axis=2)
        upper = np.stack([a00, a11, a10], axis=2)
        return np.stack([lower, upper], axis=2).reshape(-1, 3, a.shape[2])

    whole = Mesh(corners(p), corners(n), corners(t))
    a, b, c = (whole.corners[:, i] for i in range(3))
    solid = np.linalg.norm(np.cross(b - a, c - a), axis=1) > 1e-12  # poles collapse some
    return Mesh(whole.corners[solid], whole.normals[solid], whole.uvs[solid])


def smooth_lattice(points: ArrayLike, uvs: ArrayLike, wrap: bool = False) -> Mesh:
    """A lattice with normals from central differences; `wrap` closes it along the columns."""
    p = np.asarray(points, np.float64)
    if wrap:
        across = np.roll(p[:, :-1], -1, axis=1) - np.roll(p[:, :-1], 1, axis=1)
        across = np.concatenate([across, across[:, :1]], axis=1)
    else:
        across = np.gradient(p, axis=1)
    along = np.gradient(p, axis=0)
    if np.allclose(p[0], p[0, :1]):  # a pole: lean on the next row
        across[0] = across[1]
    if np.allclose(p[-1], p[-1, :1]):
        across[-1] = across[-2]
    normals = np.cross(across, along)
    normals = normals / np.maximum(np.linalg.norm(normals, axis=2, keepdims=True), 1e-12)
    return lattice(p, normals, uvs)
