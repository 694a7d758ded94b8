"""The view: what is shown of the frame, what its colours mean, and how it is drawn."""

from __future__ import annotations

from dataclasses import replace

from imgui_bundle import imgui

from viewer.services.runs import missing_in
from viewer.state.readings import can_draw
from viewer.state.tone import MID_GREY, NEUTRAL
from viewer.state.views import View
from viewer.window.panels import legend, lights, slicing
from viewer.window.setting_rows import ALL, in_panel, setting_row, setting_switch
from viewer.window.ui import Ui
from viewer.window.widgets import QUIET, WARNING, em, paragraph, properties, right, row, same_line_for, tooltip


def show(ui: Ui) -> None:
    """Show the panel."""
    draw = ui.controller.session.draw
    settings = in_panel(ui, "View") + in_panel(ui, "Tone")
    with properties("view", 5.0) as shown:
        if shown:
            row("View", "What is shown of the frame; the key of each view stands beside it in the list.")
            _views(ui)
            if draw.view.of_light and ui.controller.session.scene is not None and ui.controller.session.scene.lights:
                row("Light", "The light that the view is about (L and Shift+L).")
                lights.combo(ui, "view", draw.light, ui.controller.settings.set_light)
            if draw.view.has_slice:
                slicing.rows(ui)
            for one in settings:
                if one.kind is not bool:
                    setting_row(ui, one, _mid_grey(ui) if one.path == "draw.tone.curve" else "")
            _range(ui)
    for place, one in enumerate(one for one in settings if one.kind is bool):
        if place:
            same_line_for(one.label)
        setting_switch(ui, one)
    if draw.view.shows_picture and not draw.tone.neutral and imgui.button("Reset tone", (-1.0, 0.0)):
        ui.controller.session.set_draw(tone=NEUTRAL)
    legend.in_panel(ui)
    _explanation(ui)


def _mid_grey(ui: Ui) -> str:
    tone = ui.controller.session.draw.tone
    return f"\nMid grey, {MID_GREY:g}, becomes {tone.mid_grey:.2f} with exposure, white and curve as they are."


def _views(ui: Ui) -> None:
    """All views to choose from, each with its key."""
    chosen = ui.controller.session.draw.view
    if not imgui.begin_combo("##view", chosen.label, int(imgui.ComboFlags_.height_largest)):
        return
    for view in View:
        if imgui.selectable(f"{view.label}##{view.value}", view is chosen)[0]:
            ui.controller.session.set_draw(view=view)
        if view is chosen:
            imgui.set_item_default_focus()
        key = ui.key_label(view.label)
        if key:
            imgui.same_line()
            right(key, QUIET)
    imgui.end_combo()


def _range(ui: Ui) -> None:
    """What has the first and the last colour: as the frame has it, or as it was set."""
    c = ui.controller
    draw, frame = c.session.draw, c.frame
    spans = ALL["draw.spans"]
    if not c.session.state.applies(spans) or frame is None or not can_draw(frame, draw.view, draw.light):
        return
    low, high = c.comparing.span(draw.view) or draw.view.declared.span(frame)
    row(spans.label, f"{spans.help} Drag, or Ctrl+click to type.")
    imgui.set_next_item_width(-em(4.2))
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
    """What the view shows, and what it costs."""
    c = ui.controller
    view, run, text = c.session.draw.view, c.runs.current, c.session.draw.view.help
    lacks = missing_in(run, view) if run is not None else ""
    if lacks:
        paragraph(f"This run {lacks}.", WARNING)
    elif view.needs_verify:
        text += " It traces every culled ray as well, so that frames take longer."
    paragraph(text, QUIET)
