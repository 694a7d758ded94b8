"""The slice through space: its rows in the panel View; and what a view of space says beside the pointer."""

from __future__ import annotations

from imgui_bundle import imgui

from viewer.state.draw_options import AXES
from viewer.state.pixels import pixel_at
from viewer.state.views import View
from viewer.views import view_of, words_at
from viewer.window.ui import Ui
from viewer.window.widgets import em, row, tooltip_at


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


def step(ui: Ui, layers: int) -> None:
    """Go on by so many layers."""
    session, frame = ui.controller.session, ui.controller.frame
    cut = session.draw.slice
    many = view_of(session.draw.view).layers(frame, cut.axis) if frame is not None else 0
    if many:
        session.set_draw(slice=cut.in_layer(cut.layer(many) + layers, many))


def lines_at(ui: Ui, x: int, y: int) -> list[str]:
    """What a pixel of the newest frame shows of space, in a view of that; nothing where it shows none."""
    c = ui.controller
    view = c.scheduler.drawn_view
    if c.frame is None or not (view.has_slice or view is View.CELL_LIGHTS):
        return []
    words = words_at(c.frame, c.session.draw, x, y)
    return [] if words in (("-",), ("miss",)) else list(words)


def show(ui: Ui) -> None:
    """Beside the pointer, what is under it."""
    c = ui.controller
    at, frame = c.selection.hovered, c.frame
    if at is None or frame is None or imgui.is_mouse_down(0):
        return
    lines = lines_at(ui, *pixel_at(frame, *at))
    if lines:
        tooltip_at("\n".join(lines))
