"""Every ray against every primitive, by the tracer's own intersectors and without any tree.

Twins that must agree to the last bit ask here: an intersector of their own would round otherwise and,
where a ray passes along an edge, decide otherwise.  That the intersectors themselves are right,
test_intersect.py and test_world.py show against float64.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

import tracer
from tracer.geometry.intersect import hit_quadric, hit_triangle, transform_ray
from tracer.geometry.memory import data_pointer
from tracer.geometry.rays import INFINITY, Ray, Rays
from tracer.runtime.kernels import inlined, kernel


@inlined
def ray_in(rays, i):
    """The i-th ray of a batch."""
    o, d = rays.origin, rays.direction
    return Ray(o[0, i], o[1, i], o[2, i], d[0, i], d[1, i], d[2, i], rays.t_min[i], rays.t_max[i])


@kernel
def _meet_all(placed, rays, t, u, v):
    """Into t, u and v (rays, primitives) float32: where each ray meets each primitive; t = inf for a miss."""
    triangles, quadrics, to_object = (
        data_pointer(placed.triangles),
        data_pointer(placed.quadrics),
        data_pointer(placed.to_object),
    )
    flat = len(placed.triangles)
    for i in range(len(rays.t_min)):
        for primitive in range(len(placed.object_of)):
            ray, owner = ray_in(rays, i), placed.object_of[primitive]
            if owner != 0:
                ray = transform_ray(ray, to_object, owner, 12)
            if primitive < flat:
                t[i, primitive], u[i, primitive], v[i, primitive] = hit_triangle(ray, triangles, primitive)
            else:
                t[i, primitive] = hit_quadric(ray, quadrics, primitive - flat)


@dataclass(frozen=True)
class Meetings:
    """Where n rays meet p primitives: t, u and v (n, p) float32, t = inf for a miss."""

    t: np.ndarray
    u: np.ndarray
    v: np.ndarray

    def closest(self) -> np.ndarray:
        """(n,) the nearest primitive, of equally near ones the first; -1 for a miss."""
        return np.where(np.isfinite(self.t).any(axis=1), self.t.argmin(axis=1), -1)


def meet_all(world: tracer.World, rays: Rays, there: np.ndarray) -> Meetings:
    """Rays against all primitives that are `there`, (p,) bool."""
    shape = len(rays.t_min), len(there)
    t, u, v = np.full(shape, INFINITY), np.zeros(shape, np.float32), np.zeros(shape, np.float32)
    if t.size:
        _meet_all(world.placed, rays, t, u, v)
    t[:, ~there] = INFINITY
    return Meetings(t, u, v)


def primitives_there(scene: tracer.Scene, time: float) -> np.ndarray:
    """(p,) bool: which primitives are visible at a time."""
    owners = [scene.object_of(primitive) for primitive in range(scene.primitive_count)]
    visible = [index == 0 or scene.animation.visible(item.chain, time) for index, item in enumerate(scene.objects)]
    return np.array([visible[owner] for owner in owners], np.bool_)
