"""Random rays through the unit cube, and objects that are in it."""

from __future__ import annotations

import numpy as np

import tracer
from tests.tracing.worlds import moved, random_corners
from tracer.geometry.rays import Rays


def random_rays(rng: np.random.Generator, n: int) -> Rays:
    """Rays through the unit cube, some parallel to its sides, some from within, some that end."""
    origins, targets = rng.normal(size=(n, 3)) + 0.5, rng.random((n, 3))
    directions = targets - origins
    directions[: n // 8, rng.integers(3)] = 0.0
    origins[n // 8 : n // 4] = rng.random((n // 4 - n // 8, 3))
    return tracer.RayBatch(origins, directions, 1e-5, np.where(rng.random(n) < 0.5, np.inf, rng.uniform(0.2, 1.5, n)))


def movers(rng: np.random.Generator, count: int, triangles: int = 12) -> tuple[tracer.SceneObject, ...]:
    """Objects in the unit cube, turned and scaled."""
    made = []
    for i in range(count):
        matrix = np.eye(4)
        matrix[:3, :3] = np.linalg.qr(rng.normal(size=(3, 3)))[0] * rng.uniform(0.2, 0.5)
        matrix[:3, 3] = rng.random(3) * 0.8
        made.append(moved(f"part {i}", random_corners(rng, triangles, 0.1), matrix))
    return tuple(made)
