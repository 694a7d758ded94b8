"""The view: what is shown of the frame, and what its colours mean."""

from __future__ import annotations

from imgui_bundle import imgui

from viewer.services.runs import missing_in
from viewer.state.views import View
from viewer.window.panels import legend, lights, slicing, tone
from viewer.window.ui import Ui
from viewer.window.widgets import QUIET, WARNING, checkbox, em, paragraph, properties, right, row


def show(ui: Ui) -> None:
    """The panel."""
    c = ui.controller
    p = c.preferences
    with properties("view", 5.0) as shown:
        if shown:
            row("View", "what is shown of the frame; the key of each view stands beside it in the list")
            _views(ui)
            if c.session.view.of_light and c.session.scene is not None and c.session.scene.lights:
                row("Light", f"the light that the view is about{ui.keys('Next light', 'Previous light')}")
                lights.combo(ui)
            if c.session.view is View.WIPE:
                row("Line", "where it is; or drag it in the picture")
                changed, at = imgui.slider_float("##wipe", 100.0 * c.session.wipe, 0.0, 100.0, "%.0f %%")
                c.session.wipe = min(max(at / 100.0, 0.0), 1.0) if changed else c.session.wipe
            if c.session.view.has_slice:
                slicing.rows(ui)
            if c.session.view is View.DIFFERENCE or c.session.view.has_slice:
                row("Beneath", "how bright the picture is beneath the wrong pixels, or behind the slice")
                changed, percents = imgui.slider_float("##beneath", 100.0 * p.beneath, 0.0, 60.0, "%.0f %%")
                p.beneath = min(max(percents / 100.0, 0.0), 0.6) if changed else p.beneath
            if c.session.view.is_flat:
                row("Shading", "how much of the picture's light and shade shows under the colours")
                changed, shading = imgui.slider_float("##shading", p.shading, 0.0, 1.0, "%.2f")
                p.shading = min(max(shading, 0.0), 1.0) if changed else p.shading
            tone.rows(ui)
    checkbox(
        "Legend",
        p.legend,
        lambda on: setattr(p, "legend", on),
        f"in the picture{ui.key('Legend')}; drag it where you like",
    )
    imgui.same_line(0.0, em(1.0))
    checkbox(
        "Outlines", p.outlines, lambda on: setattr(p, "outlines", on), f"borders between primitives{ui.key('Outlines')}"
    )
    if c.session.view.needs_work:
        tip = "the share of the shadow rays due, or of the rays traced without culling, instead of counts"
        tip += ui.key("Shares of rays")
        checkbox("Shares", p.work_shares, lambda on: setattr(p, "work_shares", on), tip)
    if c.session.view.needs_verify:
        tip = f"rings around pixels with wrong shadow answers, so that a lone one is found{ui.key('Mark wrong pixels')}"
        checkbox("Mark wrong pixels", p.mark_wrong, lambda on: setattr(p, "mark_wrong", on), tip)
    tone.ticks(ui)
    legend.in_panel(ui)
    _explanation(ui)


def _views(ui: Ui) -> None:
    """All views to choose from, each with its key."""
    chosen = ui.controller.session.view
    if not imgui.begin_combo("##view", chosen.label, int(imgui.ComboFlags_.height_largest)):
        return
    for view in View:
        if imgui.selectable(f"{view.label}##{view.value}", view is chosen)[0]:
            ui.controller.settings.set_view(view)
        if view is chosen:
            imgui.set_item_default_focus()
        key = ui.key_label(view.label)
        if key:
            imgui.same_line()
            right(key, QUIET)
    imgui.end_combo()


def _explanation(ui: Ui) -> None:
    """What the view shows, and what it costs."""
    c = ui.controller
    view, run, text = c.session.view, c.runs.current, c.session.view.help
    lacks = missing_in(run, view) if run is not None else ""
    if lacks:
        paragraph(f"This run {lacks}.", WARNING)
    elif view.needs_verify:
        text += " It traces every culled ray as well, so that frames take longer."
    paragraph(text, QUIET)
