"""A path of frames by several methods: the paper's Table 1.

Every method has a renderer, and so modes, of its own, and renders the same frames in turn.  Each frame begins with
another method, so that what goes on beside it, and what the first of them finds in no cache, falls on all alike.

What is compared is the work of shadow rays, frame by frame, against `none`; certificates, where a method makes any,
count against it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from tracer.experiments.runner import Run
from tracer.frame import Frame, Settings
from tracer.geometry.accelerators import LAZY
from tracer.geometry.world import World
from tracer.method import Method, title_of
from tracer.renderer import Renderer
from tracer.scene.model import Cancelled, Progress, Scene
from tracer.statistics import FrameStatistics, ShadowCounts

REFERENCE = "none"


def _wrong(statistics: FrameStatistics) -> int:
    """Wrong answers; of clusters of lights, which give none, the pixels that differ by more than they may."""
    if statistics.cuts is not None and statistics.wrong is not None:
        return statistics.wrong.pixels
    return statistics.shadow.wrong


_FIGURES: dict[str, Callable[[FrameStatistics], float]] = {
    "shadow_rays_due": lambda s: s.shadow.due,
    "shadow_rays_culled": lambda s: s.shadow.culled,
    "shadow_rays_dynamic_only": lambda s: s.shadow.dynamic_only,
    "shadow_traversal_steps": lambda s: s.shadow.traversal_steps,
    "shadow_intersection_tests": lambda s: s.shadow.intersection_tests,
    "occlusion_tests": lambda s: s.occlusion_tests,
    "certificate_steps": lambda s: s.certificate_steps,
    "certificate_tests": lambda s: s.certificate_tests,
    "wrong": _wrong,
    "frame_seconds": lambda s: s.seconds,
}

FIGURES = tuple(_FIGURES)
"""Names of what is measured of each frame, as in the JSON of `shadowcull bench`."""


def figures_of(statistics: FrameStatistics) -> dict[str, float]:
    """What is measured of a frame, by the names in `FIGURES`; all but "frame_seconds" are whole numbers."""
    return {name: of(statistics) for name, of in _FIGURES.items()}


def saved_of(figures: Mapping[str, np.ndarray]) -> float:
    """How many shadow rays frames have saved, by the names in `FIGURES`."""
    culled, dynamic_only = (int(figures[f"shadow_rays_{name}"].sum()) for name in ("culled", "dynamic_only"))
    return ShadowCounts(culled=culled, dynamic_only=dynamic_only).saved


def wrong_part(method: str, wrong: float, due: float, pixels: float) -> float:
    """The part that is wrong: of the shadow rays due, or of the pixels of all frames by clusters of lights."""
    try:
        by_pixels = Method.parse(method).clusters
    except ValueError:  # kept results may be of a method that is not there
        by_pixels = False
    return float(wrong / max(1.0, pixels if by_pixels else due))


# Settings of all methods.
_SHARED = ("depth", "zoom_factor", "symmetric", "verify", "accelerator", "threads", "lamp_radius", "lamp_samples")


@dataclass
class Results:
    """What was measured: for each frame in `frames`, one entry in each list of each method.

    Attributes
    ----------
    scene : str
        File of the scene.
    size : (int, int)
        Width and height in pixels.
    frames : list of int
        Numbers of the frames that were rendered, counted along the path.
    methods : dict
        For each method, a list for each figure, by the names of the JSON of `shadowcull bench`.
    path_times : sequence of float
        Seconds of all frames of the path.
    planned : int
        How many frames were to be rendered.
    stopped : bool
        Whether the run was ended early.
    settings : dict
        The settings that all methods share, by name.
    build_seconds, memory_bytes : dict
        For each method, how long it made what it culls by, before each frame's shading, and what it held after it.
    """

    scene: str
    size: tuple[int, int]
    frames: list[int] = field(default_factory=list)
    methods: dict[str, dict[str, list[float]]] = field(default_factory=dict)
    path_times: Sequence[float] = ()
    planned: int = 0
    stopped: bool = False
    settings: dict[str, Any] = field(default_factory=dict)
    build_seconds: dict[str, list[float]] = field(default_factory=dict)
    memory_bytes: dict[str, list[int]] = field(default_factory=dict)

    @property
    def path_frames(self) -> int:
        """How many frames the path has: the scene's own number, or what it was resampled to."""
        return len(self.path_times)

    @property
    def times(self) -> list[float]:
        """Seconds of each frame."""
        return [self.path_times[number] for number in self.frames]

    def to_dict(self) -> dict[str, Any]:
        """Plain lists and numbers, for JSON."""
        return {
            "scene": self.scene,
            "size": list(self.size),
            "frames": self.frames,
            "methods": self.methods,
            "times": self.times,
            "path_frames": self.path_frames,
            "planned_frames": self.planned,
            "stopped": self.stopped,
            "settings": self.settings,
            "build_seconds": self.build_seconds,
            "memory_bytes": self.memory_bytes,
        }

    def reductions(self, method: str, work: str) -> np.ndarray:
        """Say what a method saves, frame by frame.

        Parameters
        ----------
        method : str
            Name of the method.
        work : str
            "steps" or "tests".

        Returns
        -------
        (frames,) float64
            Saved parts of the work of "none". Work on certificates counts against the method.
        """
        key = {"steps": "shadow_traversal_steps", "tests": "shadow_intersection_tests"}[work]
        before = np.array(self.methods[REFERENCE][key], np.float64)
        after = np.array(self.methods[method][key], np.float64) + self.methods[method][f"certificate_{work}"]
        return np.divide(before - after, before, out=np.zeros_like(before), where=before > 0)


