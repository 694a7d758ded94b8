"""What the renderer says of the clicked pixel or, until one is clicked, of the one under the pointer.

`inspect_pixel` is a pure function of the renderer and a pixel of a frame, asked as a query: what light reaches it, and
why its shadow rays were culled or traced.  An answer speaks of one moment of the scene, in world space, and so it stays
right while the camera moves and the next is on its way.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from tracer.explanation import Explanation, explain, outline
from tracer.frame import Frame
from tracer.light_cut import LightCut, light_cut
from tracer.mode_origins import NEVER, Origins
from tracer.reasons import TaughtBy, Why
from tracer.renderer import Renderer
from tracer.scene.model import Cancelled
from tracer.told_rays import RayTree
from tracer.why import why
from viewer.services.queries import Ask, Newest
from viewer.services.selection import Selection
from viewer.state.picking import pixel_of, same_place
from viewer.state.pixels import pixel_at

MOST_OCCLUDERS = 8  # of one light that are named and drawn
MOST_LIGHTS = 40  # that are drawn, and listed at once
MOST_CLUSTERS = 100
"""Clusters of lights that are drawn: those that send most."""
Pixel = tuple[int, int]


@dataclass(frozen=True, eq=False)  # arrays cannot be compared as one
class Inspection:
    """What was found for a pixel of a frame: an explanation for each light, outlines of what they name, and `why` its
    shadow rays were culled or traced, None where the renderer has gone on to another frame."""

    frame: Frame
    lights: tuple[Explanation, ...]
    outlines: dict[int, tuple[NDArray[np.float64], ...]]
    why: Why | None = None

    @cached_property
    def drawn(self) -> tuple[Explanation, ...]:
        """Lights whose shadow rays are drawn: those that are due, or of many the nearest of these, in their order."""
        return drawn_lights(self.lights)

    @cached_property
    def wrong_beyond(self) -> int:
        """How many answers are wrong at what is mirrored at the pixel, or seen through it."""
        rays = () if self.why is None or self.why.tree is None else self.why.tree.rays[1:]
        return sum(int(np.count_nonzero(ray.shadows.wrong)) for ray in rays if ray.shadows is not None)


def inspect_pixel(renderer: Renderer, frame: Frame, x: int, y: int, cancelled: Callable[[], bool]) -> Inspection:
    """Find out what lights do at a pixel."""
    lights = explain(renderer, frame, x, y)
    numbers = {number for one in drawn_lights(lights) for number in drawn_primitives(one)}
    reasons = None
    with suppress(LookupError):  # another frame has begun
        reasons = why(renderer, frame, x, y, cancelled)
    return Inspection(frame, lights, {number: outline(renderer.world, number) for number in numbers}, reasons)


def find_cut(renderer: Renderer, frame: Frame, x: int, y: int, cancelled: Callable[[], bool]) -> LightCut | None:
    """Find the clusters of lights that shade a pixel, None where no cut does."""
    try:
        return light_cut(renderer, frame, x, y)
    except LookupError:
        raise Cancelled("another frame has begun") from None


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
    """Asks about the pixel that is selected or pointed at; nothing is known of what is not visible from here.

    `cut` are the clusters of lights that shade it, where they are wanted, and `awaits_cut` is the pixel whose clusters
    are to come."""

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
        self.cut: LightCut | None = None
        self.awaits_cut: Pixel | None = None

    def update(self, frame: Frame | None, idle: bool, cuts: bool = False) -> None:
        """Take up what has been answered, and ask about what is looked at now.

        `frame` is the newest, None where nothing may be asked about it; what the pointer is on is asked about when
        `idle`, and `cuts` says that clusters are wanted."""
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
        self._find_cut(frame, at if cuts and idle else None)

    @property
    def answer(self) -> Inspection | None:
        """What is known of the pixel, None while that is nothing, or of another moment or method."""
        found: Inspection | None = self._inspected.answer
        return found if found is not None and self._is_of_now(found.frame) else None

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

    def _find_cut(self, frame: Frame, at: Pixel | None) -> None:
        self.cut = self.awaits_cut = None
        if at is not None and frame.primitive[at[1], at[0]] >= 0:
            future = self._query(find_cut, frame, *at)
            if not future.done() or future.cancelled():
                self.awaits_cut = at
            elif future.exception() is None:
                self.cut = future.result()

    def _pointed_at(self, frame: Frame, idle: bool) -> Pixel | None:
        """The pixel under the pointer, while nothing moves and it shows something."""
        hovered = self._selection.hovered
        if hovered is None or not idle:
            return None
        x, y = pixel_at(frame, *hovered)
        return (x, y) if frame.primitive[y, x] >= 0 else None


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
