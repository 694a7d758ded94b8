"""Small scenes for tests, made of arrays."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from tracer.methods.certified import CertifiedCells
from tracer.neighbours.certified.store import CertificateStore
from tracer.renderer import Renderer
from tracer.scene.animation import Animation
from tracer.scene.model import (
    Camera,
    Light,
    Material,
    Quadrics,
    Scene,
    SceneObject,
    Triangles,
    empty_quadrics,
    empty_triangles,
)

GREY = Material(ambient=(0.1, 0.1, 0.1), diffuse=(0.8, 0.8, 0.8))


def triangles(corners, material: int = 0) -> Triangles:
    """Flat-shaded triangles of corners (n, 3, 3)."""
    corners = np.asarray(corners, np.float32).reshape(-1, 3, 3)
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-30)
    n = len(corners)
    return Triangles(
        corners,
        np.repeat(normal[:, None], 3, axis=1).astype(np.float32),
        np.zeros((n, 3, 2), np.float32),
        np.full(n, material, np.int32),
        np.full(n, -1, np.int32),
    )


def quad(a, b, c, d) -> list:
    return [[a, b, c], [a, c, d]]


def wall(columns: int, rows: int, hole: tuple[int, int] | None = None, z: float = 0.0) -> list:
    """A wall of 4 by 3 at z, cut into rectangles of two triangles each, perhaps without one of them."""
    x, y = np.linspace(0.0, 4.0, columns + 1), np.linspace(0.0, 3.0, rows + 1)
    return [
        triangle
        for i in range(columns)
        for j in range(rows)
        if (i, j) != hole
        for triangle in quad((x[i], y[j], z), (x[i + 1], y[j], z), (x[i + 1], y[j + 1], z), (x[i], y[j + 1], z))
    ]


def quadrics(rows: list[tuple[int, np.ndarray, tuple[float, float]]], material: int = 0) -> Quadrics:
    """Spheres and cones from (kind, map to object space (3, 4), radii)."""
    return Quadrics(
        np.array([r[0] for r in rows], np.int32),
        np.array([r[1] for r in rows], np.float64).reshape(-1, 3, 4),
        np.array([r[2] for r in rows], np.float32).reshape(-1, 2),
        np.zeros(len(rows), np.bool_),
        np.full(len(rows), material, np.int32),
    )


def affine(scale=1.0, move=(0.0, 0.0, 0.0)) -> np.ndarray:
    """The map (3, 4) that scales and then moves."""
    return np.concatenate([np.eye(3) * scale, np.asarray(move, np.float64)[:, None]], axis=1)


def scene(
    static=(), static_quadrics: Quadrics | None = None, dynamic: tuple[SceneObject, ...] = (), lights=(), **extra
) -> Scene:
    base = SceneObject(
        "static", triangles(static) if len(static) else empty_triangles(), static_quadrics or empty_quadrics()
    )
    values = {
        "path": Path("test.aff"),
        "objects": (base, *dynamic),
        "materials": (GREY,),
        "textures": (),
        "lights": tuple(Light(f"light {i}", tuple(map(float, p))) for i, p in enumerate(lights)),
        "camera": Camera((0.0, 0.0, 10.0), (0.0, 0.0, -1.0), angle=40.0),
        "animation": Animation.empty(),
    } | extra
    return Scene(**values)


def moved(name: str, corners, matrix: np.ndarray) -> SceneObject:
    """A dynamic object of triangles under a fixed (4, 4) matrix."""
    return SceneObject(name, triangles(corners), empty_quadrics(), (np.asarray(matrix, np.float64),))


def random_corners(rng: np.random.Generator, n: int, size: float) -> np.ndarray:
    """n triangles in the unit cube, with some slivers, duplicates and flat ones among them."""
    corners = rng.random((n, 1, 3)) + rng.normal(size=(n, 3, 3)) * size
    corners[: n // 8, 2] = corners[: n // 8, 1] + rng.normal(size=(n // 8, 3)) * size * 1e-3
    corners[n // 8 : n // 4, :, rng.integers(3)] = 0.5
    if n >= 8:
        corners[n // 2] = corners[n // 2 + 1]
    return corners.astype(np.float32)


def nasty_triangles(rng: np.random.Generator, n: int) -> np.ndarray:
    """Triangles in the unit cube: any, small ones, slivers, flat ones in a plane that others share, and duplicates."""
    corners = rng.random((n, 1, 3)) + rng.normal(size=(n, 3, 3)) * np.exp(rng.uniform(-9, 0, (n, 1, 1)))
    sliver, flat, twice = (rng.random(n) < 0.2 for _ in range(3))
    corners[sliver, 2] = corners[sliver, 1] + rng.normal(size=(sliver.sum(), 3)) * np.exp(rng.uniform(-14, -4))
    corners[flat, :, rng.integers(3)] = rng.choice([0.0, 0.5, 1.0])
    corners[twice] = corners[rng.permutation(n)[: twice.sum()]]
    return corners


def certificates_of(renderer: Renderer) -> CertificateStore | None:
    """The certificates of cells that a renderer has made, if any."""
    method = renderer.state.method("certified")
    return method.store if isinstance(method, CertifiedCells) else None
