"""What rays to some of a cell's points say of it, as published: wrong now and then, where a shadow falls between them.

Rays go from the light to points that primary rays have hit.  Where all of a cell's are blocked, the light counts as
hidden from the cell, where none is, as lighting all of it.  A cell of which they disagree is divided, and so is a large
one; the smallest cells have what blocked any of their rays for blockers.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tracer.culling.shadow_testing import LIGHT_MARGIN
from tracer.geometry.camera import Pinhole
from tracer.geometry.rays import RAY_OFFSET, ray_batch
from tracer.neighbours.environments.octree import HIDDEN, LIT, UNKNOWN
from tracer.neighbours.environments.store import By, EnvironmentStore, Settle
from tracer.visibility.box_candidates import MOST, Light

if TYPE_CHECKING:
    from tracer.geometry.world import World

SAMPLES, FEWEST = 16, 4  # rays to a cell, at most; with fewer points than that nothing is said of it
COARSEST = 3  # levels above the smallest cells from which on samples that agree are believed
POINTS = 1 << 17  # of a picture, at most


def seen_points(primitive: NDArray[np.int32], depth: NDArray[np.float32], rays: Pinhole) -> NDArray[np.float32]:
    """Points (n, 3) just before what primary rays have hit, by its buffers (h, w), evenly spread over the picture."""
    step = max(1, int(np.ceil(np.sqrt(primitive.size / POINTS))))
    rows, columns = np.nonzero(primitive[::step, ::step] >= 0)
    y, x = step * rows, step * columns
    way = rays.corner + x[:, None] * rays.column + y[:, None] * rays.row
    way /= np.linalg.norm(way, axis=1, keepdims=True)
    far = depth[y, x][:, None]
    points = rays.origin + far * way
    offset = 4 * RAY_OFFSET * np.maximum(far, np.abs(points).max(1, keepdims=True))
    return (points - offset * way).astype(np.float32)


def settle_by_samples(world: World, points: NDArray[np.float32]) -> By:
    """What finds the codes of cells by rays to those of points (n, 3) that lie in them (`EnvironmentStore.work`)."""

    def by(store: EnvironmentStore, cells: NDArray[np.int64]) -> Settle:
        of = store.tree.leaves_at(points)
        order = np.argsort(of, kind="stable")
        sorted_cells = of[order]

        def sampled(
            those: NDArray[np.int64], light: Light, above: NDArray[np.int32]
        ) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
            first = np.searchsorted(sorted_cells, those)
            count = np.searchsorted(sorted_cells, those, side="right") - first
            enough = count >= FEWEST
            # Some of each cell's points, evenly.
            picks = first[:, None] + np.arange(SAMPLES) * np.maximum(count, 1)[:, None] // SAMPLES
            ends = points[order[np.minimum(picks, len(points) - 1)[enough]]].reshape(-1, 3)
            codes, found = np.full(len(those), UNKNOWN, np.int32), np.zeros((len(those), MOST), np.int32)
            if not len(ends):
                return codes, found
            rays = ray_batch(np.broadcast_to(light.place, ends.shape), ends - light.place, LIGHT_MARGIN, 1.0)
            met = world.occluders(rays, threads=1)
            met[world.object_of[np.maximum(met, 0)] != 0] = -1  # what moves is asked in any case
            met = met.reshape(-1, SAMPLES)
            blocked, at = (met >= 0).sum(1), np.flatnonzero(enough)
            level = store.tree.cells[those[at], 3] - store.finest
            codes[at[(blocked == 0) & (level < COARSEST)]] = LIT
            codes[at[(blocked == SAMPLES) & (level < COARSEST)]] = HIDDEN
            disagree = (codes[at] == UNKNOWN) & (level <= 0)
            for cell, row in zip(at[disagree], met[disagree], strict=True):
                names = np.unique(row[row >= 0])
                codes[cell], found[cell, : len(names)] = len(names), names
            return codes, found

        return sampled

    return by
