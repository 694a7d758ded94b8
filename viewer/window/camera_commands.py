"""The menus Camera and Time: how the camera moves, what it turns around, bookmarks, copies for other programs."""

from __future__ import annotations

import math
from collections.abc import Callable

from viewer.state import camera_text, navigation
from viewer.state.picking import extent_at, part_points, point_at, primitive_points
from viewer.window.command import Command, Condition, scene_open, switch
from viewer.window.setting_rows import setting_command
from viewer.window.ui import Ui

KEYED_BOOKMARKS = 9

# Name: right, up and towards us, as `navigation.looking_from` has them; and key.
_SIDES = (
    ("the front", (0, 0, 1), "Keypad1"),
    ("the back", (0, 0, -1), "Ctrl+Keypad1"),
    ("the right", (1, 0, 0), "Keypad3"),
    ("the left", (-1, 0, 0), "Ctrl+Keypad3"),
    ("the top", (0, 1, 0), "Keypad7"),
    ("below", (0, -1, 0), "Ctrl+Keypad7"),
)


def camera(ui: Ui) -> list[Command]:
    """The menu Camera."""
    c, p = ui.controller, ui.controller.preferences
    here = scene_open(c)

    def mode(name: str) -> Callable[[], None]:
        return lambda: setattr(p, "navigation", name)

    return [
        Command("Fly", "Camera", mode("fly"), "G", checked=lambda: p.navigation == "fly"),
        Command("Orbit", "Camera", mode("orbit"), "O", checked=lambda: p.navigation == "orbit"),
        Command("Focus", "Camera", lambda: focus(ui), "F", enabled=here, separated=True),
        Command("Reset camera", "Camera", c.motion.reset_camera, "R", enabled=here),
        Command("Follow the scene's path", "Camera", lambda: c.motion.follow_path(not c.session.on_path), "P",
                checked=lambda: c.session.on_path, enabled=here),
        Command("Add bookmark", "Camera/Bookmarks", c.bookmarks.add, "Ctrl+B", enabled=here, separated=True),
        *_sides(ui, here), *_text(ui, here), *_bookmarks(ui, here),
    ]  # fmt: skip


def time(ui: Ui) -> list[Command]:
    """The menu Time."""
    c, p = ui.controller, ui.controller.preferences
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
        switch("Loop", "Time", p, "loop", separated=True),
        setting_command(ui, "pace.every_frame", "Time"),
    ]


def pivot_of(ui: Ui) -> tuple[float, float, float]:
    """What the camera turns around: what was clicked or focused on, else the middle of the scene."""
    c = ui.controller
    if ui.picture.pivot is not None and ui.picture.pivot_scene is c.session.scene:
        return ui.picture.pivot
    low, high = c.info.get("bounds") or ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    middle = [0.5 * (a + b) for a, b in zip(low, high, strict=True)]
    return middle[0], middle[1], middle[2]


def focus(ui: Ui) -> None:
    """Turn to what is under the pointer, else to what is selected, and go near it; orbits turn around it then."""
    c = ui.controller
    at = c.selection.hovered
    pixel = c.selection.pixel
    if at is None and pixel is not None and c.frame is not None:
        at = (pixel[0] + 0.5) / c.frame.width, (pixel[1] + 0.5) / c.frame.height
    if c.selection.picked is not None and c.selection.hovered is None and (at is None or c.selection.part is not None):
        fly_to_selected(ui)
        return
    if at is None or c.frame is None:
        c.notices.say("point at something, or click it, to focus on it")
        return
    point, extent = point_at(c.frame, *at), extent_at(c.frame, *at)
    if point is None or extent is None:
        c.notices.say("there is nothing to focus on here")
        return
    ui.picture.pivot = (float(point[0]), float(point[1]), float(point[2]))
    c.motion.glide(navigation.focus(c.session.camera, ui.picture.pivot, extent, c.motion.world_up))


