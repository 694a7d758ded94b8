"""What culling saves of the newest frame: measured by frames in turn, said in one sentence, and as parts of a bar.

What became of the shadow rays are the frame's own counters.  Steps and time, which need a frame by `none` to be
compared with, come from frames that were traced in turn (`viewer.services.beside`): a single frame's time says little,
as whatever else the machine does is in it.  Frames in turn share that, so that the ratio of two neighbours varies less
than either, and the median of many ratios less still."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from enum import Enum

import numpy as np

from tracer.culling.fate import Fate
from tracer.frame import Frame
from tracer.geometry.accelerators import BVH8
from tracer.method import Method, title_of
from tracer.statistics import FrameStatistics
from viewer.state import terms, verified
from viewer.state.methods import NO_CULLING
from viewer.state.palette import FATE_WOULD, FATES
from viewer.util.numbers import count, percent, whole_percent

LONGEST = ": 29.6 % of shadow rays saved, not verified, 15 % fewer steps, 1.08 × as fast as tracing all (± 0.02)"
"""As long as the sentence usually is, after the method's name: what room there should be for it."""
WOULD_OPACITY = 0.4
"""Of a colour, where it stands for what would be."""
TWO_ERRORS = 2.0 * 1.2533 / 1.349
"""Twice the standard error of a median, as a part of the quartiles' distance by the root of the number: normal numbers
have quartiles 1.349 standard deviations apart, and medians with 1.2533 times the error of the mean."""
_SHORTEST = 0.4  # of the width, that the bar takes
LEAST = 8
"""Rounds from which on a median tells something."""


# --- frames in turn ----------------------------------------------------------------------------------


@dataclass(frozen=True)
class Spread:
    """A median of so many numbers, with the quartiles, and the margin within which it is known."""

    median: float
    low: float
    high: float
    count: int

    @staticmethod
    def of(numbers: Iterable[float]) -> Spread:
        """Return the spread of one number at least."""
        values = np.array(list(numbers), np.float64)
        low, median, high = (float(value) for value in np.percentile(values, (25.0, 50.0, 75.0)))
        return Spread(median, low, high, len(values))

    @property
    def margin(self) -> float:
        """Twice the standard error of the median."""
        return TWO_ERRORS * (self.high - self.low) / self.count**0.5

    @property
    def is_one(self) -> bool:
        """Whether it is 1 as far as one can tell, or as it is written."""
        return abs(self.median - 1.0) <= max(self.margin, 0.005)


@dataclass(frozen=True)
class InTurn:
    """Frames of one picture: `rounds` holds the statistics of one by each of the `methods`, in their order, and
    `settled` says that no more are to come."""

    methods: tuple[str, ...]
    rounds: tuple[tuple[FrameStatistics, ...], ...] = ()
    settled: bool = False

    @property
    def count(self) -> int:
        return len(self.rounds)

    @property
    def tells(self) -> bool:
        """Whether there are enough rounds to say how fast a method is."""
        return self.count >= LEAST

    def frames(self, method: str) -> list[FrameStatistics]:
        """Return all frames by a method, the first one first."""
        at = self.methods.index(method)
        return [one[at] for one in self.rounds]

    def seconds(self, method: str, phase: str = "") -> float | None:
        """Return the median of what frames by a method take, or one of their phases; None where none has it."""
        found = [seconds_of(one, phase) for one in self.frames(method)]
        known = [seconds for seconds in found if seconds is not None]
        return float(np.median(known)) if known else None

    def speed(self, method: str, other: str) -> Spread:
        """Return how many times as fast as another a method is, after one round at least."""
        pairs = zip(self.frames(method), self.frames(other), strict=True)
        return Spread.of(its.seconds / mine.seconds for mine, its in pairs)


def seconds_of(statistics: FrameStatistics, phase: str = "") -> float | None:
    """Return what a frame took, or one of its phases; None where it has none of that name."""
    return statistics.phases.get(phase) if phase else statistics.seconds


# --- the bar -----------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Part:
    """A part of the shadow rays that are due: what became of them, or `would`, and how many they are."""

    fate: Fate
    rays: int
    due: int
    would: bool = False

    @property
    def name(self) -> str:
        return FATE_WOULD[self.fate] if self.would else FATES[self.fate].name

    @property
    def share(self) -> str:
        return percent(self.rays, self.due)

    @property
    def label(self) -> str:
        return f"{self.name} {self.share}"

    def in_words(self) -> str:
        """Return what it is, in two lines."""
        meaning, way = FATES[self.fate].meaning, "what the paper's method would do: " if self.would else ""
        return f"{self.name}: {count(self.rays)} of {count(self.due)} shadow rays due ({self.share})\n{way}{meaning}"


