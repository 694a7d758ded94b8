"""Camera and time: moved by hand, glided, played.

While something moves, pictures should come fast rather than fine."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from tracer.frame import Frame
from tracer.scene.model import Camera
from viewer.state import navigation
from viewer.state.notices import Notices
from viewer.state.picking import typical_depth
from viewer.state.preferences import Preferences
from viewer.state.session import Session

IDLE_AFTER = 0.25
"""Seconds after a movement by hand until nothing moves."""
LONGEST_STEP = 0.25
"""Seconds, at most, by which time and a flown camera go on between two frames, however long the window slept."""

Corner = Sequence[float]


class _Glide(NamedTuple):
    """A camera on its way to another place, in so many seconds."""

    start: Camera
    end: Camera
    began: float
    seconds: float


class Motion:
    """Moves the session's camera and time on; both stay where they are while `locked()`, which says so itself."""

    def __init__(
        self, session: Session, preferences: Preferences, notices: Notices, locked: Callable[[], bool]
    ) -> None:
        self._session, self._preferences, self._notices, self._locked = session, preferences, notices, locked
        self._glide: _Glide | None = None
        self._moving_until = 0.0
        self._last = time.monotonic()
        self._bounds: tuple[Corner, Corner] | None = None
        self._depth = math.inf

    def enter(self, bounds: tuple[Corner, Corner] | None) -> None:
        """Begin in another scene, of these bounds."""
        self.halt()
        self._bounds, self._depth = bounds, math.inf

    def look_around(self, frame: Frame) -> None:
        """Take the scene's scale from its first frame, and keep it, so that the speed does not change on the way."""
        if math.isinf(self._depth):
            self._depth = typical_depth(frame)

    # --- what is moving ---------------------------------------------------------------------------

    @property
    def under_way(self) -> bool:
        """Whether frames should come fast rather than fine."""
        real_time = self._session.playing and not self._session.state.pace.every_frame
        return real_time or self.is_dragging

    @property
    def is_dragging(self) -> bool:
        """Whether the camera is being moved, by hand or to where it was sent; time that passes does not count."""
        return self._glide is not None or time.monotonic() < self._moving_until

    @property
    def destination(self) -> Camera | None:
        """Where the camera is on its way to; None unless it glides."""
        return self._glide.end if self._glide is not None else None

    @property
    def is_animating(self) -> bool:
        """Whether each of the window's frames shows something else than the last."""
        return self.under_way or self._session.playing

    def advance(self, shown: float | None) -> None:
        """Bring time and camera to where they should be now; `shown` is the time of the newest whole picture."""
        now = time.monotonic()
        step, self._last = min(now - self._last, LONGEST_STEP), now
        session, preferences = self._session, self._preferences
        if session.playing and not session.state.pace.every_frame:
            session.advance(step * preferences.playback_rate, preferences.loop)
        elif session.playing and shown == session.time:  # this frame has been traced
            session.advance_frame(preferences.loop)
        if self._glide is not None:
            t = (now - self._glide.began) / self._glide.seconds
            session.change(camera=navigation.blend(self._glide.start, self._glide.end, t))
            if t >= 1.0:
                self._glide = None

    # --- the camera -------------------------------------------------------------------------------

    @property
    def world_up(self) -> navigation.Vector:
        scene = self._session.scene
        return navigation.world_up(scene.camera) if scene is not None else np.array([0.0, 1.0, 0.0])

    @property
    def pace(self) -> float:
        """World units per second at speed 1."""
        low, high = self._bounds or ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
        return navigation.pace(low, high, self._depth)

    def move(self, camera: Camera) -> None:
        """Take the camera in hand and put it there."""
        if self._locked():
            return
        self.halt()
        self._session.change(camera=camera)
        self.by_hand()

    def glide(self, camera: Camera, start: Camera | None = None) -> None:
        """Move the camera there from where it is or from `start`, for as long as the way is, so that the eye can
        follow."""
        if not self._locked():
            start = start or self._session.camera
            seconds = navigation.flight_seconds(start, camera, self.pace)
            self._glide = _Glide(start, camera, time.monotonic(), seconds)

    def halt(self) -> None:
        """Leave the camera where it is."""
        self._glide = None

    def follow_path(self, follow: bool) -> None:
        """Put the camera on the scene's own path, or take it off where it is."""
        if self._locked():
            return
        self.halt()
        self._session.change(camera=None if follow else self._session.camera)

    # --- time -------------------------------------------------------------------------------------

    def toggle_play(self) -> None:
        if self._locked():
            return
        session = self._session
        if not session.animated:
            self._notices.say("this scene has no animation")
            return
        if not session.playing and session.scene is not None and session.time >= session.scene.time_range[1]:
            session.go_to_frame(0)
        session.playing = not session.playing

    def step(self, frames: int) -> None:
        """Stop, and go so many frames on (or back)."""
        if self._locked():
            return
        self._session.playing = False
        self._session.go_to_frame(self._session.frame + frames)
        self.by_hand()  # a key that is held down is motion

    def by_hand(self) -> None:
        """Note that the picture is changing under the user's hand: coarse frames for a moment."""
        self._moving_until = time.monotonic() + IDLE_AFTER
