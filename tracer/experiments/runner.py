"""A run: a long measurement under way, or what is left of it.

Whoever starts one shows how far it is, can end it early, and has its results as they come: the window on the thread
that traces while it draws, a command on its own thread.
"""

from __future__ import annotations

import threading
import time
from abc import ABC, abstractmethod
from bisect import bisect_left
from collections.abc import Callable, Iterable, Iterator
from datetime import datetime
from itertools import pairwise
from pathlib import Path
from statistics import median
from typing import Generic, TypeVar

from tracer.compiling.compilation import make_all_ready
from tracer.editing.edits import Origin
from tracer.frame import Frame
from tracer.geometry.world import World
from tracer.scene.model import Cancelled, Scene

STARTING = "starting"
"""The label of a run before its first frame."""
SEEN_WITHIN = 1.0
"""Seconds that a frame waits, at most, to be drawn before the next is traced, where each is to be seen."""

Results = TypeVar("Results")


def ignore() -> None:
    """Do nothing."""


def never() -> bool:
    """Return that nobody has cancelled."""
    return False


class Run(ABC, Generic[Results]):
    """Frames to trace for one purpose, with progress, cancellation and results so far.

    Attributes
    ----------
    name : str
        What it is called, such as "experiment".
    frames, traced : int
        How many frames there are to trace, and how many have been.
    label, label_shown : str
        Which frame was traced last, or what is compiled before the first, and which frame `take` gave last.
    results : Results or None
        What nothing changes any more, None before the first whole frame.
    output : Path or None
        The file or folder that it writes by itself, once something is there.
    began : datetime
        When it was made.
    seconds : float
        How long it took.
    stopping, done, whole : bool
        Whether it is to end after the last whole frame, whether it has ended, and whether it went on to its end.
    error : Exception or None
        Why it ended early.
    """

    name = "run"
    unit = "frame"
    """What it counts in."""
    verifies = True
    """Whether its frames know which answers are wrong."""
    each_is_seen = False
    """Whether each frame is to be drawn before the next is traced, where somebody `watches`."""
    watches = False

    def __init__(self, scene: Scene, frames: int) -> None:
        self.scene_path = Path(scene.path)
        self.frames, self.traced = frames, 0
        self.label = self.label_shown = STARTING
        self.results: Results | None = None
        self.output: Path | None = None
        self.error: Exception | None = None
        self.began, self.seconds = datetime.now(), 0.0
        self.stopping = self.done = False
        self._scene: Scene | None = scene
        self._origin = Origin(scene)
        self._left, self._began = TimeLeft(), 0.0
        self._wake: Callable[[], None] = ignore
        self._lock = threading.Lock()
        self._newest: tuple[Frame, str] | None = None
        self._seen = threading.Event()

    @abstractmethod
    def steps(self, scene: Scene, world: World | None, cancel: Callable[[], bool]) -> Iterator[Results]:
        """Trace, call `progressed` after each frame, and yield the results so far."""

    def copy(self, results: Results) -> Results:
        """Return results that nothing changes any more; as they are where nothing does."""
        return results

    def each(
        self, world: World | None = None, cancel: Callable[[], bool] = never, wake: Callable[[], None] = ignore
    ) -> Iterator[Results]:
        """Do it, once, and yield the results after each frame; the scene is let go at the end.

        `wake` is called whenever there is something new to show.  What goes wrong is raised, and kept as `error`."""
        assert self._scene is not None, "a run is done once"
        self._wake = wake
        self._begin()
        growing: Results | None = None
        try:
            for growing in self.steps(self._scene, world, lambda: self.stopping or cancel()):
                self.results = self.copy(growing)
                yield self.results
                wake()
        except Cancelled:
            pass
        except Exception as error:
            self.error = error
            raise
        finally:
            self.seconds = time.monotonic() - self._began
            if growing is not None:  # once more: they may say now that the run was stopped
                self.results = self.copy(growing)
            self._scene = None
            self.done = True
            wake()

    def make_ready(self, methods: Iterable[str], scene: Scene, accelerator: str, cancel: Callable[[], bool]) -> None:
        """Compile what the methods need, which `label` says meanwhile; raises Cancelled."""

        def report(what: str, fraction: float) -> None:
            self.label = what
            self._wake()
            if cancel():
                raise Cancelled

        make_all_ready(methods, len(scene.lights), accelerator, report)
        self.label = STARTING
        self._begin()

    def _begin(self) -> None:
        """Count time from now on."""
        self._began, self._left = time.monotonic(), TimeLeft()
        self._left.mark(0, self.frames)

    def progressed(self, label: str, frame: Frame | None = None) -> None:
        """Count a frame that has been traced, in words, and show it to whoever takes frames."""
        self.traced += 1
        self.label = label
        self._left.mark(self.traced, self.frames)
        self._seen.clear()
        if frame is not None:
            with self._lock:
                self._newest = frame, label
        self._wake()
        if self.each_is_seen and self.watches and not self.stopping:
            self._seen.wait(SEEN_WITHIN)

    def take(self) -> Frame | None:
        """Return the newest frame, once."""
        with self._lock:
            newest, self._newest = self._newest, None
        self._seen.set()
        if newest is None:
            return None
        frame, self.label_shown = newest
        return frame

    def stop(self) -> None:
        """End it after the last whole frame, and keep what it has."""
        self.stopping = True
        self._seen.set()

    # --- how far it is ----------------------------------------------------------------------------

    @property
    def whole(self) -> bool:
        return self.done and self.error is None and self.traced == self.frames

    @property
    def done_of(self) -> tuple[int, int]:
        """Frames that the results are of, and how many they are to be of."""
        return self.traced, self.frames

    @property
    def is_shown(self) -> bool:
        """Whether a frame of it has been taken, to be drawn."""
        return self.label_shown != STARTING

    @property
    def fraction(self) -> float:
        return self.traced / self.frames

    @property
    def seconds_left(self) -> float | None:
        """An estimate from the frames so far; None before there are any."""
        return self._left.seconds()

    # --- the scene --------------------------------------------------------------------------------

    def is_of(self, scene: Scene | None) -> bool:
        """Whether it was made in this scene, as it was read and edited then."""
        return self._origin.is_of(scene)

    def made_in(self, scene: Scene | None) -> str:
        """In which scene it was made, in words, where that is not the one that is open."""
        if scene is not None and Path(scene.path) == self.scene_path:
            return f"in {self.scene_path.name} before it was edited or reloaded"
        return f"in {self.scene_path.name}; open that scene again to go there"


