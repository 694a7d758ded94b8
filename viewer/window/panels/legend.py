"""The legend of the view: in the panel View or, where that is not in sight, in the picture, where it can be dragged."""

from __future__ import annotations

from dataclasses import dataclass, replace

from imgui_bundle import ImVec2, imgui

from viewer.state.palette import DARK
from viewer.views import legend_of
from viewer.views.legend import BACKDROP_OPACITY, Layout, Legend, fitting, lay_out
from viewer.window.panels import sides
from viewer.window.panels.area import Area, inside
from viewer.window.ui import Ui
from viewer.window.widgets import em, packed, tooltip_at, width_of

_MARGIN = 0.5  # ems between the legend and the picture's edge
_MOST, _MOST_AREA = 0.62, 0.15  # of the picture's width, of its height, and of all of it


@dataclass
class LegendState:
    """The frame of the window in which the panel showed the legend last, whether the picture shows it, and where the
    pointer holds it there."""

    in_panel: int = -2
    in_picture: bool = False
    held: tuple[float, float] = (0.0, 0.0)


def of_picture(ui: Ui) -> Legend | None:
    """The legend of what is drawn of the newest frame; None where there is none."""
    c = ui.controller
    frame, scene = c.frame, c.session.scene
    if frame is None or scene is None:
        return None
    of_both = sides.legend(ui)
    if of_both is not None:
        return of_both
    options, seen = sides.draw_options(ui), c.comparing.seen
    if seen is not None and seen.shows_a:
        frame, options = seen.a.frame, replace(options, view=seen.a.view, light=seen.a.light)
    kept = "legend" if frame is c.frame else "legend of A"
    lights = scene.lights
    found: Legend | None = ui.cached(
        kept, frame, (options.of_pixels(), lights), lambda: legend_of(frame, options, lights)
    )
    return found


def in_panel(ui: Ui) -> None:
    """The whole legend at the cursor."""
    ui.state(LegendState).in_panel = imgui.get_frame_count()
    legend = of_picture(ui)
    if legend is not None:
        draw(legend)


def in_sight(ui: Ui) -> bool:
    """Whether the panel shows the legend."""
    return imgui.get_frame_count() - ui.state(LegendState).in_panel <= 1


def is_shown(ui: Ui) -> bool:
    """Whether the panel or the picture shows it, where there was room last."""
    return in_sight(ui) or ui.state(LegendState).in_picture


def draw(legend: Legend) -> None:
    """A whole legend at the cursor."""
    layout = fitting(legend, width_of, imgui.get_text_line_height(), imgui.get_content_region_avail().x, 1e6)
    layout = layout or lay_out(legend, width_of, imgui.get_text_line_height())
    at = imgui.get_cursor_screen_pos()
    draw_layout(layout, at)
    imgui.dummy(ImVec2(layout.width, layout.height))
    if imgui.is_item_hovered():
        _tell(layout, at)


def show(ui: Ui, area: Area) -> None:
    """Over the picture, unless the panel shows it: where it was put, and always inside."""
    state, corner, end = ui.state(LegendState), area.corner, area.end
    state.in_picture = False
    legend, options = of_picture(ui), ui.controller.session.draw
    if legend is None or not options.legend or in_sight(ui):
        return
    width, height = end.x - corner.x, end.y - corner.y
    line, most = imgui.get_text_line_height(), _MOST_AREA * width * height
    layout = fitting(legend, width_of, line, _MOST * width, _MOST * height, most)
    if layout is None:
        return
    state.in_picture = True
    margin = em(_MARGIN)
    least = ImVec2(corner.x + margin, corner.y + margin + imgui.get_text_line_height() + em(0.7))  # below the title
    room = ImVec2(end.x - margin - layout.width - least.x, end.y - margin - layout.height - least.y)
    room = ImVec2(max(room.x, 1.0), max(room.y, 1.0))
    across, down = options.legend_at
    at = ImVec2(round(least.x + across * room.x), round(least.y + down * room.y))
    imgui.set_cursor_screen_pos(at)
    imgui.invisible_button("legend", ImVec2(layout.width, layout.height))
    _drag(ui, at, least, room)
    with inside(area):
        draw_layout(layout, at)
    if imgui.is_item_hovered() and not imgui.is_item_active():
        corner = ImVec2(at.x + layout.width, at.y + layout.height)
        imgui.get_window_draw_list().add_rect(at, corner, packed((1.0, 1.0, 1.0), 0.35), em(0.3))
        _tell(layout, at)


def _drag(ui: Ui, at: ImVec2, least: ImVec2, room: ImVec2) -> None:
    """Follow the pointer that holds it."""
    state, mouse = ui.state(LegendState), imgui.get_io().mouse_pos
    if imgui.is_item_activated():
        state.held = mouse.x - at.x, mouse.y - at.y
    if imgui.is_item_hovered() or imgui.is_item_active():
        imgui.set_mouse_cursor(imgui.MouseCursor_.resize_all)
    if imgui.is_item_active():
        across, down = (mouse.x - state.held[0] - least.x) / room.x, (mouse.y - state.held[1] - least.y) / room.y
        ui.controller.session.set_draw(legend_at=(min(max(across, 0.0), 1.0), min(max(down, 0.0), 1.0)))


def draw_layout(layout: Layout, at: ImVec2) -> None:
    """Draw a legend as it is laid out."""
    draw, end = imgui.get_window_draw_list(), ImVec2(at.x + layout.width, at.y + layout.height)
    draw.add_rect_filled(at, end, packed(DARK, BACKDROP_OPACITY), em(0.3))
    for box in layout.boxes:
        start = ImVec2(at.x + box.x, at.y + box.y)
        draw.add_rect_filled(start, ImVec2(start.x + box.width, start.y + box.height), packed(box.color))
    for words in layout.words:
        draw.add_text(ImVec2(at.x + words.x, at.y + words.y), packed(words.color), words.text)


def _tell(layout: Layout, at: ImVec2) -> None:
    """What the line under the pointer stands for."""
    y = imgui.get_io().mouse_pos.y - at.y
    for top, bottom, text in layout.tips:
        if top <= y < bottom:
            tooltip_at(text)
