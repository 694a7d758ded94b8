"""The pixel that was clicked, or what was chosen by its name, and the point of the picture that the pointer is on."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from tracer.frame import Frame
from tracer.scene.edits import Edited
from viewer.state.picking import Pick, pick, pick_part, pick_primitive, pixel_of, refreshed
from viewer.state.pixels import Point
from viewer.state.session import Session


class Selection:
    """`picked` is what was clicked, `hovered` where the pointer is; None where there is nothing.  `part` is the part of
    the scene (`viewer.state.parts`) that is selected as a whole, None for the primitive alone.  `serial` is another
    number after each selection."""

    def __init__(self, session: Session, newest: Callable[[], Frame | None]) -> None:
        """`newest` returns the frame that the picture shows."""
        self._session, self._newest = session, newest
        self._picked: Pick | None = None
        self.part: int | None = None
        self.hovered: Point | None = None
        self.serial = 0

    @property
    def picked(self) -> Pick | None:
        return self._picked

    @picked.setter
    def picked(self, found: Pick | None) -> None:
        self._picked, self.part = found, None
        self.serial += 1

    @property
    def frame(self) -> Frame | None:
        """The frame that the picture shows."""
        return self._newest()

    @property
    def pixel(self) -> tuple[int, int] | None:
        """Where the picture shows what was clicked; None where it does not, or where nothing was."""
        frame, kept = self.frame, self.picked
        return pixel_of(kept, frame) if kept is not None and frame is not None else None

    def at(self, point: Point | None) -> Pick | None:
        """What lies under a point of the picture."""
        frame, scene = self.frame, self._session.scene
        return pick(frame, scene, *point) if point is not None and frame is not None and scene is not None else None

    def select(self, point: Point) -> None:
        """Select what is under a point of the picture; nothing there: clear the selection."""
        found = self.at(point)
        self.picked = found if found is not None and found.primitive >= 0 else None

    def select_primitive(self, primitive: int) -> bool:
        """Select a primitive by its number in the scene as it was read, seen or not; whether that could be done."""
        frame, now = self.frame, self._session.edited
        if frame is None or now is None or not 0 <= primitive < len(now.numbers):
            return False
        return self._take(pick_primitive(frame, now.scene, int(now.numbers[primitive])), None)

    def select_part(self, part: int) -> bool:
        """Select a part of the scene, in the middle of what is seen of it; whether that could be done."""
        frame, now = self.frame, self._session.edited
        return frame is not None and now is not None and self._take(pick_part(frame, now, part), part)

    def _take(self, found: Pick | None, part: int | None) -> bool:
        if found is not None:
            self.picked, self.part = found, part
        return found is not None

    def clear(self) -> None:
        self.picked = None

    def update_for_edits(self, before: Edited | None, now: Edited) -> None:
        """The same primitive has another number now; one that is hidden is selected no more."""
        kept = self.picked
        if kept is not None and before is not None:
            number = int(now.numbers[before.primitives[kept.primitive]])
            if number >= 0:  # nothing else was selected
                self._picked = replace(kept, primitive=number, unit=number, in_cells=False, seen=None)
            else:
                self.picked = None

    def refresh(self, frame: Frame) -> None:
        """Take over from a newer frame what carries the modes."""
        if self._picked is not None:
            self._picked = refreshed(self._picked, frame)