class TimeLeft:
    """How long steps of uneven length will still take; one thread marks them while others ask.

    Steps that are near each other on a path take about as long: where n steps remain, the estimate uses the last n that
    were done, but at least FEWEST.
    """

    FEWEST = 8
    LONGEST = 20.0
    """Times the usual step: what took longer stood still, as when the machine slept, and counts no more than that."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._total = 0
        self._marks: list[tuple[int, float]] = []  # steps done, and when; one append for both

    def mark(self, done: int, total: int) -> None:
        """So many steps of `total` are done now."""
        self._total = total
        self._marks.append((done, self._clock()))

    def seconds(self) -> float | None:
        """Return what is left, counting the step under way as one like the others; None before the first is done."""
        marks = list(self._marks)
        if not marks or marks[-1][0] == marks[0][0]:
            return None
        done, then = marks[-1]
        left = self._total - done
        if not left:
            return 0.0
        pace = self._pace(marks[bisect_left(marks, (done - max(left, self.FEWEST), -1.0)) :])
        return left * pace - min(self._clock() - then, pace)

    def _pace(self, marks: list[tuple[int, float]]) -> float:
        """Seconds for a step, between these marks."""
        steps = [(done - before, at - then) for (before, then), (done, at) in pairwise(marks)]
        longest = self.LONGEST * median(seconds / count for count, seconds in steps if count)
        return sum(min(seconds, longest * max(count, 1)) for count, seconds in steps) / sum(count for count, _ in steps)
