"""How far work in several processes is, and how long it will take still, judged by what it has taken so far.

Shares say how the steps compare with each other; how fast the machine is they do not say.  That is learnt from the
steps that are done; until then a usual machine's pace makes the bar move, and no time left is told.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Collection, Mapping, Sequence

_ALMOST = 0.95  # of a step, at most, counts as done while it is under way
_ON_TIME = 0.8  # of what a step should take, until which the bar moves evenly


class Estimate:
    """`parts` names the steps that one process does one after another, in the order in which parts are begun;
    `shares` is how much of all the work each step is, `slots` how many processes work at once, and `usual` what all
    the work takes one process on a usual machine.  Times are seconds."""

    def __init__(
        self,
        parts: Mapping[str, Sequence[str]],
        shares: Mapping[str, float],
        slots: int,
        usual: float = math.inf,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._parts, self._shares, self._slots, self._clock = parts, shares, slots, clock
        self._usual = usual
        self._began: dict[str, float] = {}
        self._took: dict[str, float] = {}
        self._fraction = 0.0

    def begin(self, step: str) -> None:
        """A step has just been begun."""
        self._began[step] = self._clock()

    def end(self, step: str) -> None:
        """A step is done; raises KeyError for one that was never begun."""
        self._took[step] = self._clock() - self._began.pop(step)

    @property
    def pace(self) -> float | None:
        """Seconds that all the work would take one process, going by the steps that are done; None before any is."""
        known = sum(self._shares[step] for step in self._took)
        return sum(self._took.values()) / known if known > 0.0 else None

    @property
    def fraction(self) -> float:
        """How much of the work is done, from 0 to 1; never less than it was.  A step that takes longer than it should
        goes on ever more slowly, and is not done before it ends."""
        pace, now = self.pace or self._usual, self._clock()
        done = sum(self._shares[step] for step in self._took)
        for step, at in self._began.items():
            done += self._shares[step] * _part((now - at) / (pace * self._shares[step]))
        self._fraction = max(self._fraction, min(done, 1.0))
        return self._fraction

    def seconds_left(self, wanted: Collection[str] | None = None) -> float | None:
        """Until these parts (all, unless told) are done, when parts are begun in their order as processes become free;
        None while unknown."""
        pace = self.pace
        if pace is None:
            return None
        ends = {part: self._work_left(part, pace) for part in self._parts if self._begun(part)}
        free = sorted(ends.values())[-self._slots :]
        free += [0.0] * (self._slots - len(free))
        for part in self._parts:
            if part not in ends:
                soonest = free.index(min(free))
                free[soonest] += self._work_left(part, pace)
                ends[part] = free[soonest]
        return max(end for part, end in ends.items() if wanted is None or part in wanted)

    def _begun(self, part: str) -> bool:
        return any(step in self._began or step in self._took for step in self._parts[part])

    def _work_left(self, part: str, pace: float) -> float:
        """Seconds of work."""
        now, left = self._clock(), 0.0
        for step in self._parts[part]:
            if step not in self._took:
                whole = self._shares[step] * pace
                left += whole - min(now - self._began.get(step, now), _ALMOST * whole)
        return left


def _part(elapsed: float) -> float:
    """How much of a step is done after so many times what it should take: evenly at first, then ever more slowly."""
    if elapsed <= _ON_TIME:
        return elapsed
    room = _ALMOST - _ON_TIME
    return _ALMOST - room * math.exp((_ON_TIME - elapsed) / room)
