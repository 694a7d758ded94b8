"""Commands of the camera that are more than one key: where to look from, bookmarks, and copies for other programs."""

from __future__ import annotations

import math
from collections.abc import Callable

from viewer.state import camera_text, navigation
from viewer.window.command import Command, Condition
from viewer.window.ui import Ui

KEYED_BOOKMARKS = 9
STEP = math.radians(15.0)
"""Of a turn by a key."""

# Name: right, up and towards us, as `navigation.looking_from` has them; and key.
_SIDES = {
    "Front": ((0, 0, 1), "Keypad1"),
    "Back": ((0, 0, -1), "Ctrl+Keypad1"),
    "Right": ((1, 0, 0), "Keypad3"),
    "Left": ((-1, 0, 0), "Ctrl+Keypad3"),
    "Top": ((0, 1, 0), "Keypad7"),
    "Below": ((0, -1, 0), "Ctrl+Keypad7"),
}


def build(ui: Ui) -> list[Command]:
    """All of them, in the order of the menu."""
    here = Condition(lambda: ui.controller.session.scene is not None, "no scene is open")
    return [*_sides(ui, here), *_turns(ui, here), *_text(ui, here), *_bookmarks(ui, here)]


def pivot_of(ui: Ui) -> tuple[float, float, float]:
    """What the camera turns around: what was clicked or focused on, else the middle of the scene."""
    c = ui.controller
    if ui.picture.pivot is not None and ui.picture.pivot_scene is c.session.scene:
        return ui.picture.pivot
    low, high = c.info.get("bounds") or ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    middle = [0.5 * (a + b) for a, b in zip(low, high, strict=True)]
    return middle[0], middle[1], middle[2]


def _sides(ui: Ui, here: Condition) -> list[Command]:
    c = ui.controller

    def go(side: tuple[int, int, int]) -> Callable[[], None]:
        return lambda: c.motion.glide(navigation.looking_from(side, c.session.camera, pivot_of(ui), c.motion.world_up))

    def command(name: str) -> Command:
        side, key = _SIDES[name]
        tip = "around what was clicked last, else the middle of the scene"
        first = name == next(iter(_SIDES))
        return Command(f"Look from {_SAID[name]}", "Camera/Look from", go(side), key, enabled=here, tip=tip,
                       separated=first)  # fmt: skip

    return [command(name) for name in _SIDES]


_SAID = {"Front": "the front", "Back": "the back", "Right": "the right", "Left": "the left", "Top": "the top",
         "Below": "below"}  # fmt: skip


def _turns(ui: Ui, here: Condition) -> list[Command]:
    c, p = ui.controller, ui.controller.preferences

    def orbit(right: float, up: float) -> Callable[[], None]:
        return lambda: c.motion.move(
            navigation.orbit(c.session.camera, pivot_of(ui), right * STEP, up * STEP, c.motion.world_up)
        )

    def dolly(notches: float) -> Callable[[], None]:
        return lambda: c.motion.move(navigation.dolly(c.session.camera, pivot_of(ui), notches))

    def speed(factor: float) -> Callable[[], None]:
        def change() -> None:
            p.speed = min(max(p.speed * factor, 0.001), 1000.0)
            c.notices.say(f"flying speed {p.speed:.3g}")

        return change

    menu = "Camera/Turn"
    return [
        Command("Orbit left", menu, orbit(-1.0, 0.0), enabled=here, repeats=True),
        Command("Orbit right", menu, orbit(1.0, 0.0), enabled=here, repeats=True),
        Command("Orbit up", menu, orbit(0.0, -1.0), enabled=here, repeats=True),
        Command("Orbit down", menu, orbit(0.0, 1.0), enabled=here, repeats=True),
        Command("Nearer", menu, dolly(1.0), enabled=here, repeats=True),
        Command("Farther", menu, dolly(-1.0), enabled=here, repeats=True),
        Command("Fly faster", menu, speed(2.0), repeats=True, separated=True),
        Command("Fly slower", menu, speed(0.5), repeats=True),
    ]


def _text(ui: Ui, here: Condition) -> list[Command]:
    c = ui.controller

    def aspect() -> float:
        width, height = c.tracing.full_size
        return width / height if min(width, height) > 0 else 1.0

    def copy(text: Callable[[], str], what: str) -> Callable[[], None]:
        def do() -> None:
            ui.copy_to(text())
            c.notices.say(f"camera copied as {what}")

        return do

    def paste() -> None:
        try:
            pasted = camera_text.read(ui.paste_from() or "", c.session.camera, aspect())
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
            return f"{index + 1}  {marks.all[index].get('name', '?')}" if index < len(marks.all) else ""

        there = Condition(lambda: index < len(marks.all), "this scene has not so many bookmarks")
        return Command(f"Go to bookmark {index + 1}", "Camera/Bookmarks", lambda: c.go_to_bookmark(index),
                       f"Alt+{index + 1}", enabled=there, title=title, separated=index == 0)  # fmt: skip

    return [
        Command("Next bookmark", "Camera/Bookmarks", lambda: c.next_bookmark(1), "PageDown", enabled=some),
        Command("Previous bookmark", "Camera/Bookmarks", lambda: c.next_bookmark(-1), "PageUp", enabled=some),
        *[go(index) for index in range(KEYED_BOOKMARKS)],
    ]
