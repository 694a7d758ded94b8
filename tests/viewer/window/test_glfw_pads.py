"""Devices as GLFW tells of them, without one."""

from __future__ import annotations

from types import SimpleNamespace

import glfw
import pytest

from viewer.state.pads import Kind, Pad
from viewer.window.glfw_pads import Pads


@pytest.fixture
def plugged(monkeypatch: pytest.MonkeyPatch) -> set[int]:
    """A game pad at 0, a space mouse at 1, a flight stick at 2, and one at 3 that goes while it is asked."""
    there = {0, 1, 2, 3}
    names = {1: b"3Dconnexion SpaceNavigator", 2: b"Flight stick"}
    axes = {1: ([0.5, 0.0, 0.0, 0.0, 0.0, -1.0], 6), 2: ([0.0] * 6, 6), 3: (None, 0)}
    state = SimpleNamespace(buttons=[1] + [0] * 13 + [1], axes=[0.0, -1.0, 0.0, 0.0, -1.0, -1.0])
    monkeypatch.setattr(glfw, "joystick_present", there.__contains__)
    monkeypatch.setattr(glfw, "get_gamepad_state", lambda n: state if n == 0 else None)
    monkeypatch.setattr(glfw, "get_gamepad_name", lambda n: b"Pad")
    monkeypatch.setattr(glfw, "get_joystick_name", names.get)
    monkeypatch.setattr(glfw, "get_joystick_axes", lambda n: axes[n])
    return there


def test_pads_and_space_mice_are_read_and_other_sticks_left_alone(plugged: set[int]):
    assert Pads().read() == [
        Pad("Pad", Kind.GAMEPAD, (0.0, -1.0, 0.0, 0.0, -1.0, -1.0), frozenset({"A", "pad left"})),
        Pad("3Dconnexion SpaceNavigator", Kind.SPACE_MOUSE, (0.5, 0.0, 0.0, 0.0, 0.0, -1.0)),
    ]


def test_what_comes_and_goes_is_seen_at_the_next_look(plugged: set[int], monkeypatch: pytest.MonkeyPatch):
    pads = Pads()
    plugged.clear()
    assert pads.read() == []
    plugged.add(1)
    assert pads.read() == [], "not at once: to look takes long"
    monkeypatch.setattr("viewer.window.glfw_pads.EVERY", 0.0)
    assert [pad.name for pad in pads.read()] == ["3Dconnexion SpaceNavigator"]
