"""A and B over the picture: A's part of a wipe, and labels that say which is which."""

from __future__ import annotations

from imgui_bundle import ImVec2, ImVec4, imgui

from viewer.state.comparison import Source, Way
from viewer.state.views import LESS, MORE, Color
from viewer.window import comparing
from viewer.window.panels import layers
from viewer.window.panels.area import Area
from viewer.window.ui import Ui
from viewer.window.widgets import em, fitted

GAP = 0.3
"""Ems between pictures side by side."""
_BACK, _FRONT = ImVec4(0.05, 0.06, 0.08, 0.78), ImVec4(0.95, 0.96, 0.97, 1.0)

Seen = comparing.Seen


def area_of_b(ui: Ui, room: tuple[int, int]) -> tuple[int, int]:
    """The pixels that B is to have in a room for one picture: beside a picture that was kept as many as that has, so
    that both show the same; else as many as there is room for."""
    comparing, state = ui.controller.comparing, ui.controller.comparing.state
    if not state.on or state.way is not Way.SIDE or min(room) < 1:
        return room
    if state.source is Source.KEPT:
        kept = state.kept
        return room if kept is None else (kept.frame.width, kept.frame.height)
    gap = round(em(GAP) * imgui.get_io().display_framebuffer_scale.x)
    return (max(1, (room[0] - gap) // 2), room[1]) if comparing.b is not None else room


def draw_a(ui: Ui, area: Area, seen: Seen) -> None:
    """A, left of the line of a wipe."""
    if (
        seen[2] is not Way.WIPE
        or comparing.shows_a(ui)
        or ui.graphics.compared is None
        or ui.graphics.compared.a_texture is None
    ):
        return
    layers.draw(ui, comparing.OF_A, ui.graphics.compared.a_texture, area, ui.controller.session.wipe)


def show_names(ui: Ui, area: Area, seen: Seen, top: float) -> None:
    """Which is which, below the picture's title; a wipe has its names at the line."""
    a, b, way = seen
    names = ui.controller.comparing.names(a, b)
    y, room = top + em(0.2), area.size.x - em(0.6)
    if way is Way.SIDE:
        _label(ImVec2(area.corner.x - em(GAP) - area.size.x, area.corner.y), names[0], LESS, room)
        _label(ImVec2(area.corner.x, y), names[1], MORE, room)
    elif comparing.shows_a(ui):
        _label(ImVec2(area.corner.x, y), names[0], LESS, room)
    elif way is Way.DIFFERENCE:
        _label(ImVec2(area.corner.x, y), f"{names[1]}   minus   {names[0]}", None, room)
    elif way is not Way.WIPE:
        _label(ImVec2(area.corner.x, y), names[1], MORE, room)


def _label(at: ImVec2, text: str, color: Color | None, room: float) -> None:
    """A line on a dark ground, with a square of the colour that stands for A or B."""
    pad, line = em(0.35), imgui.get_text_line_height()
    side = 0.7 * line if color is not None else 0.0
    text = fitted(text, room - side - 4.0 * pad)
    width = imgui.calc_text_size(text).x + side + (4.0 if color is not None else 3.0) * pad
    draw = imgui.get_window_draw_list()
    end = ImVec2(at.x + width, at.y + line + 2.0 * pad)
    draw.add_rect_filled(at, end, imgui.get_color_u32(_BACK), em(0.3))
    x = at.x + 1.5 * pad
    if color is not None:
        y = at.y + pad + 0.18 * line
        draw.add_rect_filled(
            ImVec2(x, y), ImVec2(x + side, y + side), imgui.get_color_u32(ImVec4(*color, 1.0)), em(0.1)
        )
        x += side + pad
    draw.add_text(ImVec2(x, at.y + pad), imgui.get_color_u32(_FRONT), text)
