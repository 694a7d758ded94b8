"""Starts and stops runs, shows their frames as the picture, and reports how they ended.

One run at a time: it has the render thread to itself.  What the user would change of the picture
meanwhile is refused, in one line that says how to stop it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from tracer.experiments import zoom
from tracer.experiments.zoom import Step
from tracer.scene.model import Camera
from viewer.output import exports
from viewer.services.capture_service import CaptureService
from viewer.services.render_request import RenderRequest, Task, Traced
from viewer.services.runs import Experiment, Run, ZoomTest, duration
from viewer.services.selection import Selection
from viewer.state.methods import BY_MODES, CERTIFIED
from viewer.state.notices import Notices
from viewer.state.plans import ExperimentPlan, ZoomPlan
from viewer.state.preferences import Preferences
from viewer.state.session import Session


class Performs(Protocol):
    """The part of `RenderThread` that is used here."""

    def perform(self, task: Task) -> None: ...


@dataclass(frozen=True)
class Progress:
    """What has become of the run since it was last asked: a frame that is to be the picture, and whether it ended."""

    picture: Traced | None = None
    ended: bool = False


class RunController:
    """`experiment` and `zoom_test` are the last of their kind: under way, done or stopped; `current` is under way."""

    def __init__(
        self,
        session: Session,
        selection: Selection,
        renderer: Performs,
        preferences: Preferences,
        notices: Notices,
        files: CaptureService,
        wake: Callable[[], None] = lambda: None,
        edited: Callable[[], bool] = lambda: False,
    ) -> None:
        """Nothing begins while `edited()`: the scene is being edited, and the next picture is of another."""
        self._edited = edited
        self._session, self._selection, self._renderer = session, selection, renderer
        self._preferences, self._notices, self._files, self._wake = preferences, notices, files, wake
        self.experiment_plan = ExperimentPlan({BY_MODES, CERTIFIED})
        self.zoom_plan = ZoomPlan()
        self.experiment: Experiment | None = None
        self.zoom_test: ZoomTest | None = None
        self.current: Run | None = None

    def refuses(self) -> bool:
        """Whether a run is under way that must not be disturbed; says so."""
        if self.current is None or self.current.stopping:
            return False
        self._notices.say(f"the {self.current.name} is still under way; stop it first")
        return True

    def start_experiment(self) -> None:
        """Begin what `experiment_plan` says, over the open scene's path."""
        scene = self._session.scene
        if self.refuses_start() or scene is None:
            return
        try:
            run = Experiment(scene, self._session.settings, self.experiment_plan, self._wake)
        except ValueError as error:
            self._notices.say(str(error), error=True)
            return
        self.experiment = run
        self._start(run)

    def start_zoom_test(self) -> None:
        """Go towards the selected primitive, from where the picture shows it or, so planned, from the last start."""
        scene, frame, selected = self._session.scene, self._selection.frame, self._selection.picked
        if self.refuses_start() or scene is None:
            return
        if frame is None:
            self._notices.say("there is no picture yet")
            return
        start = self.last_start if self.zoom_plan.same_start else None
        if start is None and selected is None:
            self._notices.say("click a primitive in the picture first: the zoom test goes towards it", error=True)
            return
        try:
            if start is None and selected is not None:
                if selected.dynamic:
                    raise ValueError(
                        f"primitive {selected.primitive} moves, and is never culled: choose one that does not"
                    )
                start = zoom.aim(frame, selected.primitive)
            assert start is not None
            run = ZoomTest(scene, self._session.settings, start, self.zoom_plan, self._wake)
        except ValueError as error:
            self._notices.say(str(error), error=True)
            return
        self.zoom_test = run
        self._start(run)

    @property
    def last_start(self) -> zoom.Aim | None:
        """Where the last zoom test began; None where that was in another scene, or another primitive is selected."""
        test, selected = self.zoom_test, self._selection.picked
        if test is None or not test.is_of(self._session.scene):
            return None
        return test.start if selected is None or selected.primitive == test.start.primitive else None

    def refuses_start(self) -> bool:
        """Whether no run can begin now; says why."""
        if self.current is not None:
            self._notices.say(f"the {self.current.name} is still under way")
        elif self._session.scene is None:
            self._notices.say("open a scene first")
        elif self._edited():
            self._notices.say("the scene is being edited: start again when the picture shows it")
        else:
            return False
        return True

    def begin(self, run: Run) -> bool:
        """Begin a run that was made elsewhere; whether it is not refused, in one line."""
        if self.refuses_start():
            return False
        self._start(run)
        return True

    def _start(self, run: Run) -> None:
        self.current = run
        self._session.playing = False
        self._renderer.perform(run)

    def stop(self) -> None:
        """End the run that is under way after its last whole frame, and keep what it has."""
        if self.current is not None:
            self.current.stop()

    def take_progress(self) -> Progress:
        """Report a run that has ended; returns what has become of it since the last time."""
        run = self.current
        if run is None:
            return Progress()
        done = run.done  # before its last frame is taken: none comes after
        frame = run.take()
        if done:
            self.current = None
            self._report(run)
        if frame is None or run.stopping or not run.is_of(self._session.scene):
            return Progress(ended=done)
        request = RenderRequest(frame.time, frame.camera, frame.settings)
        return Progress(Traced(request, frame, frame.statistics), done)

    def _report(self, run: Run) -> None:
        if run.failure is not None:
            self._notices.report(run.failure)
        elif run.whole:
            frames = run.done_of[1]
            took = f"{frames} frame{'s' * (frames != 1)} in {duration(run.seconds)}"
            self._notices.say(f"{run.name} done: {took}{run.where}")
        else:
            kept = "" if run.results is None else f"; what was done is kept{run.where}"
            done, frames = run.done_of
            self._notices.say(f"{run.name} stopped after {done} of {frames} frames{kept}")

    def go_to(self, step: Step) -> Camera | None:
        """Set the time of the zoom test, and return the camera of one of its steps; the next test starts where that one
        did.  None, and one line, where that cannot be."""
        test, session = self.zoom_test, self._session
        if test is None or test.results is None or self.refuses():
            return None
        if not test.is_of(session.scene):
            self._notices.say(f"this test was made {test.made_in(session.scene)}")
            return None
        session.playing = False
        session.change(time=test.results.time)
        self.zoom_plan.same_start = True
        return step.camera

    def export(self, run: Run, ending: str) -> None:
        """Write the results, as one of exports.ENDINGS, into the folder of the pictures."""
        results = run.results
        self._export(run, ending, "", lambda path: run.write(results, path))

    def export_film(self, test: ZoomTest) -> None:
        """Write the filmstrip of a zoom test into that folder, as a picture."""
        results = test.results
        if results is not None:
            self._export(test, ".png", "-film", lambda path: test.write_film(results, path))

    def _export(self, run: Run, ending: str, what: str, write: Callable[[Path], None]) -> None:
        if run.results is None:
            self._notices.say("there is nothing to save yet")
            return
        folder = self._preferences.picture_folder
        name = f"{run.scene_path.stem}-{run.name.replace(' ', '-')}{what}"
        self._files.write(lambda: exports.save(folder, name, ending, write))
