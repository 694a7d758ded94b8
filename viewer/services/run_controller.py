"""Starts and stops runs, shows their frames as the picture, and tells what has come of them.

One run at a time: it has the render thread to itself.  What the user would change of the picture
meanwhile is refused, in one line that says how to stop it.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from tracer import zoom
from tracer.scene.model import Progress
from tracer.zoom import Step
from viewer.output import exports
from viewer.services.jobs import Job
from viewer.services.render_thread import RenderRequest, Traced
from viewer.services.runs import Experiment, ExperimentPlan, Run, ZoomPlan, ZoomTest, duration
from viewer.state.preferences import default_screenshot_folder

if TYPE_CHECKING:
    from viewer.services.controller import Controller


class Runner:
    """`experiment` and `zoom_test` are the last of their kind: under way, done or stopped."""

    def __init__(self, controller: Controller) -> None:
        self._c = controller
        self.experiment_plan = ExperimentPlan({"paper", "certified"})
        self.zoom_plan = ZoomPlan()
        self.experiment: Experiment | None = None
        self.zoom_test: ZoomTest | None = None
        self.current: Run | None = None

    def refuses(self) -> bool:
        """Whether a run is under way that must not be disturbed; says so."""
        if self.current is None or self.current.stopping:
            return False
        self._c.say(f"the {self.current.name} is still under way; stop it first (Escape)")
        return True

    def start_experiment(self) -> None:
        """Begin what `experiment_plan` says, over the open scene's path."""
        scene = self._c.session.scene
        if scene is None or self.current is not None:
            self._refuse_start()
            return
        try:
            run = Experiment(scene, self._c.session.settings, self.experiment_plan, lambda: self._c.wake())
        except ValueError as error:
            self._c.say(str(error), error=True)
            return
        self.experiment = run
        self._start(run)

    def start_zoom_test(self) -> None:
        """Go towards the selected primitive, from where the picture shows it or, so planned, from the last start."""
        scene, frame, selected = self._c.session.scene, self._c.frame, self._c.selected
        if scene is None or frame is None or self.current is not None:
            self._refuse_start()
            return
        start = self.last_start if self.zoom_plan.same_start else None
        if start is None and selected is None:
            self._c.say("click a primitive in the picture first: the zoom test goes towards it", error=True)
            return
        try:
            if start is None and selected is not None:
                if selected.dynamic:
                    raise ValueError(
                        f"primitive {selected.primitive} moves, and is never culled: choose one that does not"
                    )
                start = zoom.aim(frame, selected.primitive)
            assert start is not None
            run = ZoomTest(scene, self._c.session.settings, start, self.zoom_plan, lambda: self._c.wake())
        except ValueError as error:
            self._c.say(str(error), error=True)
            return
        self.zoom_test = run
        self._start(run)

    @property
    def last_start(self) -> zoom.Aim | None:
        """Where the last zoom test began; None where that was in another scene, or another primitive is selected."""
        test, selected = self.zoom_test, self._c.selected
        if test is None or not test.is_of(self._c.session.scene):
            return None
        return test.start if selected is None or selected.primitive == test.start.primitive else None

    def _refuse_start(self) -> None:
        self._c.say(f"the {self.current.name} is still under way" if self.current is not None else "open a scene first")

    def _start(self, run: Run) -> None:
        self.current = run
        self._c.session.playing = False
        self._c.tracing.interrupted()
        self._c.render.perform(run)

    def stop(self) -> None:
        """End the run that is under way after its last whole frame, and keep what it has."""
        if self.current is not None:
            self.current.stop()

    def follow(self) -> Traced | None:
        """Tell of a run that has ended; returns the frame that is to be the picture, if there is a new one."""
        run = self.current
        if run is None:
            return None
        done = run.done  # before its last frame is taken: none comes after
        frame = run.take()
        if done:
            self.current = None
            self._c.tracing.again()  # else the world might stay where the run has put it
            self._tell(run)
        if frame is None or run.stopping or not run.is_of(self._c.session.scene):
            return None
        return Traced(RenderRequest(frame.time, frame.camera, frame.settings), frame, frame.statistics)

    def _tell(self, run: Run) -> None:
        if run.failure is not None:
            self._c.report(run.failure)
        elif run.whole:
            frames = run.done_of[1]
            self._c.say(f"{run.name} done: {frames} frame{'s' * (frames != 1)} in {duration(run.seconds)}")
        else:
            kept = "" if run.results is None else "; what was done is kept"
            done, frames = run.done_of
            self._c.say(f"{run.name} stopped after {done} of {frames} frames{kept}")

    def go_to(self, step: Step) -> None:
        """Put the camera where a step of the zoom test stood, at the test's time; the next test starts as that did."""
        test, session = self.zoom_test, self._c.session
        if test is None or test.results is None or self.refuses():
            return
        if not test.is_of(session.scene):
            self._c.say(f"this test was made in {test.scene_path.name}; open that scene again to go there")
            return
        session.playing = False
        session.time = test.results.time
        self.zoom_plan.same_start = True
        self._c.glide(step.camera)

    def export(self, run: Run, ending: str) -> None:
        """Write the results, as one of exports.ENDINGS, into the folder of the screenshots."""
        results = run.results
        self._export(run, ending, "", lambda path: run.write(results, path))

    def export_film(self, test: ZoomTest) -> None:
        """Write the filmstrip of a zoom test into that folder, as a picture."""
        results = test.results
        if results is not None:
            self._export(test, ".png", "-film", lambda path: test.write_film(results, path))

    def _export(self, run: Run, ending: str, what: str, write: Callable[[Path], None]) -> None:
        if run.results is None:
            self._c.say("there is nothing to save yet")
            return
        folder = Path(self._c.preferences.screenshot_folder or default_screenshot_folder()).expanduser()
        name = f"{run.scene_path.stem}-{run.name.replace(' ', '-')}{what}"

        def save(_: Progress) -> Path:
            return exports.save(folder, name, ending, write)

        self._c.keeper.saving.append(Job("Saving", save, lambda: self._c.wake()))
