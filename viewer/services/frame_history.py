"""The history of the frames that the window traces: their counters for the plots, which of them set each mode, and the
way back to one of them.

Going back brings back a frame's time, camera, settings and view.  Pictures of exact methods are then the same, bit for
bit; others depend on the modes, which are learnt anew."""

from __future__ import annotations

import time
from collections.abc import Callable, Hashable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tracer.frame import Frame
from tracer.method import Method
from tracer.mode_origins import ModeOrigins, Origins
from tracer.scene.model import Camera
from viewer.output.commands import BUILT
from viewer.services.frame_scheduler import FrameScheduler
from viewer.services.inspector import Selection
from viewer.services.render_request import RenderRequest, Traced, Warmup
from viewer.services.runs import Experiment, Runs
from viewer.services.undo import Undo
from viewer.state.history import FrameRate, FrameRecord, FrameRecords, History
from viewer.state.notices import Notices
from viewer.state.picking import Pick
from viewer.state.pixels import Point, Zoom
from viewer.state.preferences import Preferences
from viewer.state.readings import has_modes_of_cells
from viewer.state.session import Session
from viewer.state.view_state import ViewState
from viewer.state.views import View

MOST_ORIGINS = 4
"""Mode histories, of resolutions and lamps, whose origins are known."""
Key = tuple[int, int, bool, float | None, int | None]


class FrameHistory(History):
    """Counters of the last frames, `records` of those that can be gone back to, and the origins of the modes."""

    def __init__(self, session: Session, clock: Callable[[], float] = time.monotonic) -> None:
        super().__init__()
        self._session, self._clock = session, clock
        self._repeats: dict[tuple[int, int], tuple[Hashable, int]] = {}  # by size: what set the modes, and how often
        self.records, self._rate = FrameRecords(), FrameRate()
        # Origins look at all units of each frame, for which the window need not wait.
        self._worker = ThreadPoolExecutor(1, "shadowcull mode origins")
        self.clear()

    @property
    def frames_per_second(self) -> float | None:
        """How many frames come in a second; None while none are coming."""
        return self._rate.per_second(self._clock())

    def clear(self) -> None:
        """Begin anew: another scene is open."""
        super().clear()
        self.records.clear()
        self._rate.clear()
        self._request: RenderRequest | None = None
        self._shown: Key | None = None
        self.forget_modes()

    def forget_modes(self, blank: bool = True) -> None:
        """Forget who set which mode; `blank` says that no modes are left from frames before."""
        self._origins: dict[Key, ModeOrigins] = {}
        self._lights: dict[Key, NDArray[np.float64]] = {}
        self._dropped: set[Key] = set()
        self._blank = blank
        self._repeats = {} if blank else dict.fromkeys(self._repeats, (None, 0))

    def take(self, learnt: Sequence[Traced], newest: Traced | None, drawn_seconds: float) -> None:
        """Take up the frames that have set modes since the last time, in their order, and the newest that is shown,
        which may be one of them or not be whole yet; `drawn_seconds` is what the window needed last."""
        for traced in learnt:
            self._note_origins(traced, self._count(traced, drawn_seconds))
        last = learnt[-1].request if learnt else None
        if newest is not None and newest.request is not last and newest.frame.settings.samples == 1:
            self._count(newest, drawn_seconds)

    def _count(self, traced: Traced, drawn_seconds: float) -> int:
        """Put a frame into the plots and the records; returns its number."""
        again, self._request = traced.request is self._request, traced.request
        self.add(traced.frame, drawn_seconds, again)
        if not again:
            self._rate.count(self._clock())
        self.records.put(self._record_of(traced, self.frames - 1))
        return self.frames - 1

    def _record_of(self, traced: Traced, number: int) -> FrameRecord:
        chosen, settings = self._session.settings, traced.frame.settings
        state = self._session.state_of(traced.frame).with_settings(  # of these the frame may have had others
            samples=chosen.samples, lamp_samples=chosen.lamp_samples, verify=chosen.verify, method=chosen.method
        )
        return FrameRecord(number, state, traced.frame.camera, settings, traced.full_size, traced.whole)

    # --- which frame set which mode ---------------------------------------------------------------

    def _note_origins(self, traced: Traced, number: int) -> None:
        frame, scene = traced.frame, self._session.scene
        if traced.fresh:
            self.forget_modes()
        # A frame that was left before it was whole cannot be traced again as it was.
        size, what = (frame.width, frame.height), _what_sets_modes(frame) if traced.whole else None
        known, count = self._repeats.get(size, (what, 0))
        self._repeats[size] = (what, count + 1) if known == what else (None, 0)
        if scene is None or not frame.settings.keeps_modes:
            return
        key = _key(frame)
        if traced.request.divisor == 1:
            self._shown = key
        blank = self._blank and key not in self._dropped
        origins = self._origins.pop(key, None) or ModeOrigins(frame.lights, blank=blank)
        self._origins[key] = origins  # the newest last
        if len(self._origins) > MOST_ORIGINS:
            oldest = next(iter(self._origins))
            del self._origins[oldest]
            self._dropped.add(oldest)
        lights, before = scene.light_positions(frame.time), self._lights.get(key)
        moved = None if before is None or len(before) != len(lights) else (lights != before).any(axis=1)
        self._lights[key] = lights
        self._worker.submit(origins.add, number, frame.modes, moved)

    def origins_of(self, pick: Pick) -> Origins | None:
        """Return which frames set what is known of the unit that was picked; None where that is not known."""
        origins = self._origins.get(self._shown) if self._shown is not None else None
        if origins is None or self._shown is None or self._shown[2] != pick.in_cells:
            return None
        return self._worker.submit(origins.of, pick.unit).result()

    def repeats_of(self, frame: Frame) -> int | None:
        """Return how often this very frame was traced since modes were forgotten, before it; None where others were as
        well, at its resolution, which has modes of its own."""
        what, count = self._repeats.get((frame.width, frame.height), (None, 0))
        return count - 1 if what is not None and what == _what_sets_modes(frame) and count else None


