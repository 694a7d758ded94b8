"""Between the widgets and the threads: what happens when something was asked for.

The controller owns the session, the render thread and the background jobs.  Panels and commands
call it; the window calls `tick` once per frame.  It knows neither widgets nor GL, so that tests
can drive it without a window.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Collection
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from tracer.renderer import Frame, Renderer
from tracer.scene.model import Camera, Scene
from viewer.services.capture_service import Keeper
from viewer.services.motion import Motion
from viewer.services.questions import Asking
from viewer.services.render_thread import RenderThread, Traced
from viewer.services.run_controller import Runner
from viewer.services.scene_loader import Opener
from viewer.services.shadow_inspector import Explaining
from viewer.services.tracing import Tracing
from viewer.state import navigation
from viewer.state.faults import Faults
from viewer.state.history import History
from viewer.state.log import Level, Log
from viewer.state.picking import Pick, pick, refreshed, typical_depth
from viewer.state.preferences import Preferences, save_preferences
from viewer.state.session import Session, Snapshot
from viewer.state.views import View
from viewer.util.failures import Failure
from viewer.util.messages import in_one_line

INFO_SECONDS = 6.0


@dataclass(frozen=True)
class Message:
    """One line for the status bar."""

    text: str
    error: bool
    at: float


class Controller:
    """See the module.  `wake` makes the window draw a frame soon; it may be called from any thread."""

    def __init__(self, preferences: Preferences, wake: Callable[[], None] = lambda: None) -> None:
        self.preferences = preferences
        self.session = Session(settings=preferences.settings(), view=preferences.chosen_view())
        self.wake = wake
        self.render = RenderThread(lambda: self.wake())
        self.history = History()
        self.log = Log()
        self.faults = Faults(self.log)
        self.info: dict[str, Any] = {}
        self.selected: Pick | None = None
        self.hovered: tuple[float, float] | None = None
        self.message: Message | None = None
        self.opener = Opener(self)
        self.keeper = Keeper(self)
        self.runner = Runner(self)
        self.tracing = Tracing(self)
        self.motion = Motion(self)
        self.explaining = Explaining(self)
        self.asking = Asking(self)
        self.drawn_seconds = 0.0
        self.size = (0, 0)
        self._seen = math.inf

    # --- the frame -------------------------------------------------------------------------------

    def tick(self, size: tuple[int, int]) -> Frame | None:
        """One step of everything: `size` is what the picture's window has room for, in pixels (0 if hidden).

        Returns the frame that has just come, if one has."""
        self.size = size
        self.opener.follow()
        self.keeper.follow()
        self.asking.follow()
        frame = self._take_frame()
        self.motion.follow()
        self.tracing.ask()
        self.explaining.follow()
        return frame

    @property
    def frame(self) -> Frame | None:
        """The newest traced frame."""
        return self.tracing.frame

    @property
    def traced(self) -> Traced | None:
        """The newest traced frame with the request it answers."""
        return self.tracing.traced

    @property
    def moving(self) -> bool:
        """Whether frames should come fast rather than fine."""
        return self.motion.under_way

    @property
    def lively(self) -> bool:
        """Whether each of the window's frames shows something else than the last."""
        return self.moving or self.session.playing

    @property
    def active(self) -> bool:
        """Whether anything goes on."""
        working = self.render.busy or self.opener.busy or self.keeper.busy or self.runner.current is not None
        return working or self.lively

    def _take_frame(self) -> Frame | None:
        failed = self.render.take_failure()
        if failed is not None:
            self.report(failed)
            self.session.playing = False
        of_run = self.runner.follow()
        if of_run is not None:
            self.tracing.show(of_run)
        before = self.tracing.traced
        traced = of_run if of_run is not None else self.tracing.take()
        if traced is None:
            return None
        frame = traced.frame
        if of_run is None and frame.settings.samples == 1:  # further samples count nothing
            again = before is not None and before.request is traced.request
            self.history.add(frame, self.drawn_seconds, again)
        if math.isinf(self._seen):  # from the scene's first frame on, so that the speed does not change on the way
            self._seen = typical_depth(frame)
        if self.selected is not None:
            self.selected = refreshed(self.selected, frame)
        return frame

    # --- messages and selection ------------------------------------------------------------------

    def say(self, text: str, error: bool = False, details: str = "") -> None:
        """Show one line in the status bar, a notice for some seconds, an error until the next; the log keeps both."""
        self.message = Message(in_one_line(text), error, time.monotonic())
        self.log.add(Level.ERROR if error else Level.NOTICE, self.message.text, details)
        self.wake()

    def report(self, failed: Failure) -> None:
        """Tell of a failure: in the status bar where it was to be expected, else as a fault of the program."""
        if failed.expected:
            self.say(failed.text, error=True, details=failed.details)
        else:
            self.faults.tell(failed)
            self.wake()

    @property
    def current_message(self) -> Message | None:
        if self.message is not None and not self.message.error and time.monotonic() - self.message.at > INFO_SECONDS:
            self.message = None
        return self.message

    def pick(self, at: tuple[float, float] | None) -> Pick | None:
        """What lies under a point of the picture."""
        if at is None or self.frame is None or self.session.scene is None:
            return None
        return pick(self.frame, self.session.scene, *at)

    def select(self, at: tuple[float, float]) -> None:
        """Keep what is under a point of the picture in view of the inspector; nothing there: forget it."""
        found = self.pick(at)
        self.selected = found if found is not None and found.primitive >= 0 else None

    def show(self, scene: Scene, renderer: Renderer, info: dict[str, Any]) -> None:
        """Look at another scene: what was learnt and drawn of the old one is gone, settings and view stay."""
        self.runner.stop()
        self.session.open(scene)
        self.info = info
        self.render.use(renderer)
        self.history.clear()
        self.tracing.forget()
        self._seen = math.inf
        self.selected = None
        self.motion.halt()
        self.preferences.remember_scene(Path(scene.path).absolute())
        self.save_preferences()

    def restore(self, snapshot: Snapshot) -> None:
        """Go back to a snapshot of the open scene."""
        self.runner.stop()
        self.motion.halt()
        self.session.restore(snapshot)
        self.preferences.keep(self.session.settings)
        self.preferences.view = self.session.view.value

    # --- settings --------------------------------------------------------------------------------

    def change(self, **changes: Any) -> None:
        """Change fields of `tracer.Settings`; a value that is no good is one line and changes nothing."""
        if self.runner.refuses():
            return
        try:
            settings = replace(self.session.settings, **changes)
            settings.validated()
        except ValueError as error:
            self.say(str(error), error=True)
            return
        self.session.settings = settings
        self.preferences.keep(settings)

    def set_view(self, view: View) -> None:
        if view is View.CERTIFICATE and self.frame is not None and self.frame.statistics.certificates:
            self.tracing.reconsider()  # more may be made at rest, for this view to show
        self.session.view = view
        self.preferences.view = view.value

    def set_light(self, light: int) -> None:
        """Choose the light of the views that speak of one; counts around."""
        lights = len(self.session.scene.lights) if self.session.scene is not None else 0
        self.session.light = light % lights if lights else 0

    def toggle_culling(self) -> None:
        self.change(method="none" if self.session.settings.method != "none" else self.preferences.method)

    def reset_modes(self) -> None:
        """Forget all that was learnt about shadows, and look again."""
        if not self.runner.refuses():
            self.render.reset_modes()
            self.tracing.again(modes_are_lost=True)

    def trace_again(self) -> None:
        """Trace the same frame once more: the modes may have learnt from the last.  One under way is let finish."""
        if not self.render.busy:
            self.tracing.again()

    # --- camera and time -------------------------------------------------------------------------

    @property
    def world_up(self) -> navigation.Vector:
        scene = self.session.scene
        return navigation.world_up(scene.camera) if scene is not None else np.array([0.0, 1.0, 0.0])

    @property
    def pace(self) -> float:
        """World units per second at speed 1."""
        low, high = self.info.get("bounds") or ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
        return navigation.pace(low, high, self._seen)

    def moved(self) -> None:
        """Note that the picture is changing under the user's hand: coarse frames for a moment."""
        self.motion.by_hand()

    def move(self, camera: Camera) -> None:
        """Take the camera in hand and put it there."""
        if self.runner.refuses():
            return
        self.motion.halt()
        self.session.move(camera)
        self.moved()

    def glide(self, camera: Camera, start: Camera | None = None) -> None:
        """Move the camera there in a moment's time."""
        if self.runner.refuses():
            return
        self.motion.glide(start or self.session.camera, camera)

    def follow_path(self, follow: bool) -> None:
        """Put the camera on the scene's own path, or take it off where it is."""
        if self.runner.refuses():
            return
        self.motion.halt()
        self.session.free_camera = None if follow else self.session.camera

    def reset_camera(self) -> None:
        """Back to the scene's own camera, now."""
        self.follow_path(True)

    def toggle_play(self) -> None:
        if self.runner.refuses():
            return
        if not self.session.animated:
            self.say("this scene has no animation")
            return
        scene = self.session.scene
        if not self.session.playing and scene is not None and self.session.time >= scene.time_range[1]:
            self.session.go_to_frame(0)
        self.session.playing = not self.session.playing

    def step(self, frames: int) -> None:
        """Stop, and go so many frames on (or back)."""
        if self.runner.refuses():
            return
        self.session.playing = False
        self.session.go_to_frame(self.session.frame + frames)
        self.moved()  # a key that is held down is motion

    # --- the end ---------------------------------------------------------------------------------

    def reset_preferences(self, kept: Collection[str]) -> None:
        """All settings as they were at first, but for these fields of the preferences."""
        if self.runner.refuses():
            return
        self.preferences.reset(kept)
        self.session.settings, self.session.view = self.preferences.settings(), self.preferences.chosen_view()
        self.save_preferences()
        self.say("settings reset")

    def save_preferences(self) -> None:
        error = save_preferences(self.preferences)
        if error:
            self.say(error, error=True)

    def close(self, timeout: float = 30.0) -> bool:
        """Stop everything, finish writing pictures and save the preferences; false if something would not stop."""
        deadline = time.monotonic() + timeout
        jobs = [*self.opener.cancel_all(), *self.keeper.saving]
        self.runner.stop()
        stopped = self.render.close(timeout)
        for job in jobs:
            stopped &= job.join(max(0.0, deadline - time.monotonic()))
        if self.session.scene is not None:
            self.preferences.last = self.session.snapshot().to_json()
        self.save_preferences()
        return stopped
