"""Grading a method: is it right, what does it cost, and what does it learn wrongly when something changes?

Each trial (`tracer.experiments.trials`) is traced as an experiment (`tracer.experiments.experiment`) beside `none`,
twice: through the paper's tree, whose steps and tests are counted ray by ray, with every culled ray verified; and
through the fast tree on one thread, which is timed.  Then several threads trace it once more.  Answers of a method that
claims to be exact are held against certificates, too.  At last the worst wrong pixel of all is shrunk.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from tracer.culling.modes import FULL_SHADOW, NON_SHADOW, has_shadow_mode, shadow_mode
from tracer.experiments import counterexample, experiment
from tracer.experiments.experiment import REFERENCE, Results
from tracer.experiments.hunt import VISIBLE
from tracer.experiments.runner import Run
from tracer.experiments.shrink import Cancel, Shrink, WrongPixel, explained
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


@dataclass
class Row:
    """What a trial came to: `counted` in the paper's tree and `timed` in the fast one, of `due` shadow rays, with so
    many pixels `differing` from those of `none`; certificates prove and refute some of `answers` at first hits."""

    scene: str
    change: str
    frames: int
    counted: experiment.Row
    timed: experiment.Row
    due: int
    differing: int
    answers: int
    proved: int
    refuted: int

    @property
    def right(self) -> bool:
        """Whether every answer and every pixel is that of `none`."""
        return not (self.counted.wrong or self.differing or self.refuted)


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
    """The report card of a method: a row for each trial, in how many frames several threads have made other pictures
    than one, which counters were others, and the worst wrong pixel."""

    method: str
    claims_exact: bool
    size: tuple[int, int]
    rows: list[Row] = field(default_factory=list)
    threads: int = 3
    other_pictures: int = 0
    other_counters: list[str] = field(default_factory=list)
    worst: Worst | None = None
    whole: bool = False

    @property
    def right(self) -> bool:
        """Whether all is that of `none`, with any number of threads."""
        return all(row.right for row in self.rows) and not self.other_pictures


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
        self._off = VISIBLE  # how far the worst wrong pixel is from its right colour; where it is, in words, and what
        self._worst: tuple[str, Scene, WrongPixel] | None = None
        super().__init__(self._scenes[0], len(self._trials) * 5 * frames + 1)

    def steps(self, scene: Scene, world: World | None, cancel: Cancel) -> Iterator[Card]:
        for one in self._scenes:
            for accelerator in (KD_TREE, BVH8):
                self.make_ready([REFERENCE, self.method, PROVES], one, accelerator, cancel)
        card = Card(self.method, self._kind.exact, (self._timed.width, self._timed.height))
        for trial in self._trials:
            card.rows.append(self._row(trial, card, cancel))
            yield card
        if self._worst is not None:
            self._look_into_worst(card, *self._worst, cancel)
        if cancel():
            raise Cancelled
        card.whole = True
        self.progressed("done")
        yield card

    def _traced(self, trial: Trial, settings: Settings, cancel: Cancel) -> Iterator[tuple[Results, Frame, Frame]]:
        """What was measured so far, and the newest frame by `none` and by the method; raises Cancelled."""
        frames: dict[str, Frame] = {}

        def keep(number: int, method: str, frame: Frame) -> None:
            frames[method] = frame
            self.progressed(f"{trial}: frame {number + 1} of {len(trial.times)}")

        world = self._world(trial, settings.accelerator)
        methods, times = [self.method], trial.times
        for results in experiment.run(trial.scene, settings, methods, times, cancel=cancel, world=world, on_frame=keep):
            yield results, frames[REFERENCE], frames[self.method]
        if cancel():
            raise Cancelled

    def _world(self, trial: Trial, accelerator: str) -> World:
        """The world of a trial, which is that of others with the same objects."""
        key = id(trial.scene.objects), accelerator
        if key not in self._worlds:
            self._worlds[key] = World(trial.scene, trial.times[0], accelerator)
        return self._worlds[key]

    def _row(self, trial: Trial, card: Card, cancel: Cancel) -> Row:
        """Count and time what a trial takes, and keep the worst wrong pixel."""
        held, differing, alone = np.zeros(3, np.int64), 0, []
        proving, world = replace(self._counted, method=PROVES, verify=False), self._world(trial, KD_TREE)
        proves = Renderer(trial.scene, proving, world=world, cost_model=EAGER)
        for counted, none, frame in self._traced(trial, self._counted, cancel):
            if self._kind.exact:
                held += _held_against(proves.render(frame.time, cancel=cancel), none, frame)
            differing += int((frame.color != none.color).any(axis=-1).sum())
            if not self._kind.clusters:
                self._keep_worst(trial, len(counted.frames) - 1, none, frame)
        for timed, none, frame in self._traced(trial, self._timed, cancel):  # noqa: B007
            differing += int((frame.color != none.color).any(axis=-1).sum())
            alone.append((frame.time, frame.color, frame.statistics.to_dict()))
        renderer = Renderer(trial.scene, replace(self._timed, threads=card.threads), world=self._world(trial, BVH8))
        for time, color, counts in alone:
            other = renderer.render(time, cancel=cancel)
            card.other_pictures += bool((other.color != color).any())
            again = other.statistics.to_dict()
            unlike = {name for name in counts if name not in _CHANCE and counts[name] != again[name]}
            card.other_counters = sorted(unlike.union(card.other_counters))
            self.progressed(f"{trial}: by {card.threads} threads")
        due = int(sum(counted.methods[self.method]["shadow_rays_due"]))
        rows = experiment.table(counted)[-1], experiment.table(timed)[-1]
        return Row(trial.scene.path.stem, trial.change, len(alone), *rows, due, differing, *held.tolist())

    def _keep_worst(self, trial: Trial, number: int, none: Frame, frame: Frame) -> None:
        """Keep the worst wrong pixel of a trial's frame where it is the worst so far."""
        off = np.nan_to_num(counterexample.difference_of(frame.color, none.color), nan=1.0) * (frame.wrong != 0)
        y, x = map(int, np.unravel_index(int(off.argmax()), off.shape))
        if off[y, x] > self._off:
            shown, right = np.clip((frame.color[y, x], none.color[y, x]), 0.0, 1.0)
            self._off, how = float(off[y, x]), "bright" if shown.sum() > right.sum() else "dark"
            where = f"pixel {x}, {y} in frame {number} of {trial}, too {how} by {self._off:.3f} of 1"
            before = tuple(WarmupFrame(time) for time in trial.times[:number])
            settings = replace(self._counted, record_lights=False)
            self._worst = where, trial.scene, WrongPixel(x, y, trial.times[number], None, before, settings)

    def _look_into_worst(self, card: Card, where: str, scene: Scene, wrong: WrongPixel, cancel: Cancel) -> None:
        """Shrink the worst wrong pixel, and say what is wrong there."""
        card.worst = worst = Worst(where)
        shrinking = Shrink(scene, wrong)

        def show() -> None:
            self.label = f"shrinking the worst wrong pixel: {shrinking.label}"
            self._wake()

        try:
            for _ in shrinking.each(cancel=cancel, wake=show) if self._shrinks else ():
                pass
        except ValueError as error:  # without textures, or traced once more, it is right
            worst.words = str(error)
        if left := shrinking.results:
            scene, wrong = left.scene, left.wrong
            worst.first, worst.left, worst.scene = str(left.first), str(left.counts), aff_text(scene)
        if told := explained(scene, wrong):
            find, rule = told
            worst.words = " ".join([*counterexample.in_words(find, scene)[1:], rule])  # the first says where it is
            worst.found = counterexample.to_json(find, scene)


def _held_against(certified: Frame, none: Frame, frame: Frame) -> np.ndarray:
    """Count answers at first hits, and those that certificates prove and refute."""
    words, asked, reached, right = certified.certificates, none.asked, frame.reached, none.reached
    assert asked is not None and reached is not None and right is not None
    counts = np.array([np.count_nonzero(asked), 0, 0])
    for light in range(frame.lights):
        if words is not None and has_shadow_mode(words, light):
            due, arrive, mode = asked[..., light], reached[..., light], shadow_mode(words, light)
            hidden = (due > 0) & (mode == FULL_SHADOW)
            # What is certified as lit may be in the shadow of something that moves.
            lit = (due > 0) & (mode == NON_SHADOW) & (right[..., light] == due)
            wrong = (hidden & (arrive > 0)) | (lit & (arrive < due))
            counts[1:] += np.count_nonzero((hidden | lit) & ~wrong), np.count_nonzero(wrong)
    return counts
