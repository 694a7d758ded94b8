"""The way back to frames: of the history, of an experiment, of a hunt.

Going back brings back a frame's time, camera, settings and view.  Pictures of exact methods are then the same, bit for
bit; others depend on the modes, which are learnt anew."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from tracer.experiments.zoom import METHOD, Step
from tracer.method import title_of
from tracer.scene.model import Camera
from viewer.output.comparison import Crop
from viewer.services.frame_scheduler import FrameScheduler
from viewer.services.history import KEPT_FRAMES, FrameHistory
from viewer.services.inspector import Selection
from viewer.services.render_request import FramesBefore, Traced
from viewer.services.runs import Experiment, Runs
from viewer.services.undo import Undo
from viewer.state.notices import Notices
from viewer.state.pixels import Point, Zoom, around
from viewer.state.session import Session
from viewer.state.view_state import Pace, ViewState


class FrameNavigator:
    """Goes back to frames of the history, to those of an experiment or a hunt, and to other states."""

    def __init__(
        self, session: Session, history: FrameHistory, scheduler: FrameScheduler, runs: Runs, undo: Undo,
        selection: Selection, notices: Notices, restore: Callable[[ViewState], None], reset_modes: Callable[[], None],
    ) -> None:  # fmt: skip
        self._session, self._history, self._scheduler = session, history, scheduler
        self._runs, self._undo, self._selection, self._notices = runs, undo, selection, notices
        self._restore, self._reset_modes = restore, reset_modes
        self._wanted: tuple[float, Camera, Point] | None = None
        self._found_in: Pace | None = None  # what a counterexample, or a step of a zoom test, is shown with

    def go(self, number: int) -> None:
        """Go back to a frame by its number in the plots."""
        record = self._history.records.get(number)
        if self._session.scene is None or self._runs.refuses():
            return
        if record is None:
            self._notices.say(f"picture {number} is no longer kept: only the last {KEPT_FRAMES:,} are")
            return
        self.go_to(record.state, f"picture {number}")
        said = ": the same picture, bit for bit" if record.size == self._scheduler.inputs.full_size else ""
        said = ": modes are learnt anew" if self._session.state.depends_on_modes else said
        self._notices.say(f"{self.name_of(number)}, again{said}")

    def go_to_experiment(self, run: Experiment, number: int) -> None:
        """Go to a frame of an experiment, traced by the method that it shows."""
        session = self._session
        if not self._runs.allows(run):
            return
        settings = replace(run.settings, method=run.shown, samples=session.settings.samples)
        name = f"frame {number} of the experiment"
        self.go_to(replace(session.state, time=run.times[number], camera=None, settings=settings), name)
        self._notices.say(f"{name}, by {title_of(run.shown)}")

    def go_to_find(self, number: int) -> None:
        """Fly to a counterexample of the hunt: forget all modes, trace the frames that taught it, and select its pixel,
        enlarged.  The picture stays as it was found, in its size, with one sample a pixel, until something moves."""
        runs, scene = self._runs, self._session.scene
        if scene is None or runs.hunt is None or runs.hunt.results is None or not runs.allows(runs.hunt):
            return
        runs.chosen_find, find, settings = number, runs.hunt.results.finds[number], runs.hunt.settings
        size = settings.width, settings.height
        state = replace(self._session.state, time=find.time, camera=find.seen_camera, settings=settings)
        point = (find.x + 0.5) / size[0], (find.y + 0.5) / size[1]
        warmup = tuple((one.time, one.camera or scene.camera_at(one.time)) for one in find.before)
        zoom = around(*point, size[0] / Crop.around((find.x, find.y), size).width)
        self.go_to(state.with_draw(light=find.light), f"counterexample {number + 1}", point, zoom, warmup)

    def go_to_step(self, factor: float, step: Step) -> None:
        """Fly to a step of the zoom test: forget all modes, and trace the steps before it, so that it is as it was."""
        test = self._runs.zoom_test
        if test is None or test.results is None or not self._runs.allows(test):
            return
        time, settings = test.results.time, replace(test.settings, method=METHOD, zoom_factor=factor, verify=True)
        state = replace(self._session.state, time=time, camera=step.camera, settings=settings)
        steps = next(one.steps for one in test.results.approaches if one.factor == factor)
        warmup = tuple((time, one.camera) for one in steps[: step.number])
        self.go_to(state, f"step {step.number} of the zoom test", (0.5, 0.5), None, warmup)  # it looks at the primitive

    def go_to(
        self, state: ViewState, name: str, point: Point | None = None, zoom: Zoom | None = None,
        warmup: FramesBefore | None = None,
    ) -> None:  # fmt: skip
        """Restore a state, and select a point of the picture once that has come; `zoom` is how closely it is looked at
        then.

        With `warmup` frames, all modes are forgotten and these frames, by time and camera, are traced before the
        picture, which then has one sample a pixel and is not refined: it stays as it was found until something is
        done."""
        if warmup is not None:
            state = state.with_settings(samples=self._session.settings.samples)
        self._undo.begin_step(f"going to {name}", with_time=True)
        self._restore(state)
        if zoom is not None:
            self._session.set_draw(zoom=zoom)
        self._selection.clear()
        if warmup is not None or self._session.state.depends_on_modes:
            self._reset_modes()
        if warmup is not None:
            size = state.settings.width, state.settings.height
            if size != self._scheduler.inputs.full_size:
                self._session.fix_size(*size)
                self._found_in = self._session.state.pace
            self._scheduler.freeze(self._session.state, warmup)
        self._wanted = (self._session.time, self._session.camera, point) if point is not None else None

    def leave_find(self) -> None:
        """Give the picture the size back that it had before a counterexample, once that was left."""
        session = self._session
        if self._found_in is not None and not self._scheduler.freezes(session.state):
            if self._found_in == session.state.pace:
                self._undo.without_undo(session.give_size_back)
            self._found_in = None

    def select_when_shown(self, traced: Traced | None) -> None:
        """Select the point that was gone to once its picture is shown, whole; once in each frame of the window."""
        if self._wanted is None or self._runs.current is not None:
            return
        session, (then, camera, point) = self._session, self._wanted
        edited = self._scheduler.shows_edits and session.edited is not None and session.edited.edits == session.edits
        if (session.time, session.camera) != (then, camera):
            self._wanted = None
        elif edited and traced is not None and traced.complete:
            if (traced.request.time, traced.request.camera) == (then, camera):
                self._selection.select(point)
                self._wanted = None

    def name_of(self, number: int) -> str:
        """Return what a frame is called: by its number in the plots, and in the scene's path, where it is another."""
        record, session = self._history.records.get(number), self._session
        if record is None or not session.animated:
            return f"picture {number}"
        return f"picture {number}, frame {session.frame_at(record.state.time)} of the path"
