"""How much larger letters are on the screen that the window is on now: it may be dragged to another."""

from __future__ import annotations

import sys

from imgui_bundle import glfw_utils, imgui

import glfw  # after imgui_bundle, which brings the library that both must share  # isort: skip


def content_scale() -> float:
    """What the desktop wants everything enlarged by on the window's screen; needs a window."""
    if sys.platform == "darwin":  # there windows are measured in points, and are enlarged with their letters
        return 1.0
    return float(max(glfw.get_window_content_scale(glfw_utils.glfw_window_hello_imgui())))


class Density:
    """Letters begin as large as Hello ImGui makes them for the first screen, and follow from there."""

    def __init__(self) -> None:
        self._first: tuple[float, float] | None = None

    def update(self) -> None:
        """Let letters be as large on this screen as they were on others; to be called where no frame is under way."""
        now, style = content_scale(), imgui.get_style()
        if self._first is None:
            self._first = style.font_scale_dpi, now
        letters, then = self._first
        if now > 0.0 and then > 0.0:
            style.font_scale_dpi = letters * now / then
