"""What is selected, and what the renderer says of it or, until something is, of the pixel under the pointer.

`inspect_pixel` is a pure function of the renderer and a pixel of a frame, asked as a query: why its shadow rays were
culled or traced.  An answer speaks of one moment of the scene, in world space, and so it stays
right while the camera moves and the next is on its way.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

from tracer.frame import Frame
from tracer.mode_origins import NEVER, Origins
from tracer.reasons import TaughtBy, Why
from tracer.renderer import Renderer
from tracer.scene.edits import Edited
from tracer.told_rays import RayTree
from tracer.why import why
from viewer.services.queries import Ask, Newest
from viewer.services.render_request import Traced
from viewer.state.picking import Pick, pick, pick_part, pick_primitive, pixel_of, refreshed, same_place
from viewer.state.pixels import Point, pixel_at
from viewer.state.session import Session

Pixel = tuple[int, int]


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


# --- what the renderer says of it -----------------------------------------------------------------------


class Inspection(NamedTuple):
    """What was found for a pixel of a frame: why its shadow rays were culled or traced, None where the renderer has
    gone on to another frame."""

    frame: Frame
    why: Why | None


def inspect_pixel(renderer: Renderer, frame: Frame, x: int, y: int, cancelled: Callable[[], bool]) -> Inspection:
    """Find out why the shadow rays of a pixel were culled or traced."""
    try:
        return Inspection(frame, why(renderer, frame, x, y, cancelled))
    except LookupError:
        return Inspection(frame, None)


def with_origins(found: Why, origins: Origins, name: Callable[[int], str]) -> Why:
    """Return the same reasons with the frames that set the modes; `name` names a frame by its number."""
    coverage = found.coverage
    if coverage is not None and origins.whole != NEVER:
        coverage = replace(coverage, taught=TaughtBy(origins.whole, name(origins.whole)))
    reasons = []
    for one in found.reasons:
        met = origins.lights[one.light].met() if one.light < len(origins.lights) else ()
        taught = tuple(TaughtBy(number, name(number), lit=lit, known=False) for lit, number in met)
        instead = None if one.instead is None else replace(one.instead, taught=taught)
        reasons.append(replace(one, taught=taught, instead=instead))
    return replace(found, coverage=coverage, reasons=tuple(reasons))


class Inspector:
    """Asks about the pixel that is selected or pointed at; nothing is known of what is not visible from here."""

    def __init__(self, selection: Selection, query: Ask) -> None:
        self._selection, self._query = selection, query
        self._inspected = Newest()
        self._frame: Frame | None = None
        self._subject: object = None
        self._forget()

    def _forget(self) -> None:
        self._inspected.forget()
        self._told: Inspection | None = None  # the newest with reasons
        self._traced: RayTree | None = None  # the newest; a picture that is shaded in part so far has none

    def update(self, traced: Traced | None, idle: bool) -> None:
        """Take up what has been answered, and ask about what is looked at now.

        `traced` is the newest picture, None where nothing may be asked about it; what the pointer is on is asked about
        when `idle`."""
        frame = traced.frame if traced is not None else None
        kept, self._frame = self._selection.picked, frame
        at = None
        if frame is not None:
            at = pixel_of(kept, frame) if kept is not None else self._pointed_at(frame, idle)
        subject = None if at is None else "pointer" if kept is None else (kept.primitive, kept.x, kept.y, kept.seen)
        if subject is None or subject != self._subject:
            self._forget()
        self._subject = subject
        if frame is None or at is None:
            return
        self._inspected.take(self._query(inspect_pixel, frame, *at))
        found: Inspection | None = self._inspected.answer
        if found is not None and found.why is not None:
            self._told, self._traced = found, found.why.tree or self._traced

    @property
    def answer(self) -> Why | None:
        """The reasons of this moment and method, None while they are not known."""
        told = self._told
        return told.why if told is not None and self._is_of_now(told.frame) else None

    @property
    def why(self) -> Why | None:
        """The newest reasons that are known; in motion those of the frame before, until the next come."""
        told = self._told
        return told.why if told is not None and self._is_of_now(told.frame, at_any_time=True) else None

    @property
    def tree(self) -> RayTree | None:
        """What became of the pixel's rays, None while that is not known."""
        return self._traced if self._traced is not None and self._is_of_now(self._traced.frame) else None

    @property
    def problem(self) -> str:
        """Why there is no answer, in one line."""
        return self._inspected.problem

    def names_pixels_of(self, frame: Frame) -> bool:
        """Whether pixels that `why` names are where this frame has them: it is of the same moment, place and size."""
        return self._told is not None and same_place(self._told.frame, frame)

    def _is_of_now(self, then: Frame, at_any_time: bool = False) -> bool:
        now = self._frame
        if now is None or then.settings.method != now.settings.method:
            return False
        return at_any_time or then.time == now.time

    def _pointed_at(self, frame: Frame, idle: bool) -> Pixel | None:
        """The pixel under the pointer, while nothing moves and it shows something."""
        hovered = self._selection.hovered
        if hovered is None or not idle:
            return None
        x, y = pixel_at(frame, *hovered)
        return (x, y) if frame.primitive[y, x] >= 0 else None
