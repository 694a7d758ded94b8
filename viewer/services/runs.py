"""Runs in the window: experiments, zoom tests and whatever else traces many frames, one at a time.

A run has the render thread to itself: it shares the scene's world, and has renderers, and so modes, of its own.  Its
frames are the picture meanwhile.  What the user would change of the picture is refused, in one line that says how to
stop the run.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import NamedTuple

from tracer.experiments import experiment, zoom
from tracer.experiments.experiment import Experiment
from tracer.experiments.hunt import Hunt
from tracer.experiments.runner import STARTING, Run
from tracer.experiments.zoom import Step, ZoomTest
from tracer.method import in_order
from tracer.renderer import Renderer
from tracer.scene.model import Camera, Scene
from tracer.settings import Settings
from viewer.output import exports
from viewer.output.filmstrip import Filmstrip
from viewer.services.capture_service import CaptureService
from viewer.services.inspector import Selection
from viewer.services.render_request import RenderRequest, Task, Traced
from viewer.state.methods import BY_MODES, CERTIFIED
from viewer.state.notices import Notices
from viewer.state.plans import LONGEST_SIDE, ExperimentPlan, ZoomPlan, parse_factors
from viewer.state.preferences import Preferences
from viewer.state.session import Session
from viewer.state.views import View
from viewer.util.messages import failure
from viewer.util.numbers import several


class FileRun(Run[Path]):
    """A run whose results are the files that it writes as it traces.  Its frames are the picture in the view in which
    they are drawn, or not at all where that is None."""

    view: View | None = None


class RecordedZoomTest(ZoomTest):
    """A zoom test that keeps the picture of each step."""

    def __init__(
        self, scene: Scene, settings: Settings, start: zoom.Aim, factors: Sequence[float], steps: int, ratio: float
    ) -> None:
        self.filmstrip = Filmstrip()
        super().__init__(scene, settings, start, factors, steps, ratio, self.filmstrip.record)


# --- in words -----------------------------------------------------------------------------------------


def missing_in(run: Run, view: View) -> str:
    """Why frames of a run cannot be seen in a view, in words; nothing where they can."""
    if isinstance(run, FileRun) and run.view is None:
        return "is traced beside it"
    if isinstance(run, FileRun) and run.view is view:
        return ""
    if view.needs_work:
        return "does not count the rays of each pixel"
    if view.needs_lights:
        return "does not record which samples of lights reach each pixel"
    if view.needs_fates:
        return "does not record what becomes of the shadow rays of each pixel"
    return "does not verify" if view.needs_verify and not run.verifies else ""


def shown_of(run: Run) -> str:
    """Which frame of a run is the picture, in words."""
    return f"showing {run.label_shown}" if run.label_shown != STARTING else f"the {run.name} is starting"


def described(run: Experiment | ZoomTest, scene: Scene | None) -> tuple[str, bool]:
    """Scene, size, and what was done of a run's results; and whether they are of another scene than the one that is
    open, or of what that was before: this is said first."""
    name, elsewhere = run.scene_path.name, not run.is_of(scene)
    if elsewhere and scene is not None:
        same = Path(scene.path) == run.scene_path
        name += " before it was edited or reloaded" if same else f" (not {Path(scene.path).name}, which is open)"
    if isinstance(run, ZoomTest):
        what = f"towards primitive {run.start.primitive}"
    else:
        done, of = run.done_of
        what = f"{'' if done == of else f'{done} of '}{several(of, 'frame')}, {run.settings.accelerator}"
    return f"{name}, {run.settings.width} x {run.settings.height}, {what}", elsewhere


def duration(seconds: float) -> str:
    """A time as people say it: 4 s, 2:05 min, 1:10 h."""
    if seconds < 59.5:
        return f"{seconds:.0f} s"
    minutes, rest = divmod(round(seconds), 60)
    return f"{minutes}:{rest:02d} min" if minutes < 60 else f"{minutes // 60}:{minutes % 60:02d} h"


# --- one at a time ------------------------------------------------------------------------------------


def check_size(size: tuple[int, int]) -> None:
    """Raise ValueError, in one line, for pictures that are too large for a run."""
    if max(size) > LONGEST_SIDE:
        raise ValueError(f"{size[0]} x {size[1]} is too large for a run; {LONGEST_SIDE} pixels a side at most")


@dataclass(frozen=True)
class _Task:
    """A run as the render thread does it; what goes wrong is kept in the run."""

    run: Run
    wake: Callable[[], None]

    def work(self, renderer: Renderer, cancelled: Callable[[], bool]) -> None:
        world = getattr(renderer, "world", None)
        with suppress(Exception):
            for _ in self.run.each(world, cancelled, self.wake):
                pass


class Progress(NamedTuple):
    """What has become of the run since it was last asked: a frame that is to be the picture, and whether it ended."""

    picture: Traced | None = None
    ended: bool = False


class Runs:
    """`experiment` and `zoom_test` are the last of their kind: under way, done or stopped; `current` is under way."""

    def __init__(
        self,
        session: Session,
        selection: Selection,
        perform: Callable[[Task], None],
        preferences: Preferences,
        notices: Notices,
        files: CaptureService,
        wake: Callable[[], None] = lambda: None,
        edited: Callable[[], bool] = lambda: False,
    ) -> None:
        """Nothing begins while `edited()`: the scene is being edited, and the next picture is of another."""
        self._edited = edited
        self._session, self._selection, self._perform = session, selection, perform
        self._preferences, self._notices, self._files, self._wake = preferences, notices, files, wake
        self.experiment_plan = ExperimentPlan({BY_MODES, CERTIFIED})
        self.zoom_plan = ZoomPlan()
        self.experiment: Experiment | None = None
        self.zoom_test: RecordedZoomTest | None = None
        self.current: Run | None = None

    # --- start and stop ---------------------------------------------------------------------------

    def refuses(self) -> bool:
        """Whether a run is under way that must not be disturbed; says so."""
        if self.current is None or self.current.stopping:
            return False
        self._notices.say(f"the {self.current.name} is still under way; stop it first")
        return True

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
            run.watches = True
            self.current = run
            self._session.playing = False
            self._perform(_Task(run, self._wake).work)
            return True
        return False

    def stop(self) -> None:
        """End the run that is under way after its last whole frame, and keep what it has."""
        if self.current is not None:
            self.current.stop()

    def take_progress(self) -> Progress:
        """Take what has become of the run since the last time, and report one that has ended."""
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
        where = f", in {run.output}" if run.output is not None else ""
        done, frames = run.done_of
        if run.error is not None:
            self._notices.report(failure(run.error, f"the {run.name} failed"))
        elif run.whole:
            self._notices.say(f"{run.name} done: {several(frames, 'frame')} in {duration(run.seconds)}{where}")
        else:
            kept = "" if run.results is None else f"; what was done is kept{where}"
            self._notices.say(f"{run.name} stopped after {done} of {frames} frames{kept}")

    # --- experiments and zoom tests ---------------------------------------------------------------

    def start_experiment(self) -> None:
        """Begin what `experiment_plan` says, over the open scene's path."""

        def make(scene: Scene) -> Run:
            plan = self.experiment_plan
            check_size(plan.size)
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
            check_size(plan.size)
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

    def go_to(self, step: Step) -> Camera | None:
        """Set the time of the zoom test, and return the camera of one of its steps; None, and one line, where that
        cannot be."""
        test, session = self.zoom_test, self._session
        if test is None or test.results is None or self.refuses():
            return None
        if not test.is_of(session.scene):
            self._notices.say(f"this test was made {test.made_in(session.scene)}")
            return None
        session.playing = False
        session.change(time=test.results.time)
        return step.camera

    # --- results as files -------------------------------------------------------------------------

    def exports_of(self, run: Run) -> dict[str, Callable[[Path], None]]:
        """What can be saved of a run now, by how the names of the files end."""
        results, scene = run.results, self._session.scene
        if isinstance(run, Hunt):
            if results is None or scene is None or not run.is_of(scene):
                return {}
            return {".json": lambda path: exports.write_json(path, results.to_dict(scene))}
        if results is None or not isinstance(run, Experiment | ZoomTest):
            return {}
        found: dict[str, Callable[[Path], None]] = dict.fromkeys(exports.ENDINGS, partial(exports.write, results))
        if isinstance(run, RecordedZoomTest):
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
