"""Rays of which any hits are asked and whose directions have little in common, and the very shadow rays that culling
leaves: those that `certified` traces at each bounce, once it knows a view."""

from __future__ import annotations

import ctypes
from dataclasses import replace
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
LEARNING = 4  # frames before those whose rays are kept


def any_hit_rays(world: World, time: float, points: Points, shadow: Rays, size: int, seed: int) -> dict[str, Rays]:
    """Rays from all points over the hemisphere, these shadow rays in random order, and what is left."""
    rng = np.random.default_rng(seed)
    anywhere = unit(rng.normal(size=points.geometric.shape))
    anywhere = np.where(dot(anywhere, points.geometric) < 0, -anywhere, anywhere)
    order = rng.permutation(len(shadow.t_min))
    sets = ray_batch(points.lifted(), anywhere), _some(shadow, order), *_left_by_culling(world, time, size)
    return dict(zip(ANY_HITS, sets, strict=True))


def _some(rays: Rays, which: Any) -> Rays:
    return Rays(*(np.ascontiguousarray(array[..., which]) for array in rays))


class Recorder:
    """Stands for a structure's query of any hits, which it asks, and keeps the rays of which everything is asked."""

    def __init__(self, query: Any) -> None:
        self.query, self.kept = query, list[Rays]()
        self._called = ctypes.CFUNCTYPE(None, *[ctypes.c_int64] * 5)(self._call)
        self.address = ctypes.cast(self._called, ctypes.c_void_p).value

    def _call(self, data: int, batch: int, first: int, last: int, counts: int) -> None:
        asked = Batch(*(ctypes.c_int64 * len(Batch._fields)).from_address(batch))
        if asked.which == EVERYTHING:
            at = ((asked.origin, 3), (asked.direction, 3), (asked.t_min, 1), (asked.t_max, 1))
            rows = [(ctypes.c_float * asked.stride * count).from_address(address) for address, count in at]
            o, d, t_min, t_max = (np.array(row)[:, first:last] for row in rows)
            self.kept.append(ray_batch(o.T, d.T, t_min[0], t_max[0]))
        self.query.call(data, batch, first, last, counts)


def _left_by_culling(world: World, time: float, size: int) -> list[Rays]:
    """What is left at each bounce, tile by tile; the world is placed at that time again."""
    structure: Any = world.structure
    settings = Settings(size, size, len(LEFT) - 1, method="certified", threads=1, accelerator=world.accelerator)
    renderer = Renderer(world.scene, settings, world=world, thread_clock=lambda: 0.0)  # as if learning took no time
    for _ in range(LEARNING):
        renderer.render(time)
    structure.any_hit = recorder = Recorder(structure.any_hit)
    left, before = [], np.empty(0, "V32")
    for depth in range(len(LEFT)):
        recorder.kept, renderer.settings = [], replace(settings, depth=depth)
        renderer.render(time)
        rays = joined(recorder.kept)
        rows = np.vstack([rays.origin, rays.direction, rays.t_min, rays.t_max])
        known = np.ascontiguousarray(rows.T).view("V32")[:, 0]
        left.append(_some(rays, ~np.isin(known, before)))  # the others are those of earlier bounces
        before = known
    structure.any_hit = recorder.query
    world.place(time)
    return left
