"""Figure 1 of the paper with the newest frame's numbers; a click on a part opens the view that shows it."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

from imgui_bundle import ImVec2, imgui

from viewer.output.figure1 import figure_of
from viewer.output.figure1_layout import Area, Arrow, Box, Drawing, Tone, lay_out
from viewer.window.panels import status
from viewer.window.style import BLUE
from viewer.window.ui import Ui
from viewer.window.widgets import QUIET, em, packed, paragraph, tooltip_at

_HEAD = 0.28  # ems: half of an arrow's head


def show(ui: Ui) -> None:
    """The panel."""
    c = ui.controller
    frame = c.frame
    if frame is None:
        paragraph(status.first_picture(c), QUIET)
        return
    style, room = imgui.get_style(), imgui.get_content_region_avail()
    # The same width with a scroll bar as without, so that neither brings about the other.
    width = imgui.get_window_width() - 2.0 * style.window_padding.x - style.scrollbar_size
    line = imgui.get_text_line_height()

    def laid_out() -> Drawing:
        # The status bar and other panels say of what picture it is.
        return lay_out(replace(figure_of(frame), title=""), _width_of, line, width, room.y)

    drawing: Drawing = ui.cached("figure 1", frame, (width, room.y, line), laid_out)
    at = imgui.get_cursor_screen_pos()
    clicked = imgui.invisible_button("figure 1", ImVec2(max(drawing.width, 1.0), max(drawing.height, 1.0)))
    mouse = imgui.get_mouse_pos()
    area = drawing.at(mouse.x - at.x, mouse.y - at.y) if imgui.is_item_hovered() else None
    _draw(drawing, at, area)
    if area is None:
        return
    tooltip_at(area.tip if area.view is None else f"{area.tip}\nClick for the view {area.view.label}.")
    if area.view is not None:
        imgui.set_mouse_cursor(imgui.MouseCursor_.hand)
        if clicked:
            c.session.set_draw(view=area.view)


def _draw(drawing: Drawing, at: ImVec2, pointed: Area | None) -> None:
    draw = imgui.get_window_draw_list()
    fill, edge = (imgui.get_color_u32(imgui.get_style_color_vec4(slot)) for slot in _SLOTS)
    rounded, line = em(0.25), imgui.get_color_u32(QUIET)
    for box in drawing.boxes:
        draw.add_rect_filled(*_corners(box, at), fill, rounded)
        draw.add_rect(*_corners(box, at), edge, rounded)
    for box in drawing.times:
        draw.add_rect_filled(*_corners(box, at), imgui.get_color_u32(BLUE))
    for box in drawing.bars:
        color = packed(box.color) if box.color else fill
        if box.hollow:
            draw.add_rect(*_corners(box, at), color, thickness=em(0.12))
        else:
            draw.add_rect_filled(*_corners(box, at), color)
    for arrow in drawing.arrows:
        _arrow(draw, arrow, at, line)
    for words in drawing.words:
        left = words.x - (_width_of(words.text) if words.right else 0.0)
        tone = QUIET if words.tone is Tone.QUIET else imgui.get_style_color_vec4(imgui.Col_.text)
        draw.add_text(ImVec2(at.x + left, at.y + words.y), imgui.get_color_u32(tone), words.text)
    if pointed is not None and pointed.view is not None:
        draw.add_rect(*_corners(pointed, at), imgui.get_color_u32(BLUE), rounded)


_SLOTS = imgui.Col_.frame_bg, imgui.Col_.border


def _arrow(draw: imgui.ImDrawList, arrow: Arrow, at: ImVec2, color: int) -> None:
    for (x0, y0), (x1, y1) in pairwise(arrow.points):
        draw.add_line(ImVec2(at.x + x0, at.y + y0), ImVec2(at.x + x1, at.y + y1), color, em(0.09))
    if arrow.head:
        a, b, c = (ImVec2(at.x + x, at.y + y) for x, y in arrow.head_of(em(_HEAD)))
        draw.add_triangle_filled(a, b, c, color)


def _corners(box: Box | Area, at: ImVec2) -> tuple[ImVec2, ImVec2]:
    start = ImVec2(at.x + box.x, at.y + box.y)
    return start, ImVec2(start.x + box.width, start.y + box.height)


def _width_of(text: str) -> float:
    return float(imgui.calc_text_size(text).x)
