"""What culling saves of the newest frame: measured by frames in turn, said in one sentence, and as parts of a bar.

What became of the shadow rays are the frame's own counters.  Steps and time, which need a frame by `none` to be
compared with, come from frames that were traced in turn (`viewer.services.beside`): a single frame's time says little,
as whatever else the machine does is in it.  Frames in turn share that, so that the ratio of two neighbours varies less
than either, and the median of many ratios less still.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from enum import Enum

import numpy as np

from tracer.culling.fate import Fate
from tracer.frame import Frame
from tracer.geometry.accelerators import BVH8
from tracer.method import Method
from tracer.statistics import FrameStatistics
from viewer.state import terms, verified
from viewer.state.methods import BY_MODES, NO_CULLING
from viewer.state.palette import FATE_MEANING, FATE_NAMES, FATE_WOULD
from viewer.util.numbers import count, percent, whole_percent

LONGEST = ": 29.6 % of shadow rays saved, 15 % fewer steps, not verified, 1.08 × as fast as none (± 0.02)"
"""As long as the sentence usually is, after the method's name: what room there should be for it."""
WOULD_OPACITY = 0.4
"""Of a colour, where it stands for what would be."""
TWO_ERRORS = 2.0 * 1.2533 / 1.349
"""Twice the standard error of a median, as a part of the quartiles' distance by the root of the number: normal numbers
have quartiles 1.349 standard deviations apart, and medians with 1.2533 times the error of the mean."""
LEAST = 8
"""Rounds from which on a median tells something."""
_WHOLE = 0.005  # of some work, or of all shadow rays: less is no difference


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
    """Frames of one picture: `rounds` holds the statistics of one by each of the `methods`, in their order.  `settled`
    says that no more are to come, `prepares` that frames are still traced before the first that count."""

    methods: tuple[str, ...]
    rounds: tuple[tuple[FrameStatistics, ...], ...] = ()
    settled: bool = False
    prepares: bool = True

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

    def seconds(self, method: str, phase: str = "") -> Spread | None:
        """Return what a frame by a method takes, or one of its phases; None where it has none."""
        found = [one.phases.get(phase) if phase else one.seconds for one in self.frames(method)]
        known = [seconds for seconds in found if seconds is not None]
        return Spread.of(known) if known else None

    def speed(self, method: str, other: str) -> Spread | None:
        """Return how many times as fast as another a method is; None before the first round."""
        pairs = zip(self.frames(method), self.frames(other), strict=True)
        return Spread.of(its.seconds / mine.seconds for mine, its in pairs) if self.rounds else None


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
        return (FATE_WOULD if self.would else FATE_NAMES)[self.fate]

    @property
    def share(self) -> str:
        return percent(self.rays, self.due)

    def label(self, length: Callable[[str], float], room: float) -> str:
        """Return its name and share, or the share alone, as far as there is room; `length` is that of a text."""
        texts = f"{self.name} {self.share}", self.share
        return next((text for text in texts if length(text) <= room), "")

    def in_words(self) -> str:
        """Return what it is, in two lines."""
        meaning, way = FATE_MEANING[self.fate], f"what {BY_MODES} would do: " if self.would else ""
        return f"{self.name}: {count(self.rays)} of {count(self.due)} shadow rays due ({self.share})\n{way}{meaning}"


@dataclass(frozen=True)
class Bar:
    """The shadow rays that are due by what became of them, or, where nothing is culled, `would` become of them by the
    paper's method."""

    parts: tuple[Part, ...]
    would: bool = False

    def places(self, left: float, right: float) -> Iterator[tuple[Part, int, int]]:
        """Yield each part with where it begins and ends, in whole pixels, between two edges."""
        done = 0
        for part in self.parts:
            start, end = (round(left + (right - left) * rays / part.due) for rays in (done, done + part.rays))
            done += part.rays
            yield part, start, end


def bar_of(frame: Frame) -> Bar:
    """Return the bar of a frame; without parts where no shadow ray is due, or no single light is asked."""
    shadow, said = frame.statistics.shadow, frame.statistics.by_modes_in_all
    if not shadow.due or frame.statistics.cuts is not None:
        return Bar(())
    would = not Method.parse(frame.settings.method).culls
    if would:
        rays = {Fate.CULLED: said.full_shadow, Fate.DYNAMIC_ONLY: said.non_shadow}
        rays[Fate.TRACED] = shadow.due - sum(rays.values())
    else:
        rays = {
            Fate.CULLED: shadow.culled,
            Fate.DYNAMIC_ONLY: shadow.dynamic_only,
            Fate.CANDIDATES: shadow.candidates_only,
            Fate.CACHED: shadow.cache_hits,
            Fate.TRACED: shadow.traced,
        }
    return Bar(tuple(Part(fate, number, shadow.due, would) for fate, number in rays.items() if number > 0), would)


