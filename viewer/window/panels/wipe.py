"""The line of the wipe over the picture: what lies on either side of it, and the hand that drags it."""

from __future__ import annotations

from dataclasses import dataclass

from imgui_bundle import ImVec2, ImVec4, imgui

from tracer.method import Method
from viewer.state.comparison import Way
from viewer.state.views import View
from viewer.window import comparing
from viewer.window.panels.area import Area
from viewer.window.ui import Ui
from viewer.window.widgets import em

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
        c.session.wipe = min(max(area.to_picture(imgui.get_io().mouse_pos.x, 0.0)[0], 0.0), 1.0)
        state.held = imgui.is_item_active()
    if held or (imgui.is_item_hovered() and not imgui.is_item_active() and _near(ui, area)):
        imgui.set_mouse_cursor(imgui.MouseCursor_.resize_ew)
    return held


def _there(ui: Ui) -> bool:
    """Whether a line is seen: between the culled picture and the right one, or between A and B."""
    seen = comparing.shown(ui)
    if seen is not None:
        return seen[2] is Way.WIPE and not comparing.shows_a(ui)
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
    return min(max(area.to_screen(ui.controller.session.wipe, 0.0).x, area.corner.x), area.end.x)


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
            draw.add_rect_filled(ImVec2(start, top), lower, dark if c.session.zoom.fits else ground, em(0.3))
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
