"""The way of each ray through the trees, step by step and test by test, against the naive twin."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import tracer
from tests.sweeps import cases
from tests.tracing import brute
from tests.tracing.naive_tree import Line, Traversal
from tests.tracing.random_worlds import END, quickly, scenes
from tests.tracing.rays_and_movers import random_rays
from tests.tracing.worlds import quad, random_corners, scene
from tracer.geometry.queries import batch_of
from tracer.geometry.rays import Hits, Rays


def assert_same_way(world: tracer.World, rays: Rays, there: np.ndarray, edges: bool = False) -> np.ndarray:
    """Answers, steps and tests of both queries, ray by ray; returns the sums (queries, steps and tests).

    Where rays run along `edges`, a hit on one may count or not; nothing else may be lost in the trees.
    """
    n, placed, structure = len(rays.t_min), world.placed, world.structure
    met = brute.meet_all(world, rays, there)
    hits = Hits(np.empty(n, np.float32), np.empty(n, np.int32), np.empty(n, np.float32), np.empty(n, np.float32))
    blocked, sums = np.zeros(n, np.bool_), np.zeros((2, 2), np.int64)
    nearest, whether = batch_of(rays, hits), batch_of(rays, blocked=blocked)
    for i in range(n):
        counts = np.zeros((2, 2), np.int64)
        structure.closest.call(placed.data, nearest.ctypes.data, i, i + 1, counts[0].ctypes.data)
        structure.any_hit.call(placed.data, whether.ctypes.data, i, i + 1, counts[1].ctypes.data)
        line = Line(tuple(rays.origin[:, i]), tuple(rays.direction[:, i]))
        near, whatever = (Traversal(structure.world, line, rays.t_min[i], rays.t_max[i], met.t[i]) for _ in range(2))
        assert (hits.t[i], hits.primitive[i]) == near.closest()
        assert blocked[i] == whatever.any() == (hits.primitive[i] >= 0)
        if edges:
            inside = (met.u[i] > 0) & (met.v[i] > 0) & (met.u[i] + met.v[i] < 1)
            assert hits.t[i] <= met.t[i, inside].min(initial=np.inf)
            assert hits.primitive[i] < 0 or hits.t[i] == met.t[i, hits.primitive[i]]
        else:
            assert (hits.t[i], hits.primitive[i]) == (met.t[i].min(initial=np.inf), met.closest()[i])
        assert counts.tolist() == [[near.steps, near.tests], [whatever.steps, whatever.tests]]
        sums += counts
    return sums


@pytest.mark.parametrize("seed", range(cases(2, 4)))
@pytest.mark.parametrize("n, size", [(20, 0.3), (400, 0.05)])
def test_rays_go_the_naive_twins_way_through_triangles(seed: int, n: int, size: float):
    rng = np.random.default_rng(seed)
    world = tracer.World(scene(random_corners(rng, n, size)), accelerator="kdtree")
    (steps, tests), (any_steps, any_tests) = assert_same_way(world, random_rays(rng, 60), np.ones(n, np.bool_))
    assert steps > any_steps > 0
    assert tests > any_tests > 0


@pytest.mark.parametrize("seed", range(cases(3, 6)))
def test_rays_through_edges_and_corners_go_the_naive_twins_way(seed: int):
    """Squares on a lattice, and rays along its lines and diagonals: they enter and leave nodes at one and the same t,
    and lie in planes that split, and many squares are equally near.  No number here is rounded."""
    rng = np.random.default_rng(seed)
    low, size, axes = rng.integers(0, 8, (60, 3)), 2 ** rng.integers(0, 3, 60), rng.integers(3, size=60)
    corners = []
    for corner, side, axis in zip(low, size, axes, strict=True):
        a, b = np.delete(np.eye(3) * side, axis, axis=0)
        corners += quad(corner, corner + a, corner + a + b, corner + b)
    world = tracer.World(scene(np.array(corners, np.float32)), accelerator="kdtree")
    directions = rng.integers(-1, 2, (80, 3))
    directions[(directions == 0).all(axis=1)] = 1
    origins = rng.integers(0, 8, (80, 3)) - rng.integers(0, 9, (80, 1)) * directions
    sums = assert_same_way(world, tracer.RayBatch(origins, directions), np.ones(120, np.bool_), edges=True)
    assert (sums > 0).all()


def test_rays_go_the_naive_twins_way_through_random_scenes():
    sums = np.zeros((2, 2), np.int64)

    @quickly(12)
    @given(scenes(), st.floats(0.0, END), st.integers(0, 2**32 - 1))
    def check(made: tracer.Scene, time: float, seed: int) -> None:
        nonlocal sums
        world, rng = tracer.World(made, time, "kdtree"), np.random.default_rng(seed)
        there = brute.primitives_there(made, time)
        sums += assert_same_way(world, random_rays(rng, 25), there)
        world.place(time, rng.random(len(made.objects)) < 0.5)
        sums += assert_same_way(world, random_rays(rng, 25), there)

    check()
    assert (sums[0] > sums[1]).all() and (sums > 0).all()
