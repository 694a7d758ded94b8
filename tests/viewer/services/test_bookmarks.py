"""Bookmarks: their pictures, names and order."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

from tests.viewer.fakes import make_frame, make_scene
from tracer.scene.model import Camera
from viewer.output.thumbnail import from_text
from viewer.services.bookmarks import Bookmarks
from viewer.services.settings_controller import SettingsController
from viewer.state import codec
from viewer.state.notices import Notices
from viewer.state.preferences import Preferences
from viewer.state.session import Session

AWAY = Camera((1.0, 2.0, 3.0), (0.0, 0.0, -1.0))


class Parts:
    def __init__(self) -> None:
        self.preferences, notices = Preferences(), Notices()
        self.session = Session(state=codec.recalled({}))
        self.session.open(make_scene())
        self.settings = SettingsController(self.session, self.preferences, notices, lambda: False)
        self.marks = Bookmarks(self.session, self.preferences, self.settings, notices)

    def comes(self) -> None:
        """A frame of where we are."""
        self.marks.take_pictures(make_frame(time=self.session.time, camera=self.session.camera))

    @property
    def names(self) -> list[str]:
        return [mark.name for mark in self.marks.all]

    @property
    def pictured(self) -> list[bool]:
        return [from_text(mark.picture) is not None for mark in self.marks.all]


@pytest.fixture
def parts() -> Parts:
    parts = Parts()
    for x in range(3):
        parts.session.change(camera=replace(AWAY, position=(float(x), 0.0, 0.0)))
        parts.marks.add()
    return parts


def test_a_picture_is_of_a_whole_frame_from_there(parts: Parts, own_settings: Path):
    here = parts.session.camera
    parts.marks.take_pictures(make_frame(camera=AWAY))
    assert parts.pictured == [False, False, False]
    parts.comes()
    assert parts.pictured == [False, False, True]
    parts.session.change(camera=replace(here, position=(0.0, 0.0, 0.0)))
    parts.comes()
    assert parts.pictured == [True, False, True], "who comes back takes the picture that was missed"
    parts.settings.finish()
    (kept,) = json.loads((own_settings / "settings.json").read_text())["bookmarks"].values()
    assert kept == codec.to_json(parts.marks.all)


def test_names_are_new_and_they_and_the_order_can_be_changed(parts: Parts):
    assert parts.names == ["frame 0", "frame 0 (2)", "frame 0 (3)"]
    parts.marks.rename(1, "  by   the door ")
    parts.marks.rename(0, "   ")
    parts.marks.move(2, 0)
    assert parts.names == ["frame 0 (3)", "frame 0", "by the door"]
    parts.marks.move(0, 99)
    parts.marks.forget(0)
    assert parts.names == ["by the door", "frame 0 (3)"]
    parts.comes()
    assert parts.pictured == [False, True]


def test_one_can_be_put_elsewhere(parts: Parts):
    parts.comes()
    parts.session.change(camera=AWAY)
    parts.marks.replace(2)
    assert parts.marks.find(2).camera == AWAY and parts.pictured == [False, False, False]
    parts.comes()
    assert parts.pictured == [False, False, True]


def test_one_of_an_older_version_gets_a_picture_when_somebody_goes_there(parts: Parts):
    parts.marks._unpictured = []
    parts.comes()
    assert parts.pictured == [False, False, False]
    parts.marks.arrived(2)
    parts.comes()
    assert parts.pictured == [False, False, True]
