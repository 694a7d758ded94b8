"""The camera: where it is, how it is moved, and places to come back to; and the menus Camera and Time."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial

import numpy as np
from imgui_bundle import imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from tracer.scene.model import Camera
from tracer.util.setting import Setting
from viewer.state import codec, navigation
from viewer.state.picking import extent_at, point_at, points_of
from viewer.state.preferences import NAVIGATION
from viewer.window import menus
from viewer.window.command import Command, Condition, Kind, scene_open
from viewer.window.panels import named_states
from viewer.window.panels.named_states import KEYED_BOOKMARKS
from viewer.window.setting_rows import panel_rows, setting_command, setting_row
from viewer.window.ui import Ui
from viewer.window.widgets import QUIET, heading, paragraph, properties, row


def show(ui: Ui) -> None:
    """The panel."""
    if ui.controller.session.scene is None:
        paragraph("No scene is open.", QUIET)
        return
    _place(ui)
    named_states.show_bookmarks(ui)
    heading("Moving")
    panel_rows(ui, "Camera", 5.0, {"playback_rate": _rate})


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
    menus.button(ui, "Focus", icons.ICON_FA_CROSSHAIRS, columns=2)
    imgui.same_line()
    menus.button(ui, "Reset camera", icons.ICON_FA_ROTATE_LEFT, "Reset")


def _rate(ui: Ui, one: Setting) -> None:
    if ui.controller.session.animated:
        setting_row(ui, one)


# --- what it does, and the menus -------------------------------------------------------------------


def camera_commands(ui: Ui) -> list[Command]:
    """The menu Camera."""
    c, p = ui.controller, ui.controller.preferences
    here = scene_open(c)

    def mode(name: str, key: str) -> Command:
        return Command(name.capitalize(), "Camera", lambda: setattr(p, "navigation", name), key, tip=NAVIGATION[name],
                       checked=lambda: p.navigation == name)  # fmt: skip

    marks, text = "Camera/Bookmarks", "Camera/Copy and paste"
    return [
        mode("fly", "G"),
        mode("orbit", "O"),
        Command("Focus", "Camera", lambda: focus(ui), "F", enabled=here, separated=True,
                tip="on what is under the pointer, or is selected"),
        Command("Reset camera", "Camera", lambda: c.motion.follow_path(True), "R", enabled=here),
        Command("Follow the scene's path", "Camera", lambda: c.motion.follow_path(not c.session.on_path), "P",
                checked=lambda: c.session.on_path, enabled=here),
        Command("Copy camera", text, lambda: _copy(ui), "Ctrl+Shift+C", enabled=here, separated=True,
                tip="as JSON, which `shadowcull render --camera` takes"),
        Command("Paste camera", text, lambda: _paste(ui), "Ctrl+Shift+V", enabled=here, tip="JSON from the clipboard"),
        Command("Add bookmark", marks, c.bookmarks.add, "Ctrl+B", enabled=here),
        *[_bookmark(ui, index) for index in range(KEYED_BOOKMARKS)],
    ]  # fmt: skip


def time_commands(ui: Ui) -> list[Command]:
    """The menu Time."""
    c = ui.controller
    moves = Condition(lambda: c.session.animated, "nothing moves in this scene")

    def to_end() -> None:
        if c.session.scene is not None:
            c.motion.step(c.session.scene.frames)

    return [
        Command("Play", "Time", c.motion.toggle_play, "Space", checked=lambda: c.session.playing, enabled=moves),
        Command("Step forward", "Time", lambda: c.motion.step(1), "RightArrow", enabled=moves, repeats=True),
        Command("Step back", "Time", lambda: c.motion.step(-1), "LeftArrow", enabled=moves, repeats=True),
        Command("First frame", "Time", lambda: c.motion.step(-c.session.frame), "Home", enabled=moves),
        Command("Last frame", "Time", to_end, "End", enabled=moves),
        setting_command(ui, "loop", "Time", separated=True),
        setting_command(ui, "pace.every_frame", "Time"),
    ]


def focus(ui: Ui) -> None:
    """Turn to what is under the pointer, else to what is selected, and go near it; orbits turn around it then."""
    c = ui.controller
    at, picked, pixel = c.selection.hovered, c.selection.picked, c.selection.pixel
    if at is None and pixel is not None and picked is not None and picked.part is None and c.frame is not None:
        at = (pixel[0] + 0.5) / c.frame.width, (pixel[1] + 0.5) / c.frame.height
    if at is None and picked is not None:
        fly_to_selected(ui)
    elif at is None or c.frame is None:
        c.notices.say("Point at something, or click it, to focus on it.")
    else:
        point, extent = point_at(c.frame, *at), extent_at(c.frame, *at)
        if point is None or extent is None:
            c.notices.say("there is nothing to focus on here")
        else:
            _go_near(ui, point, extent)


def fly_to_selected(ui: Ui) -> None:
    """Go near what is selected, whether or not it is seen from here; orbits turn around it then."""
    c = ui.controller
    now, picked = c.session.edited, c.selection.picked
    if now is None or picked is None:
        return
    points = points_of(now, picked, c.session.time)
    if not len(points):
        c.notices.say("the selection is not in the scene at this time")
        return
    low, high = points.min(axis=0), points.max(axis=0)
    _go_near(ui, 0.5 * (low + high), 0.5 * math.dist(low, high))


def _go_near(ui: Ui, point: np.ndarray, radius: float) -> None:
    motion = ui.controller.motion
    x, y, z = point.tolist()
    ui.picture.pivot = x, y, z
    motion.glide(navigation.focus(ui.controller.session.camera, ui.picture.pivot, radius, motion.world_up))


def _copy(ui: Ui) -> None:
    imgui.set_clipboard_text(codec.text(ui.controller.session.camera.to_json()))
    ui.controller.notices.say("camera copied as JSON")


def _paste(ui: Ui) -> None:
    """Fly to the camera on the clipboard; what its JSON leaves out stays as it is."""
    c = ui.controller
    try:
        data = c.session.camera.to_json() | {"position": None} | codec.from_text(imgui.get_clipboard_text() or "")
        c.motion.glide(Camera.from_json(data))
    except (TypeError, ValueError):
        c.notices.say("no camera pasted: the clipboard holds no camera as JSON", error=True)
    else:
        c.notices.say("camera pasted")


def _bookmark(ui: Ui, index: int) -> Command:
    c, marks = ui.controller, ui.controller.bookmarks

    def title() -> str:
        return f"{index + 1}  {marks.all[index].name}" if index < len(marks.all) else ""

    there = Condition(lambda: index < len(marks.all), "this scene has fewer bookmarks")
    return Command(f"Go to bookmark {index + 1}", "Camera/Bookmarks", partial(c.go_to_bookmark, index),
                   f"Alt+{index + 1}", enabled=there, title=title, separated=not index, kind=Kind.BOOKMARK)  # fmt: skip
