"""A session comes back from its snapshot, and refuses what is none."""

from __future__ import annotations

import json
from dataclasses import replace

import pytest

from tests.viewer.fakes import make_scene
from tracer.frame import Settings
from tracer.scene.model import Camera
from viewer.state.session import Session, Snapshot
from viewer.state.views import View


def session_somewhere() -> Session:
    session = Session(settings=Settings(method="none", zoom_factor=7.5, symmetric=True, depth=3))
    session.open(make_scene())
    session.time = 4.0
    session.move(Camera((1.0, 2.0, 3.0), (0.0, 0.6, -0.8), (0.0, 0.8, 0.6), 33.0))
    session.view, session.light, session.wipe = View.SHADOW, 2, 0.25
    return session


def test_a_snapshot_survives_json_and_brings_everything_back():
    first = session_somewhere()
    text = json.dumps(first.snapshot().to_json())
    second = Session(settings=Settings(width=99))
    second.open(make_scene())
    second.restore(Snapshot.from_json(json.loads(text)))
    assert second.camera == first.camera
    assert (second.time, second.view, second.light, second.follow) == (4.0, View.SHADOW, 2, False)
    assert second.wipe == 0.25
    assert second.settings == replace(first.settings, width=99)


@pytest.mark.parametrize(("kept", "wipe"), [({}, 0.5), ({"wipe": 7}, 0.5), ({"wipe": float("nan")}, 0.5)])
def test_a_wipe_that_lies_nowhere_is_in_the_middle(kept, wipe):
    data = session_somewhere().snapshot().to_json()
    del data["wipe"]
    assert Snapshot.from_json(data | kept).wipe == wipe


def test_what_belongs_to_this_machine_is_not_kept():
    session = session_somewhere()
    session.settings = replace(session.settings, certificate_seconds=0.05, threads=3)
    kept = session.snapshot().to_json()["settings"]
    assert kept["method"] == "none" and kept["zoom_factor"] == 7.5
    assert not {"certificate_seconds", "certificates", "threads", "width", "record_work"} & set(kept)


@pytest.mark.parametrize("radius", [None, 0.0, 2, 0.25])
@pytest.mark.parametrize("samples", [None, 64])
def test_lamps_are_restored(radius, samples):
    session = session_somewhere()
    session.settings = replace(session.settings, lamp_radius=radius, lamp_samples=samples)
    session.restore(Snapshot.from_json(json.loads(json.dumps(session.snapshot().to_json()))))
    assert (session.settings.lamp_radius, session.settings.lamp_samples) == (radius, samples)


@pytest.mark.parametrize(
    "wrong", [{"lamp_radius": -1.0}, {"lamp_radius": "wide"}, {"lamp_samples": 2.5}, {"depth": None}]
)
def test_settings_that_are_none_are_refused(wrong):
    data = session_somewhere().snapshot().to_json()
    with pytest.raises(ValueError, match=next(iter(wrong))):
        Snapshot.from_json(data | {"settings": data["settings"] | wrong})


def test_following_is_restored_as_following():
    session = session_somewhere()
    session.free_camera = None
    other = Session()
    other.open(make_scene())
    other.move(Camera((9, 9, 9), (0, 0, 1)))
    other.restore(Snapshot.from_json(session.snapshot().to_json()))
    assert other.follow


@pytest.mark.parametrize(
    ("broken", "told"),
    [
        (None, "no saved state"),
        ({}, "lacks"),
        ({"camera": 5}, "camera"),
        ({"settings": {"zoom_factor": -1.0}}, "zoom_factor"),
        ({"settings": {"depth": "deep"}}, "depth"),
        ({"settings": [1]}, "settings"),
        ({"view": "smell"}, "smell"),
        ({"time": None}, "damaged"),
    ],
)
def test_damaged_snapshots_are_refused_in_one_line(broken, told):
    data = session_somewhere().snapshot().to_json()
    data = {} if broken == {} else None if broken is None else data | broken
    with pytest.raises(ValueError, match=told) as caught:
        Snapshot.from_json(data)
    assert "\n" not in str(caught.value)


def test_time_goes_round_or_stops_at_the_end():
    session = Session()
    session.open(make_scene())
    session.playing = True
    session.time = 9.5
    session.advance(1.0, loop=True)
    assert session.time == pytest.approx(0.5) and session.playing
    session.time = 9.5
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


def test_without_a_scene_there_is_a_camera_but_no_snapshot():
    session = Session()
    assert session.camera.angle > 0
    with pytest.raises(ValueError, match="no scene"):
        session.snapshot()
