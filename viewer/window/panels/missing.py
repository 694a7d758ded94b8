"""Over the picture: why a view has nothing to show, and a button for the method that has."""

from __future__ import annotations

from imgui_bundle import ImVec2, ImVec4, imgui

from viewer.state.methods import missing, with_base
from viewer.window.ui import Ui
from viewer.window.widgets import em, paragraph, tooltip

_WIDTH, _LEAST = 26.0, 8.0  # in ems: of the note, and of a picture that has room for one
_BACK, _FRONT = ImVec4(0.05, 0.06, 0.08, 0.86), ImVec4(0.93, 0.94, 0.96, 1.0)


def show(ui: Ui, corner: ImVec2, end: ImVec2) -> None:
    """A note in the middle of the picture, below its upper third."""
    c, run, room = ui.controller, ui.controller.runs.current, end.x - corner.x - em(2.0)
    found = missing(c.session.draw.view, c.frame, c.renderer.busy) if c.frame is not None else None
    if found is None or room < em(_LEAST):
        return
    width = min(em(_WIDTH), room)
    imgui.set_cursor_screen_pos(ImVec2((corner.x + end.x - width) / 2.0, corner.y + (end.y - corner.y) / 3.0))
    imgui.push_style_color(imgui.Col_.child_bg, _BACK)
    flags = imgui.ChildFlags_.auto_resize_y | imgui.ChildFlags_.always_use_window_padding
    if imgui.begin_child("missing", ImVec2(width, 0.0), int(flags)):
        paragraph(found.text, _FRONT)
        imgui.begin_disabled(run is not None)
        if found.base and imgui.button(f"Use {found.base}##instead"):
            c.settings.change(method=with_base(c.session.settings.method, found.base))
        if found.accelerator and imgui.button(f"Use {found.accelerator}##instead"):
            c.settings.change(accelerator=found.accelerator)
        imgui.end_disabled()
        if run is not None:
            tooltip(f"Not while the {run.name} runs. Escape stops it.")
    imgui.end_child()
    imgui.pop_style_color()
