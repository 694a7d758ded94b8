"""Grading a method: is it right, what does it cost, and what does it learn wrongly when something changes?

Each trial (`tracer.experiments.trials`) is traced as an experiment (`tracer.experiments.experiment`) beside `none`,
twice: through the paper's tree, whose steps and tests are counted ray by ray, with every culled ray verified; and
through the fast tree on one thread, which is timed.  Then several threads trace it once more.  Answers of a method that
claims to be exact are held against certificates, too.  At last the worst wrong pixel of all is shrunk.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from copy import deepcopy
from dataclasses import asdict, dataclass, field, replace
from functools import reduce
from typing import Any

import numpy as np

from tracer.culling.modes import FULL_SHADOW, NON_SHADOW, has_shadow_mode, shadow_mode
from tracer.experiments import counterexample, experiment
from tracer.experiments.experiment import REFERENCE, figures_of
from tracer.experiments.hunt import VISIBLE
from tracer.experiments.runner import Run
from tracer.experiments.shrink import Shrink, Shrunk, WrongPixel, explained
from tracer.experiments.trials import Trial, trials
from tracer.experiments.warmup_frames import WarmupFrame
from tracer.frame import Frame, Settings
from tracer.geometry.accelerators import BVH8, KD_TREE
from tracer.geometry.world import World
from tracer.method import Method
from tracer.neighbours.certified.cost_model import CostModel
from tracer.renderer import Renderer
from tracer.scene.aff_writer import aff_text
from tracer.scene.model import Cancelled, Scene

FRAMES = 8
PROVES = "certified"
"""The method whose certificates answers are held against, and how eager it is to make them."""
EAGER = CostModel(root_requests=2, split_requests=4, settled_candidates=0, max_asked=48, costly_rays=True, stride=1)
_CHANCE = ("seconds", "phases", "built", "decision")  # of statistics: what depends on time, or on who came first
Cancel = Callable[[], bool]


@dataclass
class Row:
    """What trials with one kind of change came to.

    `wrong` counts wrong answers, or for clusters of lights the pixels beyond their error, and `differing` the pixels of
    another colour than by `none`, of `pixels`.  Of `answers` at first hits, certificates prove some and refute others.
    Steps and tests are those of shadow rays in the paper's tree, seconds those of each frame in the fast one."""

    frames: int = 0
    due: int = 0
    wrong: int = 0
    pixels: int = 0
    differing: int = 0
    answers: int = 0
    proven: int = 0
    refuted: int = 0
    steps: int = 0
    steps_of_none: int = 0
    tests: int = 0
    tests_of_none: int = 0
    seconds: list[float] = field(default_factory=list)
    seconds_of_none: list[float] = field(default_factory=list)

    @property
    def right(self) -> bool:
        """Whether every answer and every pixel is that of `none`."""
        return not (self.wrong or self.differing or self.refuted)

    @property
    def time(self) -> tuple[float, float]:
        """How many times as long it took as `none`, and twice the standard error of that."""
        return experiment.speed_up(np.array(self.seconds), np.array(self.seconds_of_none))

    def saved(self, work: str) -> float:
        """The part of the "steps" or "tests" of `none` that is saved."""
        return 1.0 - getattr(self, work) / max(1, getattr(self, f"{work}_of_none"))

    def plus(self, other: Row) -> Row:
        """The sum of both."""
        return Row(**{name: value + getattr(other, name) for name, value in vars(self).items()})


@dataclass
class Worst:
    """The worst wrong pixel: where it is, what is wrong there and which rule failed, all about it as `hunt` has it, how
    much there was `first` and is `left`, and that as AFF; of one that could not be shrunk, these are empty."""

    where: str
    words: str = ""
    found: dict[str, Any] = field(default_factory=dict)
    first: str = ""
    left: str = ""
    scene: str = ""


@dataclass
class Card:
    """The report card of a method: a row for each kind of change that was tried, and what it came to besides.

    Of the `threaded` frames that several threads traced, `other_pictures` were others than by one, and so were the
    counters of these names."""

    method: str
    claims_exact: bool
    scenes: list[str]
    size: tuple[int, int]
    rows: dict[str, Row] = field(default_factory=dict)
    memory_bytes: int = 0
    threads: int = 3
    threaded: int = 0
    other_pictures: int = 0
    other_counters: list[str] = field(default_factory=list)
    worst: Worst | None = None
    whole: bool = False

    @property
    def total(self) -> Row:
        """The sum of all rows."""
        return reduce(Row.plus, self.rows.values(), Row())

    def to_dict(self) -> dict[str, Any]:
        """Plain lists and numbers, for JSON."""
        return asdict(self) | {"exact": self.total.right}