def fly_to_selected(ui: Ui) -> None:
    """Go near what is selected, whether or not it is seen from here; orbits turn around it then."""
    c = ui.controller
    now, picked, part = c.session.edited, c.selection.picked, c.selection.part
    if now is None or picked is None:
        return
    time = c.session.time
    points = primitive_points(now.scene, picked.primitive, time) if part is None else part_points(now, part, time)
    if not len(points):
        c.notices.say("the selection is not in the scene at this time")
        return
    low, high = points.min(axis=0), points.max(axis=0)
    x, y, z = (0.5 * (low + high)).tolist()
    ui.picture.pivot = x, y, z
    radius = 0.5 * math.dist(low, high)
    c.motion.fly_to(navigation.focus(c.session.camera, ui.picture.pivot, radius, c.motion.world_up))


def _sides(ui: Ui, here: Condition) -> list[Command]:
    c, tip = ui.controller, "around what was clicked last, else the middle of the scene"

    def go(side: tuple[int, int, int]) -> Callable[[], None]:
        return lambda: c.motion.glide(navigation.looking_from(side, c.session.camera, pivot_of(ui), c.motion.world_up))

    return [
        Command(f"Look from {name}", "Camera/Look from", go(side), key, enabled=here, tip=tip, separated=not number)
        for number, (name, side, key) in enumerate(_SIDES)
    ]


def _text(ui: Ui, here: Condition) -> list[Command]:
    c = ui.controller

    def aspect() -> float:
        width, height = c.scheduler.full_size
        return width / height if min(width, height) > 0 else 1.0

    def copy(text: Callable[[], str], what: str) -> Callable[[], None]:
        def do() -> None:
            ui.desktop.copy(text())
            c.notices.say(f"camera copied as {what}")

        return do

    def paste() -> None:
        try:
            pasted = camera_text.read(ui.desktop.paste() or "", c.session.camera, aspect())
        except ValueError as error:
            c.notices.say(f"no camera pasted: {error}", error=True)
            return
        c.motion.fly_to(pasted.camera)
        unused = f"; not used: {', '.join(pasted.unused)}" if pasted.unused else ""
        c.notices.say(f"camera pasted from {pasted.kind}{unused}")

    menu = "Camera/Copy and paste"
    camera = lambda: c.session.camera  # noqa: E731
    return [
        Command("Copy camera", menu, copy(lambda: camera_text.as_json(camera()), "JSON"), "Ctrl+Shift+C", enabled=here,
                tip="as JSON, which `shadowcull render --camera` takes"),
        Command("Copy camera for pbrt", menu,
                copy(lambda: camera_text.as_pbrt(camera(), aspect()), "pbrt's LookAt and Camera"), enabled=here),
        Command("Copy camera for Embree", menu,
                copy(lambda: camera_text.as_embree(camera()), "arguments of Embree's viewer"), enabled=here),
        Command("Paste camera", menu, paste, "Ctrl+Shift+V", enabled=here, separated=True,
                tip="JSON, pbrt's statements or arguments of Embree's viewer, whichever the clipboard holds"),
    ]  # fmt: skip


def _bookmarks(ui: Ui, here: Condition) -> list[Command]:
    c = ui.controller
    marks = c.bookmarks
    some = Condition(lambda: bool(marks.all), "this scene has no bookmarks")

    def go(index: int) -> Command:
        def title() -> str:
            return f"{index + 1}  {marks.all[index].name}" if index < len(marks.all) else ""

        there = Condition(lambda: index < len(marks.all), "this scene has fewer bookmarks")
        return Command(f"Go to bookmark {index + 1}", "Camera/Bookmarks", lambda: c.go_to_bookmark(index),
                       f"Alt+{index + 1}", enabled=there, title=title, separated=index == 0)  # fmt: skip

    return [
        Command("Next bookmark", "Camera/Bookmarks", lambda: c.next_bookmark(1), "PageDown", enabled=some),
        Command("Previous bookmark", "Camera/Bookmarks", lambda: c.next_bookmark(-1), "PageUp", enabled=some),
        *[go(index) for index in range(KEYED_BOOKMARKS)],
    ]
