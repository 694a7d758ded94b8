"""What the chosen light sends to each pixel, where there are too many lights to record all of them in every frame."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Protocol

from tracer.frame import Frame
from tracer.one_light import with_light
from tracer.renderer import Renderer
from viewer.services.queries import Ask
from viewer.state.readings import can_draw
from viewer.state.session import Session


def record_light(renderer: Renderer, frame: Frame, light: int, cancelled: Callable[[], bool]) -> Frame:
    """Record what one light sends to each pixel of a frame."""
    return with_light(renderer, frame, light)


class Shown(Protocol):
    """The part of `Tracing` that is used here."""

    @property
    def frame(self) -> Frame | None: ...

    def complete(self, frame: Frame, more: Frame) -> None: ...


class LightRecorder:
    """Has the chosen light recorded for the frame that is shown, wherever the view needs it and the frame lacks it."""

    def __init__(self, session: Session, query: Ask, shown: Shown) -> None:
        self._session, self._query, self._shown = session, query, shown

    def update(self) -> None:
        """Take up an answer, or ask about the frame that is shown now."""
        frame, view, light = self._shown.frame, self._session.view, self._session.light
        if frame is None or not (view.needs_lights and view.of_light) or light >= frame.lights:
            return
        if frame.settings.record_lights or can_draw(frame, view, light):  # it is to come, or there
            return
        future = self._query(record_light, frame, light)
        if future.done() and not future.cancelled() and future.exception() is None:
            found: Frame = future.result()  # with as many samples, or fewer: the light is the same
            self._shown.complete(frame, replace(frame, asked=found.asked, reached=found.reached, only_light=light))
