"""What culling saves of the newest frame, in one sentence and as parts of a bar.

The sentence's figures come from two places.  What became of the shadow rays are the frame's own counters.  Steps and
time, which need a frame by `none` to be compared with, come from frames that were traced in turn
(`viewer.services.baseline`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from enum import Enum

from tracer.culling.fate import Fate
from tracer.frame import Frame
from tracer.geometry.accelerators import BVH8
from tracer.method import Method
from tracer.statistics import ShadowCounts
from viewer.state import terms, verified
from viewer.state.in_turn import InTurn, Spread
from viewer.state.methods import BY_MODES, NO_CULLING
from viewer.state.palette import FATE_MEANING, FATE_NAMES, FATE_WOULD
from viewer.util.numbers import count, percent, whole_percent

LONGEST = ": 29.6 % of shadow rays saved, 15 % fewer steps, not verified, 1.08 × as fast as none (± 0.02)"
"""As long as the sentence usually is, after the method's name: what room there should be for it."""
PALE = 0.35
"""Of a colour, what lies between the stripes of what would be."""
_WHOLE = 0.005  # of some work, or of all shadow rays: less is no difference


@dataclass(frozen=True)
class Part:
    """A part of the shadow rays that are due: what became of them, or `would`, how many they are, and their share of
    all."""

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
        """The part's name and share, or the share alone, as far as there is room; `length` is that of a text."""
        texts = f"{self.name} {self.share}", self.share
        return next((text for text in texts if length(text) <= room), "")

    def in_words(self) -> str:
        """What it is, in two lines."""
        meaning, way = FATE_MEANING[self.fate], f"what {BY_MODES} would do: " if self.would else ""
        return f"{self.name}: {count(self.rays)} of {count(self.due)} shadow rays due ({self.share})\n{way}{meaning}"


@dataclass(frozen=True)
class Bar:
    """The shadow rays that are due by what became of them, or, where nothing is culled, `would` become of them by the
    paper's method."""

    parts: tuple[Part, ...]
    would: bool = False


def bar_of(frame: Frame) -> Bar:
    """The bar of a frame; without parts where no shadow ray is due, or no single light is asked."""
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


class Tone(Enum):
    """How a clause is meant."""

    PLAIN = "a figure"
    QUIET = "not known, or not yet"
    WRONG = "something is wrong"


@dataclass(frozen=True)
class Clause:
    """A part of the sentence, and more about it; `compares` says that it compares the method with none.  Where there is
    too little room for the sentence it is the `short` text, and nothing where that is empty. `command` is what it tells
    to do, whose key the window adds."""

    text: str
    tip: str = ""
    tone: Tone = Tone.PLAIN
    compares: bool = False
    short: str | None = None
    command: str = ""


@dataclass(frozen=True)
class Standing:
    """What is known beside the frame's counters: what was `measured` in turn, whether pictures keep coming as something
    is `moving`, whether this one is still to `learn`, how far proving is where it goes on (`proves`), whether it has
    ended before all was proved (`unproved`), and `why_not` where nothing can be measured.  `run` is the name of the run
    whose frames are shown, and `back` the method that comes back when culling is turned on again."""

    measured: InTurn | None = None
    moving: bool = False
    learns: bool = False
    proves: str = ""
    unproved: bool = False
    why_not: str = ""
    run: str = ""
    back: str = ""


def sentence(frame: Frame, standing: Standing) -> tuple[Clause, ...]:
    """What the method of a frame saves of it, and whether that pays; clauses to be joined by commas."""
    return tuple(_clauses(frame, standing))


def in_words(clauses: Iterable[Clause]) -> str:
    """The sentence as text."""
    return ", ".join(clause.text for clause in clauses if clause.text)


def fitting(clauses: tuple[Clause, ...], fits: Callable[[tuple[Clause, ...]], bool]) -> tuple[Clause, ...]:
    """The sentence, or as much of it in short as it must be to fit: the first clauses first, and then without those
    that matter least.  What is in short says in its tip what is meant."""
    for left_out in (False, True):
        for at, clause in enumerate(clauses):
            if fits(clauses):
                return clauses
            if clause.short is not None and bool(clause.short) is not left_out:
                tip = "\n".join(filter(None, (clause.text, clause.tip)))
                clauses = (*clauses[:at], replace(clause, text=clause.short, tip=tip, short=None), *clauses[at + 1 :])
    return tuple(clause for clause in clauses if clause.text)


