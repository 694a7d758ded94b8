"""The window itself: what it is made with, the whole screen, and the signals that close it."""

from __future__ import annotations

import signal
import threading
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from imgui_bundle import glfw_utils, hello_imgui, imgui

import glfw  # after imgui_bundle, which brings the library that both must share  # isort: skip

from viewer.window.guard import configure as configure_recovery

NO_OPENGL = "cannot open a window: this display has no OpenGL 3.3; without one, use: shadowcull render SCENE -o out.png"
_SIGNALS = ("SIGTERM", "SIGHUP", "SIGINT")
LEAST_SIZE, PART_OF_SCREEN = (1280, 800), 0.8
Rect = tuple[int, int, int, int]
"""Left, top, width, height."""


def window_params(title: str, layout_file: Path) -> hello_imgui.RunnerParams:
    """Return what the window is made with: OpenGL 3.3, a menu bar, a status bar, and panels that are docked between
    them as a file keeps them."""
    params = hello_imgui.RunnerParams()
    params.app_window_params.window_title = title
    params.app_window_params.window_geometry.size = first_size()
    params.app_window_params.restore_previous_geometry = True
    window = params.imgui_window_params
    window.default_imgui_window_type = hello_imgui.DefaultImGuiWindowType.provide_full_screen_dock_space
    window.show_menu_bar = window.show_status_bar = True
    window.show_menu_app = window.show_menu_view = window.show_status_fps = False
    window.remember_theme = window.remember_status_bar_settings = False
    params.renderer_backend_options.open_gl_options = hello_imgui.OpenGlOptions(
        glsl_version="330", major_version=3, minor_version=3, use_core_profile=True, use_forward_compat=True,
        anti_aliasing_samples=0,  # text and widgets are smooth by themselves
    )  # fmt: skip
    params.callbacks.setup_imgui_config = _configure_imgui
    params.ini_folder_type = hello_imgui.IniFolderType.absolute_path
    params.ini_filename = str(layout_file)
    return params


def first_size() -> tuple[int, int]:
    """Return the size of a first window: most of the screen, and never less than all panels need, if it has that."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # without a display, whoever runs the window says so
        monitor = glfw.get_primary_monitor() if glfw.init() else None
    if not monitor:
        return LEAST_SIZE
    _, _, *room = glfw.get_monitor_workarea(monitor)
    width, height = (max(round(PART_OF_SCREEN * side), min(least, side)) for side, least in zip(room, LEAST_SIZE))
    return width, height


def _configure_imgui() -> None:
    hello_imgui.imgui_default_settings.setup_default_imgui_config()
    io = imgui.get_io()
    # Arrows, space and escape are commands here; they must not move a focus from button to button.
    io.config_flags &= ~int(imgui.ConfigFlags_.nav_enable_keyboard)
    io.config_windows_move_from_title_bar_only = True
    configure_recovery()


class FullScreen:
    """The window over the whole screen, and back at the size and place that it had.  `wanted` is what the user asked
    for.  Hello ImGui knows full screen only from the start of a window on, so this asks GLFW."""

    def __init__(self) -> None:
        self.wanted = False
        self.place: Rect | None = None
        """Where the window was before it was full; None while it is not."""

    def apply(self) -> None:
        """Make the window what is wanted; to be called where no frame is under way."""
        window = glfw_utils.glfw_window_hello_imgui()
        full = glfw.get_window_monitor(window)
        if self.wanted and not full:
            place = (*glfw.get_window_pos(window), *glfw.get_window_size(window))
            self.place = self.place or place  # where its screen has gone, it is in no place of its own
            monitor = _monitor_of(place)
            mode = glfw.get_video_mode(monitor)
            glfw.set_window_monitor(window, monitor, 0, 0, mode.size.width, mode.size.height, mode.refresh_rate)
        elif full and not self.wanted:
            place, self.place = self.place or (100, 100, *LEAST_SIZE), None
            glfw.set_window_monitor(window, None, *place, glfw.DONT_CARE)  # type: ignore[arg-type]


def _monitor_of(place: Rect) -> Any:
    """Return the screen that holds the middle of a window, else the first."""
    x, y = place[0] + place[2] // 2, place[1] + place[3] // 2

    def holds(monitor: Any) -> bool:
        (left, top), size = glfw.get_monitor_pos(monitor), glfw.get_video_mode(monitor).size
        return left <= x < left + size.width and top <= y < top + size.height

    return next(filter(holds, glfw.get_monitors()), glfw.get_primary_monitor())


@contextmanager
def closing_by_signals(close: Callable[[], None]) -> Iterator[None]:
    """Let the first signal that ends a program call `close` until the end of the block; the next is as it was before,
    so that a window that does not close can still be killed."""
    if threading.current_thread() is not threading.main_thread():  # others may not say what signals do
        yield
        return
    before: dict[int, Any] = {}

    def restore() -> None:
        while before:
            signal.signal(*before.popitem())

    def closing(_number: int, _frame: Any) -> None:
        restore()
        close()

    for number in (getattr(signal, name) for name in _SIGNALS if hasattr(signal, name)):
        before[number] = signal.signal(number, closing)
    try:
        yield
    finally:
        restore()