@dataclass(frozen=True)
class Row:
    """A line of the paper's Table 1.

    Savings are parts of 1. `most_steps_frame` and `most_tests_frame` are the frames that save the most, `wrong_part` is
    the part of the shadow rays due that had a wrong answer, by clusters of lights the part of pixels that differ by
    more than they may, and `frame_seconds` is the median. `path_seconds` is what all frames took, `build_seconds` the
    part of it in which the method made what it culls by, and `memory_bytes` what it held at most. `speed_up` is the
    time of "none" over that of the method, in all frames, and `speed_up_spread` is twice its standard error over the
    frames, infinite for fewer than two. `saved_part` is the part of the shadow rays due that was saved
    (`ShadowCounts.saved`).
    """

    method: str
    average_steps: float
    most_steps: float
    most_steps_frame: int
    average_tests: float
    most_tests: float
    most_tests_frame: int
    extra_tests_per_pixel: float
    wrong: int
    wrong_part: float
    frame_seconds: float
    path_seconds: float
    build_seconds: float
    memory_bytes: int
    speed_up: float
    speed_up_spread: float
    saved_part: float


def table(results: Results) -> list[Row]:
    """The paper's Table 1 of results; empty where no frame was finished."""
    return [_row(results, method) for method in results.methods] if results.frames else []


def _row(results: Results, method: str) -> Row:
    steps, tests = (results.reductions(method, work) for work in ("steps", "tests"))
    figures = {name: np.array(values, np.float64) for name, values in results.methods[method].items()}
    pixels = results.size[0] * results.size[1]
    due = max(1.0, figures["shadow_rays_due"].sum())
    of_reference = np.array(results.methods[REFERENCE]["frame_seconds"], np.float64)
    faster, spread = speed_up(of_reference, figures["frame_seconds"])
    return Row(
        method=method,
        average_steps=float(steps.mean()),
        most_steps=float(steps.max()),
        most_steps_frame=results.frames[int(steps.argmax())],
        average_tests=float(tests.mean()),
        most_tests=float(tests.max()),
        most_tests_frame=results.frames[int(tests.argmax())],
        extra_tests_per_pixel=float(figures["occlusion_tests"].mean() / pixels),
        wrong=int(figures["wrong"].sum()),
        wrong_part=wrong_part(method, figures["wrong"].sum(), due, pixels * len(results.frames)),
        frame_seconds=float(np.median(figures["frame_seconds"])),
        path_seconds=float(figures["frame_seconds"].sum()),
        build_seconds=float(sum(results.build_seconds.get(method, ()))),
        memory_bytes=max(results.memory_bytes.get(method, (0,))),
        speed_up=faster,
        speed_up_spread=spread,
        saved_part=saved_of(figures) / due,
    )


def speed_up(reference: np.ndarray, seconds: np.ndarray) -> tuple[float, float]:
    """Compare the times of the same frames by "none" and by a method.

    Parameters
    ----------
    reference, seconds : (frames,) float64
        Seconds of each frame by either.

    Returns
    -------
    tuple of float and float
        The ratio of their sums, 0 where nothing took any time, and twice the standard error of this ratio.
    """
    total, frames = float(seconds.sum()), len(seconds)
    if total <= 0.0:
        return 0.0, 0.0
    ratio = float(reference.sum()) / total
    if frames < 2:
        return ratio, math.inf
    return ratio, 2.0 * float(np.std(reference - ratio * seconds, ddof=1)) * math.sqrt(frames) / total


def path_times(scene: Scene, frames: int | None = None) -> list[float]:
    """Times of the frames of a scene's path; resampled, ends included, where a number of frames is given."""
    if frames is None:
        return [scene.frame_time(i) for i in range(scene.frames)]
    start, end = scene.time_range
    return [float(t) for t in np.linspace(start, end, frames)] if frames > 1 else [start]


