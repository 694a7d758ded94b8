"""The window over the whole screen, and back at the size and place that it had.

Hello ImGui knows full screen only from the start of a window on, so this asks GLFW.
"""

from __future__ import annotations

from typing import Any

from imgui_bundle import glfw_utils, hello_imgui

import glfw  # after imgui_bundle, which brings the library that both must share  # isort: skip

from viewer.window.window_place import Place, Rect, is_normal, place_of, shared

_MAXIMISED = "maximised"  # Hello ImGui keeps words under names beside the layout


class FullScreen:
    """`wanted` is what the user asked for; `follow` does it between two frames.  `place` is where the window is
    otherwise."""

    def __init__(self) -> None:
        self.wanted = False
        self.place = Place()
        self._entered = False
        self._maximised = False  # before it was full
        self._again = False  # whether another window is to be full in its place

    def toggle(self) -> None:
        self.wanted = not self.wanted

    def follow(self) -> None:
        """Make the window what is wanted; to be called where no frame is under way."""
        window = glfw_utils.glfw_window_hello_imgui()
        monitor = glfw.get_window_monitor(window)
        if self.wanted and not monitor:
            self._enter(window)
        elif monitor and not self.wanted:
            self._leave(window)
        elif self.place.due():
            if monitor:
                _fill(window, monitor)
            self.place.follow(window)

    def begin(self, window: Any) -> None:
        """A window has been made: as the last one was."""
        self.place.new_window()
        self.wanted, self._entered = self._again, False
        self._maximised = hello_imgui.load_user_pref(_MAXIMISED) == "yes"
        if self._maximised:
            glfw.maximize_window(window)

    def end(self) -> Rect | None:
        """The window goes; where it is, or was before it was full or maximised."""
        window = glfw_utils.glfw_window_hello_imgui()
        if is_normal(window):
            self.place.normal = place_of(window)
        full = bool(glfw.get_window_monitor(window))
        maximised = self._maximised if full else bool(glfw.get_window_attrib(window, glfw.MAXIMIZED))
        hello_imgui.save_user_pref(_MAXIMISED, "yes" if maximised else "no")
        self._again, self.wanted = self.wanted, False
        if full:
            self._leave(window)
        return self.place.normal

    def _enter(self, window: Any) -> None:
        if not self._entered:  # else its screen has gone, and GLFW has made it a window in a place that is not its own
            self._maximised = bool(glfw.get_window_attrib(window, glfw.MAXIMIZED))
            if is_normal(window):
                self.place.normal = place_of(window)
        monitor = _monitor_of(place_of(window))
        if monitor is None:
            self.wanted = False
            return
        self._entered = True
        _fill(window, monitor)

    def _leave(self, window: Any) -> None:
        self._entered = False
        x, y, width, height = self.place.normal or (100, 100, 1280, 800)
        glfw.set_window_monitor(window, None, x, y, width, height, glfw.DONT_CARE)  # type: ignore[arg-type]
        if self._maximised:
            glfw.maximize_window(window)
        self.place.new_window()


def _fill(window: Any, monitor: Any) -> None:
    """Give a window all of a screen, whose size may have changed since it had."""
    mode = _mode_of(monitor)
    if mode is None:
        return
    there = glfw.get_window_monitor(window) and tuple(glfw.get_window_size(window)) == tuple(mode.size)
    if not there:
        glfw.set_window_monitor(window, monitor, 0, 0, mode.size.width, mode.size.height, mode.refresh_rate)


def _monitor_of(place: Rect) -> Any:
    """The screen that shows most of a window, None where there is none."""

    def shown(monitor: Any) -> int:
        return shared(place, (*glfw.get_monitor_pos(monitor), *_mode_of(monitor).size))

    return max(filter(_mode_of, glfw.get_monitors()), key=shown, default=None)


def _mode_of(monitor: Any) -> Any:
    """Size and rate of a screen, None where it is just going."""
    try:
        return glfw.get_video_mode(monitor)
    except ValueError:
        return None
