"""Constructs all services of the window, and does what concerns several of them.

Panels and commands call the services.  `viewer.window.app` calls what must happen in each frame of the window, in its
order.  Nothing here knows widgets or GL, so that tests can drive all of it without a window."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

from tracer.editing.edits import Edited
from tracer.frame import Frame
from tracer.renderer import Renderer
from viewer.services.beside import Baseline
from viewer.services.capture_service import CaptureService
from viewer.services.comparing import Comparing
from viewer.services.editing import Editing
from viewer.services.film import Films
from viewer.services.frame_inputs import FrameInputs
from viewer.services.frame_navigator import FrameNavigator
from viewer.services.frame_scheduler import Activity, FrameScheduler
from viewer.services.history import FrameHistory
from viewer.services.inspector import Inspector, Selection
from viewer.services.jobs import Wake
from viewer.services.motion import Motion
from viewer.services.named_states import Bookmarks, Presets
from viewer.services.pictures import Pictures
from viewer.services.questions import Questions
from viewer.services.render_request import Traced
from viewer.services.render_thread import RenderThread
from viewer.services.runs import Runs
from viewer.services.scene_loader import SceneLoader
from viewer.services.scene_table import SceneTable
from viewer.services.settings_controller import SettingsController
from viewer.services.shrinking import Shrinking
from viewer.services.stepping import Stepping
from viewer.services.undo import Undo
from viewer.state import codec
from viewer.state.methods import remark_on
from viewer.state.notices import Notices
from viewer.state.preferences import Preferences
from viewer.state.session import Session
from viewer.state.view_state import ViewState


class Controller:
    """The services of the window.  `wake` makes the window draw a frame soon, and may be called from any thread; `info`
    is what `scene_info` says of the scene, `drawn_seconds` what the window's last frame took; `reloaded` says that the
    scene has been read again, and no frame of it has come yet."""

    def __init__(self, preferences: Preferences) -> None:
        self.wake = wake = Wake()
        self.preferences = preferences
        self.session = session = Session(state=codec.recalled(preferences.state))
        self.notices = notices = Notices(wake)
        self.renderer = renderer = RenderThread(wake)
        self.scheduler = scheduler = FrameScheduler(renderer, wake)
        self.history = FrameHistory(session)
        self.selection = selection = Selection(session, lambda: self.frame)
        self.captures = captures = CaptureService(session, preferences, notices, wake)
        self.runs = runs = Runs(
            session, selection, renderer.perform, preferences, notices, captures, wake, lambda: self.editing.under_way
        )
        self.baseline = Baseline(renderer.in_spare_time)
        self.settings = settings = SettingsController(session, preferences, notices, runs.refuses)
        self.motion = motion = Motion(session, preferences, notices, runs.refuses)
        self.comparing = Comparing(session, scheduler, notices)
        self.bookmarks = bookmarks = Bookmarks(session, preferences, notices, settings.save)
        self.undo = undo = Undo(session, motion, notices, runs.refuses, self.reset_modes)
        self.presets = Presets(session, preferences, notices, settings.save, runs.refuses, undo.begin_step)
        self.inspector = Inspector(selection, renderer.query)
        self.stepping = Stepping(selection, renderer.query, scheduler.trace_again)
        self.navigator = FrameNavigator(
            session, self.history, scheduler, runs, undo, selection, notices, self.restore, self.reset_modes
        )
        self.editing = editing = Editing(
            session, renderer, notices, runs.refuses, self._show_edited, undo.without_undo, scheduler.trace_once_more
        )
        self.table = SceneTable(session, selection, preferences, notices, captures, editing, wake)
        self.questions = questions = Questions(runs, captures, wake)
        self.loader = loader = SceneLoader(session, preferences, notices, questions.before_opening, wake)
        self.pictures = pictures = Pictures(
            session, preferences, scheduler, self.history, loader, runs, captures, notices
        )
        self.films = Films(session, preferences, runs, pictures, bookmarks)
        self.shrinking = Shrinking(session, preferences, runs, self.history, selection, lambda: self.own_traced)
        self.reloaded = False
        self.info: dict[str, Any] = {}
        self.drawn_seconds = 0.0

    @property
    def frame(self) -> Frame | None:
        """The newest traced frame."""
        return self.scheduler.frame

    @property
    def traced(self) -> Traced | None:
        """The newest traced frame with the request it answers."""
        return self.scheduler.traced

    @property
    def own_traced(self) -> Traced | None:
        """The same, None while it is that of a run."""
        return self.scheduler.traced if self.runs.current is None else None

    @property
    def active(self) -> bool:
        """Whether anything goes on."""
        working = self.renderer.busy or self.loader.busy or self.captures.busy or self.runs.current is not None
        return working or self.motion.is_animating

    # --- what happens in each frame of the window (see `viewer.window.app.advance`) ---------------

    def take_scene(self) -> None:
        """Show the scene that has been read, if one has."""
        session, arrival = self.session, self.loader.take_finished()
        if arrival is None:
            return
        place, playing, said = arrival.place, arrival.again and session.playing, arrival.text
        if arrival.again:
            place = session.state  # it is seen as it is now, from where we are
        if arrival.renderer is not None:
            self.show(arrival.renderer, arrival.info)
        if arrival.place is not None:
            self.undo.begin_step("the place of a saved picture", with_time=True)
        if place is not None:
            self.restore(place)
        elif session.scene is not None:
            said = f"{said}. {remark_on(session.scene.lights, session.settings)}".removesuffix(". ")
        session.playing, self.reloaded = playing and session.animated, arrival.again
        self.notices.say(said)

    def take_frame(self) -> None:
        """Take the newest frame, of a run that is under way or else as it was asked for."""
        problems, frame_failed = self.renderer.take_problems()
        for problem in problems:
            self.notices.report(problem)
        if frame_failed:
            self.session.playing = False
            self.scheduler.give_up()
        of_run, ended = self.runs.take_progress()
        if ended:
            self.scheduler.trace_once_more()  # else the world might stay where the run has put it
        if of_run is not None:
            self.scheduler.traced = of_run
            frame = of_run.frame
        else:
            newest = self.scheduler.take()
            self.history.take(self.renderer.take_learnt(), newest, self.drawn_seconds)
            if newest is None:
                return
            frame = newest.frame
        self.reloaded = False
        self.motion.look_around(frame)

    def move(self) -> None:
        """Bring time and camera to where they should be now."""
        traced = self.traced
        self.motion.advance(traced.request.time if traced is not None and traced.whole else None)
        self.navigator.leave_find()

    def apply_edits(self) -> None:
        """Have the scene edited as is wanted, once what was edited last has been seen."""
        seen = self.scheduler.shows_edits or not self.renderer.busy
        self.editing.apply(self.runs.current is not None, seen)

    def frame_inputs(self, size: tuple[int, int]) -> FrameInputs:
        """Return what decides how the next frame is traced, in a window that has room for so many pixels."""
        session = self.session
        return FrameInputs(
            session.state, session.scene, session.camera, size,
            moving=self.motion.under_way, playing=session.playing, counting=session.counting, run=self.runs.current,
            edited=self.editing.at_work, ready=self.loader.warm_up_job is None, second=self.comparing.second_method,
            focus=self.selection.hovered, inspected=session.playing and self.selection.pixel is not None,
        )  # fmt: skip

    def measure(self) -> None:
        """Measure in spare time how fast the picture is traced by the method and by none, while that is to be seen."""
        second = self.comparing.second_method
        wanted = self.preferences.savings or bool(second)
        busy = self.renderer.busy or self.loader.busy or self.runs.current is not None or self.editing.at_work
        busy = busy or self.scheduler.activity is not Activity.RESTING or not wanted
        self.baseline.update(self.traced, second, self.motion.is_animating, busy)

    # --- going elsewhere -------------------------------------------------------------------------

    def reset_modes(self) -> None:
        """Forget all that is known about shadows, and trace the frame anew."""
        if not self.runs.refuses():
            self.renderer.reset_modes()
            self.scheduler.forget_modes()
            self.editing.forget_modes()
            self.baseline.forget()

    def show(self, renderer: Renderer, info: dict[str, Any]) -> None:
        """Show another scene: what was known and drawn of the old one is gone, settings and view stay."""
        scene = renderer.scene
        self.runs.stop()
        if self.session.scene is None or self.session.scene.path != scene.path:
            self.undo.clear()
        self.session.open(scene)
        self.info = info
        self.renderer.use(renderer)
        self.editing.enter(renderer)
        self.history.clear()
        self.scheduler.forget()
        self.baseline.forget()
        self.selection.clear()
        self.motion.enter(info.get("bounds"))
        self.preferences.remember_scene(Path(scene.path).absolute())
        self.settings.save()

    def _show_edited(self, now: Edited, renderer: Renderer) -> None:
        """Show the scene that is open with other edits: where we are, and what was chosen, stays."""
        before = self.session.edited
        same = before is not None and before.made_as(now)
        if before is not None and not before.edits:
            self.editing.before = self.comparing.b
        self.undo.without_undo(lambda: self.session.take(now))
        self.renderer.use(renderer, fresh=False)
        self.history.forget_modes(blank=False)
        self.scheduler.forget_modes()
        self.baseline.forget()
        if not same:  # primitives and lights have other numbers: the newest frame means nothing any more
            self.scheduler.traced = None
            self.selection.update_for_edits(before, now)
            self.reloaded = True

    def restore(self, state: ViewState) -> None:
        """Go back to a state of the open scene."""
        self.runs.stop()
        self.motion.halt()
        self.session.restore(state)

    def go_to_bookmark(self, index: int) -> None:
        """Glide to a bookmark and take over its time and view; settings stay as they are."""
        if self.runs.refuses():
            return
        state, start = self.bookmarks.find(index), self.session.camera
        if state is not None:
            self.undo.begin_step(f"going to {self.bookmarks.all[index].name}", with_time=True)
            self.restore(state)
            if state.camera is not None:
                self.motion.glide(state.camera, start)

    def close(self, timeout: float = 30.0) -> bool:
        """Stop everything, finish writing files and save the preferences; false if something would not stop."""
        deadline = time.monotonic() + timeout
        jobs = [*self.loader.close(), *self.captures.saving]
        self.runs.stop()
        self.session.give_size_back()
        stopped = self.renderer.close(timeout)
        for job in jobs:
            stopped &= job.join(max(0.0, deadline - time.monotonic()))
        self.settings.finish()
        return stopped
