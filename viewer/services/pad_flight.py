"""Flies by game pads and space mice: any that are there, and those that come while the window is open."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Mapping

from viewer.services.motion import LONGEST_STEP, Motion
from viewer.state.notices import Notices
from viewer.state.pads import Kind, Pad, moved, push
from viewer.state.preferences import Preferences
from viewer.state.session import Session

BUTTONS = {
    "A": "Play",
    "B": "Undo",
    "X": "Focus",
    "Y": "Shadow culling",
    "left bumper": "Fly slower",
    "right bumper": "Fly faster",
    "back": "Previous bookmark",
    "start": "Next bookmark",
    "pad up": "Previous view",
    "pad down": "Next view",
    "pad left": "Previous light",
    "pad right": "Next light",
    "right stick": "Reset camera",
}
"""Names of commands by the buttons of a game pad."""

_HOW = {
    Kind.GAMEPAD: "the left stick flies, the right one looks around, triggers go up and down",
    Kind.SPACE_MOUSE: "push and turn its cap to fly",
}


class PadFlight:
    """`names` are those of the devices that are there."""

    def __init__(self, session: Session, preferences: Preferences, motion: Motion, notices: Notices) -> None:
        self._session, self._preferences, self._motion, self._notices = session, preferences, motion, notices
        self._last = time.monotonic()
        self._there: dict[str, Kind] = {}
        self._pressed: frozenset[str] = frozenset()

    @property
    def names(self) -> list[str]:
        return list(self._there)

    def follow(self, pads: Iterable[Pad], commands: Mapping[str, Callable[[], None]]) -> None:
        """Move the camera by what the devices say now; `commands` are those that buttons may run, by name."""
        now = time.monotonic()
        seconds, self._last = min(now - self._last, LONGEST_STEP), now
        pads = list(pads) if self._preferences.pads else []
        self._greet({pad.name: pad.kind for pad in pads})
        pressed = frozenset[str]().union(*(pad.pressed for pad in pads))
        newly, self._pressed = pressed - self._pressed, pressed
        if self._session.scene is None:
            return
        self._fly(pads, seconds)
        for button in sorted(newly):
            command = commands.get(BUTTONS.get(button, ""))
            if command is not None:
                command()

    def _fly(self, pads: list[Pad], seconds: float) -> None:
        motion, camera = self._motion, self._session.camera
        way = motion.pace * self._preferences.speed * seconds
        after = camera
        for pad in pads:
            wanted = push(pad, self._preferences.pad_dead_zone)
            if wanted:
                after = moved(after, wanted, way, seconds, motion.world_up)
        if after != camera:
            motion.move(after)

    def _greet(self, there: dict[str, Kind]) -> None:
        """Say what was plugged in or out; while they are switched off nothing is."""
        before, self._there = self._there, there
        if not self._preferences.pads:
            return
        for name in there.keys() - before.keys():
            self._notices.say(f"{there[name].value} found: {name}; {_HOW[there[name]]}")
        for name in before.keys() - there.keys():
            self._notices.say(f"{before[name].value} gone: {name}")
