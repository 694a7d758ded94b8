"""How much of a frame is traced before it is shown, so that frames come as fast as they should.

Each frame begins with its primary rays at full resolution and with some sixteenths of its pixels shaded, the rest
filled in from them; then it becomes whole. How many sixteenths fit into the time of a frame follows from what the
last frames have cost: a fixed part, a part for each primary ray and a part for each shaded pixel, estimated
separately, and the rest of the frame (placing objects, making certificates). Shaded pixels are estimated apart for
each number of samples that lamps have. Only where the primary rays alone do not fit is the resolution divided by 2,
3, ... as well; before that, frames take a little longer than they should. More is traced only with some time to
spare, so that pictures do not flutter between two steps."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tracer.shading.blocks import TURNS
from tracer.statistics import FrameStatistics

PARTS = (16, 12, 8, 6, 4, 2, 1, 0.5)
"""Sixteenths of the pixels that the first picture may have."""
LARGEST_DIVISOR = 8
FINER_BELOW = 0.95
"""Of a frame's time that a finer step may take."""
LOWER_RESOLUTION_ABOVE, RAISE_RESOLUTION_BELOW = 1.75, 1.25
"""Of a frame's time that primary rays and what comes before them may take until the resolution changes."""
WHOLE_AT_ONCE_SECONDS = 0.3
"""That a whole picture may take without a part of it being shown, where nothing moves."""
SHOWN_AGAIN_SECONDS = 0.5
"""That it takes at least until a picture that becomes whole is shown again."""
MOST_OBSERVED, WEIGHT_OF_OLDER = 24, 0.8
"""Observations of a cost, and what each counts against the one after it."""
WEIGHT_OF_SPLIT = 0.05
"""Of how costs were divided before, against all that was observed."""
SMOOTHING = 0.4
LAMP_SAMPLE_COST = 0.6
"""Of a pixel's cost by points, that each further sample of lamps adds until it has been observed."""
STALLED = 10.0
"""Times what a frame should take, after which one alone is not believed."""
PRIMARY, UNSHADED, SHADING = ("primary",), ("surfaces", "filling"), ("shading",)
OTHER_PHASES = ("place", "occlusion testing", "certification", "mode setting")


@dataclass(frozen=True)
class Plan:
    """The resolution's divisor, and the growing sixteenths of the pixels that are shaded when a picture is shown."""

    divisor: int
    parts: tuple[float, ...]


AT_ONCE = Plan(1, (TURNS,))


class Cost:
    """Seconds that something takes: a fixed part and one for each of many, by least squares over the last observations.

    Where all of these are of one number, the two parts keep the proportion that they had."""

    def __init__(self, fixed: float, each: float) -> None:
        """The parts to begin with, in seconds."""
        self.fixed, self.each = fixed, each
        self._seen: list[tuple[float, float]] = []

    def __call__(self, number: float) -> float:
        return self.fixed + self.each * number

    def observe(self, number: float, seconds: float) -> None:
        """Learn that so many took so long."""
        self._seen = [*self._seen[1 - MOST_OBSERVED :], (number, seconds)]
        numbers, taken = np.array(self._seen).T
        weights = WEIGHT_OF_OLDER ** np.arange(len(taken))[::-1]
        before = self(numbers)
        scale = float((weights * taken * before).sum() / max((weights * before * before).sum(), 1e-30))
        unit = max(float(numbers.mean()), 1.0)  # so that both unknowns are seconds
        rows = np.stack([np.ones_like(numbers), numbers / unit], axis=1)
        weighted, pull = rows * weights[:, None], WEIGHT_OF_SPLIT * weights.sum()
        known = weighted.T @ taken + pull * scale * np.array([self.fixed, self.each * unit])
        fixed, each = np.maximum(np.linalg.solve(weighted.T @ rows + pull * np.eye(2), known), 0.0)
        self.fixed, self.each = float(fixed), float(each) / unit


