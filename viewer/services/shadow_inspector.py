"""Why is a point in shadow?  Asked about what was clicked or, until something is, what the pointer is on.

The question goes to the render thread, which alone may touch the world, and is answered between two frames; the
window never waits.  What has come speaks of one moment of the scene, in world space, and so it stays right when
the camera moves on.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from enum import Enum
from functools import cached_property
from typing import NamedTuple, Protocol, cast

import numpy as np
from numpy.typing import NDArray

from tracer.explanation import Explanation, explain, outline
from tracer.frame import Frame
from tracer.reasons import Why
from tracer.renderer import Renderer
from tracer.scene.model import Cancelled
from tracer.why import why
from viewer.services.render_request import Question, Traces
from viewer.services.selection import Selection
from viewer.state.edit_effects import same_place
from viewer.state.picking import pixel_at, pixel_of
from viewer.state.projection import Stroke, strokes

MOST_OCCLUDERS = 8  # of one light that are named and drawn
MOST_LIGHTS = 40  # that are drawn, and listed at once


@dataclass(frozen=True)
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
        """Lights whose ways are drawn."""
        return drawn_lights(self.lights)

    @cached_property
    def wrong_beyond(self) -> int:
        """How many answers are wrong at what is mirrored at the pixel, or seen through it."""
        rays = () if self.why is None or self.why.tree is None else self.why.tree.rays[1:]
        return sum(int(np.count_nonzero(ray.shadows.wrong)) for ray in rays if ray.shadows is not None)


class Part(Enum):
    """What a line on the picture stands for."""

    REACHING = "the part of the shadow ray that light reaches"
    STOPPED = "the rest of it, in shadow"
    BLOCKER = "what blocks it first"
    OCCLUDER = "what its certificate names"


class DrawnLine(NamedTuple):
    """A line of one light's explanation, in pieces on the picture."""

    part: Part
    light: int
    strokes: list[Stroke]


class PixelQuestion:
    """One pixel of a frame, asked about on the render thread; `found` is set once there is an answer."""

    def __init__(self, frame: Frame, x: int, y: int) -> None:
        self.frame, self.x, self.y = frame, x, y
        self.found: Answer | None = None
        self.dropped = False

    @property
    def time(self) -> float:
        return self.frame.time

    def answer(self, renderer: Traces) -> None:
        real = cast(Renderer, renderer)
        lights = explain(real, self.frame, self.x, self.y)
        numbers = {number for one in drawn_lights(lights) for number in drawn_primitives(one)}
        outlines = {number: outline(real.world, number) for number in numbers}
        reasons = None
        with suppress(LookupError, Cancelled):
            reasons = why(real, self.frame, self.x, self.y, lambda: self.dropped)
        self.found = Answer(self.frame, self.x, self.y, lights, outlines, reasons)


class Answers(Protocol):
    """The part of `RenderThread` that is used here."""

    def ask(self, question: Question) -> None: ...


class ShadowInspector:
    """`answer` is what is known of the pixel that the inspector shows, None while nothing is, and `why` the newest
    reasons that are."""

    def __init__(self, selection: Selection, renderer: Answers) -> None:
        self._selection, self._renderer = selection, renderer
        self.answer: Answer | None = None
        self.why: Why | None = None
        self._why_of: Frame | None = None  # the frame of these
        self._subject: object = None
        self._asked: PixelQuestion | None = None
        self._drawn: tuple[Answer, Frame, list[DrawnLine]] | None = None

    def follow(self, frame: Frame | None, idle: bool) -> None:
        """Take up an answer, and ask about what the inspector shows now if that is another pixel, or frame.

        `frame` is the newest, None where it must not be asked about; what the pointer is on is asked about when
        `idle`."""
        if frame is None:
            self._forget()
            return
        kept = self._selection.picked
        subject = (kept.primitive, kept.x, kept.y, kept.seen) if kept is not None else "pointer"
        if subject != self._subject:
            self._forget()
            self._subject = subject
        if self._asked is not None and self._asked.found is not None:
            self.answer = self._asked.found
            if self.answer.why is not None:
                self.why, self._why_of = self.answer.why, self.answer.frame
        at = pixel_of(kept, frame) if kept is not None else self._pointed_at(frame, idle)
        if at is None and kept is None:
            self._forget()
        if self.answer is not None and _is_outdated(self.answer, frame):
            self.answer = None
            if at is None or self._asked is None or self._asked.frame.settings.method != frame.settings.method:
                self.why = None  # else the next comes at once
        if at is not None and not self._has_asked(frame, *at):
            self._drop()
            self._asked = PixelQuestion(frame, *at)
            self._renderer.ask(self._asked)

    def names_pixels_of(self, frame: Frame) -> bool:
        """Whether pixels that `why` names are where this frame has them: it is of the same moment, place and size."""
        return self.why is not None and self._why_of is not None and same_place(self._why_of, frame)

    def lines(self, frame: Frame) -> list[DrawnLine]:
        """What is to be drawn of the answer on a frame."""
        answer = self.answer
        if answer is None:
            return []
        if self._drawn is None or self._drawn[0] is not answer or self._drawn[1] is not frame:
            self._drawn = answer, frame, drawn_lines(answer, frame)
        return self._drawn[2]

    def _forget(self) -> None:
        self._drop()
        self.answer = self.why = self._why_of = self._asked = self._drawn = None

    def _drop(self) -> None:
        """Let the render thread leave what has been asked."""
        if self._asked is not None:
            self._asked.dropped = True

    def _has_asked(self, frame: Frame, x: int, y: int) -> bool:
        """Whether it was asked about this pixel of the frame, or of the same with fewer samples."""
        asked = self._asked
        if asked is None or asked.frame.primitive is not frame.primitive or (asked.x, asked.y) != (x, y):
            return False
        return (asked.frame.statistics.part < 1.0) == (frame.statistics.part < 1.0)

    def _pointed_at(self, frame: Frame, idle: bool) -> tuple[int, int] | None:
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
    """What blocks a light, then what its certificate rests on, each once and no more than are drawn."""
    blocker = [] if one.blocker is None else [one.blocker]
    return [*blocker, *others_named(one)][:MOST_OCCLUDERS]


def others_named(one: Explanation) -> list[int]:
    """What a light's certificate rests on, but for what blocks the light."""
    return [number for number in one.named if number != one.blocker]


def drawn_lines(answer: Answer, frame: Frame) -> list[DrawnLine]:
    """Outlines of what is named, then, for each light that is drawn, its way to the point as far as it gets, and on."""
    lines = []
    for one in answer.drawn:
        for number in drawn_primitives(one):
            part = Part.BLOCKER if number == one.blocker else Part.OCCLUDER
            lines += [DrawnLine(part, one.light, strokes(frame, line)) for line in answer.outlines[number]]
    for one in answer.drawn:
        end = one.point if one.blocked_at is None else one.blocked_at
        lines.append(DrawnLine(Part.REACHING, one.light, strokes(frame, [one.light_position, end])))
        if one.blocked_at is not None:
            lines.append(DrawnLine(Part.STOPPED, one.light, strokes(frame, [one.blocked_at, one.point])))
    return lines
