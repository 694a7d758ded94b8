"""A session comes back to a state, and goes through time."""

from __future__ import annotations

from dataclasses import replace

import pytest

from tests.viewer.fakes import make_scene
from tracer.frame import Settings
from tracer.scene.model import Camera
from viewer.state.session import Session
from viewer.state.view_state import ViewState
from viewer.state.views import View

AWAY = Camera((1.0, 2.0, 3.0), (0.0, 0.6, -0.8), (0.0, 0.8, 0.6), 33.0)


def session_somewhere() -> Session:
    session = Session(state=ViewState(settings=Settings(method="none", zoom_factor=7.5, symmetric=True, depth=3)))
    session.open(make_scene())
    session.change(time=4.0, camera=AWAY)
    session.set_draw(view=View.SHADOW, light=2, wipe=0.25)
    return session


def test_a_state_brings_everything_back_but_what_belongs_to_the_machine() -> None:
    first, second = session_somewhere(), Session(state=ViewState(settings=Settings(width=99, threads=3)))
    second.open(make_scene())
    second.playing = True
    second.restore(first.state)
    assert (second.camera, second.time, second.draw, second.playing) == (AWAY, 4.0, first.draw, False)
    assert second.settings == replace(first.settings, width=99, threads=3)


def test_a_state_of_another_scene_is_brought_into_this_one() -> None:
    session = Session()
    session.open(make_scene(lights=2))
    session.restore(replace(session_somewhere().state, scene="/gone.aff", time=1e9))
    assert session.time == 10.0 and session.draw.light == 1 and session.state.scene != "/gone.aff"


def test_the_path_is_restored_as_the_path() -> None:
    session = session_somewhere()
    on_path = replace(session.state, camera=None)
    assert not session.on_path and session.camera == AWAY
    session.restore(on_path)
    assert session.on_path and session.camera == session.scene.camera_at(4.0)


def test_time_goes_round_or_stops_at_the_end():
    session = Session()
    session.open(make_scene())
    session.playing = True
    session.change(time=9.5)
    session.advance(1.0, loop=True)
    assert session.time == pytest.approx(0.5) and session.playing
    session.change(time=9.5)
    session.advance(1.0, loop=False)
    assert session.time == 10.0 and not session.playing


def test_frames_are_stepped_one_by_one():
    session = Session()
    session.open(make_scene(frames=11))
    for expected in (1, 2, 3):
        session.advance_frame(loop=False)
        assert (session.frame, session.time) == (expected, pytest.approx(float(expected)))
    session.go_to_frame(99)
    session.playing = True
    session.advance_frame(loop=False)
    assert session.frame == 10 and not session.playing
    session.advance_frame(loop=True)
    assert session.frame == 0


def test_a_still_scene_does_not_play():
    session = Session()
    session.open(make_scene(frames=1))
    session.playing = True
    session.advance(1.0, loop=True)
    assert not session.playing and session.frame == 0


def test_without_a_scene_there_is_a_camera():
    assert Session().camera.angle > 0
