"""How finely to trace: resolution, in motion and at rest, and the rays of a pixel."""

from __future__ import annotations

from imgui_bundle import imgui

from viewer.state.view_state import LONGEST_SIDE
from viewer.window.panels import lights
from viewer.window.setting_rows import ALL, in_panel, setting_row, setting_switch
from viewer.window.ui import Ui
from viewer.window.widgets import properties, size_field


def show(ui: Ui) -> None:
    """Show the panel."""
    c = ui.controller
    pace = c.session.pace
    setting_switch(ui, ALL["pace.fixed_size"])
    if pace.fixed_size:
        imgui.same_line()
        width, height = size_field((pace.width, pace.height), LONGEST_SIDE, c.notices.say)
        if (width, height) != (pace.width, pace.height):
            c.session.set_pace(width=width, height=height)
    setting_switch(ui, ALL["pace.progressive"])
    with properties("quality", 6.4) as shown:
        for one in in_panel(ui, "Rendering") if shown else ():
            if one.kind is not bool:
                setting_row(ui, one)
        if shown and c.session.scene is not None and c.session.scene.lights:
            lights.lamp_rows(ui)
