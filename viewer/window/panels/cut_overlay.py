"""Over the picture: the clusters of lights that shade a pixel, as boxes, by how much of its light each sends."""

from __future__ import annotations

from imgui_bundle import ImVec2, ImVec4, imgui

from viewer.state.palette import color_map
from viewer.window.panels import marks, slicing, words
from viewer.window.panels.marks import SHADE, with_alpha
from viewer.window.ui import Ui
from viewer.window.widgets import em

_BEHIND = 0.45  # opacity of what lies behind something
_WIDTH, _THIN = 0.13, 0.05  # ems: of the boxes that send most, and of those that send least
_DISC = 0.28


def show(ui: Ui, corner: ImVec2, end: ImVec2) -> None:
    """Draw on the picture that fills the rectangle from a corner to its end."""
    c = ui.controller
    cut = c.cuts.cut
    if cut is None:
        _awaited(ui, corner, end)
    if cut is None or c.frame is None or cut.frame.camera != c.frame.camera:
        return
    width, height = end.x - corner.x, end.y - corner.y
    draw, colors = imgui.get_window_draw_list(), color_map(64)
    draw.push_clip_rect(corner, end, True)
    for node in c.cuts.drawn():
        red, green, blue = colors[min(int(63.0 * node.part**0.5), 63)].tolist()
        color, wide = ImVec4(red, green, blue, 1.0), _THIN + (_WIDTH - _THIN) * node.part**0.5
        for stroke in node.strokes:
            alpha = 1.0 if stroke.seen else _BEHIND
            a, b = (ImVec2(corner.x + u * width, corner.y + v * height) for u, v in (stroke.start, stroke.end))
            marks.line(draw, a, b, with_alpha(color, alpha), wide, with_alpha(SHADE, alpha))
        if node.at is not None:
            at = ImVec2(corner.x + node.at[0] * width, corner.y + node.at[1] * height)
            draw.add_circle_filled(at, em(_DISC + 0.08), imgui.get_color_u32(SHADE))
            draw.add_circle_filled(at, em(_DISC), imgui.get_color_u32(color))
    middle = (cut.x + 0.5) / cut.frame.width, (cut.y + 0.5) / cut.frame.height
    radius = marks.radius_around_pixel(width / cut.frame.width, height / cut.frame.height)
    marks.ring(draw, ImVec2(corner.x + middle[0] * width, corner.y + middle[1] * height), radius)
    draw.pop_clip_rect()


def _awaited(ui: Ui, corner: ImVec2, end: ImVec2) -> None:
    """At the clicked pixel: that its clusters are to come."""
    c = ui.controller
    at, lines = c.cuts.waits_for, slicing.awaited(c)
    if at is None or c.frame is None or c.selection.picked is None or not lines:
        return
    across, down = (end.x - corner.x) / c.frame.width, (end.y - corner.y) / c.frame.height
    middle = ImVec2(corner.x + (at[0] + 0.5) * across, corner.y + (at[1] + 0.5) * down)
    marks.ring(imgui.get_window_draw_list(), middle, marks.radius_around_pixel(across, down))
    words.write(lines, middle, (corner.x, corner.y, end.x, end.y), ui.legend_place)