def placed(
    bar: tuple[Part, ...], left: float, width: float, length: Callable[[str], float], pad: float
) -> Iterator[tuple[Part, int, int, int | None, bool]]:
    """Yield what is drawn in the colour of a part: its stretch of the bar, and behind the shortened bar a square before
    each label that does not fit into its part.  Each with its edges in whole pixels, where its label begins if that is
    here, and whether it is such a square, which is two pads wide.

    `length` is that of a text.  In little width some parts have no label."""
    outside, bar_width, room = set[Part](), width, {part: length(part.label) + 5.0 * pad for part in bar}
    for part in 2 * sorted(bar, key=lambda part: part.rays):  # twice, as each makes the others narrower
        narrow = part not in outside and length(part.label) + 2.0 * pad > bar_width * part.rays / part.due
        if narrow and bar_width - room[part] >= _SHORTEST * width:
            outside.add(part)
            bar_width -= room[part]
    done = 0
    for part in bar:
        start, end = (round(left + bar_width * rays / part.due) for rays in (done, done + part.rays))
        done += part.rays
        fits = part not in outside and length(part.label) + pad <= end - start
        yield part, start, end, round(start + pad) if fits else None, False
    at = left + bar_width
    for part in (one for one in bar if one in outside):
        start, end = round(at + pad), round(at + 3.0 * pad)
        yield part, start, end, round(end + pad), True
        at += room[part]


def bar_of(frame: Frame) -> tuple[Part, ...]:
    """Return the shadow rays that are due by what became of them or, where nothing is culled, `would` become of them by
    the paper's method; nothing where none is due, or no single light is asked."""
    shadow, said = frame.statistics.shadow, frame.statistics.by_modes_in_all
    if not shadow.due or frame.statistics.cuts is not None:
        return ()
    would = not Method.parse(frame.settings.method).culls
    if would:
        rays = {Fate.CULLED: said.full_shadow, Fate.DYNAMIC_ONLY: said.non_shadow}
        rays[Fate.TRACED] = shadow.due - sum(rays.values())
    else:
        rays = {Fate.CULLED: shadow.culled, Fate.DYNAMIC_ONLY: shadow.dynamic_only,
                Fate.CANDIDATES: shadow.candidates_only, Fate.CACHED: shadow.cache_hits,
                Fate.TRACED: shadow.traced}  # fmt: skip
    return tuple(Part(fate, number, shadow.due, would) for fate, number in rays.items() if number > 0)


# --- the sentence ------------------------------------------------------------------------------------


class Tone(Enum):
    """How a clause is meant."""

    PLAIN = "a figure"
    QUIET = "not known, or not yet"
    WRONG = "something is wrong"


@dataclass(frozen=True)
class Clause:
    """A part of the sentence, and more about it; `command` is what it tells to do, whose key the window adds."""

    text: str
    tip: str = ""
    tone: Tone = Tone.PLAIN
    command: str = ""


@dataclass(frozen=True)
class Standing:
    """What is known beside the frame's counters: what was `measured` in turn, that certificates are still made for the
    picture (`proves`), and `why_not` where nothing can be measured.  `run` is the name of the run whose frames are
    shown."""

    measured: InTurn | None = None
    proves: bool = False
    why_not: str = ""
    run: str = ""


_HOW = (
    "The same picture is traced without culling and by the chosen method in turn, again and again, while nothing else "
    "is to do."
)
_WAITS = f"{_HOW} The panel Experiment and the command bench measure a whole path, frame by frame."


def sentence(frame: Frame, standing: Standing) -> tuple[Clause, ...]:
    """Return what the method of a frame saves of it, and whether that pays; clauses to be joined by commas."""
    first, *others = counters(frame)
    if standing.run:
        name = standing.run[0].upper() + standing.run[1:]
        first = replace(first, text=f"{name}, {first.text}")
    return first, *others, *comparison(frame, standing)


def in_words(clauses: Iterable[Clause]) -> str:
    """Return the sentence as text."""
    return ", ".join(clause.text for clause in clauses)


def counters(frame: Frame) -> list[Clause]:
    """Return what of the sentence the frame's counters tell."""
    s, method = frame.statistics, Method.parse(frame.settings.method)
    culls = s.shadow.due > s.shadow.traced or s.cuts is not None
    return [_saved(frame), *([_wrong(frame, method)] if s.shadow.due and method.culls and culls else [])]


def comparison(frame: Frame, standing: Standing) -> list[Clause]:
    """Return the rest of it: how the frame's method compares with none, or why that is not known."""
    name, measured = frame.settings.method, standing.measured
    if name == NO_CULLING or not frame.statistics.shadow.due or standing.run:  # a run's panel compares the methods
        return []
    if standing.proves:
        made, meaning = terms.made(name)
        number = count(frame.statistics.certificates)
        tip = f"{made} in the picture before: {meaning}. They save rays later; their time is none of the rays'."
        return [_unknown(f"proving: {number} made in the last picture", tip)]
    if standing.why_not:
        return [_unknown("speed not measured", standing.why_not)]
    if measured is None or name not in measured.methods:
        return [_unknown("speed is measured once the picture rests", _WAITS)]
    if not measured.tells:
        return [_unknown("measuring speed ...", f"{_HOW} So far: {measured.count} rounds.")]
    return [*_steps(measured, frame), _speed(measured, frame)]


