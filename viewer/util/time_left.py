"""How long a piece of work will still take, from how long its steps have taken so far."""

from __future__ import annotations

import time
from bisect import bisect_left
from collections.abc import Callable
from itertools import pairwise
from statistics import median


class TimeLeft:
    """How long steps of uneven length will still take.

    Steps that are near each other on a path take about as long: where n steps remain, the estimate uses the last n that
    were done, but at least FEWEST.
    """

    FEWEST = 8
    LONGEST = 20.0
    """Times the usual step: what took longer stood still, as when the machine slept, and counts no more than that."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._total = 0
        self._marks: list[tuple[int, float]] = []  # how many steps were done, and when: one append, as others read it

    def mark(self, done: int, total: int) -> None:
        """So many steps of `total` are done now."""
        self._total = total
        self._marks.append((done, self._clock()))

    def seconds(self) -> float | None:
        """What is left, counting the step under way as one like the others; None before the first step is done."""
        marks = self._marks[:]
        if not marks or marks[-1][0] == marks[0][0]:
            return None
        done, at = marks[-1]
        left = self._total - done
        first = bisect_left(marks, done - max(left, self.FEWEST), key=lambda mark: mark[0])
        pace = self._pace(marks[first:])
        return left * pace - min(self._clock() - at, pace) if left else 0.0

    def _pace(self, marks: list[tuple[int, float]]) -> float:
        """Seconds for a step, of those between the marks."""
        steps = [(done - before, at - then) for (before, then), (done, at) in pairwise(marks)]
        paces = [seconds / count for count, seconds in steps if count]
        longest = self.LONGEST * median(paces)
        return sum(min(seconds, longest * max(count, 1)) for count, seconds in steps) / sum(count for count, _ in steps)
