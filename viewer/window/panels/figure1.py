"""Figure 1 of the paper with the newest frame's numbers; a click on a part opens the view that shows it."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

from imgui_bundle import ImVec2, imgui

from viewer.output.figure1 import figure_of
from viewer.output.figure1_drawing import BOX, QUIET, STRONG, TEXT, TIME, Arrow, Box, Drawing, Words, arrange, lay_out
from viewer.window import widgets
from viewer.window.panels import status
from viewer.window.style import TEAL
from viewer.window.ui import Ui
from viewer.window.widgets import em, packed, paragraph, tooltip_at, width_of


def show(ui: Ui) -> None:
    """The panel."""
    c = ui.controller
    frame = c.frame
    if frame is None:
        paragraph(status.first_picture(c), widgets.QUIET)
        return
    style, room, line = imgui.get_style(), imgui.get_content_region_avail(), imgui.get_text_line_height()
    # The same width with a scroll bar as without, so that neither brings about the other.
    width = imgui.get_window_width() - 2.0 * style.window_padding.x - style.scrollbar_size

    def laid_out() -> Drawing:
        # The status bar and other panels say of what picture it is.
        figure = replace(figure_of(frame), title="")
        names = [(stage.heading, *(flow.name for flow in stage.flows)) for stage in figure.stages]
        arranged = ui.cached(  # while only numbers change, it stays, and is not looked for anew
            "arrangement of figure 1", c.session.scene, (place, names), lambda: arrange(figure, width_of, *place)
        )
        return lay_out(figure, width_of, *place, arranged)

    place = line, width, room.y
    drawing: Drawing = ui.cached("figure 1", frame, place, laid_out)
    at, scale = imgui.get_cursor_screen_pos(), drawing.scale
    size = ImVec2(max(scale * drawing.width, 1.0), max(scale * drawing.height, 1.0))
    clicked = imgui.invisible_button("figure 1", size)
    mouse = imgui.get_mouse_pos()
    box = drawing.at(mouse.x - at.x, mouse.y - at.y) if imgui.is_item_hovered() else None
    for part in drawing.parts:
        _draw(part, at, scale)
    if box is None:
        return
    tooltip_at(box.tip if box.view is None else f"{box.tip}\nClick for the view {box.view.label}.")
    if box.view is not None:
        imgui.set_mouse_cursor(imgui.MouseCursor_.hand)
        if clicked:
            c.session.set_draw(view=box.view)


_INKS = {BOX: imgui.Col_.frame_bg, TEXT: imgui.Col_.text, STRONG: imgui.Col_.text}


def _color(ink: str) -> int:
    fixed = {TIME: TEAL, QUIET: widgets.QUIET}
    return imgui.get_color_u32(fixed[ink] if ink in fixed else imgui.get_style_color_vec4(_INKS[ink]))


def _draw(part: Box | Words | Arrow, at: ImVec2, scale: float) -> None:
    draw = imgui.get_window_draw_list()

    def placed(x: float, y: float) -> ImVec2:
        return ImVec2(at.x + scale * x, at.y + scale * y)

    if isinstance(part, Words):
        place = placed(part.x - (width_of(part.text) if part.right else 0.0), part.y)
        draw.add_text(imgui.get_font(), scale * imgui.get_font_size(), place, _color(part.ink), part.text)
    elif isinstance(part, Arrow):
        for start, end in pairwise(part.points):
            draw.add_line(placed(*start), placed(*end), _color(QUIET), em(0.09))
        if part.head:
            tip, left, right = (placed(*corner) for corner in part.corners)
            draw.add_triangle_filled(tip, left, right, _color(QUIET))
    elif part.ink:
        corners = placed(part.x, part.y), placed(part.x + part.width, part.y + part.height)
        color = _color(part.ink) if isinstance(part.ink, str) else packed(part.ink)
        if part.hollow:
            draw.add_rect(*corners, color, thickness=em(0.12))
        else:
            draw.add_rect_filled(*corners, color, em(0.25) if part.ink == BOX else 0.0)
