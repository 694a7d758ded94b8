"""How long a piece of work will still take, from how long its steps have taken so far."""

from __future__ import annotations

import time
from bisect import bisect_left
from collections.abc import Callable
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
        self._done: list[int] = []
        self._at: list[float] = []

    def mark(self, done: int, total: int) -> None:
        """So many steps of `total` are done now."""
        self._total = total
        self._at.append(self._clock())
        self._done.append(done)

    def seconds(self) -> float | None:
        """What is left, counting the step under way as one like the others; None before the first step is done."""
        if not self._done or self._done[-1] == self._done[0]:
            return None
        done, left = self._done[-1], self._total - self._done[-1]
        first = bisect_left(self._done, done - max(left, self.FEWEST))
        pace = self._pace(first)
        return left * pace - min(self._clock() - self._at[-1], pace) if left else 0.0

    def _pace(self, first: int) -> float:
        """Seconds for a step, of those since mark `first`."""
        marks = range(first + 1, len(self._at))
        steps = [(self._done[n] - self._done[n - 1], self._at[n] - self._at[n - 1]) for n in marks]
        paces = [seconds / count for count, seconds in steps if count]
        longest = self.LONGEST * median(paces)
        return sum(min(seconds, longest * max(count, 1)) for count, seconds in steps) / sum(count for count, _ in steps)
