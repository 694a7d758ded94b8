"""All numbers of a frame as rows of a table: of one frame, or of two beside each other."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np

from tracer.culling.fate import FATE, Fate
from tracer.frame import Frame
from tracer.geometry.accelerators import BVH8
from tracer.method import Method
from tracer.statistics import RayCounts
from viewer.state import terms
from viewer.state.savings import InTurn, seconds_of
from viewer.state.views import REGRET
from viewer.util.numbers import count, percent, whole_percent

RAYS, WORK, TIME = "Shadow rays", "Work", "Time"
Seconds = Callable[[str], float | None]
"""What a phase of the frame took, or all of it, which is the phase ""; None where that is not known."""
NO_TIME = (
    "known for two methods live, once the picture rests and both have traced it in turn: of two single frames nothing "
    "follows"
)
_STEPS = "nodes of the tree that they enter"
_TESTS = "rays against primitives"
_PACKETS = "; bvh8 counts one for a whole packet of up to 128 coherent rays, an experiment in the kd-tree counts each's"


@dataclass(frozen=True)
class Row:
    """A number under the heading of its `group`, None where the frame has none; it may be a part of a `whole`.  One
    that is 0 is left out unless it is shown `always`."""

    group: str
    name: str
    number: float | None
    tip: str = ""
    whole: int | None = None
    digits: int = 0
    unit: str = ""
    always: bool = False

    @property
    def is_shown(self) -> bool:
        return self.always or bool(self.number and round(abs(self.number), self.digits))

    @property
    def share(self) -> str:
        return percent(self.number or 0, self.whole) if self.whole is not None else ""

    def text(self, number: float | None, signed: bool = False) -> str:
        """Return a number as this row writes it."""
        if number is None:
            return "-"
        body = count(abs(number)) if not self.digits else f"{abs(number):,.{self.digits}f}"
        sign = "" if not round(abs(number), self.digits) else "-" if number < 0.0 else "+" if signed else ""
        return f"{sign}{body}{self.unit}"


def rows(frame: Frame) -> list[Row]:
    """Return what there is to say of a frame."""
    s = frame.statistics
    return [row for row in _rows(frame, partial(seconds_of, s)) if row.is_shown]


def regret_of(frame: Frame) -> int | None:
    """Return how many rays of a frame were traced that could be proved, if anybody has asked for that."""
    found = frame.layers.get(REGRET)
    return None if found is None else int(found[found > 0].sum())


def primary_due(frame: Frame) -> int:
    """Return how many shadow rays of primary hits are due, 0 unless the frame has recorded what became of them."""
    return 0 if frame.fates is None else int(np.count_nonzero(frame.fates & FATE >= Fate.CULLED))


def beside(a: Frame, b: Frame, timed: InTurn | None = None) -> list[tuple[Row, Row]]:
    """Return the rows of two frames, in pairs; what neither has is left out.

    Times are medians of frames in turn, where there are any by both methods: single frames vary by more than methods
    differ."""
    methods = a.settings.method, b.settings.method
    if timed is None or not timed.tells or not set(methods) <= set(timed.methods):
        tip, timed = NO_TIME, None
    else:
        tip = f"medians of {timed.count} whole frames by each method, in turn, while nothing else was to be done"
        speed = timed.speed(methods[1], methods[0])
        tip += f"; B is {speed.median:.2f} ± {speed.margin:.2f} times as fast as A"
    seconds = [partial(timed.seconds, method) if timed is not None else lambda phase: None for method in methods]
    pairs = zip(_rows(a, seconds[0], tip), _rows(b, seconds[1], tip), strict=True)
    return [(one, other) for one, other in pairs if one.is_shown or other.is_shown]


def change(a: Row, b: Row) -> tuple[str, str]:
    """Return B - A, and that in per cent of A."""
    if a.number is None or b.number is None:
        return "-", "-"
    apart = b.number - a.number
    if not a.number:
        return b.text(apart, signed=True), "-"
    share = 100.0 * apart / a.number
    return b.text(apart, signed=True), f"{share:+,.{1 if abs(share) < 1000.0 else 0}f} %" if share else "0 %"


def _rows(frame: Frame, seconds: Seconds, tip: str = "from the request to the picture; below, its parts") -> list[Row]:
    """Return all rows, the same for every frame, so that those of two can be paired."""
    return [*_shadow_rays(frame), *_work(frame), *_times(frame, seconds, tip)]


def _shadow_rays(frame: Frame) -> Iterator[Row]:
    """What became of the shadow rays of the first sample, and what is wrong in all samples."""
    s, shadow = frame.statistics, frame.statistics.shadow
    pixels = frame.primitive.size
    shaded = round(pixels * s.part)

    def term(term: str, number: int | None, whole: int | None = None, always: bool = False) -> Row:
        return Row(RAYS, term.capitalize(), number, terms.MEANINGS[term], whole, always=always)

    partly = f"{whole_percent(s.part)} so far; all counts but those of primary rays and occlusion tests are theirs"
    yield Row(RAYS, "Shaded pixels", None if s.part >= 1.0 else shaded, partly, pixels)
    yield term(terms.DUE, shadow.due, always=True)
    yield Row(RAYS, "  per pixel", shadow.due / max(shaded, 1), "of those that are shaded", digits=2)
    yield term(terms.SAVED, shadow.saved, shadow.due, always=True)
    yield term(terms.CULLED, shadow.culled, shadow.due, always=True)
    yield term(terms.DYNAMIC_ONLY, shadow.dynamic_only, shadow.due, always=True)
    yield term(terms.CANDIDATES_ONLY, shadow.candidates_only, shadow.due)
    yield term(terms.CACHE_HITS, shadow.cache_hits, shadow.due)
    yield term(terms.TRACED, shadow.traced, shadow.due, always=True)
    could = "of primary hits: traced, although the smallest cell there can be proved; a share of those due, the ceiling"
    yield Row(RAYS, "Regret", regret_of(frame), could, primary_due(frame))
    yield term(terms.PASSED_OVER, shadow.passed_over)
    wrong, by_lights = s.wrong, s.cuts is None
    of_pixels = terms.WRONG_PIXELS if by_lights else terms.BEYOND
    for name, found, whole in (
        (terms.WRONG, wrong.answers if wrong and by_lights else None, wrong.due if wrong else 0),
        (of_pixels, wrong.pixels if wrong else None, wrong.shaded if wrong else 0),
    ):
        yield Row(RAYS, name.capitalize(), found, terms.MEANINGS[name], whole, always=found is not None)
    samples = wrong.samples if wrong and wrong.samples > 1 else None
    yield Row(RAYS, "  in samples", samples, "wrong answers are counted in all of them, all else in the first")


def _work(frame: Frame) -> Iterator[Row]:
    """Rays, steps and tests, and those of what the method makes."""
    s, method = frame.statistics, frame.settings.method
    packets = _PACKETS if frame.settings.accelerator == BVH8 else ""

    def rays(name: str, number: int, counts: RayCounts, tip: str) -> Iterator[Row]:
        yield Row(WORK, f"{name} rays", number, tip, always=True)
        yield Row(WORK, "  steps", counts.traversal_steps, f"{_STEPS}{packets}")
        yield Row(WORK, "  tests", counts.intersection_tests, f"{_TESTS}{packets}")

    yield from rays("Primary", s.primary.rays, s.primary, "from the camera, through all pixels")
    yield from rays("Secondary", s.secondary.rays, s.secondary, "reflected and refracted")
    yield from rays("Shadow", s.shadow.traced, s.shadow, terms.traced_shadow_rays(s.shadow))
    made, meaning = terms.made(method)
    yield Row(WORK, made.capitalize(), s.certificates if made else None, meaning, always=bool(made))
    yield Row(WORK, "  steps", s.certificate_steps if made else None, f"{_STEPS}, that this took")
    yield Row(WORK, "  tests", s.certificate_tests if made else None, f"{_TESTS}, that this took")
    kinds = s.primary, s.secondary, s.shadow
    yield Row(WORK, "All steps", s.certificate_steps + sum(kind.traversal_steps for kind in kinds), _STEPS, always=True)
    yield Row(
        WORK, "All tests", s.certificate_tests + sum(kind.intersection_tests for kind in kinds), _TESTS, always=True
    )
    tests = s.occlusion_tests if Method.parse(method).uses_modes else None
    yield Row(WORK, "Occlusion tests", tests, "whether a primitive hides that of a neighbouring pixel (§2.3)")
    per_pixel = None if tests is None else tests / frame.primitive.size
    yield Row(WORK, "  per pixel", per_pixel, "of all pixels", digits=3)
    built = s.built
    yield Row(
        WORK, terms.BUILT.capitalize(), built.primitives if built else None, terms.MEANINGS[terms.BUILT],
        built.of if built else None,
    )  # fmt: skip
    memory = f"in {built.memory_bytes / 1e6:.1f} MB, with what waits for rays" if built else ""
    yield Row(WORK, "  nodes", built.nodes if built else None, memory)


def _times(frame: Frame, seconds: Seconds, tip: str) -> Iterator[Row]:
    def row(name: str, phase: str, tip: str) -> Row:
        found = seconds(phase)
        return Row(TIME, name, None if found is None else 1e3 * found, tip, digits=1, unit=" ms", always=not phase)

    yield row("Frame", "", tip)
    for name in terms.PHASES:
        label, what = terms.phase(name, frame.settings)
        yield row(f"  {label}", name, what)
