"""The panels View, what is shown of the frame, and Rendering, how finely it is traced."""

from __future__ import annotations

from dataclasses import replace

from imgui_bundle import imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from viewer.services.runs import missing_in
from viewer.state.draw_options import NEUTRAL
from viewer.state.view_state import LONGEST_FIXED_SIDE
from viewer.state.views import View, can_draw
from viewer.window.panels import legend, lights, slicing
from viewer.window.setting_rows import ALL, in_panel, setting_row, setting_switch, setting_switches
from viewer.window.ui import Ui
from viewer.window.widgets import QUIET, WARNING, em, paragraph, properties, right, row, size_field, tooltip

_BUTTON = 2.2  # ems that a row leaves for a button


def show(ui: Ui) -> None:
    """Show the panel View."""
    draw, scene = ui.controller.session.draw, ui.controller.session.scene
    settings = in_panel(ui, "View") + in_panel(ui, "Tone")
    with properties("view", 5.0) as shown:
        if shown:
            row("View", f"{draw.view.help}\nThe key of each view stands beside it in the list.")
            _views(ui)
            if draw.view.of_light and scene is not None and scene.lights:
                row("Light", f"The light that the view is about{ui.key('Next light')}.")
                lights.combo(ui, "view", draw.light, ui.controller.settings.set_light)
            if draw.view.has_slice:
                slicing.rows(ui)
            for one in settings:
                if one.path == "draw.tone.exposure" and not draw.tone.neutral:
                    setting_row(ui, one, room=_BUTTON)
                    _reset_tone(ui)
                elif one.kind is not bool:
                    setting_row(ui, one)
            _range(ui)
    setting_switches(ui, [one for one in settings if one.kind is bool])
    legend.in_panel(ui)
    _explanation(ui)


def show_rendering(ui: Ui) -> None:
    """Show the panel Rendering."""
    c = ui.controller
    pace = c.session.state.pace
    setting_switch(ui, ALL["pace.fixed_size"])
    if pace.fixed_size:
        imgui.same_line()
        width, height = size_field((pace.width, pace.height), LONGEST_FIXED_SIDE, c.notices.say)
        if (width, height) != (pace.width, pace.height):
            c.session.set_pace(width=width, height=height)
    setting_switch(ui, ALL["pace.progressive"])
    with properties("quality", 6.4) as shown:
        for one in in_panel(ui, "Rendering") if shown else ():
            if one.kind is not bool:
                setting_row(ui, one)
        if shown and c.session.scene is not None and c.session.scene.lights:
            lights.lamp_rows(ui)


def _reset_tone(ui: Ui) -> None:
    imgui.same_line(0.0, em(0.3))
    if imgui.button(f"{icons.ICON_FA_ROTATE_LEFT}##reset tone", (-1.0, 0.0)):
        ui.controller.session.set_draw(tone=NEUTRAL)
    tooltip("Reset exposure, white and curve: colours as traced.")


def _views(ui: Ui) -> None:
    """Show all views to choose from, each with its key."""
    chosen = ui.controller.session.draw.view
    if not imgui.begin_combo("##view", chosen.label, int(imgui.ComboFlags_.height_largest)):
        return
    for view in View:
        if imgui.selectable(f"{view.label}##{view.value}", view is chosen)[0]:
            ui.controller.session.set_draw(view=view)
        tooltip(view.help)
        if view is chosen:
            imgui.set_item_default_focus()
        imgui.same_line()
        right(ui.key_label(view.label), QUIET)
    imgui.end_combo()


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
    cost = " It traces every culled ray as well, so that frames take longer." if view.needs_verify else ""
    paragraph(f"{view.help}{cost}", QUIET)
