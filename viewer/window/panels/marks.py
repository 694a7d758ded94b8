"""Marks that panels draw over the picture: a ring around a point, and a cross where light is blocked."""

from __future__ import annotations

from imgui_bundle import ImVec2, ImVec4, imgui

from viewer.window.widgets import em

SHADE = ImVec4(0.05, 0.06, 0.08, 0.6)
"""Around what is drawn, so that it is seen on any picture."""


def with_alpha(color: ImVec4, alpha: float) -> ImVec4:
    """The colour, so much more transparent."""
    return ImVec4(color.x, color.y, color.z, color.w * alpha)


def ring(draw: imgui.ImDrawList, at: ImVec2, radius: float = 0.4, alpha: float = 1.0) -> None:
    """A white ring of so many ems around a point of the screen."""
    draw.add_circle(at, em(radius), imgui.get_color_u32(SHADE), 0, em(0.22))
    draw.add_circle(at, em(radius), imgui.get_color_u32(ImVec4(1.0, 1.0, 1.0, alpha)), 0, em(0.1))


def cross(draw: imgui.ImDrawList, at: ImVec2, color: ImVec4, arm: float = 0.28) -> None:
    """A cross with arms of so many ems at a point of the screen."""
    shown, reach = imgui.get_color_u32(color), em(arm)
    for way in (1.0, -1.0):
        start, end = ImVec2(at.x - reach, at.y - way * reach), ImVec2(at.x + reach, at.y + way * reach)
        draw.add_line(start, end, shown, em(0.14))


def line(
    draw: imgui.ImDrawList, start: ImVec2, end: ImVec2, color: ImVec4, width: float, around: ImVec4, rim: float = 0.06
) -> None:
    """A line of so many ems, with a rim of another colour."""
    draw.add_line(start, end, imgui.get_color_u32(around), em(width + 2.0 * rim))
    draw.add_line(start, end, imgui.get_color_u32(color), max(1.0, em(width)))
