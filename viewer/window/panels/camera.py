"""The camera: where it is, how it is moved, and places to come back to."""

from __future__ import annotations

from dataclasses import replace

from imgui_bundle import imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from viewer.window.camera_commands import focus
from viewer.window.panels import named_states
from viewer.window.setting_rows import ALL, setting_row
from viewer.window.ui import Ui
from viewer.window.widgets import QUIET, heading, paragraph, properties, row, same_line_for, tooltip, wide_button

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


def _place(ui: Ui) -> None:
    c = ui.controller
    camera = c.session.camera
    with properties("camera", 5.0) as shown:
        if shown:
            row("Position")
            changed, (x, y, z) = imgui.drag_float3(
                "##position", list(camera.position), 0.02 * c.motion.pace, format="%.4g"
            )
            if changed:
                c.motion.move(replace(camera, position=(x, y, z)))
            row("Direction")
            view = [float(part) for part in camera.basis()[2]]
            changed, (x, y, z) = imgui.drag_float3("##direction", view, 0.01, -1.0, 1.0, "%.3f")
            if changed and x * x + y * y + z * z > 1e-6:
                c.motion.move(replace(camera, direction=(x, y, z)))
            row("Angle", "of the vertical field of view")
            clamped = int(imgui.SliderFlags_.always_clamp)
            changed, angle = imgui.slider_float("##angle", camera.angle, 1.0, 170.0, "%.1f degrees", clamped)
            if changed:
                c.motion.move(replace(camera, angle=angle))
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
            if ui.controller.session.animated:
                setting_row(ui, ALL["playback_rate"])
