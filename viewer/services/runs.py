"""Experiments and zoom tests in the window: what `shadowcull bench` and `zoom` do, while one watches.

A `Run` is a task of the render thread: it has renderers, and so modes, of its own, and shares the
scene's world, so that no frame is traced beside it.  Meanwhile the window shows its frames as its
picture.  What has come of it is there at any moment, and stays when it is stopped.
"""

from __future__ import annotations

import math
import threading
import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from dataclasses import replace
from datetime import datetime
from pathlib import Path
from typing import Generic, TypeVar, cast

from tracer.experiments import experiment, zoom
from tracer.frame import Frame, Settings
from tracer.method import in_order
from tracer.renderer import Renderer
from tracer.scene.edits import Origin
from tracer.scene.model import Cancelled, Scene
from viewer.output import exports
from viewer.output.film import Film
from viewer.services.render_request import Traces
from viewer.state.plans import ExperimentPlan, ZoomPlan, parse_factors
from viewer.state.views import View
from viewer.util.messages import Failure, failure
from viewer.util.time_left import TimeLeft

LONGEST_SIDE = 4096
"""Pixels of a run's pictures: it traces many."""

SEEN_WITHIN = 1.0
"""Seconds that a frame of a zoom test waits, at most, to be drawn before the next is traced."""

STARTING = "starting"
"""The label of a run before its first frame."""

Results = TypeVar("Results")


class Run(ABC, Generic[Results]):
    """Long tracing under way, or what is left of it.

    `results` is a copy that nothing changes any more, None before the first whole frame; `frames` is
    how many there are to trace, `traced` how many have been; `label` says which was the last of them,
    `label_shown` which is shown; `failure` is why it ended early; `began` is the time of day.  The scene is let go
    at the end; `scene_path` stays.
    """

    name = "run"
    endings: tuple[str, ...] = tuple(exports.ENDINGS)
    """Of the files that its results can be saved as."""

    def __init__(self, scene: Scene, frames: int, wake: Callable[[], None] = lambda: None) -> None:
        self.scene_path = scene.path
        self._scene: Scene | None = scene
        self._origin = Origin(scene)
        self.began = datetime.now()
        self.frames = frames
        self.traced = 0
        self.label = self.label_shown = STARTING
        self.results: Results | None = None
        self.failure: Failure | None = None
        self.seconds = 0.0
        self.stopping = False
        self._left = TimeLeft()
        self._wake = wake
        self._lock = threading.Lock()
        self._shown: tuple[Frame, str] | None = None
        self._seen = threading.Event()
        self._done = threading.Event()

    @property
    def done(self) -> bool:
        return self._done.is_set()

    @property
    def whole(self) -> bool:
        """Whether it went on to its end."""
        return self.done and self.failure is None and self.traced == self.frames

    @property
    def showing(self) -> str:
        """Which of its frames is the picture, in words, or that none has been yet."""
        return f"showing {self.label_shown}" if self.is_shown else f"the {self.name} is starting"

    @property
    def is_shown(self) -> bool:
        """Whether the picture is one of its frames."""
        return self.label_shown != STARTING

    @property
    def verifies(self) -> bool:
        """Whether its frames know which answers are wrong."""
        return True

    def lacks(self, view: View) -> str:
        """Why frames of this run cannot be seen in a view that needs more of them, in words; else nothing."""
        if view.needs_work:
            return "does not count the rays of each pixel"
        if view.needs_lights:
            return "does not record which samples of lights reach each pixel"
        if view.needs_fates:
            return "does not record what becomes of the shadow rays of each pixel"
        return "does not verify" if view.needs_verify and not self.verifies else ""

    def is_of(self, scene: Scene | None) -> bool:
        """Whether it is (or was) made in this scene, as it was read and edited then."""
        return self._origin.is_of(scene)

    def made_in(self, scene: Scene | None) -> str:
        """In which scene it was made, in words, where that is not the one that is open."""
        if scene is not None and Path(scene.path) == self.scene_path:
            return f"in {self.scene_path.name} as it was before it was edited, or read again"
        return f"in {self.scene_path.name}; open that scene again to go there"

    @property
    def done_of(self) -> tuple[int, int]:
        """Frames that the results are of, and how many they are to be of."""
        return self.traced, self.frames

    @property
    def where(self) -> str:
        """Where it has written what it has made, in words; nothing where that is saved when asked for."""
        return ""

    @property
    def fraction(self) -> float:
        return self.traced / self.frames

    @property
    def seconds_left(self) -> float | None:
        """An estimate from the frames so far; None before there are any."""
        return self._left.seconds()

    def stop(self) -> None:
        """End it after the last whole frame."""
        self.stopping = True
        self._seen.set()

    def take(self) -> Frame | None:
        """The newest frame to be shown, once."""
        with self._lock:
            shown, self._shown = self._shown, None
        self._seen.set()
        if shown is None:
            return None
        frame, self.label_shown = shown
        return frame

    def work(self, renderer: Traces, cancelled: Callable[[], bool]) -> None:
        """Do it, on the render thread."""
        assert self._scene is not None, "a run is done once"
        began = time.monotonic()
        self._left.mark(0, self.frames)
        try:
            for results in self._steps(self._scene, cast(Renderer, renderer), lambda: self.stopping or cancelled()):
                self.results = self._copy(results)
                self._wake()
        except Cancelled:
            pass
        except Exception as error:
            self.failure = failure(error, f"the {self.name} failed")
        finally:
            self.seconds = time.monotonic() - began
            self._scene = None
            self._done.set()
            self._wake()

    def _count(self, label: str) -> None:
        """One more frame has been traced."""
        self.traced += 1
        self.label = label
        self._left.mark(self.traced, self.frames)

    def _show(self, frame: Frame, wait: bool) -> None:
        self._seen.clear()
        with self._lock:
            self._shown = frame, self.label
        self._wake()
        if wait and not self.stopping:
            self._seen.wait(SEEN_WITHIN)

    @abstractmethod
    def _steps(self, scene: Scene, renderer: Renderer, cancelled: Callable[[], bool]) -> Iterator[Results]: ...

    def _copy(self, results: Results) -> Results:
        """Results that nothing changes any more; as they are where nothing does."""
        return results

    @abstractmethod
    def write(self, results: Results, path: Path) -> None:
        """Results of this run as one of `exports.ENDINGS`; raises OSError or ValueError in one line."""


