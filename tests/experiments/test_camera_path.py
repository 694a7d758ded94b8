"""Films take the frames of a path, or go evenly through their stops."""

from __future__ import annotations

import numpy as np
import pytest

from tests.tracing.worlds import scene
from tracer.experiments.camera_path import Stop, Take, along_path, through
from tracer.scene.model import Camera

FORWARD = (0.0, 0.0, -1.0)


def stop(x: float, z: float, time: float = 0.0, direction: tuple[float, float, float] = FORWARD) -> Stop:
    return Stop(time, Camera((x, 1.0, z), direction, (0.0, 1.0, 0.0), 40.0))


def test_the_frames_of_a_path_know_their_numbers():
    eleven = scene(frames=11, time_range=(0.0, 10.0))
    takes = along_path(eleven, 3, 6)
    assert takes == [Take(float(n), None, n) for n in range(3, 7)]
    resampled = along_path(eleven, 0, 10, 5)
    assert [take.time for take in resampled] == [0.0, 2.5, 5.0, 7.5, 10.0]
    assert {take.number for take in resampled} == {None}
    for first, last in ((-1, 3), (4, 3), (0, 11)):
        with pytest.raises(ValueError, match="frame numbers are 0 to 10"):
            along_path(eleven, first, last)


def test_each_frame_goes_on_as_far():
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


def test_nothing_is_lost_where_cameras_look_opposite_ways_or_nothing_moves():
    for stops in ([stop(0, 0), stop(1, 0, 1.0, (0.0, 0.0, 1.0))], [stop(0, 0), stop(0, 0, 4.0)]):
        takes = through(stops, 30)
        for take in takes:
            assert np.isfinite([take.time, *take.camera.position, *take.camera.basis().ravel()]).all()
        assert np.all(np.diff([take.time for take in takes]) > 0.0)
    with pytest.raises(ValueError, match="two of them"):
        through([stop(0, 0)], 30)
    with pytest.raises(ValueError, match="a film has 2 to"):
        through([stop(0, 0), stop(1, 0)], 1)