def _what_sets_modes(frame: Frame) -> Hashable:
    s = frame.settings
    of_settings = s.method, s.symmetric, s.zoom_factor, s.depth, s.lamp_radius, s.lamp_samples, s.accelerator
    return frame.time, frame.camera, of_settings


def _key(frame: Frame) -> Key:
    """Return what tells mode histories apart."""
    s = frame.settings
    return s.width, s.height, has_modes_of_cells(frame), s.lamp_radius, s.lamp_samples


@dataclass(frozen=True)
class JumpTarget:
    """Where to go, what it is called, and which point of the picture is selected there, if any.

    `zoom` is how closely the picture is looked at then, None for as it is.  With `warmup` frames, all modes are
    forgotten and these frames, by time and camera, are traced before the picture, which then has one sample a pixel and
    is not refined: it stays as it was found until something is done."""

    state: ViewState
    name: str
    size: tuple[int, int]
    point: Point | None = None
    zoom: Zoom | None = None
    warmup: Warmup | None = None


class FrameNavigator:
    """Goes back to frames of the history, to those of an experiment, and to other targets."""

    def __init__(
        self,
        session: Session,
        preferences: Preferences,
        history: FrameHistory,
        scheduler: FrameScheduler,
        runs: Runs,
        undo: Undo,
        selection: Selection,
        notices: Notices,
        restore: Callable[[ViewState], None],
        reset_modes: Callable[[], None],
    ) -> None:
        self._session, self._preferences, self._history, self._scheduler = session, preferences, history, scheduler
        self._runs, self._undo, self._selection, self._notices = runs, undo, selection, notices
        self._restore, self._reset_modes = restore, reset_modes
        self._wanted: tuple[float, Camera, Point] | None = None

    def go(self, number: int) -> None:
        """Go back to a frame by its number in the plots."""
        record = self._history.records.get(number)
        if self._session.scene is None or self._runs.refuses():
            return
        if record is None:
            self._notices.say(f"picture {number} is no longer kept: only the last 10,000 are")
            return
        self.go_to(JumpTarget(record.state, f"picture {number}", record.size))
        self._notices.say(f"{self.name_of(number)}, again{self._may_differ(record)}")

    def go_to_experiment(self, run: Experiment, number: int) -> None:
        """Go to a frame of an experiment, traced by the method that it shows."""
        scene, session = self._session.scene, self._session
        if scene is None or self._runs.refuses():
            return
        if not run.is_of(scene):
            self._notices.say(f"this was measured {run.made_in(scene)}")
            return
        settings = replace(run.settings, method=run.shown, samples=session.settings.samples)
        then = run.times[number]
        state = replace(session.state, time=then, camera=None, settings=settings)
        self.go_to(JumpTarget(state, f"frame {number} of the experiment", (settings.width, settings.height)))
        self._notices.say(self.name_in_experiment(run, number))

    def go_to(self, target: JumpTarget) -> None:
        """Restore a target's state, and select its point once its picture has come."""
        self._undo.begin_step(f"going to {target.name}", with_time=True)
        self._restore(target.state)
        if target.zoom is not None:
            self._session.set_draw(zoom=target.zoom)
        self._selection.clear()
        if target.warmup is not None or self._depends_on_modes:
            self._reset_modes()
        if target.warmup is not None:
            width, height = target.size
            if target.size != self._scheduler.full_size:
                self._session.set_pace(fixed_size=True, width=width, height=height)
            self._scheduler.freeze(self._session.state, target.warmup)
        camera = self._session.camera
        self._wanted = (self._session.time, camera, target.point) if target.point is not None else None

    def select_when_shown(self, traced: Traced | None) -> None:
        """Select the point of the last target once its picture is shown, whole; once in each frame of the window."""
        if self._wanted is None or self._runs.current is not None:
            return
        then, camera, point = self._wanted
        if (self._session.time, self._session.camera) != (then, camera):
            self._wanted = None
        elif traced is not None and traced.whole and traced.request.divisor == 1 and self._edits_are_shown:
            if (traced.request.time, traced.request.camera) == (then, camera):
                self._selection.select(point)
                self._wanted = None

    @property
    def _edits_are_shown(self) -> bool:
        """Whether the newest picture is of the scene that is wanted."""
        edited = self._session.edited
        return self._scheduler.shows_edits and edited is not None and edited.edits == self._session.edits

    def name_of(self, number: int) -> str:
        """Return what a frame is called: by its number in the plots, and in the scene's path, where it is another."""
        record = self._history.records.get(number)
        return f"picture {number}{self._of_path(record.state.time) if record is not None else ''}"

    def name_in_experiment(self, run: Experiment, number: int) -> str:
        """Return what a frame of an experiment is called, and in the scene's path where the experiment has others."""
        scene = self._session.scene
        if scene is None or not run.is_of(scene) or len(run.times) == scene.frames:
            return f"frame {number} of the path, by {run.shown}"
        return f"frame {number} of the experiment, by {run.shown}{self._of_path(run.times[number])}"

    def _of_path(self, then: float) -> str:
        return f", frame {self._session.frame_at(then)} of the path" if self._session.animated else ""

    def _may_differ(self, record: FrameRecord) -> str:
        """Return what else its picture depends on, in words."""
        if record.size != self._scheduler.full_size:
            width, height = record.size
            return f", though its picture had {width} x {height} pixels"
        if record.state.draw.view is View.TREE:
            return f", though {BUILT}"
        return ": modes are learnt anew" if self._depends_on_modes else ": the same picture, bit for bit"

    @property
    def _depends_on_modes(self) -> bool:
        """Whether the picture depends on what was seen before it."""
        return not Method.parse(self._session.settings.method).exact or self._session.draw.view.of_modes
