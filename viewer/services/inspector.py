"""What is selected, and what the renderer says of it or, until something is, of the pixel under the pointer.

`inspect_pixel` is a pure function of the renderer and a pixel of a frame, asked as a query: why its shadow rays were
culled or traced.  An answer speaks of one moment of the scene, in world space, and so it stays
right while the camera moves and the next is on its way."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

from tracer.editing.edits import Edited
from tracer.frame import Frame
from tracer.inspect.mode_origins import NEVER, Origins
from tracer.inspect.path_records import RayTree
from tracer.inspect.reasons import TaughtBy, Why
from tracer.inspect.why import why
from tracer.renderer import Renderer
from viewer.services.render_request import Ask, Newest, Traced
from viewer.state.picking import Pick, pick, pick_part, pick_primitive, pixel_of, same_place
from viewer.state.pixels import Point, pixel_at
from viewer.state.session import Session

Pixel = tuple[int, int]


class Selection:
    """`picked` is what was clicked, `hovered` where the pointer is; None where there is nothing."""

    def __init__(self, session: Session, newest: Callable[[], Frame | None]) -> None:
        """`newest` returns the frame that the picture shows."""
        self._session, self._newest = session, newest
        self.picked: Pick | None = None
        self.hovered: Point | None = None

    @property
    def frame(self) -> Frame | None:
        """The frame that the picture shows."""
        return self._newest()

    @property
    def pixel(self) -> Pixel | None:
        """Where the picture shows what was clicked; None where it does not, or where nothing was."""
        frame, picked = self.frame, self.picked
        return pixel_of(picked, frame) if picked is not None and frame is not None else None

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
        return self._select(pick_primitive(frame, now.scene, int(now.numbers[primitive])))

    def select_part(self, part: int) -> bool:
        """Select a part of the scene, in the middle of what is seen of it; whether that could be done."""
        frame, now = self.frame, self._session.edited
        return frame is not None and now is not None and self._select(pick_part(frame, now, part))

    def _select(self, found: Pick | None) -> bool:
        self.picked = found or self.picked
        return found is not None

    def clear(self) -> None:
        """Select nothing."""
        self.picked = None

    def update_for_edits(self, before: Edited | None, now: Edited) -> None:
        """Give the selected primitive its number in an edited scene; one that is hidden there is selected no more."""
        if self.picked is not None and before is not None:
            number = int(now.numbers[before.primitives[self.picked.primitive]])
            self.picked = replace(self.picked, primitive=number, seen=None) if number >= 0 else None


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
        taught = tuple(TaughtBy(number, name(number), lit) for lit, number in met)
        instead = None if one.instead is None else replace(one.instead, taught=taught)
        reasons.append(replace(one, taught=taught, instead=instead))
    return replace(found, coverage=coverage, reasons=tuple(reasons))


class Inspector:
    """Asks about the pixel that is selected or pointed at; nothing is known of what is not visible from here."""

    def __init__(self, selection: Selection, query: Ask) -> None:
        self._selection, self._query = selection, query
        self._newest = Newest()
        self._frame: Frame | None = None
        self._subject: Pick | str | None = None  # whose answers stay in other frames, until the next come
        self._found: Inspection | None = None  # the newest with reasons
        self._tree: RayTree | None = None  # the newest; a picture that is shaded in part so far has none

    def update(self, traced: Traced | None, idle: bool) -> None:
        """Take up what has been answered, and ask about what is looked at now.

        `traced` is the newest picture, None where nothing may be asked about it; what the pointer is on is asked about
        when `idle`."""
        picked, frame = self._selection.picked, traced.frame if traced is not None else None
        self._frame = frame
        at = None
        if frame is not None:
            at = pixel_of(picked, frame) if picked is not None else self._pointed_at(frame, idle)
        subject = None if at is None else picked or "pointer"
        if subject is None:
            self._newest.forget()
        if subject != self._subject:  # a click where the pointer rests waits for the answer that was asked for then
            self._newest, self._found, self._tree = Newest(), None, None
        self._subject = subject
        if frame is None or at is None:
            return
        self._newest.take(self._query(inspect_pixel, frame, *at))
        found: Inspection | None = self._newest.answer
        if found is not None and found.why is not None:
            self._found, self._tree = found, found.why.tree or self._tree

    @property
    def why(self) -> Why | None:
        """The newest reasons that are known; in motion those of the frame before, until the next come."""
        found = self._found
        return found.why if found is not None and self._is_of_now(found.frame, at_any_time=True) else None

    @property
    def tree(self) -> RayTree | None:
        """What became of the pixel's rays, None while that is not known."""
        return self._tree if self._tree is not None and self._is_of_now(self._tree.frame) else None

    @property
    def problem(self) -> str:
        """Why there is no answer, in one line."""
        return self._newest.problem

    def names_pixels_of(self, frame: Frame) -> bool:
        """Whether pixels that `why` names are where this frame has them: it is of the same moment, place and size."""
        return self._found is not None and same_place(self._found.frame, frame)

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
