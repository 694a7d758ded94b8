"""A and B over the picture: A's part of a wipe, the line that is dragged, and labels that say which is which."""

from __future__ import annotations

from dataclasses import dataclass

from imgui_bundle import ImVec2, ImVec4, imgui

from tracer.method import Method
from viewer.state.comparison import CompareMode, Source
from viewer.state.palette import LESS, MORE, Color
from viewer.state.views import View
from viewer.window import comparing
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
    if not state.on or state.mode is not CompareMode.SIDE or min(room) < 1:
        return room
    if state.source is Source.KEPT:
        kept = comparing.kept
        return room if kept is None else (kept.frame.width, kept.frame.height)
    gap = round(em(GAP) * imgui.get_io().display_framebuffer_scale.x)
    return (max(1, (room[0] - gap) // 2), room[1]) if comparing.b is not None else room


def draw_a(ui: Ui, area: Area, seen: Seen) -> None:
    """A, left of the line of a wipe."""
    if (
        seen[2] is not CompareMode.WIPE
        or comparing.shows_a(ui)
        or ui.graphics.compared is None
        or ui.graphics.compared.a.texture_id is None
    ):
        return
    draw_picture(ui, comparing.OF_A, ui.graphics.compared.a.texture_id, area, ui.controller.session.draw.wipe)


def show_names(ui: Ui, area: Area, seen: Seen, top: float) -> None:
    """Which is which, below the picture's title; a wipe has its names at the line."""
    a, b, way = seen
    names = ui.controller.comparing.names(a, b)
    y, room = top + em(0.2), area.size.x - em(0.6)
    if way is CompareMode.SIDE:
        _label(ImVec2(area.corner.x - em(GAP) - area.size.x, area.corner.y), names[0], LESS, room)
        _label(ImVec2(area.corner.x, y), names[1], MORE, room)
    elif comparing.shows_a(ui):
        _label(ImVec2(area.corner.x, y), names[0], LESS, room)
    elif way is CompareMode.DIFFERENCE:
        _label(ImVec2(area.corner.x, y), f"{names[1]}   minus   {names[0]}", None, room)
    elif way is not CompareMode.WIPE:
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


_REACH = 0.45  # ems to either side of the line where it can be taken hold of
_DARK, _LIGHT, _HELD, _GROUND = (
    ImVec4(0.05, 0.06, 0.08, 0.72),
    ImVec4(0.95, 0.96, 0.97, 1.0),
    ImVec4(0.42, 0.70, 0.96, 1.0),
    ImVec4(0.05, 0.06, 0.08, 0.94),  # where numbers may lie beneath
)


@dataclass
class WipeState:
    """Whether the pointer holds the line."""

    held: bool = False


def handle(ui: Ui, area: Area) -> bool:
    """Let the pointer drag the line across the picture, which is ImGui's last item; whether the line holds it."""
    state = ui.state(WipeState)
    c = ui.controller
    if not _there(ui):
        state.held = False
        return False
    if imgui.is_item_activated() and imgui.is_mouse_clicked(imgui.MouseButton_.left) and _near(ui, area):
        state.held = True
    held = state.held
    if held:
        c.session.set_draw(wipe=min(max(area.to_picture(imgui.get_io().mouse_pos.x, 0.0)[0], 0.0), 1.0))
        state.held = imgui.is_item_active()
    if held or (imgui.is_item_hovered() and not imgui.is_item_active() and _near(ui, area)):
        imgui.set_mouse_cursor(imgui.MouseCursor_.resize_ew)
    return held


def _there(ui: Ui) -> bool:
    """Whether a line is seen: between the culled picture and the right one, or between A and B."""
    seen = comparing.shown(ui)
    if seen is not None:
        return seen[2] is CompareMode.WIPE and not comparing.shows_a(ui)
    return ui.controller.scheduler.drawn_view is View.WIPE


def _names(ui: Ui) -> tuple[str, str]:
    """Of what lies left of the line, and right of it."""
    c, seen = ui.controller, comparing.shown(ui)
    if seen is not None:
        return c.comparing.names(seen[0], seen[1])
    method = c.frame.settings.method if c.frame is not None else ""
    return method if Method.parse(method).culls else "no culling", "reference"


def _place(ui: Ui, area: Area) -> float:
    """Where the line is on the screen: at an edge where it lies beyond what is shown."""
    return min(max(area.to_screen(ui.controller.session.draw.wipe, 0.0).x, area.corner.x), area.end.x)


def _near(ui: Ui, area: Area) -> bool:
    return abs(imgui.get_io().mouse_pos.x - _place(ui, area)) <= em(_REACH)


def show(ui: Ui, area: Area) -> None:
    """The line, its handle, and the names of both sides near the picture's upper edge, below the text there."""
    c = ui.controller
    if not _there(ui) or c.frame is None:
        return
    x, corner, end = _place(ui, area), area.corner, area.end
    dark, light, held, ground = (imgui.get_color_u32(color) for color in (_DARK, _LIGHT, _HELD, _GROUND))
    bright = held if ui.state(WipeState).held else light
    draw = imgui.get_window_draw_list()
    draw.push_clip_rect(corner, end, True)
    half = max(1.0, em(0.05))
    draw.add_rect_filled(ImVec2(x - 2.0 * half, corner.y), ImVec2(x + 2.0 * half, end.y), dark)
    draw.add_rect_filled(ImVec2(x - half, corner.y), ImVec2(x + half, end.y), bright)
    _knob(draw, ImVec2(x, (corner.y + end.y) / 2.0), bright, dark)
    left, right = _names(ui)
    pad, text = em(0.35), imgui.get_text_line_height()
    top = corner.y + text + 4.0 * pad
    for name, side in ((left, -1.0), (right, 1.0)):
        width = imgui.calc_text_size(name).x + 2.0 * pad
        start = x + 2.0 * pad if side > 0.0 else x - 2.0 * pad - width
        if corner.x <= start and start + width <= end.x:
            lower = ImVec2(start + width, top + text + 2.0 * pad)
            draw.add_rect_filled(ImVec2(start, top), lower, dark if c.session.draw.zoom.fits else ground, em(0.3))
            draw.add_text(ImVec2(start + pad, top + pad), light, name)
    draw.pop_clip_rect()


def _knob(draw: imgui.ImDrawList, at: ImVec2, bright: int, dark: int) -> None:
    """A disc on the line with an arrow to either side."""
    radius, arrow = em(0.8), em(0.28)
    draw.add_circle_filled(at, radius, dark)
    draw.add_circle(at, radius, bright, 0, max(1.5, em(0.1)))
    for side in (-1.0, 1.0):
        tip, base = at.x + side * 0.62 * radius, at.x + side * 0.22 * radius
        draw.add_triangle_filled(ImVec2(tip, at.y), ImVec2(base, at.y - arrow), ImVec2(base, at.y + arrow), bright)


def draw_picture(ui: Ui, name: str, texture: int, area: Area, right: float = 1.0) -> None:
    """As much of a picture as is to be seen, up to a column, 0 to 1 from the picture's left edge."""
    left, top, end, bottom = area.zoom.shown()
    right = min(right, end)
    if right <= left:
        return
    at = ImVec2(area.corner.x + (right - left) / (end - left) * area.size.x, area.end.y)
    start, stop = ImVec2(left, top), ImVec2(right, bottom)
    magnifier = ui.graphics.magnifier
    crisp = magnifier.texture_of(name, texture, area.zoom, ui.picture.size) if magnifier is not None else None
    if crisp is not None:
        texture, start, stop = crisp, ImVec2(0.0, 0.0), ImVec2((right - left) / (end - left), 1.0)
    imgui.get_window_draw_list().add_image(imgui.ImTextureRef(texture), area.corner, at, start, stop)