def comparison_in_words(frame: Frame, standing: Standing) -> str:
    """What of the sentence no counter of the frame can tell: how its method compares with none; empty where that is not
    known."""
    return in_words(one for one in _clauses(frame, standing) if one.compares and one.tone is not Tone.QUIET)


def counters_in_words(frame: Frame) -> str:
    """What of the sentence the frame's counters tell."""
    return in_words(one for one in _clauses(frame, Standing()) if not one.compares)


def _clauses(frame: Frame, standing: Standing) -> Iterator[Clause]:
    s, method = frame.statistics, Method.parse(frame.settings.method)
    yield _saved(frame, standing)
    if not method.culls and standing.back:
        yield Clause(
            f"turn {standing.back} on again", "the method that culled last", Tone.QUIET, command="Shadow culling"
        )
    if frame.settings.method == NO_CULLING or not s.shadow.due:
        return
    measured = standing.measured
    if measured is not None and frame.settings.method not in measured.methods:
        measured = None  # it is of another picture
    tells = measured is not None and measured.tells
    culls = bool(_answered(s.shadow)) or s.cuts is not None
    if measured is not None and culls and not standing.moving:
        yield from _steps(measured, frame)
    if method.culls and culls:
        yield _wrong(frame, method)
    if standing.run:
        return  # whose panel compares the methods, on a whole path
    if standing.unproved and method.has_certificates and not standing.moving:
        text, made = "not all is proved yet, keep tracing", terms.things(terms.made(frame.settings.method)[0])
        tip = (
            f"The last picture has made {count(s.certificates)} {made}: there are more to make, while tracing goes on."
        )
        yield Clause(text, tip, Tone.QUIET, short="unfinished", command="Keep tracing when idle")
    if standing.moving:
        yield Clause("speed not measurable while moving", _IN_MOTION, Tone.QUIET, compares=True)
    elif standing.proves:
        made, meaning = terms.made(frame.settings.method)
        tip = f"{made} in the picture before: {meaning}. They save rays later; their time is none of the rays'."
        yield Clause(standing.proves, tip, Tone.QUIET, True)
    elif standing.why_not:
        yield Clause("speed not measured", standing.why_not, Tone.QUIET, compares=True)
    elif tells and measured is not None:
        yield from _speed(measured, frame, method)
    elif measured is not None:
        done = "preparing" if measured.prepares else f"{measured.count} rounds"
        yield Clause("measuring speed ...", f"{_HOW} So far: {done}.", Tone.QUIET, compares=True)
    else:
        yield Clause("speed is measured once the picture rests", _HOW, Tone.QUIET, compares=True)


_HOW = (
    "The same picture is traced by none and by the chosen method in turn, again and again, while nothing else is to do."
)

_IN_MOTION = (
    "It is measured at rest: stop, and this picture is traced by both in turn. The panel Experiment and the command "
    "bench measure a whole path, frame by frame."
)


def _answered(shadow: ShadowCounts) -> int:
    """Rays that were not traced through the whole scene."""
    return shadow.due - shadow.traced


def _saved(frame: Frame, standing: Standing) -> Clause:
    s, name = frame.statistics, frame.settings.method
    shadow, culls = s.shadow, Method.parse(name).culls
    if standing.run:
        name = f"{standing.run[0].upper()}{standing.run[1:]}, {name}"
    part = f" (of the {whole_percent(s.part)} shaded)" if s.part < 1.0 else ""
    if s.cuts is not None:
        text = f"{name}: {s.cuts.mean:.0f} clusters for {count(s.cuts.lights)} lights"
        return Clause(f"{text}{part}", "of the lights that each block of points is shaded by, on average")
    if not shadow.due:
        return Clause(f"{name}: no shadow ray is due here", terms.MEANINGS[terms.DUE])
    if not culls:
        said = s.by_modes_in_all
        share = percent(said.saved, shadow.due)
        would = f"; the paper's modes would save {share}" if said.due else ""
        tip = f"what the modes that are kept for the views would save now, by the method {BY_MODES}"
        text = f"{name}: every shadow ray is traced{would}{part}"
        return Clause(text, tip, short=f"{name}: all traced{would}{part}")
    if not _answered(shadow):
        if standing.learns:
            return Clause(f"{name}: nothing saved yet", "what this picture teaches saves rays in the next")
        return Clause(f"{name}: culls nothing here", s.decision or "every shadow ray is traced")
    tip = f"{count(shadow.saved)} of {count(shadow.due)} shadow rays due: culled, or asked dynamic objects only"
    share = percent(shadow.saved, shadow.due)
    return Clause(f"{name}: {share} of shadow rays saved{part}", tip, short=f"{name}: {share} saved{part}")


