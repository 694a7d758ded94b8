"""Batches of rays that keep all kinds of company."""

from __future__ import annotations

import numpy as np

import tracer
from tracer.geometry.rays import Rays


def shoals(rng: np.random.Generator, n: int) -> dict[str, Rays]:
    """Rays through the unit cube: n of each of some kinds of company."""
    origins, targets = rng.normal(size=(n, 3)) + 0.5, rng.random((n, 3))
    eye, step = np.broadcast_to(origins[0], (n, 3)), rng.normal(size=3)
    grid = (np.stack(np.mgrid[:n, :1].reshape(2, -1), axis=1) / n)[:, :1]
    axis = np.eye(3)[rng.integers(3, size=n)] * rng.choice([-1.0, 1.0], (n, 1))
    ends = np.where(rng.random(n) < 0.5, np.inf, rng.uniform(0.2, 1.5, n))
    return {
        "from one point": tracer.RayBatch(eye, targets - eye),
        "from one point to near ones": tracer.RayBatch(eye, 0.5 - eye + 0.3 * grid * step),
        "around a point": tracer.RayBatch(np.full((n, 3), 0.5), rng.normal(size=(n, 3))),
        "side by side": tracer.RayBatch(origins[:1] + 0.2 * grid * targets[:1], 0.5 - eye),
        "along axes": tracer.RayBatch(targets - 3 * axis, axis),
        "along one axis": tracer.RayBatch(targets - [0, 0, 3], np.tile([0.0, 0.0, 1.0], (n, 1))),
        "anywhere": tracer.RayBatch(origins, targets - origins, 1e-5, ends),
        "of all lengths": tracer.RayBatch(origins, (targets - origins) * 10.0 ** rng.uniform(-6, 6, (n, 1))),
    }
