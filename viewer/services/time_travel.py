"""Back to a frame that was traced: its time, camera and settings, and if asked for, the modes that it was traced with.

Pictures of exact methods are then the same, bit for bit.  Others depend on what was seen before: `go(..., modes=True)`
forgets all modes, and traces the frames that had taught them once more, in their order and size."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from tracer.frame import Settings
from tracer.method import Method
from tracer.scene.model import Camera
from viewer.output.recipe import BUILT
from viewer.services.record import Record
from viewer.services.render_request import Traced
from viewer.services.replay import Past, Replay
from viewer.services.run_controller import RunController
from viewer.services.runs import Experiment
from viewer.services.selection import Point, Selection
from viewer.services.tracing import Tracing
from viewer.services.undo import Undo
from viewer.state.moments import Moment
from viewer.state.notices import Notices
from viewer.state.preferences import Preferences
from viewer.state.session import Session, Snapshot, settings_to_json
from viewer.state.views import View
from viewer.state.zooming import Zoom

MOST_REPLAYED = 2000
"""Frames that are traced once more for one picture."""


@dataclass(frozen=True)
class Goal:
    """Where to go, what it is called, and which point of the picture is to be selected there, if any.  `zoom` is how
    closely the picture is looked at then, None for as it is; it stays at `one_sample` a pixel if that is so."""

    snapshot: Snapshot
    name: str
    size: tuple[int, int]
    point: Point | None = None
    zoom: Zoom | None = None
    one_sample: bool = False


class TimeTravel:
    """See the module."""

    def __init__(
        self,
        session: Session,
        preferences: Preferences,
        record: Record,
        tracing: Tracing,
        runs: RunController,
        undo: Undo,
        selection: Selection,
        notices: Notices,
        restore: Callable[[Snapshot], None],
        wake: Callable[[], None] = lambda: None,
    ) -> None:
        self._session, self._preferences, self._record, self._tracing = session, preferences, record, tracing
        self._runs, self._undo, self._selection, self._notices = runs, undo, selection, notices
        self._restore, self._wake = restore, wake
        self._wanted: tuple[float, Camera, Point] | None = None
        self.replay: Replay | None = None

    def go(self, number: int, modes: bool = False, point: Point | None = None) -> None:
        """Go back to a traced frame, by its number in the plots; with `modes`, to what was known then as well."""
        scene, moment = self._session.scene, self._record.moments.get(number)
        if scene is None or self._runs.refuses():
            return
        if moment is None:
            self._notices.say(f"picture {number} is no longer kept: only the last 10,000 are")
            return
        goal = Goal(self._snapshot(moment), f"picture {number}", moment.size, point)
        if not modes:
            self._arrive(goal)
            self._notices.say(f"{self.named(moment)}, again{self._may_differ(moment)}")
            return
        before = self._before(moment)
        if before is not None:
            self.replay_to(goal, before)

    def go_to_experiment(self, run: Experiment, number: int, modes: bool = False) -> None:
        """Go to a frame of an experiment, traced by the method that it shows; with `modes`, after those before it."""
        scene = self._session.scene
        if scene is None or self._runs.refuses():
            return
        if not run.is_of(scene):
            self._notices.say(f"this was measured {run.made_in(scene)}")
            return
        session = self._session
        settings = replace(run.settings, method=run.shown, samples=session.settings.samples)
        time = run.times[number]
        snapshot = replace(
            session.snapshot(), time=time, camera=scene.camera_at(time), follow=True,
            settings=settings_to_json(settings),
        )  # fmt: skip
        goal = Goal(snapshot, f"frame {number} of the experiment", (settings.width, settings.height))
        if modes:
            before = [(then, scene.camera_at(then)) for then in run.times[:number]]
            self.replay_to(goal, pasts(before, settings))
        else:
            self._arrive(goal)
            self._notices.say(self.named_of_experiment(run, number))

    def named(self, moment: Moment) -> str:
        """A picture by its number in the plots, and by the frame of the scene's path, whose number is another."""
        return f"picture {moment.number}{self._of_path(moment.time)}"

    def named_of_experiment(self, run: Experiment, number: int) -> str:
        """A frame of an experiment, and of the scene's path where the experiment has others."""
        scene = self._session.scene
        if scene is None or not run.is_of(scene) or len(run.times) == scene.frames:
            return f"frame {number} of the path, by {run.shown}"
        return f"frame {number} of the experiment, by {run.shown}{self._of_path(run.times[number])}"

    def _of_path(self, time: float) -> str:
        return f", frame {self._session.frame_at(time)} of the path" if self._session.animated else ""

    def _snapshot(self, moment: Moment) -> Snapshot:
        return replace(
            self._session.snapshot(), time=moment.time, camera=moment.camera, follow=moment.follow,
            settings=dict(moment.chosen), view=moment.view, light=moment.light, wipe=moment.wipe,
            span=self._session.spans.get(moment.view), edits=moment.edits, cut=self._session.cut,
        )  # fmt: skip

    def _may_differ(self, moment: Moment) -> str:
        """What else its picture depends on, in words."""
        if moment.size != self._tracing.full_size:
            width, height = moment.size
            return f", though its picture had {width} x {height} pixels"
        if moment.view is View.TREE:
            return f", though {BUILT}"
        method = Method.parse(str(moment.chosen.get("method")))
        if method.exact and not moment.view.of_modes:
            return ": the same picture, bit for bit"
        return ", with the modes of now; 'with its modes' brings back those of then"

    def _before(self, moment: Moment) -> list[Past] | None:
        """The frames that had set modes before it; None, and one line, where they are not known."""
        numbers = self._record.learnt_from
        earlier = [n for n in numbers or [] if n < moment.number]
        kept = [self._record.moments.get(n) for n in earlier]
        if numbers is None or (numbers and moment.number < numbers[0]) or not all(kept):
            why = "were forgotten since, or learnt in motion, and cannot be learnt again"
            self._notices.say(f"the modes of picture {moment.number} {why}")
            return None
        if len(kept) > MOST_REPLAYED:
            self._notices.say(f"it took {len(kept):,} pictures, and {MOST_REPLAYED:,} at most are traced again")
            return None
        return [Past(one.time, one.camera, one.settings) for one in kept if one is not None]

    def replay_to(self, goal: Goal, before: Sequence[Past]) -> None:
        """Forget all modes, trace these frames, and then show the picture of a goal, in its own size, and no other
        after it until something is done."""
        scene = self._session.scene
        if scene is None or self._runs.refuses() or self._runs.current is not None:
            return
        self._arrive(goal)
        p, (width, height) = self._preferences, goal.size
        if goal.size != self._tracing.full_size:
            p.fixed_resolution, p.fixed_width, p.fixed_height = True, width, height
        self._tracing.begin_replay(goal.one_sample)
        self.replay = Replay(scene, before, self._wake)
        self._runs.begin(self.replay)

    def _arrive(self, goal: Goal) -> None:
        self._undo.call_next(f"going to {goal.name}", with_time=True)
        self._restore(goal.snapshot)
        if goal.zoom is not None:
            self._session.zoom = goal.zoom
        self._selection.clear()
        camera = self._session.camera
        self._wanted = (self._session.time, camera, goal.point) if goal.point is not None else None

    def follow(self, traced: Traced | None) -> None:
        """Select what was to be selected, once its picture has come whole."""
        if self._wanted is None or self._runs.current is not None:
            return
        time, camera, point = self._wanted
        if (self._session.time, self._session.camera) != (time, camera):
            self._wanted = None
        elif traced is not None and traced.whole and traced.request.divisor == 1 and self._edits_are_shown:
            if (traced.request.time, traced.request.camera) == (time, camera):
                self._selection.select(point)
                self._wanted = None

    @property
    def _edits_are_shown(self) -> bool:
        """Whether the newest picture is of the scene that is wanted."""
        edited = self._session.edited
        return self._tracing.shows_edits and edited is not None and edited.edits == self._session.edits


def pasts(frames: Sequence[tuple[float, Camera]], settings: Settings) -> list[Past]:
    """Frames of a path, or beside it, that share their settings, as the window would have traced them."""
    shared = replace(settings, samples=1, verify=False, modes=True)
    return [Past(time, camera, shared) for time, camera in frames]