# --- the sentence ------------------------------------------------------------------------------------


class Tone(Enum):
    """How a clause is meant."""

    PLAIN = "a figure"
    QUIET = "not known, or not yet"
    WRONG = "something is wrong"


@dataclass(frozen=True)
class Clause:
    """A part of the sentence, and more about it; `compares` says that it compares the method with none, and `command`
    is what it tells to do, whose key the window adds."""

    text: str
    tip: str = ""
    tone: Tone = Tone.PLAIN
    compares: bool = False
    command: str = ""


@dataclass(frozen=True)
class Standing:
    """What is known beside the frame's counters: what was `measured` in turn, whether pictures keep coming as something
    is `moving`, how far proving is where it goes on (`proves`), and `why_not` where nothing can be measured.  `run` is
    the name of the run whose frames are shown."""

    measured: InTurn | None = None
    moving: bool = False
    proves: str = ""
    why_not: str = ""
    run: str = ""


_HOW = (
    "The same picture is traced by none and by the chosen method in turn, again and again, while nothing else is to do."
)
_IN_MOTION = (
    "It is measured at rest: stop, and this picture is traced by both in turn. The panel Experiment and the command "
    "bench measure a whole path, frame by frame."
)


def sentence(frame: Frame, standing: Standing) -> tuple[Clause, ...]:
    """Return what the method of a frame saves of it, and whether that pays; clauses to be joined by commas."""
    return tuple(_clauses(frame, standing))


def in_words(clauses: Iterable[Clause]) -> str:
    """Return the sentence as text."""
    return ", ".join(clause.text for clause in clauses)


def comparison_in_words(frame: Frame, standing: Standing) -> str:
    """Return what of the sentence no counter of the frame can tell: how its method compares with none; empty where that
    is not known."""
    return in_words(one for one in _clauses(frame, standing) if one.compares and one.tone is not Tone.QUIET)


def counters_in_words(frame: Frame) -> str:
    """Return what of the sentence the frame's counters tell."""
    return in_words(one for one in _clauses(frame, Standing()) if not one.compares)


def _clauses(frame: Frame, standing: Standing) -> Iterator[Clause]:
    s, method = frame.statistics, Method.parse(frame.settings.method)
    yield _saved(frame, standing)
    if frame.settings.method == NO_CULLING or not s.shadow.due:
        return
    culls = s.shadow.due > s.shadow.traced or s.cuts is not None
    measured = standing.measured
    if measured is None or frame.settings.method not in measured.methods or standing.moving:
        measured = None  # it is of another picture
    elif culls:
        yield from _steps(measured, frame)
    if method.culls and culls:
        yield _wrong(frame, method)
    if standing.run:
        return  # whose panel compares the methods, on a whole path
    if standing.moving:
        yield _unknown("speed not measurable while moving", _IN_MOTION)
    elif standing.proves:
        made, meaning = terms.made(frame.settings.method)
        tip = f"{made} in the picture before: {meaning}. They save rays later; their time is none of the rays'."
        yield _unknown(standing.proves, tip)
    elif standing.why_not:
        yield _unknown("speed not measured", standing.why_not)
    elif measured is None:
        yield _unknown("speed is measured once the picture rests", _HOW)
    elif measured.tells:
        yield from _speed(measured, frame, method)
    else:
        done = "preparing" if measured.prepares else f"{measured.count} rounds"
        yield _unknown("measuring speed ...", f"{_HOW} So far: {done}.")


def _unknown(text: str, tip: str) -> Clause:
    """How the method compares with none, where that is not known."""
    return Clause(text, tip, Tone.QUIET, compares=True)


