"""How many pixels of the window a length takes on the screen that it is on now: it may be dragged to another."""

from __future__ import annotations

from imgui_bundle import glfw_utils, imgui

import glfw  # after imgui_bundle, which brings the library that both must share  # isort: skip


def content_scale() -> float:
    """What the desktop wants everything enlarged by on the window's screen; needs a window."""
    return max(glfw.get_window_content_scale(glfw_utils.glfw_window_hello_imgui()))


class Density:
    """Fonts begin as large as Hello ImGui makes them for the first screen, and follow from there."""

    def __init__(self) -> None:
        self._first: tuple[float, float] | None = None

    def follow(self) -> None:
        """Let letters be as large on this screen as they were on others; to be called where no frame is under way."""
        framebuffer = imgui.get_io().display_framebuffer_scale.x
        if framebuffer <= 0.0:
            return
        now = content_scale() / framebuffer  # where a window is measured in points, the desktop enlarges it itself
        style = imgui.get_style()
        if self._first is None:
            self._first = style.font_scale_dpi, now
        fonts, then = self._first
        style.font_scale_dpi = fonts * now / then
