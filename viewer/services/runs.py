"""Runs in the window: experiments, zoom tests and whatever else traces many frames, one at a time.

A run has the render thread to itself: it shares the scene's world, and has renderers, and so modes, of its own.  Its
frames are the picture meanwhile.  What the user would change of the picture is refused, in one line that says how to
stop the run."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

from tracer.experiments import experiment, hunt, zoom
from tracer.experiments.camera_path import along_path
from tracer.experiments.experiment import Experiment
from tracer.experiments.filmstrip import Filmstrip
from tracer.experiments.hunt import Hunt, Search
from tracer.experiments.runner import Run
from tracer.experiments.zoom import ZoomTest
from tracer.frame import Frame
from tracer.method import in_order
from tracer.renderer import Renderer
from tracer.scene.model import Scene
from tracer.settings import Settings
from viewer.output import exports
from viewer.services.capture_service import CaptureService
from viewer.services.inspector import Selection
from viewer.services.render_request import RenderRequest, Task, Traced
from viewer.state.methods import BY_MODES, CERTIFIED
from viewer.state.notices import Notices
from viewer.state.plans import ExperimentPlan, HuntPlan, ZoomPlan, parse_factors
from viewer.state.preferences import Preferences
from viewer.state.session import Session
from viewer.state.views import Record, View
from viewer.util.messages import failure
from viewer.util.numbers import several
from viewer.views.difference import ringed


class FileRun(Run[Path]):
    """A run whose results are the files that it writes as it traces.  Its frames are the picture in the view in which
    they are drawn, or not at all where that is None."""

    view: View | None = None


class RecordedZoomTest(ZoomTest):
    """A zoom test that keeps the picture of each step, with rings around wrong pixels."""

    def __init__(
        self, scene: Scene, settings: Settings, start: zoom.Aim, factors: Sequence[float], steps: int, ratio: float
    ) -> None:
        self.filmstrip = Filmstrip()

        def record(factor: float, number: int, frame: Frame) -> None:
            self.filmstrip.record(factor, number, ringed(frame))

        super().__init__(scene, settings, start, factors, steps, ratio, record)


# --- in words -----------------------------------------------------------------------------------------


_NOT_RECORDED = {
    Record.VERIFY: "does not verify",
    Record.WORK: "does not count the rays of each pixel",
    Record.LIGHTS: "does not record which samples of lights reach each pixel",
    Record.FATES: "does not record what becomes of the shadow rays of each pixel",
}


def missing_in(run: Run, view: View) -> str:
    """Say why frames of a run cannot be seen in a view; nothing where they can."""
    if isinstance(run, FileRun) and run.view is None:
        return "is traced beside it"
    drawn = isinstance(run, FileRun) and run.view is view
    if view.records is None or drawn or (view.records is Record.VERIFY and run.verifies):
        return ""
    return _NOT_RECORDED[view.records]


def shown_of(run: Run) -> str:
    """Say which frame of a run is the picture."""
    return f"showing {run.label_shown}" if run.is_shown else f"{run.name}: {run.label}"


def duration(seconds: float) -> str:
    """Say a time as people do: 4 s, 2:05 min, 1:10 h."""
    if seconds < 59.5:
        return f"{seconds:.0f} s"
    minutes, rest = divmod(round(seconds), 60)
    return f"{minutes}:{rest:02d} min" if minutes < 60 else f"{minutes // 60}:{minutes % 60:02d} h"


# --- one at a time ------------------------------------------------------------------------------------


class Runs:
    """`experiment`, `zoom_test` and `hunt` are the last of their kind: under way, done or stopped; `current` is under
    way.  `chosen_find` is the counterexample of the hunt that is looked at, by its place in the list."""

    def __init__(
        self, session: Session, selection: Selection, perform: Callable[[Task[None]], object],
        preferences: Preferences, notices: Notices, files: CaptureService, wake: Callable[[], None] = lambda: None,
        edited: Callable[[], bool] = lambda: False,
    ) -> None:  # fmt: skip
        """Nothing begins while `edited()`: the scene is being edited, and the next picture is of another."""
        self._edited = edited
        self._session, self._selection, self._perform = session, selection, perform
        self._preferences, self._notices, self._files, self._wake = preferences, notices, files, wake
        self.experiment_plan = ExperimentPlan({BY_MODES, CERTIFIED})
        self.zoom_plan, self.hunt_plan = ZoomPlan(), HuntPlan()
        self.experiment: Experiment | None = None
        self.zoom_test: RecordedZoomTest | None = None
        self.hunt: Hunt | None = None
        self.chosen_find: int | None = None
        self.current: Run | None = None

    # --- start and stop ---------------------------------------------------------------------------

    def refuses(self) -> bool:
        """Whether a run is under way that must not be disturbed; says so."""
        if self.current is None or self.current.stopping:
            return False
        self._notices.say(f"the {self.current.name} is still under way; stop it first")
        return True

    def allows(self, run: Run) -> bool:
        """Return whether one may go to what a run has shown: none is under way, and its scene is open; else says so."""
        if self.refuses():
            return False
        found = run.is_of(self._session.scene)
        if not found:
            self._notices.say(f"the {run.name} was made {run.made_in(self._session.scene)}")
        return found

    def start(self, make: Callable[[Scene], Run]) -> bool:
        """Begin what `make` returns for the open scene; says why where that cannot be, as where it raises an error."""
        scene = self._session.scene
        if self.current is not None:
            self._notices.say(f"the {self.current.name} is still under way")
        elif scene is None:
            self._notices.say("open a scene first")
        elif self._edited():
            self._notices.say("the scene is being edited; start again when the picture shows it")
        else:
            try:
                run = make(scene)
            except (ValueError, OSError) as error:
                self._notices.say(str(error), error=True)
                return False

            def work(renderer: Renderer, cancelled: Callable[[], bool]) -> None:
                for _ in run.each(getattr(renderer, "world", None), cancelled, self._wake):  # it keeps what it raises
                    pass

            run.watches = True
            self.current = run
            self._session.playing = False
            self._perform(work)
            return True
        return False

    def stop(self) -> None:
        """End the run that is under way after its last whole frame, and keep what it has."""
        if self.current is not None:
            self.current.stop()

    def take_progress(self) -> tuple[Traced | None, bool]:
        """Take a frame that is to be the picture, and whether the run has ended since the last time, which is said."""
        run = self.current
        if run is None:
            return None, False
        done = run.done  # before its last frame is taken: none comes after
        frame = run.take()
        if done:
            self.current = None
            self._report(run)
        if frame is None or run.stopping or not run.is_of(self._session.scene):
            return None, done
        request = RenderRequest(frame.time, frame.camera, frame.settings)
        return Traced(request, frame, frame.statistics), done

    def _report(self, run: Run) -> None:
        where = f", in {run.output}" if run.output is not None else ""
        done, frames = run.done_of
        if run.error is not None:
            self._notices.report(failure(run.error, f"the {run.name} failed"))
        elif run.whole:
            self._notices.say(
                f"{run.name} done: {several(frames, run.unit)} in {duration(run.seconds)}{where}", file=run.output
            )
        else:
            kept = "" if run.results is None else f"; what was done is kept{where}"
            self._notices.say(f"{run.name} stopped after {done} of {frames} {run.unit}s{kept}")

    # --- experiments, zoom tests and hunts -----------------------------------------------------------

    def start_experiment(self) -> None:
        """Measure what `experiment_plan` says, over the open scene's path."""

        def make(scene: Scene) -> Run:
            plan = self.experiment_plan
            settings = replace(
                self._session.settings, width=plan.size[0], height=plan.size[1], depth=plan.depth, verify=plan.verify,
                samples=1, accelerator=plan.accelerator,
                certificate_seconds=math.inf,  # a count of certificates is what repeats exactly
            )  # fmt: skip
            times = experiment.path_times(scene, plan.frames)
            self.experiment = Experiment(scene, settings, in_order(plan.methods), times)
            return self.experiment

        self.start(make)

    def start_zoom_test(self) -> None:
        """Go towards the selected primitive, from where the picture shows it."""

        def make(scene: Scene) -> Run:
            plan, frame, selected = self.zoom_plan, self._selection.frame, self._selection.picked
            settings = replace(self._session.settings, width=plan.size[0], height=plan.size[1]).validated()
            if frame is None:
                raise ValueError("there is no picture yet")
            if selected is None:
                raise ValueError("click a primitive in the picture first: the zoom test goes towards it")
            if selected.dynamic:
                raise ValueError(f"primitive {selected.primitive} moves, and is never culled: choose one that does not")
            start, factors = zoom.aim(frame, selected.primitive), parse_factors(plan.factors)
            self.zoom_test = RecordedZoomTest(scene, settings, start, factors, plan.steps, plan.ratio)
            return self.zoom_test

        self.start(make)

    def start_hunt(self) -> None:
        """Search for wrong pixels as `hunt_plan` says, with the settings that are chosen now."""

        def make(scene: Scene) -> Run:
            plan = self.hunt_plan
            times = [take.time for take in along_path(scene, *plan.frames(scene))][:: plan.step]
            settings = replace(
                self._session.settings, method=plan.method, width=plan.size[0], height=plan.size[1], samples=1,
                certificate_seconds=math.inf, verify=True,
            ).validated()  # fmt: skip
            search = Search(settings, times, None, plan.around, plan.radius, plan.seed, plan.keep)
            self.hunt, self.chosen_find = Hunt(scene, search), None
            return self.hunt

        self.start(make)

    # --- results as files -------------------------------------------------------------------------

    def exports_of(self, run: Run) -> dict[str, Callable[[Path], None]]:
        """List what can be saved of a run now, by how the names of the files end."""
        results, scene = run.results, self._session.scene
        if isinstance(results, hunt.Results) and scene is not None and run.is_of(scene):
            return {".json": lambda path: exports.write_json(path, results.to_dict(scene))}
        if not isinstance(results, experiment.Results | zoom.Results):
            return {}
        found: dict[str, Callable[[Path], None]] = dict.fromkeys(exports.ENDINGS, partial(exports.write, results))
        if isinstance(run, RecordedZoomTest) and isinstance(results, zoom.Results):
            found["-film.png"] = partial(exports.write_film, run.filmstrip, results)
        return found

    def export(self, run: Run, ending: str) -> None:
        """Write the results, as one of `exports_of`, into the folder of the pictures."""
        write = self.exports_of(run).get(ending)
        if write is None:
            self._notices.say("there is nothing to save yet")
            return
        folder, name = self._preferences.picture_folder, f"{run.scene_path.stem}-{run.name.replace(' ', '-')}"
        self._files.write(lambda: exports.save(folder, name, ending, write))
