"""The slice through space: its rows in the panel View; and what a view of space says beside the pointer."""

from __future__ import annotations

import numpy as np
from imgui_bundle import imgui

from tracer.light_cut import LightCut
from viewer.services.controller import Controller
from viewer.services.inspector import MOST_CLUSTERS
from viewer.state.draw_options import AXES
from viewer.state.pixels import pixel_at
from viewer.state.views import View
from viewer.util.numbers import several
from viewer.views import view_of, words_at
from viewer.window.panels.area import Area, write_beside
from viewer.window.panels.legend import LegendState
from viewer.window.panels.status import traced_before_an_answer
from viewer.window.ui import Ui
from viewer.window.widgets import em, percent, row


def rows(ui: Ui) -> None:
    """Rows of the panel's table."""
    session, frame = ui.controller.session, ui.controller.frame
    cut = session.draw.slice
    row("Slice", "The axis that the slice goes across.")
    for axis, name in enumerate(AXES):
        if axis:
            imgui.same_line(0.0, em(0.6))
        if imgui.radio_button(f"{name}##slice", cut.axis == axis):
            session.set_draw(slice=cut._replace(axis=axis))
    layers = view_of(session.draw.view).layers(frame, cut.axis) if frame is not None else 0
    if layers:
        row("Layer", "Where along the axis it is. Ctrl+click to type a number.")
        flags = int(imgui.SliderFlags_.always_clamp)
        changed, number = imgui.slider_int("##layer", cut.layer(layers), 0, layers - 1, "%d", flags)
        if changed:
            session.set_draw(slice=cut.in_layer(number, layers))


def lines_at(ui: Ui, x: int, y: int) -> list[str]:
    """What a pixel of the newest frame shows of space, in a view of that; nothing where it shows none."""
    c = ui.controller
    view, lit = c.scheduler.drawn_view, c.inspector.cut
    if c.frame is not None and (view.has_slice or view is View.CELL_LIGHTS):
        words = words_at(c.frame, c.session.draw, x, y)
        return [] if words in (("-",), ("miss",)) else list(words)
    if view is View.CUTS and lit is not None and (lit.x, lit.y) == (x, y):
        return cut_lines(lit)
    if view is View.CUTS and c.selection.picked is None and c.inspector.awaits_cut == (x, y):
        return awaited(c)
    return []


def awaited(c: Controller) -> list[str]:
    """That the clusters of a pixel are to come, where they do not come at once."""
    before = traced_before_an_answer(c)
    return [f"its clusters are drawn after {before}"] if before else []


def cut_lines(cut: LightCut) -> list[str]:
    """What shades a pixel, in a few lines."""
    many, single, cuts = len(cut.nodes), int((cut.lights == 1).sum()), cut.frame.statistics.cuts
    shade = f"{several(many, 'cluster')} {'shades' if many == 1 else 'shade'} it"
    one = "single light" if cuts is None or cuts.lights == cut.frame.lights else "single sample"
    lines = [f"{shade}, {several(single, one)} among them"]
    total = float(cut.sent.sum())
    if total > 0.0:
        lines.append(f"the brightest sends {percent(float(np.max(cut.sent)), total)} of their light")
    if many > MOST_CLUSTERS:
        lines.append(f"drawn are the {MOST_CLUSTERS} that send most")
    return lines


def show(ui: Ui, area: Area) -> None:
    """Beside the pointer, what is under it."""
    c = ui.controller
    at, frame = c.selection.hovered, c.frame
    if at is None or frame is None or imgui.is_mouse_down(0):
        return
    lines = lines_at(ui, *pixel_at(frame, *at))
    if lines:
        room = area.corner.x, area.corner.y, area.end.x, area.end.y
        write_beside(lines, imgui.get_io().mouse_pos, room, ui.state(LegendState).place)