class Grade(Run[Card]):
    """Grading as a run: over some scenes, each from one frame of its path on."""

    name = "grade"

    def __init__(
        self, method: str, scenes: Sequence[tuple[Scene, int]], settings: Settings, frames: int = FRAMES,
        shrinks: bool = True,
    ) -> None:  # fmt: skip
        """Raises ValueError, in one line, where there is no such method or a setting is out of range."""
        self.method, self._kind, self._shrinks = method, Method.parse(method), shrinks
        shared = replace(settings, method=method, samples=1, modes=False, threads=1).recording_only().validated()
        self._counted = replace(shared, accelerator=KD_TREE, verify=True, record_lights=self._kind.exact)
        self._timed = replace(shared, accelerator=BVH8)
        self._scenes = [scene for scene, _ in scenes]
        self._trials = [trial for scene, first in scenes for trial in trials(scene, first, frames)]
        self._worlds: dict[tuple[int, str], World] = {}
        self._worst: tuple[float, Trial, int, int, int] = (VISIBLE, self._trials[0], 0, 0, 0)
        super().__init__(self._scenes[0], len(self._trials) * 5 * frames + 1)

    def steps(self, scene: Scene, world: World | None, cancel: Cancel) -> Iterator[Card]:
        for one in self._scenes:
            for accelerator in (KD_TREE, BVH8):
                self.make_ready([REFERENCE, self.method, PROVES], one, accelerator, cancel)
        size, names = (self._timed.width, self._timed.height), [one.path.stem for one in self._scenes]
        card = Card(self.method, self._kind.exact, names, size)
        for trial in self._trials:
            row = Row()
            self._count(trial, row, cancel)
            self._time(trial, row, card, cancel)
            card.rows[trial.change] = card.rows.get(trial.change, Row()).plus(row)
            yield card
        if self._worst[0] > VISIBLE:
            self._look_into_worst(card, cancel)
        card.whole = not cancel()
        self.progressed("done")
        yield card

    def copy(self, results: Card) -> Card:
        return deepcopy(results)

    def _world(self, trial: Trial, accelerator: str) -> World:
        """The world of a trial, which is that of others with the same objects."""
        key = id(trial.scene.objects), accelerator
        if key not in self._worlds:
            self._worlds[key] = World(trial.scene, trial.times[0], accelerator)
        return self._worlds[key]

    def _traced(
        self, trial: Trial, settings: Settings, world: World, cancel: Cancel
    ) -> Iterator[tuple[experiment.Results, dict[str, Frame]]]:
        """What was measured so far, and the newest frame by each method; raises Cancelled."""
        frames: dict[str, Frame] = {}

        def keep(number: int, method: str, frame: Frame) -> None:
            frames[method] = frame
            self.progressed(f"{trial}: frame {number + 1} of {len(trial.times)}")

        for results in experiment.run(
            trial.scene, settings, [self.method], trial.times, cancel=cancel, world=world, on_frame=keep
        ):
            yield results, frames
        if cancel():
            raise Cancelled

    def _count(self, trial: Trial, row: Row, cancel: Cancel) -> None:
        """Count steps, tests and what is wrong, and keep the worst wrong pixel."""
        world = self._world(trial, KD_TREE)
        proving = replace(self._counted, method=PROVES, verify=False)
        proves = Renderer(trial.scene, proving, world=world, cost_model=EAGER)
        for _, frames in self._traced(trial, self._counted, world, cancel):
            none, frame = frames[REFERENCE], frames[self.method]
            if self._kind.exact:
                _hold_against(proves.render(frame.time, cancel=cancel), none, frame, row)
            off = _compare(none, frame, row)
            off[frame.wrong == 0] = 0.0
            y, x = np.unravel_index(int(off.argmax()), off.shape)
            if off[y, x] > self._worst[0] and not self._kind.clusters:
                self._worst = float(off[y, x]), trial, row.frames, int(x), int(y)
            counted, of_none = frame.statistics, none.statistics.shadow
            row.frames += 1
            row.due += counted.shadow.due
            row.wrong += int(figures_of(counted)["wrong"])
            row.steps += counted.shadow.traversal_steps + counted.certificate_steps
            row.tests += counted.shadow.intersection_tests + counted.certificate_tests
            row.steps_of_none += of_none.traversal_steps
            row.tests_of_none += of_none.intersection_tests

    def _time(self, trial: Trial, row: Row, card: Card, cancel: Cancel) -> None:
        """Time the method, and trace the same on several threads."""
        world, alone = self._world(trial, BVH8), []
        for results, frames in self._traced(trial, self._timed, world, cancel):  # noqa: B007
            _compare(frames[REFERENCE], frames[self.method], row)
            alone.append(frames[self.method])
        row.seconds_of_none, row.seconds = (results.methods[m]["frame_seconds"] for m in (REFERENCE, self.method))
        card.memory_bytes = max(card.memory_bytes, *results.memory_bytes[self.method])
        renderer = Renderer(trial.scene, replace(self._timed, threads=card.threads), world=world)
        for time, one in zip(trial.times, alone, strict=True):
            other = renderer.render(time, cancel=cancel)
            card.threaded += 1
            card.other_pictures += one.color.tobytes() != other.color.tobytes()
            counters = _counters(other)
            unlike = [name for name, count in _counters(one).items() if counters[name] != count]
            card.other_counters = sorted({*card.other_counters, *unlike})
            self.progressed(f"{trial}: by {card.threads} threads")

    def _look_into_worst(self, card: Card, cancel: Cancel) -> None:
        """Shrink the worst wrong pixel, and say what is wrong there."""
        difference, trial, number, x, y = self._worst
        where = f"pixel {x}, {y} in frame {number} of {trial}, off by {difference:.3f} of 1"
        card.worst = worst = Worst(where)
        before = tuple(WarmupFrame(time) for time in trial.times[:number])
        settings = replace(self._counted, record_lights=False)
        scene, wrong = trial.scene, WrongPixel(x, y, trial.times[number], None, before, settings)
        left: Shrunk | None = None
        shrinking = Shrink(scene, wrong)

        def show() -> None:
            self.label = f"shrinking the worst wrong pixel: {shrinking.label}"
            self._wake()

        try:
            for left in shrinking.each(cancel=cancel, wake=show) if self._shrinks else ():  # noqa: B007
                pass
        except ValueError as error:  # without textures, or traced once more, it is right
            worst.words = str(error)
        if left is not None:
            scene, wrong = left.scene, left.wrong
            worst.first, worst.left, worst.scene = str(left.first), str(left.counts), aff_text(scene)
        if told := explained(scene, wrong):
            worst.words = " ".join([*counterexample.in_words(told[0], scene), told[1]])
            worst.found = counterexample.to_json(told[0], scene)


