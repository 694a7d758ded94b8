"""Full screen where screens come and go: one that is just going has no size any more."""

from __future__ import annotations

from types import SimpleNamespace
from typing import NamedTuple

import pytest

from viewer.window import full_screen


def test_a_screen_that_is_just_going_is_never_chosen_and_never_filled(monkeypatch: pytest.MonkeyPatch) -> None:
    size = NamedTuple("Size", [("width", int), ("height", int)])(800, 600)
    screens = {"going": None, "there": SimpleNamespace(size=size, refresh_rate=60)}
    filled: list[tuple] = []

    def mode(monitor: str) -> SimpleNamespace:
        if screens[monitor] is None:
            raise ValueError("NULL pointer access")  # as GLFW's wrapper does
        return screens[monitor]

    monkeypatch.setattr(full_screen.glfw, "get_monitors", lambda: list(screens))
    monkeypatch.setattr(full_screen.glfw, "get_monitor_pos", lambda monitor: (0, 0))
    monkeypatch.setattr(full_screen.glfw, "get_video_mode", mode)
    monkeypatch.setattr(full_screen.glfw, "get_window_monitor", lambda window: None)
    monkeypatch.setattr(full_screen.glfw, "set_window_monitor", lambda *given: filled.append(given))
    assert full_screen._monitor_of((10, 10, 100, 100)) == "there"
    for monitor in screens:
        full_screen._fill("window", monitor)
    assert filled == [("window", "there", 0, 0, 800, 600, 60)]
    del screens["there"]
    assert full_screen._monitor_of((10, 10, 100, 100)) is None
