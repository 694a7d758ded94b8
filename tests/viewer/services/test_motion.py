"""Camera and time, moved by hand, glided and played."""

from __future__ import annotations

from dataclasses import replace

import pytest

from tests.viewer.fakes import Moving, make_frame, make_scene
from tracer.scene.model import Camera
from viewer.services.motion import IDLE_AFTER
from viewer.state.navigation import SHORTEST_FLIGHT

ELSEWHERE = Camera((1.0, 2.0, 3.0), (0.0, 0.0, -1.0))


@pytest.fixture
def moving(monkeypatch: pytest.MonkeyPatch) -> Moving:
    return Moving(monkeypatch)


def test_a_glide_ends_where_it_goes_and_a_hand_ends_it(moving: Moving):
    start = moving.session.camera
    for halt in (False, True):
        moving.session.change(camera=start)
        moving.motion.glide(ELSEWHERE)
        moving.after(0.5 * SHORTEST_FLIGHT)
        assert moving.session.camera not in (start, ELSEWHERE) and moving.motion.under_way
        if halt:
            moving.motion.move(start)
            moving.now += IDLE_AFTER
            assert not moving.motion.under_way, "a hand that moves the camera is motion for a moment"
        moving.after(3600.0)  # though the window slept on the way
        assert moving.session.camera == (start if halt else ELSEWHERE)


def test_time_is_played_as_it_passes_or_frame_by_frame(moving: Moving):
    session, motion = moving.session, moving.motion
    moving.preferences.playback_rate = 2.0
    motion.toggle_play()
    moving.after(0.1)
    assert session.time == pytest.approx(0.2) and motion.under_way
    session.go_to_frame(0)
    moving.session.set_pace(every_frame=True)
    motion.advance(None)
    assert session.frame == 0 and motion.is_animating and not motion.under_way, "this frame has not been traced yet"
    motion.advance(session.time)
    assert session.frame == 1
    motion.step(-1)
    assert session.frame == 0 and not session.playing
    session.go_to_frame(session.scene.frames - 1)
    motion.toggle_play()
    assert session.frame == 0, "played from the beginning once the end is reached"
    session.open(make_scene(frames=1))
    session.playing = False
    motion.toggle_play()
    assert moving.notices.current.text == "this scene has no animation" and not session.playing


def test_nothing_moves_while_it_is_locked(moving: Moving):
    session, before = moving.session, (moving.session.camera, moving.session.time)
    moving.locked = True
    moving.motion.move(ELSEWHERE)
    moving.motion.glide(ELSEWHERE)
    moving.motion.follow_path(False)
    moving.motion.step(1)
    moving.motion.toggle_play()
    moving.motion.advance(None)
    assert (session.camera, session.time) == before and session.on_path and not session.playing


def test_the_pace_is_that_of_the_first_frame_until_another_scene(moving: Moving):
    motion, frame = moving.motion, make_frame()
    motion.enter(((-80.0, -80.0, -80.0), (80.0, 80.0, 80.0)))
    wide = motion.pace
    motion.look_around(frame)
    assert motion.pace == pytest.approx(2.0 * 2.0 / 8.0) and motion.pace < wide, "all that is seen is 2 units away"
    motion.look_around(replace(frame, depth=frame.depth * 100.0))
    assert motion.pace == pytest.approx(0.5)
    motion.enter(((-80.0, -80.0, -80.0), (80.0, 80.0, 80.0)))
    assert motion.pace == wide