def _compare(none: Frame, frame: Frame, row: Row) -> np.ndarray:
    """Count the pixels of another colour than by `none`; (h, w) by how much each is off."""
    row.pixels += frame.primitive.size
    row.differing += int(np.count_nonzero((frame.color != none.color).any(axis=-1)))
    off = np.abs(np.clip(frame.color, 0.0, 1.0) - np.clip(none.color, 0.0, 1.0)).max(axis=-1)
    return np.nan_to_num(off, nan=1.0)


def _hold_against(certified: Frame, none: Frame, frame: Frame, row: Row) -> None:
    """Count the answers at first hits that certificates prove, and those that they refute."""
    words, asked, reached, right = certified.certificates, none.asked, frame.reached, none.reached
    if words is None or asked is None or reached is None or right is None:  # no certificates with that many lights
        return
    row.answers += int(np.count_nonzero(asked))
    for light in range(asked.shape[-1]):
        if has_shadow_mode(words, light):
            due, arrive, proven = asked[..., light], reached[..., light], shadow_mode(words, light)
            hidden = (due > 0) & (proven == FULL_SHADOW)
            # What is certified as lit may be in the shadow of something that moves.
            lit = (due > 0) & (proven == NON_SHADOW) & (right[..., light] == due)
            wrong = (hidden & (arrive > 0)) | (lit & (arrive < due))
            row.proven += int(np.count_nonzero((hidden | lit) & ~wrong))
            row.refuted += int(np.count_nonzero(wrong))


def _counters(frame: Frame) -> dict[str, Any]:
    """What a frame counted, by names."""
    return {name: count for name, count in frame.statistics.to_dict().items() if name not in _CHANCE}
