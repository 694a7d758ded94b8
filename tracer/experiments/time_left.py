"""How long a piece of work will still take, from how long its steps have taken so far."""

from __future__ import annotations

import time
from bisect import bisect_left
from collections.abc import Callable
from itertools import pairwise
from statistics import median


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
