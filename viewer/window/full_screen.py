"""The window over the whole screen, and back at the size and place that it had.

Hello ImGui knows full screen only from the start of a window on, so this asks GLFW.
"""

from __future__ import annotations

from typing import Any

from imgui_bundle import glfw_utils

import glfw  # after imgui_bundle, which brings the library that both must share  # isort: skip

Rect = tuple[int, int, int, int]
"""Left, top, width, height."""


class FullScreen:
    """`wanted` is what the user asked for; `apply` does it between two frames."""

    def __init__(self) -> None:
        self.wanted = False
        self._place: Rect | None = None  # where the window was before it was full; None while it is not
        self._again = False  # whether another window is to be full in its place

    def toggle(self) -> None:
        self.wanted = not self.wanted

    def apply(self) -> None:
        """Make the window what is wanted; to be called where no frame is under way."""
        window = glfw_utils.glfw_window_hello_imgui()
        monitor = glfw.get_window_monitor(window)
        if self.wanted and not monitor:
            self._enter(window)
        elif monitor and not self.wanted:
            self._leave(window)

    def begin(self) -> None:
        """A window has been made: full if the last one was."""
        self.wanted, self._place = self._again, None

    def end(self) -> Rect | None:
        """The window goes; returns where it was before it was full, None where it is not."""
        self._again, self.wanted = self.wanted, False
        return self._place

    def _enter(self, window: Any) -> None:
        place = (*glfw.get_window_pos(window), *glfw.get_window_size(window))
        if self._place is None:  # else its screen has gone, and it is in no place of its own
            self._place = place
        monitor = _monitor_of(place)
        mode = glfw.get_video_mode(monitor)
        glfw.set_window_monitor(window, monitor, 0, 0, mode.size.width, mode.size.height, mode.refresh_rate)

    def _leave(self, window: Any) -> None:
        x, y, width, height = self._place or (100, 100, 1280, 800)
        self._place = None
        glfw.set_window_monitor(window, None, x, y, width, height, glfw.DONT_CARE)  # type: ignore[arg-type]


def _monitor_of(place: Rect) -> Any:
    """The screen that holds the middle of a window, else the first."""
    x, y = place[0] + place[2] // 2, place[1] + place[3] // 2

    def holds(monitor: Any) -> bool:
        (left, top), size = glfw.get_monitor_pos(monitor), glfw.get_video_mode(monitor).size
        return left <= x < left + size.width and top <= y < top + size.height

    return next(filter(holds, glfw.get_monitors()), glfw.get_primary_monitor())