class Experiment(Run[experiment.Results]):
    """A path of frames by several methods; the frames of the method `shown` are the picture.

    Raises ValueError for a method that does not exist or a size out of range.
    """

    name = "experiment"

    def __init__(
        self, scene: Scene, settings: Settings, plan: ExperimentPlan, wake: Callable[[], None] = lambda: None
    ) -> None:
        _check_size(plan.size)
        self.methods = experiment.with_reference(in_order(plan.methods))
        self.times = experiment.path_times(scene, plan.frames)
        self.settings = replace(
            settings,
            width=plan.size[0],
            height=plan.size[1],
            depth=plan.depth,
            verify=plan.verify,
            samples=1,
            accelerator=plan.accelerator,
            certificate_seconds=math.inf,  # a count of certificates is what repeats exactly
        ).validated()
        self.shown = self.methods[-1]
        super().__init__(scene, len(self.methods) * len(self.times), wake)

    @property
    def verifies(self) -> bool:
        return self.settings.verify

    @property
    def done_of(self) -> tuple[int, int]:
        return len(self.results.frames) if self.results is not None else 0, len(self.times)

    def _steps(self, scene: Scene, renderer: Renderer, cancelled: Callable[[], bool]) -> Iterator[experiment.Results]:
        def on_frame(number: int, method: str, frame: Frame) -> None:
            self._count(f"frame {number + 1} of {len(self.times)}, {method}")
            if method == self.shown:
                self._show(frame, wait=False)

        return experiment.run(scene, self.settings, self.methods, self.times, cancel=cancelled, on_frame=on_frame)

    def _copy(self, results: experiment.Results) -> experiment.Results:
        methods = {
            method: {name: list(values) for name, values in figures.items()}
            for method, figures in results.methods.items()
        }
        return replace(results, frames=list(results.frames), methods=methods)

    def write(self, results: experiment.Results, path: Path) -> None:
        exports.write(results, path)


class ZoomTest(Run[zoom.Results]):
    """Towards a primitive; every frame is the picture once, and kept in `film`.

    Raises ValueError for factors or a size that are none."""

    name = "zoom test"

    def __init__(
        self,
        scene: Scene,
        settings: Settings,
        start: zoom.Aim,
        plan: ZoomPlan,
        wake: Callable[[], None] = lambda: None,
    ) -> None:
        _check_size(plan.size)
        self.start, self.plan = start, replace(plan)
        self.factors = parse_factors(plan.factors)
        self.film = Film()
        self.settings = replace(settings, width=plan.size[0], height=plan.size[1]).validated()
        super().__init__(scene, len(self.factors) * (plan.steps + zoom.STILL_FRAMES), wake)

    def _steps(self, scene: Scene, renderer: Renderer, cancelled: Callable[[], bool]) -> Iterator[zoom.Results]:
        last = self.plan.steps + zoom.STILL_FRAMES - 1

        def on_frame(factor: float, number: int, frame: Frame) -> None:
            self.film.record(factor, number, frame)
            self._count(f"zoom factor {factor:g}, step {number} of {last}")
            self._show(frame, wait=True)

        return zoom.run(
            scene,
            self.settings,
            self.start,
            self.factors,
            self.plan.steps,
            self.plan.ratio,
            cancel=cancelled,
            world=renderer.world,
            on_frame=on_frame,
        )

    def _copy(self, results: zoom.Results) -> zoom.Results:
        return replace(results, approaches=[replace(a, steps=list(a.steps)) for a in results.approaches])

    def write(self, results: zoom.Results, path: Path) -> None:
        exports.write(results, path)

    def write_film(self, results: zoom.Results, path: Path) -> None:
        """The filmstrip as a picture; raises OSError in one line, and ValueError where no step is done."""
        exports.write_film(self.film, results, path)


def _check_size(size: tuple[int, int]) -> None:
    if max(size) > LONGEST_SIDE:
        raise ValueError(f"{size[0]} x {size[1]} is too large for a run; {LONGEST_SIDE} pixels a side at most")


def duration(seconds: float) -> str:
    """A time as people say it: 4 s, 2:05 min, 1:10 h."""
    if seconds < 59.5:
        return f"{seconds:.0f} s"
    minutes, rest = divmod(round(seconds), 60)
    return f"{minutes}:{rest:02d} min" if minutes < 60 else f"{minutes // 60}:{minutes % 60:02d} h"
