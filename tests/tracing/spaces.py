"""Stores of voxels and of cells that are settled, and a search of all triangles for what lights meet."""

from __future__ import annotations

import numpy as np

from tracer.culling.rest import nothing_rests
from tracer.culling.shadow_testing import LIGHT_MARGIN
from tracer.geometry.world import World
from tracer.neighbours.environments.store import EnvironmentStore
from tracer.neighbours.voxels.store import VoxelStore
from tracer.scene.lights import Lamps, LampTable, Light


def voxel_store(world: World, lights: np.ndarray, memory: float = 3e6, by_ray: bool = True) -> VoxelStore:
    """Voxels that are classified for point lights (n, 3)."""
    store = VoxelStore(world, len(lights), 1, memory, by_ray)
    table = LampTable(tuple(Light(f"light {i}", (0.0, 0.0, 0.0)) for i in range(len(lights))))
    store.update(table.at(np.asarray(lights, np.float64)), nothing_rests(len(world.scene.objects)))
    store.classify(np.inf, 1)
    return store


def crossed_by(rows: np.ndarray, light: np.ndarray, ends: np.ndarray) -> np.ndarray:
    """(n,) bool: whether segments from a light to ends (n, 3) cross any of triangles (t, 9), in float64."""
    crossed = np.zeros(len(ends), np.bool_)
    way = ends - light
    for row in rows.astype(np.float64):
        a, e1, e2 = row[:3], row[3:6], row[6:]
        normal, s = np.cross(e1, e2), light - a
        d, t = -way @ normal, s @ normal
        sign = np.where(d < 0, -1.0, 1.0)
        u, v = sign * (way @ np.cross(e2, s)), sign * (way @ np.cross(s, e1))
        d, t = np.abs(d), sign * t
        crossed |= (d > 0) & (u >= 0) & (v >= 0) & (u + v <= d) & (t > LIGHT_MARGIN * d) & (t < d)
    return crossed


def point_lamps(places: np.ndarray) -> Lamps:
    table = LampTable(tuple(Light(f"light {i}", (0.0, 0.0, 0.0)) for i in range(len(places))))
    return table.at(np.asarray(places, np.float64))


def environment_store(world: World, lamps: Lamps, points: np.ndarray, memory: float = 3e7) -> EnvironmentStore:
    """Cells that are settled around points (n, 3)."""
    store = EnvironmentStore(world, lamps, 1, memory, True)
    store.update(lamps, nothing_rests(len(world.scene.objects)))

    def want() -> None:
        store.tree.wanted[store.tree.leaves_at(points)] = True

    store.work(want, np.inf)
    return store
