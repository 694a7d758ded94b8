"""Wires the session, the threads and the helpers together, and takes them one step further in each frame.

Panels and commands call the helpers; the window calls `tick` once per frame.  Nothing here knows widgets or GL, so that
tests can drive all of it without a window.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from tracer.experiments.zoom import Step
from tracer.frame import Frame
from tracer.renderer import Renderer
from tracer.scene.edits import Edited
from tracer.scene.model import Scene
from viewer.services.baseline import Baseline
from viewer.services.before_edits import BeforeEdits
from viewer.services.bookmarks import Bookmarks
from viewer.services.capture_service import CaptureService
from viewer.services.comparing import Comparing
from viewer.services.editing import Editing
from viewer.services.film_controller import FilmController
from viewer.services.frame_history import FrameHistory, FrameNavigator
from viewer.services.hunt_controller import HuntController
from viewer.services.light_recorder import LightRecorder
from viewer.services.motion import Motion
from viewer.services.origin_pixels import OriginFinder
from viewer.services.picture_controller import PictureController
from viewer.services.pixel_inspector import PixelInspector
from viewer.services.presets import Presets
from viewer.services.preview import Preview
from viewer.services.questions import Questions
from viewer.services.ray_inspector import RayInspector
from viewer.services.recipes import Recipes
from viewer.services.render_request import Traced
from viewer.services.render_thread import RenderThread
from viewer.services.run_controller import RunController
from viewer.services.scene_loader import Arrival, SceneLoader
from viewer.services.scene_table import SceneTable
from viewer.services.scene_watcher import SceneWatcher
from viewer.services.selection import Selection
from viewer.services.settings_controller import SettingsController
from viewer.services.tracing import Conditions, Tracing
from viewer.services.undo import Undo
from viewer.state.arriving import fitting_view
from viewer.state.notices import Notices
from viewer.state.preferences import Preferences
from viewer.state.session import Session, Snapshot
from viewer.state.views import View


class Controller:
    """See the module.  `wake` makes the window draw a frame soon, and may be called from any thread; `info` is what
    `scene_info` says of the scene, `drawn_seconds` what the window's last frame took; `reloaded` says that the scene
    has been read again, and no frame of it has come yet."""

    def __init__(self, preferences: Preferences, wake: Callable[[], None] = lambda: None) -> None:
        self.wake = wake

        def awaken() -> None:
            self.wake()

        self.preferences = preferences
        self.session = session = Session(settings=preferences.settings(), view=preferences.chosen_view())
        self.notices = notices = Notices(awaken)
        self.renderer = renderer = RenderThread(awaken)
        self.history = FrameHistory(session)
        self.selection = Selection(session, lambda: self.frame)
        self.captures = CaptureService(session, preferences, notices, awaken)
        self.runs = RunController(
            session, self.selection, renderer, preferences, notices, self.captures, awaken,
            lambda: self.editing.under_way,
        )  # fmt: skip
        self.tracing = Tracing(session, preferences, renderer, self.runs.refuses, awaken, forgotten=self._forget_modes)
        self.baseline = Baseline(renderer)
        self.settings = SettingsController(session, preferences, notices, self.runs.refuses)
        self.motion = Motion(session, preferences, notices, self.runs.refuses)
        self.comparing = Comparing(session, self.tracing, self.settings, notices)
        self.bookmarks = Bookmarks(session, preferences, self.settings, notices)
        self.undo = Undo(
            session, preferences, self.motion, notices, self.runs.refuses,
            lambda meshes: self.loader.read_as(meshes), lambda: self.loader.load_job is not None,
        )  # fmt: skip
        self.presets = Presets(
            session, preferences, notices, self.runs.refuses, self.settings.save, self.undo.call_next
        )
        self.inspector = PixelInspector(self.selection, renderer.query)
        self.rays = RayInspector(session, self.selection, self.inspector, renderer.query)
        self.origins = OriginFinder(self.selection, self.history, renderer.query)
        self.navigator = FrameNavigator(
            session, preferences, self.history, self.tracing, self.runs, self.undo, self.selection, notices,
            self.restore,
        )  # fmt: skip
        self.recorder = LightRecorder(session, renderer.query, self.tracing)
        refuses, overlook = self.runs.refuses, self.undo.overlook
        self.editing = Editing(session, renderer, notices, refuses, self._show_edited, overlook, self.tracing.again)
        self.table = SceneTable(session, self.selection, preferences, notices, self.captures, self.editing, awaken)
        self.before_edits = BeforeEdits(session, self.editing)
        self.questions = Questions(self.runs, self.captures, awaken)
        self.loader = SceneLoader(session, preferences, notices, self.questions.before_opening, awaken)
        self.preview = Preview(session, self.loader, self.motion, notices, awaken)
        self.recipes = Recipes(session, preferences, self.tracing, self.loader, notices)
        films = FilmController(session, preferences, self.runs, self.recipes, self.bookmarks, notices, awaken)
        self.films = films
        self.pictures = PictureController(session, preferences, self.runs, self.recipes, notices, awaken)
        self.hunts = HuntController(session, preferences, self.runs, self.navigator, self.recipes, notices, awaken)
        self.watcher = SceneWatcher(
            preferences, lambda: self.loader.files, self._may_reload, self.loader.follow_change, awaken
        )
        self.reloaded = False
        self._bookmark = -1  # the one that was gone to last
        self.info: dict[str, Any] = {}
        self.drawn_seconds = 0.0

    @property
    def frame(self) -> Frame | None:
        """The newest traced frame."""
        return self.tracing.frame

    @property
    def traced(self) -> Traced | None:
        """The newest traced frame with the request it answers."""
        return self.tracing.traced

    @property
    def active(self) -> bool:
        """Whether anything goes on."""
        working = self.renderer.busy or self.loader.busy or self.captures.busy or self.runs.current is not None
        working = working or bool(self.pictures.jobs)
        return working or self.motion.lively

    # --- the frame -------------------------------------------------------------------------------

    def tick(self, size: tuple[int, int]) -> Frame | None:
        """Take everything one step further; `size` is what the picture's window has room for, in pixels (0 if hidden).

        Returns the frame that has just come, if one has."""
        self._take_scene()
        self.watcher.follow()
        self.captures.follow()
        self.pictures.follow()
        self.questions.follow()
        frame = self._take_frame()
        self.preview.follow(traced=self.frame is not None)
        self.comparing.follow()
        traced, motion, run = self.traced, self.motion, self.runs.current
        motion.follow(traced.request.time if traced is not None and traced.whole else None)
        self.undo.follow()
        self.editing.follow(run is not None, self.tracing.shows_edits or not self.renderer.busy)
        traced = self.traced if run is None else None  # edits may have left the newest frame behind
        # Before the next frame is asked for:
        cuts = traced is not None and traced.whole and self.tracing.drawn_view is View.CUTS
        self.inspector.update(self.frame if run is None else None, not motion.lively, cuts)
        self.rays.update(self.frame if run is None else None)
        self.table.follow(traced, motion.lively)
        edits, focus = self.editing.at_work, self.selection.hovered
        scene, settings = self.session.scene, self.session.settings
        if scene is not None:
            self.loader.prepare(settings.method, len(scene.lights), settings.accelerator)
        self.tracing.ask(Conditions(size, motion.under_way, run, edits, self.loader.ready, focus))
        if run is None:
            self.recorder.update()
            self._follow_before_edits()
            if self.traced is not None and self.traced.whole:
                self.bookmarks.follow(self.traced.frame, self.traced.request.divisor == 1)
        self.navigator.select_when_shown(self.traced)
        if not motion.lively:
            self._keep_preferences()
        self.origins.update(scene, self.traced if run is None and not motion.lively else None)
        self._follow_baseline()
        return frame

    def _follow_baseline(self) -> None:
        """Measure in spare time what the picture that is shown takes, while that is to be seen."""
        tracing, compared = self.tracing, self.comparing.measures
        wanted = self.preferences.savings or bool(compared)
        busy = self.renderer.busy or tracing.awaits or tracing.adds_samples or tracing.refines_lamps
        busy = busy or self.loader.busy or self.runs.current is not None or self.editing.at_work or not wanted
        self.baseline.follow(self.traced, compared, self.motion.lively, busy)

    def _forget_modes(self) -> None:
        self.editing.forget_modes()
        self.baseline.forget()

    def _keep_preferences(self) -> None:
        """Save them soon after a change."""
        if self.preferences.start_where_left and self.session.scene is not None:
            self.preferences.last = self.session.snapshot().to_json()
        self.settings.follow()

    def _follow_before_edits(self) -> None:
        traced, tracing = self.traced, self.tracing
        now = traced is not None and traced.whole and traced.request.divisor == 1 and not self.motion.lively
        frame = traced.frame if traced is not None and now and tracing.shows_edits else None
        self.before_edits.follow(frame, not (tracing.awaits or tracing.adds_samples or self.renderer.busy))

    def _take_scene(self) -> None:
        arrival, flown = self.loader.follow(), self.preview.flown
        if arrival is None:
            return
        said = ""
        if arrival.again:
            self._show_again(arrival)
        elif arrival.opened is not None:
            self.show(arrival.opened.scene, arrival.opened.renderer, arrival.opened.info)
            said = self._fit_view() if arrival.place is None else ""
        if arrival.place is not None:
            self.undo.call_next("the place of a saved picture")
            self.restore(arrival.place)
        if flown is not None:  # while the scene was waiting for its kernels
            self.session.move(flown)
        self.notices.say(f"{arrival.text}. {said}" if said else arrival.text)

    def _fit_view(self) -> str:
        """Show the picture where the view has nothing to show in the scene that has just been opened; returns what is
        to be said of it, and of the method there."""
        session = self.session
        view, said = fitting_view(session.view, session.settings, session.scene.lights if session.scene else ())
        if view is not session.view:
            self.settings.set_view(view)
        return said

    def _show_again(self, arrival: Arrival) -> None:
        """Show the scene that was open as it is now, from where we are."""
        session, opened = self.session, arrival.opened
        if opened is None or session.scene is None:
            return
        here, playing = session.snapshot(), session.playing
        self.show(opened.scene, opened.renderer, opened.info)
        session.restore(here)
        session.playing = playing and session.animated
        self.reloaded = True

    def _may_reload(self) -> bool:
        """Whether a scene that has changed may be read now: not while a run goes on, or another is being read."""
        return self.runs.current is None and self.loader.load_job is None

    def _take_frame(self) -> Frame | None:
        """The newest frame, of a run that is under way or else as it was asked for."""
        for complaint in self.renderer.take_complaints():
            self.notices.report(complaint)
        failed = self.renderer.take_failure()
        if failed is not None:
            self.notices.report(failed)
            self.session.playing = False
            self.tracing.give_up()
        run = self.runs.follow()
        if run.ended:
            self.tracing.again()  # else the world might stay where the run has put it
        if run.picture is not None:
            self.tracing.show(run.picture)
            frame = run.picture.frame
        else:
            newest = self.tracing.take()
            learnt = self.renderer.take_learnt()
            for traced in learnt:
                self.tracing.learnt.add(traced.frame)
            self.history.take(learnt, newest, self.drawn_seconds)
            if newest is None:
                return None
            frame = newest.frame
        self.reloaded = False
        self.motion.look_around(frame)
        self.selection.refresh(frame)
        return frame

    # --- going elsewhere -------------------------------------------------------------------------

    def show(self, scene: Scene, renderer: Renderer, info: dict[str, Any]) -> None:
        """Show another scene: what was known and drawn of the old one is gone, settings and view stay."""
        self.runs.stop()
        if self.session.scene is None or self.session.scene.path != scene.path:
            self.undo.clear()
        self.session.open(scene)
        self.info = info
        self.renderer.use(renderer)
        self.editing.enter(renderer)
        self.before_edits.forget()
        self.history.clear()
        self.tracing.forget()
        self.baseline.forget()
        self.selection.clear()
        self.motion.enter(info.get("bounds"))
        self.preferences.remember_scene(Path(scene.path).absolute())
        self.settings.save()

    def _show_edited(self, now: Edited, renderer: Renderer) -> None:
        """Show the scene that is open with other edits: where we are, and what was chosen, stays."""
        before = self.session.edited
        same = before is not None and before.made_as(now)
        self.undo.overlook(lambda: self.session.take(now))
        self.renderer.use(renderer, fresh=False)
        self.history.forget_modes(blank=False)
        self.tracing.follow_edits(same)
        self.baseline.forget()
        if not same:
            self.selection.follow_edits(before, now)
            self.reloaded = True

    def restore(self, snapshot: Snapshot) -> None:
        """Go back to a snapshot of the open scene."""
        self.runs.stop()
        self.motion.halt()
        self.session.restore(snapshot)
        self.preferences.keep(self.session.settings)
        self.preferences.view = self.session.view.value

    def go_to_bookmark(self, index: int) -> None:
        """Glide to a bookmark and take over its time and view; settings stay as they are."""
        if self.runs.refuses():
            return
        snapshot, start = self.bookmarks.find(index), self.session.camera
        self._bookmark = index
        if snapshot is not None:
            self.undo.call_next(f"going to {self.bookmarks.all[index].get('name', '?')}")
            self.restore(snapshot)
            self.bookmarks.arrived(index)
            if not snapshot.follow:
                self.motion.fly_to(snapshot.camera, start)

    def next_bookmark(self, step: int) -> None:
        """Go to the next bookmark of the list, or with -1 to the one before; past the last comes the first."""
        count = len(self.bookmarks.all)
        if count:
            self._bookmark = (self._bookmark + step) % count if self._bookmark < count else 0
            self.go_to_bookmark(self._bookmark)
        else:
            self.notices.say("this scene has no bookmarks")

    def go_to_step(self, step: Step) -> None:
        """Glide to where a step of the zoom test stood, at the test's time."""
        camera = self.runs.go_to(step)
        if camera is not None:
            self.motion.glide(camera)

    def close(self, timeout: float = 30.0) -> bool:
        """Stop everything, finish writing files and save the preferences; false if something would not stop."""
        deadline = time.monotonic() + timeout
        jobs = [*self.loader.cancel_all(), *self.captures.saving]
        self.runs.stop()
        self.watcher.close()
        stopped = self.renderer.close(timeout)
        for job in jobs:
            stopped &= job.join(max(0.0, deadline - time.monotonic()))
        if self.session.scene is not None:
            self.preferences.last = self.session.snapshot().to_json()
        self.settings.save()
        return stopped
