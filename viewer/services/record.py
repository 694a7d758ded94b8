"""The record of all frames that the window traces: their counters for the plots, what brings them back, and which of
them taught each mode."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from tracer.frame import Frame
from tracer.mode_origins import ModeOrigins, Origins
from tracer.scene.edits import NO_EDITS
from viewer.services.render_request import RenderRequest, Traced
from viewer.state.history import History
from viewer.state.moments import MOST, Moment, Moments
from viewer.state.picking import Pick
from viewer.state.rate import Rate
from viewer.state.readings import has_modes_of_cells
from viewer.state.session import Session, settings_to_json

MODE_HISTORIES = 4
"""Those, of resolutions and lamps, of which it is known which frame set each mode."""
Key = tuple[int, int, bool, float | None, int | None]


class Record:
    """`moments` are the frames that can be gone back to; `learnt_from` are the numbers of those that set modes since
    these were last forgotten, in order, None where the first of them are not kept any more; `rate` is how many pictures
    come."""

    def __init__(self, session: Session, history: History, clock: Callable[[], float] = time.monotonic) -> None:
        self._session, self._history, self._clock = session, history, clock
        self.moments, self.rate = Moments(), Rate()
        self.forget()

    @property
    def pictures_a_second(self) -> float | None:
        """None while none are coming."""
        return self.rate.per_second(self._clock())

    def forget(self) -> None:
        """Another scene is open."""
        self._history.clear()
        self.moments.clear()
        self.rate.forget()
        self._request: RenderRequest | None = None
        self._shown: Key | None = None
        self.forget_modes()

    def forget_modes(self) -> None:
        """Nothing is known of shadows any more."""
        self._origins: dict[Key, ModeOrigins] = {}
        self._lights: dict[Key, NDArray[np.float64]] = {}
        self._dropped: set[Key] = set()
        self._blank = True  # whether modes are those of frames that were seen here
        self.learnt_from: list[int] | None = []

    def follow_edits(self) -> None:
        """The scene is edited otherwise: what modes are left, or come back, were taught by frames of another."""
        self.forget_modes()
        self._blank, self.learnt_from = False, None

    def add(self, learnt: Sequence[Traced], newest: Traced | None, drawn_seconds: float) -> None:
        """Take up the frames that have set modes since the last time, all of them and in their order, and the newest
        that is shown, which may be one of them or not be whole yet; `drawn_seconds` is what the window needed last."""
        for traced in learnt:
            number = self._count(traced, drawn_seconds)
            self._learn(traced, number)
        last = learnt[-1].request if learnt else None
        if newest is not None and newest.request is not last and newest.frame.settings.samples == 1:
            self._count(newest, drawn_seconds)

    def _count(self, traced: Traced, drawn_seconds: float) -> int:
        """Put a frame into the plots, and keep what brings it back; returns its number."""
        again, self._request = traced.request is self._request, traced.request
        self._history.add(traced.frame, drawn_seconds, again)
        if not again:
            self.rate.count(self._clock())
        number = self._history.frames - 1
        self.moments.put(self._moment(traced, number))
        return number

    def _moment(self, traced: Traced, number: int) -> Moment:
        session, frame = self._session, traced.frame
        scene = session.scene
        follow = session.follow and scene is not None and frame.camera == scene.camera_at(frame.time)
        chosen = settings_to_json(session.settings)
        for name, value in settings_to_json(frame.settings).items():
            if name not in ("samples", "lamp_samples", "verify", "method"):  # of these the picture may have had others
                chosen[name] = value
        return Moment(
            number, frame.time, frame.camera, follow, frame.settings, chosen, session.view, session.light, session.wipe,
            traced.full_size, traced.whole, session.edited.edits if session.edited is not None else NO_EDITS,
        )  # fmt: skip

    # --- which frame set a mode --------------------------------------------------------------------------

    def _learn(self, traced: Traced, number: int) -> None:
        frame, scene = traced.frame, self._session.scene
        if traced.fresh:
            self.forget_modes()
        if self.learnt_from is not None:
            self.learnt_from.append(number)
            if not traced.whole or len(self.learnt_from) > MOST:
                self.learnt_from = None
        if scene is None or not frame.settings.keeps_modes:
            return
        key = _key(frame)
        if traced.request.divisor == 1:
            self._shown = key
        blank = self._blank and key not in self._dropped
        origins = self._origins.pop(key, None) or ModeOrigins(frame.lights, blank=blank)
        self._origins[key] = origins  # the newest last
        if len(self._origins) > MODE_HISTORIES:
            oldest = next(iter(self._origins))
            del self._origins[oldest]
            self._dropped.add(oldest)
        lights, before = scene.light_positions(frame.time), self._lights.get(key)
        moved = None if before is None or len(before) != len(lights) else (lights != before).any(axis=1)
        self._lights[key] = lights
        origins.add(number, frame.modes, moved)

    def origins(self, pick: Pick) -> Origins | None:
        """Which frames set the modes of the unit that was picked; None where that is not known."""
        origins = self._origins.get(self._shown) if self._shown is not None else None
        if origins is None or self._shown is None or self._shown[2] != pick.in_cells:
            return None
        return origins.of(pick.unit)


def _key(frame: Frame) -> Key:
    """What tells mode histories apart."""
    s = frame.settings
    return s.width, s.height, has_modes_of_cells(frame), s.lamp_radius, s.lamp_samples
