"""Camera and time, moved by hand, glided and played."""

from __future__ import annotations

from dataclasses import replace

import pytest

from tests.viewer.fakes import Clock, make_frame, make_scene
from tracer.scene.model import Camera
from viewer.services.controller import Controller
from viewer.services.motion import IDLE_AFTER
from viewer.state.navigation import SHORTEST_FLIGHT

ELSEWHERE = Camera((1.0, 2.0, 3.0), (0.0, 0.0, -1.0))


def test_a_glide_ends_where_it_goes_and_a_hand_ends_it(clock: Clock, c: Controller):
    start = c.session.camera
    for halt in (False, True):
        c.session.change(camera=start)
        c.motion.glide(ELSEWHERE)
        clock.now += 0.5 * SHORTEST_FLIGHT
        c.move()
        assert c.session.camera not in (start, ELSEWHERE) and c.motion.under_way
        if halt:
            c.motion.move(start)
            clock.now += IDLE_AFTER
            assert not c.motion.under_way, "a hand that moves the camera is motion for a moment"
        clock.now += 3600.0  # though the window slept on the way
        c.move()
        assert c.session.camera == (start if halt else ELSEWHERE)


def test_time_is_played_as_it_passes_or_frame_by_frame(clock: Clock, c: Controller):
    session, motion = c.session, c.motion
    c.preferences.playback_rate = 2.0
    motion.toggle_play()
    clock.now += 0.1
    c.move()
    assert session.time == pytest.approx(0.2) and motion.under_way
    session.go_to_frame(0)
    session.set_pace(every_frame=True)
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
    assert c.notices.current.text == "this scene has no animation" and not session.playing


def test_the_pace_is_that_of_the_first_frame_until_another_scene(c: Controller):
    motion, frame = c.motion, make_frame()
    motion.enter(((-80.0, -80.0, -80.0), (80.0, 80.0, 80.0)))
    wide = motion.pace
    motion.look_around(frame)
    assert motion.pace == pytest.approx(2.0 * 2.0 / 8.0) and motion.pace < wide, "all that is seen is 2 units away"
    motion.look_around(replace(frame, depth=frame.depth * 100.0))
    assert motion.pace == pytest.approx(0.5)
    motion.enter(((-80.0, -80.0, -80.0), (80.0, 80.0, 80.0)))
    assert motion.pace == wide
