"""What the same picture takes by several methods that trace it in turn, many times: medians, and how far they vary.

A single frame's time says little, as whatever else the machine does is in it.  Frames in turn share that, so that the
ratio of two neighbours varies less than either, and the median of many ratios less still.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from tracer.statistics import FrameStatistics

TWO_ERRORS = 2.0 * 1.2533 / 1.349
"""Twice the standard error of a median, as a part of the quartiles' distance by the root of the number: normal numbers
have quartiles 1.349 standard deviations apart, and medians with 1.2533 times the error of the mean."""
LEAST = 8
"""Rounds from which on a median tells something."""


@dataclass(frozen=True)
class Spread:
    """A median of so many numbers, with the quartiles, and the margin within which it is known."""

    median: float
    low: float
    high: float
    count: int

    @staticmethod
    def of(numbers: Iterable[float]) -> Spread:
        """The spread of one number at least."""
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
        """All frames by a method, the first one first."""
        at = self.methods.index(method)
        return [one[at] for one in self.rounds]

    def seconds(self, method: str, phase: str = "") -> Spread | None:
        """Of a frame by a method, or of one of its phases; None where it has none."""
        found = [one.phases.get(phase) if phase else one.seconds for one in self.frames(method)]
        known = [seconds for seconds in found if seconds is not None]
        return Spread.of(known) if known else None

    def speed(self, method: str, other: str) -> Spread | None:
        """How many times as fast as another a method is; None before the first round."""
        if not self.rounds:
            return None
        mine, its = self.methods.index(method), self.methods.index(other)
        return Spread.of(one[its].seconds / one[mine].seconds for one in self.rounds)

    def steps(self, method: str) -> int | None:
        """Nodes that rays of all kinds enter in a frame, the last; None before there is one."""
        return self.frames(method)[-1].traversal_steps if self.rounds else None
