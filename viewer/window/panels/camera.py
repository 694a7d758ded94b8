"""The camera: where it is, how it is moved, and places to come back to."""

from __future__ import annotations

from dataclasses import replace

from imgui_bundle import imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from viewer.state import navigation
from viewer.window.camera_commands import focus
from viewer.window.panels import named_states
from viewer.window.setting_rows import ALL, setting_row, setting_switch
from viewer.window.ui import Ui
from viewer.window.widgets import (
    QUIET,
    checkbox,
    heading,
    paragraph,
    properties,
    row,
    same_line_for,
    tooltip,
    wide_button,
)

_MODES = {
    "Fly": "drag to look around, W A S D Q E to move",
    "Orbit": "drag to turn around the point that was clicked",
}


def show(ui: Ui) -> None:
    """The panel."""
    if ui.controller.session.scene is None:
        paragraph("No scene is open.", QUIET)
        return
    _place(ui)
    named_states.show_bookmarks(ui)
    _moving(ui)
    _path(ui)


def _place(ui: Ui) -> None:
    c = ui.controller
    camera = c.session.camera
    with properties("camera", 5.0) as shown:
        if shown:
            row("Position")
            changed, position = imgui.drag_float3(
                "##position", list(camera.position), 0.02 * c.motion.pace, format="%.4g"
            )
            if changed:
                c.motion.move(replace(camera, position=(position[0], position[1], position[2])))
            row("Direction")
            view = [float(x) for x in camera.basis()[2]]
            changed, direction = imgui.drag_float3("##direction", view, 0.01, -1.0, 1.0, "%.3f")
            if changed and sum(x * x for x in direction) > 1e-6:
                c.motion.move(replace(camera, direction=(direction[0], direction[1], direction[2])))
            row("Angle", "of the vertical field of view")
            changed, angle = imgui.slider_float("##angle", camera.angle, 5.0, 120.0, "%.1f degrees")
            if changed:
                c.motion.move(navigation.zoom(camera, angle))
    if wide_button(
        f"{icons.ICON_FA_CROSSHAIRS}  Focus", f"on what is selected, or under the pointer{ui.key('Focus')}", 2
    ):
        focus(ui)
    imgui.same_line()
    if wide_button(f"{icons.ICON_FA_ROTATE_LEFT}  Reset", f"back to the scene's own camera{ui.key('Reset camera')}"):
        c.motion.reset_camera()


def _moving(ui: Ui) -> None:
    p = ui.controller.preferences
    heading("Moving")
    with properties("moving", 5.0) as shown:
        if shown:
            row("Mode")
            for name, tip in _MODES.items():
                if name != "Fly":
                    same_line_for(name)
                if imgui.radio_button(name, p.navigation == name.lower()):
                    p.navigation = name.lower()
                tooltip(f"{tip}{ui.key(name)}")
            setting_row(ui, ALL["speed"])


def _path(ui: Ui) -> None:
    c = ui.controller
    p = c.preferences
    heading("Path and time")
    if not c.session.animated:
        paragraph("Nothing moves in this scene.", QUIET)
        return
    checkbox(
        "Follow the scene's path",
        c.session.on_path,
        c.motion.follow_path,
        "until the camera is moved by hand" + ui.key("Follow the scene's path"),
    )
    checkbox("Loop", p.loop, lambda on: setattr(p, "loop", on))
    every_frame = ALL["pace.every_frame"]
    same_line_for(every_frame.label)
    setting_switch(ui, every_frame)
    if not c.session.pace.every_frame:
        with properties("rate", 5.0) as shown:
            if shown:
                setting_row(ui, ALL["playback_rate"])
