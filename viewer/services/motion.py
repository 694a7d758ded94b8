"""What moves by itself: a camera that glides to another place, and time that is played."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import TYPE_CHECKING

from tracer.scene.model import Camera
from viewer.state import navigation

if TYPE_CHECKING:
    from viewer.services.controller import Controller

AT_REST_AFTER = 0.25
GLIDE_SECONDS = 0.35
LONGEST_STEP = 0.25


@dataclass(frozen=True)
class _Glide:
    """A camera on its way to another place."""

    start: Camera
    end: Camera
    began: float


class Motion:
    """Moves the session on with the clock, and knows whether the picture is at rest."""

    def __init__(self, controller: Controller) -> None:
        self._c = controller
        self._glide: _Glide | None = None
        self._moving_until = 0.0
        self._last = time.monotonic()

    @property
    def under_way(self) -> bool:
        """Whether frames should come fast rather than fine."""
        real_time = self._c.session.playing and not self._c.preferences.every_frame
        return real_time or self._glide is not None or time.monotonic() < self._moving_until

    def by_hand(self) -> None:
        """Note that the picture is changing under the user's hand: coarse frames for a moment."""
        self._moving_until = time.monotonic() + AT_REST_AFTER

    def glide(self, start: Camera, end: Camera) -> None:
        """Move the camera from one place to another in a moment's time, from the next `follow` on."""
        self._glide = _Glide(start, end, time.monotonic())

    def halt(self) -> None:
        """Leave the camera where it is."""
        self._glide = None

    def follow(self) -> None:
        """Bring time and camera to where they should be now."""
        now = time.monotonic()
        step, self._last = min(now - self._last, LONGEST_STEP), now
        self._play(step)
        if self._glide is not None:
            t = (now - self._glide.began) / GLIDE_SECONDS
            self._c.session.move(navigation.blend(self._glide.start, self._glide.end, t))
            if t >= 1.0:
                self._glide = None

    def _play(self, step: float) -> None:
        """In real time, or on to the next frame once this one has been traced."""
        session, preferences, traced = self._c.session, self._c.preferences, self._c.traced
        if not session.playing:
            return
        if not preferences.every_frame:
            session.advance(step * preferences.playback_rate, preferences.loop)
        elif traced is not None and traced.whole and traced.request.time == session.time:
            session.advance_frame(preferences.loop)