def in_turn(methods: Sequence[str], frame: int) -> list[str]:
    """The methods in the order in which they render a frame, the first of the run being 0."""
    first = frame % len(methods)
    return [*methods[first:], *methods[:first]]


def with_reference(methods: list[str]) -> list[str]:
    """The methods, each once, the reference first; raises ValueError for one that does not exist."""
    for method in methods:
        Method.parse(method)  # raises where there is no such method
    return list(dict.fromkeys([REFERENCE, *methods]))


def run(
    scene: Scene,
    settings: Settings,
    methods: list[str],
    times: list[float],
    numbers: range | None = None,
    progress: Progress | None = None,
    cancel: Callable[[], bool] | None = None,
    world: World | None = None,
    on_frame: Callable[[int, str, Frame], None] | None = None,
) -> Iterator[Results]:
    """Render a path of frames by several methods, and yield the results after each frame.

    It always yields the same growing object, so that whoever stops early keeps what is done.

    Parameters
    ----------
    scene : Scene
        What to render.
    settings : Settings
        How; the method is replaced by each of `methods`.
    methods : list of str
        Names of methods; "none" is always rendered, too.
    times : list of float
        Seconds of all frames of the path.
    numbers : range, optional
        Which of them to render; all by default.
    progress : callable, optional
        Called while trees are built; it may raise Cancelled.
    cancel : callable, optional
        Once it returns true, the run ends after the last whole frame.
    world : World, optional
        The geometry of the scene, which nobody else may use meanwhile.
    on_frame : callable, optional
        Called with the number, the method and the picture of each frame.

    Yields
    ------
    Results
        What was measured so far.

    Raises
    ------
    ValueError
        If a method does not exist.
    Cancelled
        If `progress` raises it.
    """
    numbers = range(len(times)) if numbers is None else numbers
    names = with_reference(methods)
    world = world or World(scene, times[0] if times else 0.0, settings.accelerator, progress)
    world.build()  # no frame that is measured has to
    builder = (
        Renderer(scene, replace(settings, method=REFERENCE), world=world) if settings.accelerator == LAZY else None
    )
    renderers = {name: Renderer(scene, replace(settings, method=name), world=world) for name in names}
    results = Results(
        str(scene.path),
        (settings.width, settings.height),
        methods={name: {figure: [] for figure in FIGURES} for name in names},
        path_times=tuple(times),
        planned=len(numbers),
        settings={name: getattr(settings, name) for name in _SHARED},
    )
    for turn, number in enumerate(numbers):
        frames = {}
        try:
            if builder is not None:  # or the first method would build for all of them
                builder.render(times[number], cancel=cancel)
            for name in in_turn(names, turn):
                frames[name] = renderers[name].render(times[number], cancel=cancel)
                if on_frame is not None:
                    on_frame(number, name, frames[name])
        except Cancelled:
            results.stopped = True
            return
        results.frames.append(number)
        for name, frame in frames.items():
            for figure, value in figures_of(frame.statistics).items():
                results.methods[name][figure].append(value)
            results.build_seconds.setdefault(name, []).append(frame.statistics.phases.get("certification", 0.0))
            results.memory_bytes.setdefault(name, []).append(renderers[name].memory_bytes)
        yield results


class Experiment(Run[Results]):
    """An experiment as a run; the frames of the method `shown` are to be looked at meanwhile.

    Raises ValueError for a method that does not exist or a setting out of range."""

    name = "experiment"

    def __init__(
        self, scene: Scene, settings: Settings, methods: list[str], times: list[float], numbers: range | None = None
    ) -> None:
        self.settings, self.times = settings.validated(), times
        self.methods = with_reference(methods)
        self.numbers = range(len(times)) if numbers is None else numbers
        self.shown, self.verifies = self.methods[-1], settings.verify
        super().__init__(scene, len(self.methods) * len(self.numbers))

    @property
    def done_of(self) -> tuple[int, int]:
        return len(self.results.frames) if self.results is not None else 0, len(self.numbers)

    def steps(self, scene: Scene, world: World | None, cancel: Callable[[], bool]) -> Iterator[Results]:
        def on_frame(number: int, method: str, frame: Frame) -> None:
            label = f"frame {number - self.numbers.start + 1} of {len(self.numbers)}, {title_of(method)}"
            self.progressed(label, frame if method == self.shown else None)

        self.make_ready(self.methods, scene, self.settings.accelerator, cancel)
        fits = world is not None and world.accelerator == self.settings.accelerator
        yield from run(
            scene, self.settings, self.methods, self.times, self.numbers, cancel=cancel,
            world=world if fits else None, on_frame=on_frame,
        )  # fmt: skip

    def copy(self, results: Results) -> Results:
        methods = {
            method: {name: list(values) for name, values in figures.items()}
            for method, figures in results.methods.items()
        }
        return replace(results, frames=list(results.frames), methods=methods)