class FrameBudget:
    """Plans frames by what the last ones have cost."""

    def __init__(self) -> None:
        self.forget()

    def forget(self) -> None:
        """Begin anew: another scene costs something else."""
        self._primary, self._unshaded = Cost(3e-3, 3e-8), Cost(1e-3, 3e-8)
        self._shading = {1: Cost(5e-3, 6e-7)}  # by samples of lamps
        self._other_phases = 0.0
        self._finest = 0.0  # pixels that the last plan shaded
        self._known, self._stalled, self._last_divisor = False, False, 1

    def observe(self, statistics: FrameStatistics, pixels: int, lamp_samples: int = 1) -> None:
        """Learn from a frame of so many pixels, or the first part of one, whose lamps have so many samples."""
        phases = statistics.phases
        if pixels <= 0 or "shading" not in phases:
            return
        taken, expected = sum(phases.values()), self.seconds(pixels, TURNS * statistics.part, lamp_samples)
        late = taken > STALLED * expected + WHOLE_AT_ONCE_SECONDS
        self._stalled = self._known and not self._stalled and late
        if self._stalled:  # the machine was asleep, or is much slower from now on: the next frame tells which
            return
        self._primary.observe(pixels, _sum(phases, PRIMARY))
        if "surfaces" in phases:  # else it was whole at once, without what parts need
            self._unshaded.observe(pixels, _sum(phases, UNSHADED))
        self._shading[lamp_samples] = shading = self._shading_with(lamp_samples)
        shading.observe(pixels * statistics.part, _sum(phases, SHADING))
        other = _sum(phases, OTHER_PHASES)
        self._other_phases += (SMOOTHING if self._known else 1.0) * (other - self._other_phases)
        self._known = True

    def seconds(self, pixels: float, part: float, lamp_samples: int = 1) -> float:
        """Return what a picture of so many pixels takes until it is shown with so many sixteenths of them shaded."""
        return self._before_shading(pixels, part) + self._shading_with(lamp_samples)(pixels * part / TURNS)

    def _before_shading(self, pixels: float, part: float = 0.0) -> float:
        """Return what it takes before anything is shaded; nothing is filled in where all is."""
        return self._other_phases + self._primary(pixels) + (self._unshaded(pixels) if part < TURNS else 0.0)

    def _shading_with(self, lamp_samples: int) -> Cost:
        """Return the cost of shaded pixels; unless it has been observed, by that of the next smaller number of samples,
        or of the smallest."""
        known = self._shading.get(lamp_samples)
        if known is not None:
            return known
        near = max((samples for samples in self._shading if samples < lamp_samples), default=min(self._shading))
        more = (1.0 + LAMP_SAMPLE_COST * (lamp_samples - 1)) / (1.0 + LAMP_SAMPLE_COST * (near - 1))
        return Cost(self._shading[near].fixed, more * self._shading[near].each)

    def plan(
        self, width: int, height: int, seconds: float, coarse: bool = True, playing: bool = True,
        lamp_samples: int = 1,
    ) -> Plan:  # fmt: skip
        """Return how to begin a picture that is to be shown so many seconds later, and how to go on; at full resolution
        unless it may be a `coarse` one, and at once where nothing moves and the whole does not take long."""
        if not coarse and not playing and self.seconds(width * height, TURNS, lamp_samples) <= WHOLE_AT_ONCE_SECONDS:
            return AT_ONCE
        divisor = self._divisor(width, height, seconds) if coarse else 1
        w, h = divided(width, height, divisor)
        for part in PARTS:
            shaded = w * h * part / TURNS
            limit = seconds if shaded <= self._finest else FINER_BELOW * seconds
            if self.seconds(w * h, part, lamp_samples) <= limit:
                break
        self._finest = shaded
        return Plan(divisor, self._onward(w * h, part, self._shading_with(lamp_samples)))

    def _divisor(self, width: int, height: int, seconds: float) -> int:
        """Return the finest resolution whose primary rays fit into so many seconds."""
        for divisor in range(1, LARGEST_DIVISOR + 1):
            w, h = divided(width, height, divisor)
            limit = LOWER_RESOLUTION_ABOVE if divisor >= self._last_divisor else RAISE_RESOLUTION_BELOW
            if self._before_shading(w * h) <= limit * seconds:
                break
        self._last_divisor = divisor
        return divisor

    def _onward(self, pixels: int, part: float, shading: Cost) -> tuple[float, ...]:
        """Return the way from a part to the whole, in steps that are worth showing."""
        parts, more = [part], part
        while more < TURNS:
            more = min(2 * more, TURNS)
            if more == TURNS or shading(pixels * (more - parts[-1]) / TURNS) > SHOWN_AGAIN_SECONDS:
                parts.append(more)
        return tuple(parts)


def _sum(phases: dict[str, float], names: tuple[str, ...]) -> float:
    return sum(phases.get(name, 0.0) for name in names)


def divided(width: int, height: int, divisor: int) -> tuple[int, int]:
    """Return the size of a frame that is coarser by `divisor`, never empty."""
    return max(1, round(width / divisor)), max(1, round(height / divisor))
