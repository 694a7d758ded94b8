"""Moving a camera leaves it a camera, and moves it as a hand would expect."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tracer.scene.model import Camera
from viewer.state import navigation as nav

UP = np.array([0.0, 1.0, 0.0])
HOME = Camera((0.0, 1.0, 5.0), (0.0, 0.0, -1.0), (0.0, 1.0, 0.0), 60.0)
angles = st.floats(-10.0, 10.0)
pivots = st.tuples(st.floats(-5, 5), st.floats(-5, 5), st.floats(-5, 4))


HEIGHT = 2.0 * 5.0 * math.tan(math.radians(30.0))  # of what is seen 5 units away


@pytest.mark.parametrize(
    ("moved", "position", "direction"),
    [
        (nav.fly(HOME, right=1.0, up=2.0, forward=3.0, world=UP), (1.0, 3.0, 2.0), HOME.direction),
        (nav.look(HOME, math.pi / 2, 0.0, UP), HOME.position, (1.0, 0.0, 0.0)),
        (nav.look(HOME, 0.0, 0.5, UP), HOME.position, (0.0, math.sin(0.5), -math.cos(0.5))),
        (nav.orbit(HOME, (0.0, 1.0, 0.0), math.pi / 2, 0.0, UP), (-5.0, 1.0, 0.0), (1.0, 0.0, 0.0)),
        (nav.pan(HOME, 0.25, 0.5, distance=5.0), (-0.25 * HEIGHT, 1.0 - 0.5 * HEIGHT, 5.0), HOME.direction),
        (nav.focus(HOME, HOME.position, 1.0, UP), HOME.position, HOME.direction),
        (nav.focus(HOME, (0.0, 1.0, 0.0), 0.2, UP), (0.0, 1.0, 0.6 / math.tan(math.radians(30.0))), HOME.direction),
    ],
)
def test_a_camera_moves_as_the_hand_does(moved: Camera, position: tuple[float, ...], direction: tuple[float, ...]):
    assert moved.position == pytest.approx(position, abs=1e-12)
    assert moved.direction == pytest.approx(direction, abs=1e-12)


@given(angles, angles)
def test_looking_never_passes_straight_up_or_down(right, up):
    camera = nav.look(nav.look(HOME, right, up, UP), right, up, UP)
    steepness = math.degrees(math.asin(min(1.0, abs(camera.basis()[2] @ UP))))
    assert steepness < 89.1
    assert camera.basis() @ camera.basis().T == pytest.approx(np.eye(3), abs=1e-9)


def test_from_straight_down_the_way_back_is_open():
    down = Camera((0.0, 5.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, -1.0))
    assert nav.look(down, 0.0, 0.3, UP).basis()[2][1] > -0.97
    assert nav.look(down, 0.0, -0.3, UP).direction == pytest.approx((0.0, -1.0, 0.0))


@given(pivots, angles, angles)
def test_orbiting_keeps_the_distance_and_the_pivots_place_in_the_picture(pivot, right, up):
    camera = nav.orbit(HOME, pivot, right, up, UP)
    assert math.dist(camera.position, pivot) == pytest.approx(math.dist(HOME.position, pivot))
    before = HOME.basis() @ np.subtract(pivot, HOME.position)
    after = camera.basis() @ np.subtract(pivot, camera.position)
    assert after == pytest.approx(before, abs=1e-6)


@given(st.floats(-30.0, 60.0))
def test_a_dolly_never_reaches_its_pivot(notches):
    camera = nav.dolly(HOME, (0.0, 1.0, 0.0), notches)
    assert camera.position[2] > 0.0


def test_the_worlds_up_is_an_axis_where_the_camera_is_nearly_upright():
    assert nav.world_up(Camera((0, 0, 0), (1, 0, 0), (0.05, 0.1, 1.0))) == pytest.approx((0, 0, 1))
    tilted = nav.world_up(Camera((0, 0, 0), (1, 0, 0), (0.0, 1.0, 1.0)))
    assert tilted == pytest.approx((0, math.sqrt(0.5), math.sqrt(0.5)))


def test_the_pace_follows_the_scenes_size():
    small, large = nav.pace((0, 0, 0), (1, 1, 1)), nav.pace((0, 0, 0), (100, 100, 100))
    assert large == pytest.approx(100 * small)
    assert nav.pace((0, 0, 0), (0, 0, 0)) == 1.0
    room_in_a_plain = nav.pace((-1000, 0, -1000), (1000, 5, 1000), seen=4.0)
    assert room_in_a_plain == pytest.approx(1.0)


def test_a_flight_turns_at_an_even_pace_even_to_the_opposite_side():
    start = Camera((0.0, 0.0, 0.0), (0.0, 0.0, -1.0))
    there = nav.orbit(HOME, (0.0, 0.0, 0.0), 1.0, 0.3, UP)
    assert nav.blend(HOME, there, 0.0).position == pytest.approx(HOME.position) and nav.blend(HOME, there, 1.0) == there
    for end in (replace(start, direction=(1.0, 0.0, 0.0)), replace(start, direction=(0.0, 0.0, 1.0))):
        ways = [nav.blend(start, end, t).basis()[2] for t in np.linspace(0.0, 1.0, 21)]
        steps = [math.acos(min(1.0, float(a @ b))) for a, b in pairwise(ways)]
        assert max(steps) < 0.15 * sum(steps) and sum(steps) == pytest.approx(math.acos(float(ways[0] @ ways[-1])))
        assert all(abs(float(way[1])) < 1e-9 for way in ways), "the horizon stays level"


def test_a_longer_way_takes_longer_and_none_takes_long():
    start = Camera((0.0, 0.0, 0.0), (0.0, 0.0, -1.0))
    times = [nav.flight_seconds(start, replace(start, position=(x, 0.0, 0.0)), 1.0) for x in (0.0, 1.0, 5.0, 1e9)]
    assert times == sorted(times) and times[0] == nav.SHORTEST_FLIGHT and times[-1] == pytest.approx(nav.LONGEST_FLIGHT)
    assert nav.flight_seconds(start, replace(start, direction=(0.0, 0.0, 1.0)), 1.0) > times[0]
