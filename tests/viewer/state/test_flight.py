"""Flights go through their bookmarks, evenly, and never lose their balance."""

from __future__ import annotations

import numpy as np
import pytest

from tests.viewer.fakes import make_scene
from tracer.scene.model import Camera
from viewer.state.flight import Stop, Take, along_path, through

FORWARD = (0.0, 0.0, -1.0)


def stop(x: float, z: float, time: float = 0.0, direction: tuple[float, float, float] = FORWARD) -> Stop:
    return Stop(time, Camera((x, 1.0, z), direction, (0.0, 1.0, 0.0), 40.0))


def test_the_frames_of_a_path_know_how_many_come_before() -> None:
    scene = make_scene(frames=11)
    takes = along_path(scene, 3, 6)
    assert takes == [Take(scene.frame_time(3 + i), None, i, 3 + i) for i in range(4)]
    resampled = along_path(scene, 0, 10, 5)
    assert [take.time for take in resampled] == [0.0, 2.5, 5.0, 7.5, 10.0]
    assert {take.warmup for take in resampled} == {None}
    for first, last in ((-1, 3), (4, 3), (0, 11)):
        with pytest.raises(ValueError, match="frame numbers are 0 to 10"):
            along_path(scene, first, last)


def test_each_frame_goes_on_as_far() -> None:
    stops = [stop(0, 0), stop(1, 0, 2.0), stop(1, 7, 3.0), stop(4, 9, 8.0)]
    takes = through(stops, 200)
    places = np.array([take.camera.position for take in takes])
    steps = np.linalg.norm(np.diff(places, axis=0), axis=1)
    assert steps.max() / steps.min() < 1.02, "an even speed, though the bookmarks are unevenly apart"
    for each in stops:
        assert np.linalg.norm(places - each.camera.position, axis=1).min() < 0.6 * steps.max()
    assert (takes[0].camera, takes[0].time) == (stops[0].camera, 0.0)
    assert (takes[-1].camera, takes[-1].time) == (stops[-1].camera, 8.0)
    assert (np.diff([take.time for take in takes]) >= 0.0).all(), "time never runs back"


def test_turning_in_place_is_even_too() -> None:
    angles = np.radians([0.0, 10.0, 150.0])
    takes = through([stop(0, 0, 0.0, (float(np.sin(a)), 0.0, -float(np.cos(a)))) for a in angles], 60)
    views = np.array([take.camera.basis()[2] for take in takes])
    assert np.allclose(np.linalg.norm([take.camera.direction for take in takes], axis=1), 1.0, atol=1e-2)
    turns = np.degrees(np.arccos(np.clip((views[1:] * views[:-1]).sum(axis=1), -1.0, 1.0)))
    assert turns.max() / turns.min() < 1.05


def test_nothing_is_lost_where_cameras_look_opposite_ways_or_nothing_moves() -> None:
    for stops in ([stop(0, 0), stop(1, 0, 1.0, (0.0, 0.0, 1.0))], [stop(0, 0), stop(0, 0, 4.0)]):
        takes = through(stops, 30)
        for take in takes:
            assert np.isfinite([take.time, *take.camera.position, *take.camera.basis().ravel()]).all()
        assert np.all(np.diff([take.time for take in takes]) > 0.0)
    with pytest.raises(ValueError, match="two of them"):
        through([stop(0, 0)], 30)
    with pytest.raises(ValueError, match="a film has 2 to"):
        through([stop(0, 0), stop(1, 0)], 1)
