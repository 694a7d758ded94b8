"""What the renderer says of the clicked pixel or, until one is clicked, of the one under the pointer.

What light reaches it and why its shadow rays were culled or traced, and which clusters of lights shade it.  An answer
speaks of one moment of the scene, in world space, and so it stays right when the camera moves on.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from tracer.explanation import Explanation, explain, outline
from tracer.frame import Frame
from tracer.light_cut import LightCut, light_cut
from tracer.reasons import Why
from tracer.renderer import Renderer
from tracer.scene.model import Cancelled
from tracer.why import why
from viewer.services.queries import Ask, Newest
from viewer.services.selection import Selection
from viewer.state.picking import pixel_at, pixel_of, same_place

MOST_OCCLUDERS = 8  # of one light that are named and drawn
MOST_LIGHTS = 40  # that are drawn, and listed at once
MOST_CLUSTERS = 100
"""Clusters of lights that are drawn: those that send most."""
Pixel = tuple[int, int]


@dataclass(frozen=True, eq=False)  # arrays cannot be compared as one
class Answer:
    """What was found for a pixel of a frame: an explanation for each light, outlines of what they name, and `why` its
    shadow rays were culled or traced, None where the renderer has gone on to another frame."""

    frame: Frame
    x: int
    y: int
    lights: tuple[Explanation, ...]
    outlines: dict[int, tuple[NDArray[np.float64], ...]]
    why: Why | None = None

    @cached_property
    def drawn(self) -> tuple[Explanation, ...]:
        """Lights whose shadow rays are drawn."""
        return drawn_lights(self.lights)

    @cached_property
    def wrong_beyond(self) -> int:
        """How many answers are wrong at what is mirrored at the pixel, or seen through it."""
        rays = () if self.why is None or self.why.tree is None else self.why.tree.rays[1:]
        return sum(int(np.count_nonzero(ray.shadows.wrong)) for ray in rays if ray.shadows is not None)


def explain_pixel(renderer: Renderer, frame: Frame, x: int, y: int, cancelled: Callable[[], bool]) -> Answer:
    """Find out what lights do at a pixel."""
    lights = explain(renderer, frame, x, y)
    numbers = {number for one in drawn_lights(lights) for number in drawn_primitives(one)}
    outlines = {number: outline(renderer.world, number) for number in numbers}
    reasons = None
    with suppress(LookupError):  # another frame has begun
        reasons = why(renderer, frame, x, y, cancelled)
    return Answer(frame, x, y, lights, outlines, reasons)


def find_cut(renderer: Renderer, frame: Frame, x: int, y: int, cancelled: Callable[[], bool]) -> LightCut | None:
    """Find the clusters of lights that shade a pixel, None where no cut does."""
    try:
        return light_cut(renderer, frame, x, y)
    except LookupError:
        raise Cancelled("another frame has begun") from None


class PixelInspector:
    """`answer` is what is known of the pixel, None while nothing is, and `why` the newest reasons that are; `cut` are
    the clusters that shade it, where they are wanted, and `awaits_cut` is the pixel whose clusters are to come."""

    def __init__(self, selection: Selection, query: Ask) -> None:
        self._selection, self._query = selection, query
        self._explained = Newest()
        self._subject: object = None
        self._why: Answer | None = None  # with the newest reasons
        self.cut: LightCut | None = None
        self.awaits_cut: Pixel | None = None

    @property
    def answer(self) -> Answer | None:
        found: Answer | None = self._explained.answer
        return found

    @property
    def why(self) -> Why | None:
        return None if self._why is None else self._why.why

    @property
    def problem(self) -> str:
        """Why there is no answer, in one line."""
        return self._explained.problem

    def update(self, frame: Frame | None, idle: bool, cuts: bool = False) -> None:
        """Take up what has been answered, and ask about what is looked at now.

        `frame` is the newest, None where nothing may be asked about it; what the pointer is on is asked about when
        `idle`, and `cuts` says that clusters are wanted."""
        if frame is None:
            self._forget()
            return
        kept = self._selection.picked
        at = pixel_of(kept, frame) if kept is not None else self._pointed_at(frame, idle)
        subject = "pointer" if kept is None else (kept.primitive, kept.x, kept.y, kept.seen)
        if subject != self._subject or (kept is None and at is None):
            self._forget()
            self._subject = subject
        if at is not None:
            self._explained.take(self._query(explain_pixel, frame, *at))
        answer = self.answer
        if answer is not None and answer.why is not None:
            self._why = answer
        if answer is not None and _is_outdated(answer, frame):
            self._explained.answer = None
            if at is None or answer.frame.settings.method != frame.settings.method:
                self._why = None  # else the next comes at once
        self._find_cut(frame, at if cuts and idle else None)

    def names_pixels_of(self, frame: Frame) -> bool:
        """Whether pixels that `why` names are where this frame has them: it is of the same moment, place and size."""
        return self._why is not None and same_place(self._why.frame, frame)

    def _find_cut(self, frame: Frame, at: Pixel | None) -> None:
        self.cut = self.awaits_cut = None
        if at is not None and frame.primitive[at[1], at[0]] >= 0:
            future = self._query(find_cut, frame, *at)
            if not future.done() or future.cancelled():
                self.awaits_cut = at
            elif future.exception() is None:
                self.cut = future.result()

    def _forget(self) -> None:
        self._explained.forget()
        self._why = self.cut = self.awaits_cut = None

    def _pointed_at(self, frame: Frame, idle: bool) -> Pixel | None:
        """The pixel under the pointer, while nothing moves and it shows something."""
        hovered = self._selection.hovered
        if hovered is None or not idle:
            return None
        x, y = pixel_at(frame, *hovered)
        return (x, y) if frame.primitive[y, x] >= 0 else None


def _is_outdated(answer: Answer, frame: Frame) -> bool:
    """Whether an answer speaks of another moment, or of what another method knew."""
    then = answer.frame
    return then.time != frame.time or then.settings.method != frame.settings.method


def nearest_first(lights: Sequence[Explanation]) -> list[Explanation]:
    """The lights by their distance from the point."""
    return sorted(lights, key=lambda one: math.dist(one.light_position, one.point))


def drawn_lights(lights: Sequence[Explanation]) -> tuple[Explanation, ...]:
    """Those of the lights that are due, or of many the nearest of these, in their order."""
    due = [one for one in lights if one.due]
    return tuple(due) if len(due) <= MOST_LIGHTS else tuple(nearest_first(due)[:MOST_LIGHTS])


def drawn_primitives(one: Explanation) -> list[int]:
    """What blocks a light, then what its certificate names, each once and no more than are drawn."""
    blocker = [] if one.blocker is None else [one.blocker]
    return [*blocker, *(number for number in one.named if number != one.blocker)][:MOST_OCCLUDERS]
