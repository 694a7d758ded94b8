"""The pixels that taught a mode: those of the clicked primitive in the frames that set its modes.

The frames were not kept.  So when somebody clicks a primitive, their primary rays are traced once more, with shadow
rays to all lights and without culling: what the primitive's pixels meet is what they met then.  A mode that none of
them can have set was taught by reflected or refracted rays."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Protocol, cast

import numpy as np

from tracer.culling.modes import FULL_SHADOW, NON_SHADOW, shadow_mode
from tracer.explanation import explain
from tracer.frame import Frame
from tracer.mode_origins import NEVER, Taught
from tracer.reasons import TaughtBy, Why
from tracer.renderer import Renderer
from tracer.scene.model import Camera
from tracer.settings import Settings
from viewer.services.frame_history import FrameHistory
from viewer.services.render_request import Question, Traced, Traces
from viewer.services.selection import Selection
from viewer.state.history import FrameRecord
from viewer.state.picking import Pick
from viewer.state.readings import can_record_lights
from viewer.state.session import Session

_LOOKED_INTO = 6  # pixels in shadow of which one may be in that of something static
MOST_PIXELS = 1 << 22
"""Of frames that are looked into; larger ones are not."""


@dataclass(frozen=True)
class Teacher:
    """The pixels of a frame that met one answer of one light: how many, and one of them (x, y), None where only
    reflected or refracted rays did."""

    count: int
    pixel: tuple[int, int] | None


Answers = dict[tuple[int, bool], Teacher]
"""By light, and whether it is lit."""


class TeacherQuestion:
    """What the pixels of a unit met in a frame that was traced before; `found` is set once there is an answer.

    `time` is that of the frame that is shown now, for which the world stands again afterwards."""

    def __init__(self, time: float, record: FrameRecord, pick: Pick) -> None:
        self._time, self.record, self.pick = time, record, pick
        self.found: Answers | None = None

    @property
    def time(self) -> float:
        return self._time

    def answer(self, renderer: Traces) -> None:
        real, record, pick = cast(Renderer, renderer), self.record, self.pick
        try:
            self.found = answers_at(real, record.time, record.camera, record.settings, pick.unit, pick.in_cells)
        finally:
            real.world.place(self._time, real.state.rest.now.since > 0)


def answers_at(
    renderer: Renderer, time: float, camera: Camera | None, settings: Settings, unit: int, in_cells: bool
) -> Answers:
    """Trace a frame once more, in the world of a renderer, and return what the pixels of a unit met in it."""
    settings = replace(
        settings.recording_only("record_lights"), method="cells" if in_cells else "paper", depth=0, samples=1,
        modes=False, certificate_seconds=math.inf,
    )  # fmt: skip
    alone = Renderer(renderer.scene, settings, world=renderer.world)
    return answers_in(alone, alone.render(time, camera), unit)


def can_be_asked(settings: Settings, lights: int) -> bool:
    """Whether a frame is small enough to be traced once more with what reaches each pixel."""
    pixels = settings.width * settings.height
    return pixels <= MOST_PIXELS and can_record_lights(pixels, lights)


def with_teachers(
    found: Why, taught: Taught, of: Callable[[int, int, bool], Teacher | None], name: Callable[[int], str]
) -> Why:
    """Return reasons that say which frames gave the modes, and which pixels of these as far as `of` knows them, by the
    frame's number, the light, and whether it was seen lit; `name` names a frame."""
    coverage = found.coverage
    if coverage is not None and taught.whole != NEVER:
        coverage = replace(coverage, taught=TaughtBy(taught.whole, name(taught.whole)))
    reasons = []
    for one in found.reasons:
        by = []
        if one.light < len(taught.lights):
            lesson = taught.lights[one.light]
            for lit, number in ((False, lesson.blocked), (True, lesson.lit)):
                if number != NEVER:
                    teacher = of(number, one.light, lit)
                    pixel = None if teacher is None else teacher.pixel
                    by.append(TaughtBy(number, name(number), pixel, lit, teacher is not None))
        instead = None if one.instead is None else replace(one.instead, taught=tuple(by))
        reasons.append(replace(one, taught=tuple(by), instead=instead))
    return replace(found, coverage=coverage, reasons=tuple(reasons))