def _steps(measured: InTurn, frame: Frame) -> Iterator[Clause]:
    """Of frames in turn, once they save as much as the one that is shown, or all are there."""
    mine, its = measured.steps(frame.settings.method), measured.steps(NO_CULLING)
    shadow, shown = measured.frames(frame.settings.method)[-1].shadow if measured.rounds else None, frame.statistics
    if mine is None or not its or shadow is None:
        return
    apart = abs(shadow.saved / max(shadow.due, 1) - shown.shadow.saved / max(shown.shadow.due, 1))
    if apart > _WHOLE and not measured.settled:
        return
    more = mine / its - 1.0
    tree = "; of whole packets of rays where these are coherent" if frame.settings.accelerator == BVH8 else ""
    tip = f"nodes of the tree that rays of all kinds enter: {count(mine)}, with none {count(its)}{tree}"
    if apart > _WHOLE:
        tip += f"; in frames in turn, which save {percent(shadow.saved, shadow.due)} of shadow rays"
    if abs(more) < _WHOLE:
        yield Clause("as many steps", tip, compares=True, short="")
    elif more > 1.0:
        yield Clause(f"{mine / its:.1f} × as many steps", tip, compares=True, short="")
    else:
        text = f"{100.0 * abs(more):.0f} % {'more' if more > 0.0 else 'fewer'} steps"
        yield Clause(text, tip, compares=True, short="")


def _wrong(frame: Frame, method: Method) -> Clause:
    s = frame.statistics
    if s.wrong is not None:
        tone = Tone.WRONG if verified.is_wrong(s) else Tone.PLAIN
        share = f"{percent(s.wrong.answers, s.wrong.due)} wrong" if s.wrong.answers else "none wrong"
        return Clause(
            share if s.cuts is None else verified.in_short(s) or "not verified yet", verified.in_words(s), tone
        )
    if method.exact:
        return Clause(
            "exact", "its pictures are those of none, bit for bit; Verify traces every culled ray as well, to check"
        )
    tip = "trace every culled ray as well, to count wrong answers"
    return Clause("not verified", tip, Tone.QUIET, command="Verify")


def _speed(measured: InTurn, frame: Frame, method: Method) -> Iterator[Clause]:
    speed = measured.speed(frame.settings.method, NO_CULLING)
    if speed is None:
        return
    within = "within noise" if speed.is_one else f"± {max(speed.margin, 0.01):.2f}"
    besides = ""
    if method.makes and _answered(frame.statistics.shadow):
        besides = ", proofs not counted" if "certificates made" in method.makes else ", preparing not counted"
    tree = "" if frame.settings.accelerator == BVH8 else f" in the {frame.settings.accelerator}"
    tip = _tip(measured, speed, frame.settings.method)
    times = "as fast" if speed.is_one else f"{speed.median:.2f} × as fast"
    text = f"{times} as none{tree} ({within}"
    yield Clause(f"{text}{besides})", tip, compares=True, short=f"{text})" if besides else None)


def _tip(measured: InTurn, speed: Spread, method: str) -> str:
    """How the speed was measured."""
    mine, its = measured.seconds(method), measured.seconds(NO_CULLING)
    assert mine is not None and its is not None
    times = f"median frame {1e3 * mine.median:.1f} ms, with none {1e3 * its.median:.1f} ms: whole frames of one sample "
    times += "a pixel, without verifying or recording. The status bar has the time of the picture that is shown."
    ratio = f"none over {method}: median {speed.median:.3f} ± {speed.margin:.3f}, quartiles {speed.low:.3f} and"
    ends = "" if measured.settled else "; it goes on"
    return f"{times}\n{ratio} {speed.high:.3f}\n{measured.count} whole frames by each, in turn{ends}. {_HOW}"
