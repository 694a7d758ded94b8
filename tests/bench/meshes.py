"""One model in as many triangles as are wanted, for benchmarks of how costs grow with their number."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

_GOLDEN = (1.0 + 5.0**0.5) / 2.0


def frequency_for(triangles: int) -> int:
    """Into how many parts each edge of the icosahedron is cut for about so many triangles."""
    return max(1, round((triangles / 20) ** 0.5))


def bumpy_sphere(frequency: int) -> NDArray[np.float32]:
    """Corners (20 * frequency², 3, 3) of an icosahedron whose faces are subdivided, blown up to a sphere with bumps.

    Neighbours share corners exactly, so that nothing passes between them.
    """
    i, j = (index.reshape(-1) for index in np.indices((frequency, frequency)))
    up, down = i + j < frequency, i + j < frequency - 1
    a = np.stack([np.stack([i + u, j + v], 1)[up] for u, v in ((0, 0), (1, 0), (0, 1))], 1)
    b = np.stack([np.stack([i + u, j + v], 1)[down] for u, v in ((1, 0), (1, 1), (0, 1))], 1)
    steps = np.concatenate([a, b])  # (frequency², 3, 2): along two edges of a face
    weights = np.concatenate([frequency - steps.sum(2, keepdims=True), steps], axis=2)
    return _bumpy(np.einsum("tck,fkx->ftcx", weights, _icosahedron()).reshape(-1, 3, 3))


def bumpy_face(face: int, frequency: int) -> tuple[NDArray[np.float32], NDArray[np.int32]]:
    """One of the 20 faces of the same: points (k, 3), each once, and triangles (frequency², 3) between them."""
    i, j = (index.reshape(-1) for index in np.indices((frequency + 1, frequency + 1)))
    number = np.full((frequency + 1, frequency + 1), -1, np.int32)
    there = i + j <= frequency
    i, j = i[there], j[there]
    number[i, j] = np.arange(len(i))
    weights = np.stack([frequency - i - j, i, j], axis=1)
    points = _bumpy(np.einsum("tk,kx->tx", weights, _icosahedron()[face])[:, None])[:, 0]
    triangles = []
    for around, room in ((((0, 0), (1, 0), (0, 1)), 1), (((1, 0), (1, 1), (0, 1)), 2)):
        at = i + j <= frequency - room
        triangles.append(np.stack([number[i[at] + u, j[at] + v] for u, v in around], axis=1))
    return points, np.concatenate(triangles)


def _bumpy(points: NDArray[np.float64]) -> NDArray[np.float32]:
    """Points (n, corners, 3) on the sphere with bumps."""
    points = points / np.linalg.norm(points, axis=2, keepdims=True)
    x, y, z = np.moveaxis(points, 2, 0)
    bumps = np.sin(7 * x + 1) * np.sin(8 * y + 2) * np.sin(9 * z) + 0.3 * np.sin(23 * x) * np.sin(21 * y) * np.sin(
        22 * z
    )
    return (points * (1.0 + 0.15 * bumps[..., None])).astype(np.float32)


def _icosahedron() -> NDArray[np.float64]:
    """Corners (20, 3, 3), each face counterclockwise from outside."""
    corners = np.array(
        [p for s in (-1, 1) for t in (-_GOLDEN, _GOLDEN) for p in ((0, s, t), (s, t, 0), (t, 0, s))], float
    )
    faces = []
    for a in range(12):
        for b in range(12):
            for c in range(12):
                p, q, r = corners[[a, b, c]]
                near = all(abs(np.linalg.norm(u - v) - 2.0) < 1e-9 for u, v in ((p, q), (q, r), (r, p)))
                if near and a < min(b, c) and np.dot(np.cross(q - p, r - p), p) > 0:
                    faces.append((p, q, r))
    return np.array(faces)