def answers_in(renderer: Renderer, frame: Frame, unit: int) -> Answers:
    """What the pixels of a unit met in a frame that was traced without knowing anything before."""
    assert frame.asked is not None and frame.reached is not None
    here, found = frame.cell == unit, Answers()
    moves = renderer.world.placed.has_dynamic
    for light in range(frame.lights):
        mode = int(shadow_mode(frame.modes[unit], light))
        for lit, bit in ((False, FULL_SHADOW), (True, NON_SHADOW)):
            if not mode & bit:
                continue
            asked, reached = frame.asked[..., light], frame.reached[..., light]
            met = here & (asked > 0) & ((reached > 0) if lit else (reached == 0))
            rows, columns = np.nonzero(met)
            if not len(rows):
                continue
            order = np.argsort(np.hypot(rows - rows.mean(), columns - columns.mean()), kind="stable")
            at = [(int(columns[i]), int(rows[i])) for i in order[:_LOOKED_INTO]]
            static = at if lit or not moves else [p for p in at if _is_static(renderer, frame, *p, light)]
            found[light, lit] = Teacher(len(rows), (static or at)[0])
    return found


def _is_static(renderer: Renderer, frame: Frame, x: int, y: int, light: int) -> bool:
    """Whether what blocks a light first there never moves."""
    blocker = explain(renderer, frame, x, y)[light].blocker
    return blocker is not None and renderer.scene.object_of(blocker) == 0


class Asks(Protocol):
    """The part of `RenderThread` that is used here."""

    def ask(self, question: Question) -> None: ...


class Teachers:
    """Asks about the primitive that was clicked, frame after frame; `of` is what is known."""

    def __init__(self, session: Session, selection: Selection, history: FrameHistory, renderer: Asks) -> None:
        self._session, self._selection, self._history, self._renderer = session, selection, history, renderer
        self._asked: TeacherQuestion | None = None
        self._subject: object = None
        self._known: dict[int, Answers] = {}

    def of(self, number: int, light: int, lit: bool) -> Teacher | None:
        """Who met an answer of a light in a frame, by its number; None while that is not known."""
        known = self._known.get(number)
        return None if known is None else known.get((light, lit), Teacher(0, None))

    @property
    def answered(self) -> int:
        """How many frames have been asked about."""
        return len(self._known)

    def follow(self, shown: Traced | None) -> None:
        """Take up an answer, and ask about the next frame that taught; `shown` is None where nothing may be asked."""
        pick = self._selection.picked
        subject = None if pick is None else (pick.unit, pick.in_cells, id(self._session.scene))
        if subject != self._subject:
            self._subject, self._asked, self._known = subject, None, {}
        asked = self._asked
        if asked is not None and asked.found is not None:
            self._known[asked.record.number] = asked.found
            self._asked = asked = None
        if pick is None or shown is None or not shown.whole:
            return
        if asked is not None and asked.time == shown.request.time:
            return
        record = self._next(pick)
        if record is not None:
            self._asked = TeacherQuestion(shown.request.time, record, pick)
            self._renderer.ask(self._asked)

    def _next(self, pick: Pick) -> FrameRecord | None:
        """A frame that taught the unit, and has not been asked about."""
        taught = self._history.taught(pick)
        if taught is None:
            return None
        for number in sorted({n for lesson in taught.lights for n in lesson if n != NEVER} - self._known.keys()):
            record = self._history.records.get(number)
            # Of a picture that was left before it was whole, nobody knows any more which of its pixels were shaded.
            if record is not None and record.whole and can_be_asked(record.settings, len(pick.shadows)):
                return record
        return None
