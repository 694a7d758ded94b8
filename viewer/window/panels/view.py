"""The panels View, what is shown of the frame, and Rendering, how finely it is traced."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

from imgui_bundle import imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from tracer.util.setting import Setting
from viewer.services.runs import missing_in
from viewer.state.draw_options import AXES
from viewer.state.pixels import pixel_at
from viewer.state.view_state import LONGEST_FIXED_SIDE
from viewer.state.views import Record, View, can_draw
from viewer.views import view_of, words_at
from viewer.window import menus
from viewer.window.panels import legend, lights
from viewer.window.setting_rows import ALL, panel_rows, setting_row
from viewer.window.ui import Ui
from viewer.window.widgets import QUIET, WARNING, em, one_of, paragraph, row, size_field, tooltip, tooltip_at


def show(ui: Ui) -> None:
    """Show the panel View."""
    legend.in_panel(ui)
    panel_rows(ui, "View", 5.0, {"draw.tone.exposure": _exposure}, partial(_slice, ui), partial(_range, ui))
    _explanation(ui)


def show_rendering(ui: Ui) -> None:
    """Show the panel Rendering."""
    lamps = {"settings.lamp_radius": lights.lamp_radius, "settings.lamp_samples": lights.lamp_samples}
    panel_rows(ui, "Rendering", 6.4, {"pace.fixed_size": _fixed_size, **lamps}, also=("Lamps",))


def _fixed_size(ui: Ui, one: Setting) -> None:
    """Show whether pictures have a size of their own, and which."""
    c, pace = ui.controller, ui.controller.session.state.pace
    setting_row(ui, one)
    if pace.fixed_size:
        imgui.same_line()
        width, height = size_field((pace.width, pace.height), LONGEST_FIXED_SIDE, c.notices.say)
        if (width, height) != (pace.width, pace.height):
            c.session.set_pace(width=width, height=height)


def _exposure(ui: Ui, one: Setting) -> None:
    setting_row(ui, one, room=2.2)
    imgui.same_line(0.0, em(0.3))
    menus.button(ui, "Colours as traced", icons.ICON_FA_ROTATE_LEFT, width=1.9)


def _range(ui: Ui) -> None:
    """Show what has the first and the last colour: as the frame has it, or as it was set."""
    c = ui.controller
    draw, frame, spans = c.session.draw, c.frame, ALL["draw.spans"]
    if not c.session.state.applies(spans) or frame is None or not can_draw(frame, draw.view, draw.light):
        return
    low, high = c.comparing.span(draw.view) or draw.view.declared.span(frame)
    row(spans.label, f"{spans.help} Drag, or Ctrl+click to type.", room=4.2)
    speed = max((high - low) / 200.0, 1e-6)
    changed, low, high = imgui.drag_float_range2("##range", low, high, speed, 0.0, 0.0, "%.4g", "%.4g")
    if changed and low < high:
        c.session.state = replace(c.session.state, draw=draw.with_span((low, high)))
    imgui.same_line(0.0, em(0.3))
    imgui.begin_disabled(draw.span is None)
    if imgui.button("Fit##range", (-1.0, 0.0)):
        c.session.state = replace(c.session.state, draw=draw.with_span(None))
    imgui.end_disabled()
    tooltip("Let the range follow what each frame has.")


def _explanation(ui: Ui) -> None:
    """Show what the view shows, and what it costs."""
    c = ui.controller
    view, run = c.session.draw.view, c.runs.current
    lacks = missing_in(run, view) if run is not None else ""
    if lacks:
        paragraph(f"This run {lacks}.", WARNING)
        return
    cost = " It traces every culled ray as well, so that frames take longer." if view.records is Record.VERIFY else ""
    paragraph(f"{view.help}{cost}", QUIET)


# --- views of space: the slice through it, and what they say beside the pointer -------------------------


def _slice(ui: Ui) -> None:
    """Show rows of the slice through space, in views that have one."""
    session, frame = ui.controller.session, ui.controller.frame
    if not session.draw.view.has_slice:
        return
    cut = session.draw.slice
    row("Slice", "The axis that the slice goes across.")
    axis = one_of(((number, f"{name}##slice", "") for number, name in enumerate(AXES)), cut.axis)
    if axis != cut.axis:
        session.set_draw(slice=cut._replace(axis=axis))
    layers = view_of(session.draw.view).layers(frame, cut.axis) if frame is not None else 0
    if layers:
        row("Layer", "Where along the axis it is. Ctrl+click to type a number.")
        flags = int(imgui.SliderFlags_.always_clamp)
        changed, number = imgui.slider_int("##layer", cut.layer(layers), 0, layers - 1, "%d", flags)
        if changed:
            session.set_draw(slice=cut.in_layer(number, layers))


def step_slice(ui: Ui, layers: int) -> None:
    """Move the slice by so many layers."""
    session, frame = ui.controller.session, ui.controller.frame
    cut = session.draw.slice
    many = view_of(session.draw.view).layers(frame, cut.axis) if frame is not None else 0
    if many:
        session.set_draw(slice=cut.in_layer(cut.layer(many) + layers, many))


def words_in_space(ui: Ui, x: int, y: int) -> list[str]:
    """What a pixel of the newest frame shows of space, in a view of that; nothing where it shows none."""
    c = ui.controller
    view = c.scheduler.drawn_view
    if c.frame is None or not (view.has_slice or view is View.CELL_LIGHTS):
        return []
    words = words_at(c.frame, c.session.draw, x, y)
    return [] if words in (("-",), ("miss",)) else list(words)


def show_words_in_space(ui: Ui) -> None:
    """Beside the pointer, what is under it."""
    c = ui.controller
    at, frame = c.selection.hovered, c.frame
    if at is None or frame is None or imgui.is_mouse_down(0):
        return
    lines = words_in_space(ui, *pixel_at(frame, *at))
    if lines:
        tooltip_at("\n".join(lines))
