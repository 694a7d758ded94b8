"""The window over the whole screen, and back at the size and place that it had.

Hello ImGui knows full screen only from the start of a window on, so this asks GLFW.
"""

from __future__ import annotations

from typing import Any

from imgui_bundle import glfw_utils

import glfw  # after imgui_bundle, which brings the library that both must share  # isort: skip


class FullScreen:
    """`wanted` is what the user asked for; `follow` does it between two frames."""

    def __init__(self) -> None:
        self.wanted = False
        self._place: tuple[int, int, int, int] | None = None
        self._maximised = False

    def toggle(self) -> None:
        self.wanted = not self.wanted

    def follow(self) -> None:
        """Make the window what is wanted; to be called where no frame is under way."""
        window = glfw_utils.glfw_window_hello_imgui()
        is_full = bool(glfw.get_window_monitor(window))
        if self.wanted and not is_full:
            self._enter(window)
        elif is_full and not self.wanted:
            self._leave(window)

    def end(self) -> None:
        """Back to a window, so that its own size is the one that is remembered."""
        self.wanted = False
        self.follow()

    def _enter(self, window: Any) -> None:
        self._place = (*glfw.get_window_pos(window), *glfw.get_window_size(window))
        self._maximised = bool(glfw.get_window_attrib(window, glfw.MAXIMIZED))
        monitor = _monitor_of(self._place)
        if monitor is None:
            self.wanted = False
            return
        mode = glfw.get_video_mode(monitor)
        glfw.set_window_monitor(window, monitor, 0, 0, mode.size.width, mode.size.height, mode.refresh_rate)

    def _leave(self, window: Any) -> None:
        x, y, width, height = self._place or (100, 100, 1280, 800)
        glfw.set_window_monitor(window, None, x, y, width, height, glfw.DONT_CARE)  # type: ignore[arg-type]
        if self._maximised:
            glfw.maximize_window(window)


def _monitor_of(place: tuple[int, int, int, int]) -> Any:
    """The screen that shows most of a window, None where there is none."""

    def shown(monitor: Any) -> int:
        left, top = glfw.get_monitor_pos(monitor)
        size = glfw.get_video_mode(monitor).size
        across = min(place[0] + place[2], left + size.width) - max(place[0], left)
        down = min(place[1] + place[3], top + size.height) - max(place[1], top)
        return max(across, 0) * max(down, 0)

    return max(glfw.get_monitors(), key=shown, default=None)
