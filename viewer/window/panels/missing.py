"""Over the picture: why a view has nothing to show, and a button for the method that has."""

from __future__ import annotations

from imgui_bundle import ImVec2, ImVec4, imgui

from viewer.state.methods import with_base
from viewer.state.missing import missing
from viewer.state.views import View
from viewer.window.ui import Ui
from viewer.window.widgets import em, tooltip

_WIDTH, _LEAST = 26.0, 8.0  # in ems: of the note, and of a picture that has room for one
_BACK, _FRONT = ImVec4(0.05, 0.06, 0.08, 0.86), ImVec4(0.93, 0.94, 0.96, 1.0)


def show(ui: Ui, corner: ImVec2, end: ImVec2) -> None:
    """A note in the middle of the picture, below its upper third."""
    c = ui.controller
    frame, shares = c.frame, c.session.draw.shares
    found = missing(c.session.draw.view, frame, shares, c.renderer.busy) if frame is not None else None
    left, right = _free(ui, corner.x, end.x)
    room = right - left - em(2.0)
    if found is None or room < em(_LEAST):
        return
    width = min(em(_WIDTH), room)
    imgui.set_cursor_screen_pos(ImVec2((left + right - width) / 2.0, corner.y + (end.y - corner.y) / 3.0))
    imgui.push_style_color(imgui.Col_.child_bg, _BACK)
    imgui.push_style_var(imgui.StyleVar_.child_rounding, em(0.4))
    imgui.push_style_var(imgui.StyleVar_.window_padding, ImVec2(em(0.8), em(0.7)))
    flags = imgui.ChildFlags_.auto_resize_y | imgui.ChildFlags_.always_use_window_padding
    if imgui.begin_child("missing", ImVec2(width, 0.0), int(flags)):
        imgui.push_text_wrap_pos(0.0)
        imgui.text_colored(_FRONT, found.text)
        imgui.pop_text_wrap_pos()
        if found.base and _button(ui, found.base):
            c.settings.change(method=with_base(c.session.settings.method, found.base))
        if found.accelerator and _button(ui, found.accelerator):
            c.settings.change(accelerator=found.accelerator)
    imgui.end_child()
    imgui.pop_style_var(2)
    imgui.pop_style_color()


def _button(ui: Ui, what: str) -> bool:
    """The button that takes up a method or a structure: pale while a run goes on, and it says why."""
    run = ui.controller.runs.current
    imgui.begin_disabled(run is not None)
    clicked = imgui.button(f"Use {what}##instead")
    imgui.end_disabled()
    if run is not None:
        tooltip(f"Not while the {run.name} runs. Escape stops it.")
    return clicked


def _free(ui: Ui, left: float, right: float) -> tuple[float, float]:
    """From where to where across the picture a note may lie: on the wider side of the wipe's line, where that is."""
    if ui.controller.scheduler.drawn_view is not View.WIPE:
        return left, right
    line = left + ui.controller.session.draw.wipe * (right - left)
    return (left, line) if line - left > right - line else (line, right)
