"""Rays of which any hits are asked: with no direction in common, or left by culling once it knows a view."""

from __future__ import annotations

import ctypes
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np

from tests.bench.rays import Points, dot, joined, unit
from tracer.frame import Settings
from tracer.geometry.queries import EVERYTHING, Batch
from tracer.geometry.rays import Rays, ray_batch
from tracer.geometry.world import World
from tracer.renderer import Renderer

LEFT = ("left at 0", "left at 1", "left at 2")  # bounces
ANY_HITS = ("hemisphere", "random order", *LEFT)


def any_hit_rays(world: World, time: float, points: Points, shadow: Rays, size: int, seed: int) -> dict[str, Rays]:
    """Rays from all points over the hemisphere, these shadow rays in random order, and what is left."""
    rng = np.random.default_rng(seed)
    anywhere = unit(rng.normal(size=points.geometric.shape))
    hemisphere = np.where(dot(anywhere, points.geometric) < 0, -anywhere, anywhere)
    shuffled, left = _some(shadow, rng.permutation(len(shadow.t_min))), _left_by_culling(world, time, size)
    return dict(zip(ANY_HITS, (ray_batch(points.lifted(), hemisphere), shuffled, *left), strict=True))


def _some(rays: Rays, which: Any) -> Rays:
    return Rays(*(np.ascontiguousarray(array[..., which]) for array in rays))


def _left_by_culling(world: World, time: float, size: int) -> list[Rays]:
    """The shadow rays that `certified` traces at each bounce, tile by tile; then the world is placed anew."""
    structure: Any = world.structure
    kept: list[Rays] = []

    def keep_rays(data: int, batch: int, first: int, last: int, counts: int) -> None:
        """Ask the structure about rays, and keep them if everything is asked."""
        asked = Batch(*(ctypes.c_int64 * len(Batch._fields)).from_address(batch))
        if asked.which == EVERYTHING:
            at = ((asked.origin, 3), (asked.direction, 3), (asked.t_min, 1), (asked.t_max, 1))
            rows = [(ctypes.c_float * asked.stride * count).from_address(address) for address, count in at]
            o, d, t_min, t_max = (np.array(row)[:, first:last] for row in rows)
            kept.append(ray_batch(o.T, d.T, t_min[0], t_max[0]))
        query.call(data, batch, first, last, counts)

    settings = Settings(size, size, len(LEFT) - 1, method="certified", threads=1, accelerator=world.accelerator)
    renderer = Renderer(world.scene, settings, world=world, thread_clock=lambda: 0.0)  # as if learning took no time
    for _ in range(4):  # by then most is known
        renderer.render(time)
    query, keeping = structure.any_hit, ctypes.CFUNCTYPE(None, *[ctypes.c_int64] * 5)(keep_rays)
    structure.any_hit = SimpleNamespace(address=ctypes.cast(keeping, ctypes.c_void_p).value)
    left, before = [], np.empty(0, "V32")
    for depth in range(len(LEFT)):
        renderer.settings = replace(settings, depth=depth)
        kept.clear()
        renderer.render(time)
        rays = joined(kept)
        known = np.ascontiguousarray(np.vstack(rays).T).view("V32")[:, 0]
        left.append(_some(rays, ~np.isin(known, before)))  # the others are those of earlier bounces
        before = known
    structure.any_hit = query
    world.place(time)
    return left
