"""Where the fast structure and the kd-tree answer differently, exact arithmetic says that both may.

Rays of nasty scenes aim at triangles, half of them at edges and corners.  A triangle of the fast structure is larger by
EDGE of itself, and either structure rounds.  None may claim a triangle that is missed by more, nor pass one that is hit
by more than rounding.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pytest

from tests.tracing.exact import Exact, cross, dot, exact, minus
from tests.tracing.nasty_worlds import nasty_walk
from tracer.geometry.rays import MISS, ray_batch
from tracer.geometry.triangle_test import EDGE
from tracer.geometry.world import World

ROUNDING = 8 * 2.0**-24  # of a triple product, in sizes of its vectors
RAYS = 400  # from each place
STRUCTURES = ("bvh8", "kdtree")


class Crossing(NamedTuple):
    """Where a line crosses a triangle's plane, exactly: u, v and 1 - u - v with the error of each, t with its own."""

    inside: tuple[tuple[float, float], ...]
    t: float
    t_error: float

    @property
    def may_hit(self) -> bool:
        return all(value >= -(float(EDGE) + error) for value, error in self.inside)

    @property
    def may_miss(self) -> bool:
        return any(value <= error for value, error in self.inside)


def length(a: Exact) -> float:
    return float(np.linalg.norm([float(x) for x in a]))


def crossing(origin: np.ndarray, direction: np.ndarray, corners: np.ndarray) -> Crossing | None:
    """Where a ray crosses the plane of a triangle (3, 3); None where it lies in that plane, up to rounding."""
    o, d, a, b, c = exact(origin, direction, *corners)
    e1, e2, s = minus(b, a), minus(c, a), minus(o, a)
    normal, q = cross(e1, e2), cross(s, d)
    det = -dot(d, normal)
    sizes, away = length(e1) * length(e2), length(s)
    if abs(det) <= ROUNDING * length(d) * sizes:
        return None
    u, v, t = (x / det for x in (dot(e2, q), -dot(e1, q), dot(s, normal)))
    unit = ROUNDING / abs(det)
    of_det = unit * length(d) * sizes
    of_u = unit * away * length(d) * length(e2) + abs(u) * of_det
    of_v = unit * away * length(d) * length(e1) + abs(v) * of_det
    inside = (u, of_u), (v, of_v), (1.0 - u - v, of_u + of_v)
    return Crossing(inside, t, unit * away * sizes + abs(t) * of_det)


@pytest.mark.parametrize("seed", range(6))
def test_only_rounding_and_the_larger_triangles_of_the_fast_structure_tell_them_apart(seed: int) -> None:
    walk, rng = nasty_walk(seed), np.random.default_rng(seed)
    corners = walk.scene.objects[0].triangles.corners
    worlds = [World(walk.scene, 0.0, name) for name in STRUCTURES]
    for _, camera in walk.frames[:3]:
        start = np.asarray(camera.position, np.float32)
        shares = rng.dirichlet((0.5, 0.5, 0.5), RAYS)
        shares[::2, 0] = 0.0  # on an edge
        shares /= shares.sum(axis=1, keepdims=True)
        aims = (corners[rng.integers(len(corners), size=RAYS)] * shares[..., None]).sum(axis=1)
        ways = (aims - start).astype(np.float32)
        rays = ray_batch(np.repeat(start[None], RAYS, 0), ways, 0.0, np.inf)
        hits = [world.closest_hits(rays) for world in worlds]
        for i in np.flatnonzero(hits[0].primitive != hits[1].primitive):
            claims = sorted(
                (float(found.t[i]), int(found.primitive[i])) for found in hits if found.primitive[i] != MISS
            )
            if any(primitive >= len(corners) for _, primitive in claims):
                continue  # a sphere or a cone, or something that moves
            found = [crossing(start, ways[i], corners[primitive]) for _, primitive in claims]
            for one in found:
                assert one is None or one.may_hit, (i, claims, one)
            nearest, *others = found
            if nearest is None or None in others:
                continue
            same = any(abs(one.t - nearest.t) <= one.t_error + nearest.t_error for one in others)
            assert same or nearest.may_miss, (i, claims, found)