def _unknown(text: str, tip: str) -> Clause:
    return Clause(text, tip, Tone.QUIET)


def _saved(frame: Frame) -> Clause:
    s, method = frame.statistics, Method.parse(frame.settings.method)
    name = method.title
    shadow, said = s.shadow, s.by_modes_in_all
    part = f" (of the {whole_percent(s.part)} shaded)" if s.part < 1.0 else ""
    if s.cuts is not None:
        text = f"{name}: {s.cuts.mean:.0f} clusters for {count(s.cuts.lights)} lights{part}"
        return Clause(text, "of the lights that each block of points is shaded by, on average")
    if not shadow.due:
        return Clause(f"{name}: no shadow ray is due here", terms.MEANINGS[terms.DUE])
    if not method.culls:
        would = f"; the paper's modes would save {percent(said.saved, shadow.due)}" if said.due else ""
        tip = "what the modes that are kept for the views would save now, by the paper's method"
        return Clause(f"Every shadow ray is traced{would}{part}", tip)
    if shadow.due == shadow.traced and s.decision:
        return Clause(f"{name}: culls nothing here", s.decision)
    if shadow.due == shadow.traced:
        tip = "every shadow ray was traced; the modes that this has set may save some later"
        return Clause(f"{name}: nothing saved yet", tip)
    what = f"{terms.CULLED}, or {terms.DYNAMIC_ONLY}"
    tip = f"{count(shadow.saved)} of {count(shadow.due)} shadow rays due: {what}; pictures of other sizes have others"
    return Clause(f"{name}: {percent(shadow.saved, shadow.due)} of shadow rays saved{part}", tip)


def _wrong(frame: Frame, method: Method) -> Clause:
    s = frame.statistics
    if s.wrong is not None:
        tone = Tone.WRONG if verified.is_wrong(s) else Tone.PLAIN
        share = f"{percent(s.wrong.answers, s.wrong.due)} wrong" if s.wrong.answers else "none wrong"
        text = share if s.cuts is None else verified.in_short(s) or "not verified yet"
        return Clause(text, verified.in_words(s), tone)
    if method.exact:
        tip = "its pictures are those without culling, bit for bit; Verify traces every culled ray as well, to check"
        return Clause("exact", tip)
    tip = "trace every culled ray as well, to count wrong answers"
    return Clause("not verified", tip, Tone.QUIET, command="Verify")


def _steps(measured: InTurn, frame: Frame) -> Iterator[Clause]:
    mine, its = (measured.frames(method)[-1] for method in (frame.settings.method, NO_CULLING))
    if not its.traversal_steps:
        return
    more = round(100.0 * (mine.traversal_steps / its.traversal_steps - 1.0))
    packets = "; of whole packets of rays where these are coherent" if frame.settings.accelerator == BVH8 else ""
    tip = (
        f"nodes of the tree that rays of all kinds enter: {count(mine.traversal_steps)}, without "
        f"culling {count(its.traversal_steps)}{packets}; in frames in turn, which save "
        f"{percent(mine.shadow.saved, mine.shadow.due)} of shadow rays"
    )
    yield Clause(f"{abs(more)} % {'more' if more > 0 else 'fewer'} steps" if more else "as many steps", tip)


def _speed(measured: InTurn, frame: Frame) -> Clause:
    name, shadow, makes = frame.settings.method, frame.statistics.shadow, Method.parse(frame.settings.method).makes
    speed = measured.speed(name, NO_CULLING)
    mine, its = (1e3 * (measured.seconds(method) or 0.0) for method in (name, NO_CULLING))
    within = "within noise" if speed.is_one else f"± {max(speed.margin, 0.01):.2f}"
    if makes and shadow.due > shadow.traced:
        within += ", proofs not counted" if "certificates made" in makes else ", preparing not counted"
    tree = "" if frame.settings.accelerator == BVH8 else f" in the {frame.settings.accelerator}"
    times = "as fast" if speed.is_one else f"{speed.median:.2f} × as fast"
    tip = (
        f"median frame {mine:.1f} ms, without culling {its:.1f} ms: whole frames of one sample a pixel, without "
        "verifying or recording. The status bar has the time of the picture that is shown.\n"
        f"without culling over {title_of(name)}: median {speed.median:.3f} ± {speed.margin:.3f}, quartiles "
        f"{speed.low:.3f} and {speed.high:.3f}\n"
        f"{measured.count} whole frames by each, in turn{'' if measured.settled else '; it goes on'}. {_HOW}"
    )
    return Clause(f"{times} as tracing all{tree} ({within})", tip)
