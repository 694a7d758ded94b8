"""What the chosen light sends to each pixel, where there are too many lights to record all of them in every frame.

It is asked of the render thread, which alone may touch the world, and answered between two frames; the window never
waits.
"""

from __future__ import annotations

from typing import Protocol, cast

from tracer.frame import Frame
from tracer.one_light import with_light
from tracer.renderer import Renderer
from viewer.services.render_request import Question, Traces
from viewer.state.readings import can_draw
from viewer.state.session import Session


class LightQuestion:
    """One light of a frame, asked about on the render thread; `found` is the frame with it, once there is an answer."""

    def __init__(self, frame: Frame, light: int) -> None:
        self.frame, self.light = frame, light
        self.found: Frame | None = None

    @property
    def time(self) -> float:
        return self.frame.time

    def answer(self, renderer: Traces) -> None:
        self.found = with_light(cast(Renderer, renderer), self.frame, self.light)


class Answers(Protocol):
    """The part of `RenderThread` that is used here."""

    def ask(self, question: Question) -> None: ...


class Shown(Protocol):
    """The part of `Tracing` that is used here."""

    @property
    def frame(self) -> Frame | None: ...

    def complete(self, frame: Frame, more: Frame) -> None: ...


class LightRecorder:
    """Has the chosen light recorded for the frame that is shown, wherever the view needs it and the frame lacks it."""

    def __init__(self, session: Session, renderer: Answers, shown: Shown) -> None:
        self._session, self._renderer, self._shown = session, renderer, shown
        self._asked: LightQuestion | None = None

    def follow(self) -> None:
        """Take up an answer, and ask about the frame that is shown now."""
        asked, view, light = self._asked, self._session.draw.view, self._session.draw.light
        if asked is not None and asked.found is not None:
            self._shown.complete(asked.frame, asked.found)
            self._asked = asked = None
        frame = self._shown.frame
        if frame is None or not (view.needs_lights and view.of_light) or light >= frame.lights:
            return
        to_come = frame.settings.record_lights or can_draw(frame, view, light)
        if not to_come and (asked is None or (asked.frame, asked.light) != (frame, light)):
            self._asked = LightQuestion(frame, light)
            self._renderer.ask(self._asked)
