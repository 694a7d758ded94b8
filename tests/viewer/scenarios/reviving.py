"""What becomes of the window when the machine changes under it: its graphics driver, its screens, their density."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any
from unittest import mock

import numpy as np
from imgui_bundle import glfw_utils, imgui

import glfw  # after imgui_bundle, which brings the library that both must share  # isort: skip

from tests.viewer.driver import Driver
from tracer.frame import Frame
from viewer.state.views import View
from viewer.window import graphics
from viewer.window import style as window_style

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
    draw = graphics.draw

    def lose(_ui: object) -> None:
        """In the middle of a frame, as something else than the picture is drawn: that is no fault."""
        graphics.draw = draw
        d.app.context_loss.status = lambda: UNKNOWN_RESET
        raise RuntimeError("made to fail")

    graphics.draw = lose
    d.wait(lambda: bool(d.app.context_loss.cause), "the loss to be seen", 20.0)
    return lambda d: _revived(d, *before)


def _state(d: Driver) -> tuple[Any, ...]:
    size = glfw.get_window_size(glfw_utils.glfw_window_hello_imgui())
    return d.c.session.state, d.c.session.draw.view, d.c.selection.picked, d.c.preferences.theme, tuple(size)


def _revived(d: Driver, state: tuple[Any, ...], picture: np.ndarray, frame: Frame) -> None:
    assert _state(d) == state and d.c.session.draw.view is View.OCCLUSION
    assert (d.c.frame.width, d.c.frame.height) == (frame.width, frame.height)
    assert np.array_equal(d.shown(), picture)
    assert d.c.notices.message.text.startswith("the graphics driver was reset: the window was made anew")
    assert d.c.notices.newest_fault is None
    _denser_screen(d)
    _full_screen(d)


def _denser_screen(d: Driver) -> None:
    """Letters and lengths follow the screen, and go back with it."""
    style = imgui.get_style()
    before = _lengths()
    for scale in (2.0, 1.5, 1.0):
        with mock.patch.object(window_style, "content_scale", lambda scale=scale: scale):
            d.frames(3)
            assert style.font_scale_dpi == scale and d.ui.fold.folded == (scale > 1.0)
            assert np.allclose(_lengths(), np.multiply(before, scale), atol=1.0)
    assert _lengths() == before
    d.frames(3)


def _lengths() -> tuple[float, ...]:
    style = imgui.get_style()
    return style.frame_padding.x, style.item_spacing.x, style.scrollbar_size, style.indent_spacing


def _full_screen(d: Driver) -> None:
    """The window has its place again after it was full."""

    def place() -> tuple[int, ...]:
        window = glfw_utils.glfw_window_hello_imgui()
        return (*glfw.get_window_pos(window), *glfw.get_window_size(window))

    before, screen = place(), glfw.get_video_mode(glfw.get_monitors()[0]).size
    d.ui.full_screen.toggle()
    d.wait(lambda: place() == (0, 0, *screen), "a full window", 20.0)
    d.ui.full_screen.toggle()
    d.wait(lambda: place() == before, "the window as it was", 20.0)
