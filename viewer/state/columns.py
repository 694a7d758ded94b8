"""The statistics of two frames in columns, with what the second has more or less than the first."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from tracer.frame import Frame
from viewer.state import terms
from viewer.state.in_turn import InTurn
from viewer.util.numbers import count


@dataclass(frozen=True)
class Row:
    """A figure of A and of B; None where the frame has none.  `heading` rows have a name only."""

    name: str
    tip: str = ""
    a: float | None = None
    b: float | None = None
    unit: str = ""
    digits: int = 0
    heading: bool = False

    @property
    def shows_any(self) -> bool:
        """Whether either figure is more than nothing, as it is written."""
        return any(number and round(abs(number), self.digits) for number in (self.a, self.b))

    @property
    def difference(self) -> float | None:
        """B - A."""
        return None if self.a is None or self.b is None else self.b - self.a

    @property
    def share(self) -> float | None:
        """The difference in per cent of A; None where A is nothing."""
        return None if self.difference is None or not self.a else 100.0 * self.difference / self.a

    def written(self, number: float | None, signed: bool = False) -> str:
        """One of the figures as text."""
        if number is None:
            return "-"
        body = count(abs(number)) if not self.digits else f"{abs(number):.{self.digits}f}"
        none = round(abs(number), self.digits) == 0.0
        sign = "" if none else "-" if number < 0.0 else "+" if signed else ""
        return f"{sign}{body}{self.unit}"

    @property
    def written_share(self) -> str:
        share = self.share
        if share is None:
            return "-"
        return f"{share:+,.{1 if abs(share) < 1000.0 else 0}f} %" if share else "0 %"


NO_TIME = (
    "known for two methods live, once the picture rests and both have traced it in turn: of two single frames nothing "
    "follows"
)


def rows(a: Frame, b: Frame, timed: InTurn | None = None) -> list[Row]:
    """All figures of two frames, in the words of the panel of statistics; what neither frame has is left out.

    Times are those of frames in turn, where there are any by both methods."""
    found = list(_rows(a, b, timed))
    kept = [row for row in found if row.heading or row.name in _ALWAYS or row.shows_any]
    return [row for i, row in enumerate(kept) if not row.heading or (i + 1 < len(kept) and not kept[i + 1].heading)]


_ALWAYS = (terms.DUE.capitalize(), terms.TRACED.capitalize(), "Frame")


def _rows(a: Frame, b: Frame, timed: InTurn | None) -> Iterator[Row]:
    s, t = a.statistics, b.statistics
    if a.statistics.part < 1.0 or b.statistics.part < 1.0:
        shaded = [round(one.primitive.size * one.statistics.part) for one in (a, b)]
        meaning = "so far; all counts but those of primary rays and occlusion tests are theirs"
        yield Row("Shaded pixels", meaning, shaded[0], shaded[1])
    yield Row("Shadow rays", heading=True)
    for term in (terms.DUE, terms.SAVED, terms.CULLED, terms.DYNAMIC_ONLY, terms.CANDIDATES_ONLY, terms.CACHE_HITS):
        field = {terms.CANDIDATES_ONLY: "candidates_only"}.get(term, term.replace(" ", "_"))
        yield Row(term.capitalize(), terms.MEANINGS[term], getattr(s.shadow, field), getattr(t.shadow, field))
    traced = s.shadow.traced, t.shadow.traced
    yield Row(terms.TRACED.capitalize(), terms.MEANINGS[terms.TRACED], *traced)
    found = [one.statistics.wrong for one in (a, b)]
    for term, of in ((terms.WRONG, "answers"), (terms.WRONG_PIXELS, "pixels")):
        wrong = [getattr(one, of) if one is not None else None for one in found]
        yield Row(term.capitalize(), terms.MEANINGS[term], wrong[0], wrong[1])
    yield Row(
        terms.PASSED_OVER.capitalize(), terms.MEANINGS[terms.PASSED_OVER], s.shadow.passed_over, t.shadow.passed_over
    )
    yield Row("Work", heading=True)
    for kind in ("primary", "secondary", "shadow"):
        ours, theirs = getattr(s, kind), getattr(t, kind)
        yield Row(f"{kind.capitalize()} rays", "those that were traced", ours.rays, theirs.rays)
        yield Row("  steps", f"nodes that {kind} rays entered", ours.traversal_steps, theirs.traversal_steps)
        tests = ours.intersection_tests, theirs.intersection_tests
        yield Row("  tests", f"of {kind} rays against primitives", *tests)
    yield Row("Occlusion tests", "whether a primitive hides that of a neighbour", s.occlusion_tests, t.occlusion_tests)
    made = {name: meaning for one in (a, b) for name, meaning in [terms.made(one.settings.method)] if name}
    if made:
        name = " and ".join(dict.fromkeys(made)).capitalize()
        yield Row(name, "; ".join(made.values()), s.certificates, t.certificates)
        yield Row("  steps", "that this took", s.certificate_steps, t.certificate_steps)
        yield Row("  tests", "that this took", s.certificate_tests, t.certificate_tests)
    yield Row("Time", heading=True)
    yield from _times(a, b, timed)


def _times(a: Frame, b: Frame, timed: InTurn | None) -> Iterator[Row]:
    """Medians of frames in turn: single frames vary by more than methods differ."""
    methods = a.settings.method, b.settings.method
    if timed is None or not timed.tells or not set(methods) <= set(timed.methods):
        yield Row("Frame", NO_TIME)
        return

    def median(method: str, phase: str = "") -> float | None:
        found = timed.seconds(method, phase)
        return 1e3 * found.median if found is not None else None

    speed = timed.speed(methods[1], methods[0])
    tip = f"medians of {timed.count} whole frames by each method, in turn, while nothing else was to be done"
    if speed is not None:
        tip += f"; B is {speed.median:.2f} ± {speed.margin:.2f} times as fast as A"
    yield Row("Frame", tip, median(methods[0]), median(methods[1]), " ms", 1)
    for name, (label, what) in terms.PHASES.items():
        yield Row(f"  {label}", what, median(methods[0], name), median(methods[1], name), " ms", 1)
