"""The newest frame on the GPU: drawn when anything about it has changed, and saved when that was asked for."""

from __future__ import annotations

from dataclasses import replace

from viewer.services.controller import Controller
from viewer.services.frame_scheduler import Activity
from viewer.services.runs import missing_in
from viewer.state.methods import missing
from viewer.state.parts import parts_of
from viewer.state.savings import Tone, comparison, in_words
from viewer.state.views import View
from viewer.window.display import InWindow
from viewer.window.panels import legend, savings, sides
from viewer.window.ui import CaptureKind, Ui


def draw(ui: Ui) -> None:
    """Bring a new frame to the GPU, and draw the view if anything about it has changed."""
    display, c = ui.graphics.display, ui.controller
    display.context.gc()
    picked, now = c.selection.picked, c.session.edited
    if picked is not None and picked.part is not None and now is not None:
        display.part_of = ui.cached("parts", now, 0, lambda: parts_of(now.original).part_of[now.primitives])
    options, window = sides.draw_options(ui), in_window(ui)
    if picked is not None:
        window = replace(window, selected=picked.primitive, selected_part=-1 if picked.part is None else picked.part)
    display.draw(c.frame, options, window)
    sides.draw(ui, options)
    sides.magnify(ui, options)


def in_window(ui: Ui) -> InWindow:
    """Return what the window adds to the picture, but for what is selected."""
    return InWindow(fate=ui.fate_shown if ui.controller.scheduler.drawn_view is View.FATE else None)


def capture(ui: Ui) -> None:
    """Save the picture, or copy it, if that was asked for and it has come; where it will not come, say why."""
    c, wanted, display = ui.controller, ui.capture_wanted, ui.graphics.display
    if wanted not in (CaptureKind.PICTURE, CaptureKind.CLIPBOARD):
        ui.capture_view = None
        return
    view = ui.capture_view = ui.capture_view or c.session.draw.view
    why = _why_none(c) if view is c.session.draw.view else "another view was chosen before it came"
    if why:
        ui.capture_wanted = ui.capture_view = None
        c.notices.say(f"no picture of the view {view.label}: {why}", error=True)
        return
    shown = c.scheduler.drawn_view is c.session.draw.view
    ready = shown and not c.scheduler.becoming_finer  # else the picture is saved when it has come
    if ready:
        ui.capture_wanted = ui.capture_view = None
        options, window = sides.draw_options(ui), in_window(ui)  # without what is selected
        pixels = display.read() if display.draw(c.frame, options, window) else None
        compared = pixels is not None and c.comparing.seen is not None
        if pixels is not None and compared:
            pixels = sides.composed_picture(ui, pixels)
        described = legend.of_picture(ui) if c.preferences.legend_in_pictures else None
        state = c.pictures.state_of(c.frame, options.view) if c.frame is not None and not compared else None
        if state is not None and c.frame is not None and state.draw.savings is not None:
            known = (one for one in comparison(c.frame, savings.standing(c)) if one.tone is not Tone.QUIET)
            state = state.with_draw(savings=in_words(known))
        take = c.captures.copy if wanted is CaptureKind.CLIPBOARD else c.captures.capture
        take(c.frame, pixels, described, state)


def _why_none(c: Controller) -> str:
    """Why there is no picture in the chosen view, and none is on its way; nothing where there is, or may be."""
    frame, view, run = c.frame, c.session.draw.view, c.runs.current
    if frame is None or c.scheduler.drawn_view is view:
        return ""
    if run is not None and (lacks := missing_in(run, view)):
        return f"the {run.name} {lacks}"
    if run is None and (c.renderer.busy or c.scheduler.activity not in (Activity.RESTING, Activity.ADDING_SAMPLES)):
        return ""
    found = missing(view, frame)
    return found.text if found is not None else ""
