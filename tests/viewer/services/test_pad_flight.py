"""Flying by devices that come and go."""

from __future__ import annotations

import time

import numpy as np
import pytest

from tests.viewer.fakes import make_scene
from viewer.services.motion import Motion
from viewer.services.pad_flight import BUTTONS, PadFlight
from viewer.state.notices import Notices
from viewer.state.pads import Kind, Pad
from viewer.state.preferences import Preferences
from viewer.state.session import Session

REST = (0.0, 0.0, 0.0, 0.0, -1.0, -1.0)


class Flight:
    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.now = 100.0
        monkeypatch.setattr(time, "monotonic", lambda: self.now)
        self.session, self.preferences, self.notices = Session(), Preferences(), Notices()
        self.session.open(make_scene())
        self.motion = Motion(self.session, self.preferences, self.notices, lambda: False)
        self.pads = PadFlight(self.session, self.preferences, self.motion, self.notices)
        self.ran: list[str] = []

    def frame(self, *axes: float, pressed: tuple[str, ...] = (), there: bool = True) -> None:
        self.now += 0.1
        pad = Pad("Pad 7", Kind.GAMEPAD, axes or REST, frozenset(pressed))
        commands = {name: lambda name=name: self.ran.append(name) for name in BUTTONS.values()}
        self.pads.follow([pad] if there else [], commands)


@pytest.fixture
def flight(monkeypatch: pytest.MonkeyPatch) -> Flight:
    return Flight(monkeypatch)


def test_a_stick_flies_as_far_as_time_says(flight: Flight):
    start = flight.session.camera
    flight.frame()
    assert flight.session.camera == start and flight.session.follow
    flight.frame(0.0, -1.0, 0.0, 0.0, -1.0, -1.0)
    way = np.subtract(flight.session.camera.position, start.position) @ start.basis()[2]
    assert way == pytest.approx(0.1 * flight.motion.pace) and flight.motion.under_way


def test_a_pad_is_greeted_when_it_comes_and_missed_when_it_goes(flight: Flight):
    flight.frame(there=False)
    assert flight.notices.message is None and flight.pads.names == []
    flight.frame()
    assert flight.notices.message.text.startswith("game pad found: Pad 7") and flight.pads.names == ["Pad 7"]
    flight.notices.message = None
    flight.frame()
    assert flight.notices.message is None, "once"
    flight.frame(there=False)
    assert flight.notices.message.text == "game pad gone: Pad 7"


def test_a_button_runs_its_command_once_for_each_press(flight: Flight):
    for pressed in (("A",), ("A",), (), ("A", "start"), ("guide",)):
        flight.frame(pressed=pressed)
    assert flight.ran == ["Play", "Play", "Next bookmark"]


def test_switched_off_nothing_moves(flight: Flight):
    flight.preferences.pads = False
    before = flight.session.camera
    flight.frame(1.0, 1.0, 1.0, 1.0, 1.0, 1.0, pressed=("A",))
    assert flight.session.camera == before and flight.ran == [] and flight.pads.names == []
