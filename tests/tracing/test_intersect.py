"""Rays on triangles, spheres and cones, against analytic answers."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import tracer
from tests.tracing.random_worlds import quickly
from tests.tracing.worlds import affine, quadrics, scene
from tracer.scene.model import CONE, SPHERE


def hits_of(world, origins, directions, **interval):
    return world.closest_hits(tracer.RayBatch(origins, directions, **interval), threads=1)


def test_a_ray_hits_the_middle_of_a_triangle_at_its_weights():
    world = tracer.World(scene([[[0, 0, 0], [1, 0, 0], [0, 1, 0]]]))
    hits = hits_of(world, [[0.25, 0.5, 2]], [[0, 0, -4]])
    assert (hits.t[0], hits.u[0], hits.v[0], hits.primitive[0]) == (0.5, 0.25, 0.5, 0)


@pytest.mark.parametrize("t_min, t_max, found", [(0, 10, True), (2, 10, False), (0, 2, False), (0, 2.01, True)])
def test_the_interval_of_t_is_open(t_min, t_max, found):
    world = tracer.World(scene([[[0, 0, 0], [1, 0, 0], [0, 1, 0]]]))
    rays = tracer.RayBatch([[0.2, 0.2, 2]], [[0, 0, -1]], t_min, t_max)
    assert (world.closest_hits(rays, 1).primitive[0] == 0) == found
    assert world.any_hits(rays, 1)[0] == found


@quickly(60, shrink=True)
@given(
    st.lists(st.floats(-3, 3), min_size=3, max_size=3),
    st.floats(0.01, 5),
    st.lists(st.floats(-1, 1), min_size=3, max_size=3),
)
def test_sphere_hits_lie_on_the_sphere(centre, radius, aim):
    """A ray aimed at an inner point of a sphere from outside hits where the quadratic says."""
    centre, aim = np.array(centre), np.array(aim) * 0.5 / np.sqrt(3)
    origin = np.array([0.0, 0.0, 20.0])
    direction = centre + aim * radius - origin
    direction /= np.linalg.norm(direction)
    world = tracer.World(scene(static_quadrics=quadrics([(SPHERE, affine(radius, centre), (1, 1))])))
    hits = hits_of(world, [origin], [direction])
    o, d = origin.astype(np.float32).astype(float) - centre, direction.astype(np.float32).astype(float)
    b, c = o @ d, o @ o - radius**2
    expected = (-b - np.sqrt(b * b - (d @ d) * c)) / (d @ d)
    assert hits.t[0] == pytest.approx(expected, rel=2e-5)


def test_from_inside_a_sphere_the_far_side_is_hit():
    world = tracer.World(scene(static_quadrics=quadrics([(SPHERE, affine(2.0), (1, 1))])))
    assert hits_of(world, [[0, 0, 0]], [[0, 1, 0]]).t[0] == pytest.approx(2.0)


@pytest.mark.parametrize(
    "origin, direction, expected",
    [
        ((-5, 0, 0.5), (1, 0, 0), 5 - 0.75),  # half way up, between radii 1 and 0.5
        ((0, 0, 0.5), (1, 0, 0), 0.75),  # from inside
        ((-5, 0, 1.5), (1, 0, 0), np.inf),  # over the top
        ((0, 0, 5), (0, 0, -1), np.inf),  # along the axis: it is open
        ((0.75, 0, 5), (0, 0, -1), 4.5),  # parallel to the axis, through the slanted side
    ],
)
def test_cones_are_open_and_end(origin, direction, expected):
    world = tracer.World(scene(static_quadrics=quadrics([(CONE, affine(), (1.0, 0.5))])))
    assert hits_of(world, [origin], [direction]).t[0] == pytest.approx(expected, rel=1e-5)


def test_a_stretched_sphere_is_an_ellipsoid():
    stretch = np.diag([3.0, 1.0, 1.0])
    world = tracer.World(
        scene(static_quadrics=quadrics([(SPHERE, np.concatenate([stretch, np.zeros((3, 1))], 1), (1, 1))]))
    )
    assert hits_of(world, [[10, 0, 0], [0, 10, 0]], [[-1, 0, 0], [0, -1, 0]]).t == pytest.approx([7.0, 9.0])


def test_triangles_without_area_are_never_hit():
    world = tracer.World(scene([[[0, 0, 0]] * 3, [[0, 0, 0], [1, 1, 0], [2, 2, 0]]]))
    rng = np.random.default_rng(0)
    origins, targets = rng.normal(size=(200, 3)) * 3, rng.random((200, 3)) * [2, 2, 0]
    assert (hits_of(world, origins, targets - origins).primitive == -1).all()
