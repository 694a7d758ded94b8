"""What it takes to come back to a frame that was traced: its time, camera and settings, by its number in the plots."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from typing import Any

from tracer.frame import Settings
from tracer.scene.edits import NO_EDITS, Edits
from tracer.scene.model import Camera
from viewer.state.views import View

MOST = 10_000
"""Frames that can be gone back to, the newest."""


@dataclass(frozen=True)
class Moment:
    """A traced frame.

    `settings` are those that it was traced with, `chosen` those of the user as a snapshot keeps them; `size` is that of
    the window's picture then, of which this may be a coarser version; `whole` says that all of its pixels were shaded,
    so that it set modes.  `edits` are those of the scene."""

    number: int
    time: float
    camera: Camera
    follow: bool
    settings: Settings
    chosen: dict[str, Any]
    view: View
    light: int
    wipe: float
    size: tuple[int, int]
    whole: bool
    edits: Edits = NO_EDITS


class Moments:
    """The last MOST frames."""

    def __init__(self, most: int = MOST) -> None:
        self._kept: deque[Moment] = deque(maxlen=most)

    def put(self, moment: Moment) -> None:
        """Keep a frame; it takes the place of those with its number and later ones."""
        while self._kept and self._kept[-1].number >= moment.number:
            self._kept.pop()
        self._kept.append(moment)

    def get(self, number: int) -> Moment | None:
        """The frame of this number; None where it is not kept."""
        if not self._kept:
            return None
        place = number - self._kept[0].number
        if 0 <= place < len(self._kept) and self._kept[place].number == number:
            return self._kept[place]
        return next((one for one in self._kept if one.number == number), None)

    def clear(self) -> None:
        self._kept.clear()
