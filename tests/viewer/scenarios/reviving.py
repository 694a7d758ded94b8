"""What becomes of the window when the machine changes under it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from imgui_bundle import glfw_utils, imgui

import glfw  # after imgui_bundle, which brings the library that both must share  # isort: skip

from tests.viewer.driver import Driver
from tracer.frame import Frame
from viewer.state.views import View

KEY = imgui.Key
SMALL = (1100, 700)
UNKNOWN_RESET = 0x8255  # as GL_KHR_robustness has it


def reviving(d: Driver) -> Callable[[Driver], Any]:
    """The graphics driver is reset: another window comes, and shows what this one did."""
    d.resize(*SMALL)
    d.settle()
    d.press(KEY._2)
    d.drag(d.picture_centre(), (40.0, 10.0))
    d.settle()
    d.context.mouse_move_to_pos(d.picture_centre())
    d.context.mouse_click(0)
    d.ui.show_panel("Log")
    d.c.preferences.theme = "light"
    d.settle()
    d.frames(4)
    before = _state(d), d.shown(), d.c.frame
    d.app.losses.status = lambda: UNKNOWN_RESET
    while not d.app.losses.cause:
        d.frames(1)
    return lambda d: _revived(d, *before)


def _state(d: Driver) -> tuple[Any, ...]:
    size = glfw.get_window_size(glfw_utils.glfw_window_hello_imgui())
    return d.c.session.snapshot(), d.c.session.view, d.c.selection.picked, d.c.preferences.theme, tuple(size)


def _revived(d: Driver, state: tuple[Any, ...], picture: np.ndarray, frame: Frame) -> None:
    assert _state(d) == state and d.c.session.view is View.OCCLUSION
    assert (d.c.frame.width, d.c.frame.height) == (frame.width, frame.height)
    assert np.array_equal(d.shown(), picture)
    assert d.c.notices.message.text.startswith("the graphics driver was reset: the window was made anew")