def _saved(frame: Frame, standing: Standing) -> Clause:
    s, name = frame.statistics, frame.settings.method
    shadow, said = s.shadow, s.by_modes_in_all
    culls = Method.parse(name).culls
    if standing.run:
        name = f"{standing.run[0].upper()}{standing.run[1:]}, {name}"
    part = f" (of the {whole_percent(s.part)} shaded)" if s.part < 1.0 else ""
    if s.cuts is not None:
        text = f"{name}: {s.cuts.mean:.0f} clusters for {count(s.cuts.lights)} lights{part}"
        return Clause(text, "of the lights that each block of points is shaded by, on average")
    if not shadow.due:
        return Clause(f"{name}: no shadow ray is due here", terms.MEANINGS[terms.DUE])
    if not culls:
        would = f"; the paper's modes would save {percent(said.saved, shadow.due)}" if said.due else ""
        tip = f"what the modes that are kept for the views would save now, by the method {BY_MODES}"
        return Clause(f"{name}: every shadow ray is traced{would}{part}", tip)
    if shadow.due == shadow.traced:
        if s.decision:
            return Clause(f"{name}: culls nothing here", s.decision)
        return Clause(
            f"{name}: nothing saved yet", "every shadow ray was traced; what that teaches may save some later"
        )
    tip = f"{count(shadow.saved)} of {count(shadow.due)} shadow rays due: culled, or asked dynamic objects only"
    return Clause(f"{name}: {percent(shadow.saved, shadow.due)} of shadow rays saved{part}", tip)


def _steps(measured: InTurn, frame: Frame) -> Iterator[Clause]:
    """Of frames in turn, once they save as much as the one that is shown, or all are there."""
    if not measured.rounds:
        return
    mine, its = (measured.frames(method)[-1] for method in (frame.settings.method, NO_CULLING))
    shadow, shown = mine.shadow, frame.statistics.shadow
    apart = abs(shadow.saved / max(shadow.due, 1) - shown.saved / max(shown.due, 1))
    if (apart > _WHOLE and not measured.settled) or not its.traversal_steps:
        return
    more = mine.traversal_steps / its.traversal_steps - 1.0
    tree = "; of whole packets of rays where these are coherent" if frame.settings.accelerator == BVH8 else ""
    tip = "nodes of the tree that rays of all kinds enter: "
    tip += f"{count(mine.traversal_steps)}, with none {count(its.traversal_steps)}{tree}"
    if apart > _WHOLE:
        tip += f"; in frames in turn, which save {percent(shadow.saved, shadow.due)} of shadow rays"
    text = f"{100.0 * abs(more):.0f} % {'more' if more > 0.0 else 'fewer'} steps"
    yield Clause("as many steps" if abs(more) < _WHOLE else text, tip, compares=True)


def _wrong(frame: Frame, method: Method) -> Clause:
    s = frame.statistics
    if s.wrong is not None:
        tone = Tone.WRONG if verified.is_wrong(s) else Tone.PLAIN
        share = f"{percent(s.wrong.answers, s.wrong.due)} wrong" if s.wrong.answers else "none wrong"
        text = share if s.cuts is None else verified.in_short(s) or "not verified yet"
        return Clause(text, verified.in_words(s), tone)
    if method.exact:
        tip = "its pictures are those of none, bit for bit; Verify traces every culled ray as well, to check"
        return Clause("exact", tip)
    return Clause(
        "not verified", "trace every culled ray as well, to count wrong answers", Tone.QUIET, command="Verify"
    )


def _speed(measured: InTurn, frame: Frame, method: Method) -> Iterator[Clause]:
    name, shadow = frame.settings.method, frame.statistics.shadow
    speed, mine, its = measured.speed(name, NO_CULLING), measured.seconds(name), measured.seconds(NO_CULLING)
    if speed is None or mine is None or its is None:
        return
    within = "within noise" if speed.is_one else f"± {max(speed.margin, 0.01):.2f}"
    if method.makes and shadow.due > shadow.traced:
        within += ", proofs not counted" if "certificates made" in method.makes else ", preparing not counted"
    tree = "" if frame.settings.accelerator == BVH8 else f" in the {frame.settings.accelerator}"
    times = "as fast" if speed.is_one else f"{speed.median:.2f} × as fast"
    tip = (
        f"median frame {1e3 * mine.median:.1f} ms, with none {1e3 * its.median:.1f} ms: whole frames of one sample a "
        "pixel, without verifying or recording. The status bar has the time of the picture that is shown.\n"
        f"none over {name}: median {speed.median:.3f} ± {speed.margin:.3f}, quartiles {speed.low:.3f} and "
        f"{speed.high:.3f}\n"
        f"{measured.count} whole frames by each, in turn{'' if measured.settled else '; it goes on'}. {_HOW}"
    )
    yield Clause(f"{times} as none{tree} ({within})", tip, compares=True)
