"""How much of a picture is traced before it is shown, so that frames come as fast as they should.

Each picture begins with its primary rays at full resolution and with some sixteenths of its pixels shaded, the rest
filled in from them; then it becomes whole.  How many sixteenths fit into the time of a frame follows from what the last
frames have cost: a fixed part, a part for each primary ray and a part for each shaded pixel, estimated separately, and
the rest of the frame (placing objects, making certificates).  Pixels are estimated apart for each number of samples
that lamps have.  Only where the primary rays alone do not fit is the
resolution divided by 2, 3, ... as well; before that, frames take a little longer than they should.  More is traced only
with some time to spare, so that pictures do not flutter between two steps.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tracer.shading.blocks import TURNS
from tracer.statistics import FrameStatistics

PARTS = (16, 12, 8, 6, 4, 2, 1, 0.5)  # sixteenths of the pixels that the first picture may have
LARGEST_DIVISOR = 8
SPARE = 0.95  # of a frame's time that a finer step may take
# How much longer than it should what comes before shading may take before the resolution falls, and rises again.
LENIENCE, REGAINED = 1.75, 1.25
SOON = 0.3  # seconds that a whole picture may take without a part of it being shown, where nothing moves
SHOWN_AGAIN = 0.5  # seconds that it takes at least until a picture that becomes whole is shown again
KEPT, FORGETTING = 24, 0.8  # observations, and what each counts against the one after it
TRUST = 0.05  # in how costs were divided before, against all that was observed
SMOOTHING = 0.4
LAMP_SAMPLE = 0.6  # of a pixel's cost by points, that each further sample of lamps adds until it has been observed
MOVING_SAMPLES, FEWEST_SAMPLES = 4, 1  # of lamps in motion, where there is time and where there is none
LEAST_PART = 4  # sixteenths of the pixels that there must be time for with the former
STALLED = 10.0  # times what a frame should take, after which one alone is not believed
PRIMARY, UNSHADED, SHADING = ("primary",), ("surfaces", "filling"), ("shading",)
BESIDE = ("place", "occlusion testing", "certification", "mode setting")


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
        self._seen = [*self._seen[1 - KEPT :], (number, seconds)]
        numbers, taken = np.array(self._seen).T
        weights = FORGETTING ** np.arange(len(taken))[::-1]
        before = self.fixed + self.each * numbers
        scale = float((weights * taken * before).sum() / max((weights * before * before).sum(), 1e-30))
        parts = scale * self.fixed, scale * self.each
        unit = max(float(numbers.mean()), 1.0)  # so that both unknowns are seconds
        rows = np.stack([np.ones_like(numbers), numbers / unit], axis=1)
        weighted = rows * weights[:, None]
        system = weighted.T @ rows + TRUST * weights.sum() * np.eye(2)
        known = weighted.T @ taken + TRUST * weights.sum() * np.array([parts[0], parts[1] * unit])
        fixed, each = np.maximum(np.linalg.solve(system, known), 0.0)
        self.fixed, self.each = float(fixed), float(each) / unit


class Governor:
    """Plans pictures by what frames have cost."""

    def __init__(self) -> None:
        self.forget()

    def forget(self) -> None:
        """Another scene costs something else."""
        self._primary, self._unshaded = Cost(3e-3, 3e-8), Cost(1e-3, 3e-8)
        self._shading = {1: Cost(5e-3, 6e-7)}  # by samples of lamps
        self._moving_samples = MOVING_SAMPLES
        self._beside = 0.0
        self._finest = 0.0  # pixels that the last plan shaded
        self._known, self._stalled, self._last_divisor = False, False, 1

    def observe(self, statistics: FrameStatistics, pixels: int, lamp_samples: int = 1) -> None:
        """Learn from a frame of so many pixels, or the first part of one, whose lamps have so many samples."""
        phases = statistics.phases
        if pixels <= 0 or "shading" not in phases:
            return
        taken, expected = sum(phases.values()), self.seconds(pixels, TURNS * statistics.part, lamp_samples)
        self._stalled = self._known and not self._stalled and taken > STALLED * expected + SOON
        if self._stalled:  # the machine was asleep, or is much slower from now on: the next frame tells which
            return
        self._primary.observe(pixels, _sum(phases, PRIMARY))
        if "surfaces" in phases:  # else it was whole at once, without what parts need
            self._unshaded.observe(pixels, _sum(phases, UNSHADED))
        self._shading[lamp_samples] = shading = self._shading_with(lamp_samples)
        shading.observe(pixels * statistics.part, _sum(phases, SHADING))
        beside = _sum(phases, BESIDE)
        self._beside = self._beside + SMOOTHING * (beside - self._beside) if self._known else beside
        self._known = True

    def seconds(self, pixels: float, part: float, lamp_samples: int = 1) -> float:
        """What a picture of so many pixels takes until it is shown with so many sixteenths of them shaded."""
        return self._unavoidable(pixels, part) + self._shading_with(lamp_samples)(pixels * part / TURNS)

    def _shading_with(self, lamp_samples: int) -> Cost:
        """The cost of shaded pixels; unless it has been observed, by that of the next smaller number of samples, or of
        the smallest."""
        known = self._shading.get(lamp_samples)
        if known is not None:
            return known
        near = max((samples for samples in self._shading if samples < lamp_samples), default=min(self._shading))
        more = (1.0 + LAMP_SAMPLE * (lamp_samples - 1)) / (1.0 + LAMP_SAMPLE * (near - 1))
        return Cost(self._shading[near].fixed, more * self._shading[near].each)

    def moving_samples(self, width: int, height: int, seconds: float) -> int:
        """Samples of lamps in motion, where a picture is to be shown so many seconds later.  The answer changes only
        with some time to spare, as modes are lost with it."""
        lenience = LENIENCE if self._moving_samples == MOVING_SAMPLES else SPARE
        fits = self.seconds(width * height, LEAST_PART, MOVING_SAMPLES) <= lenience * seconds
        self._moving_samples = MOVING_SAMPLES if fits else FEWEST_SAMPLES
        return self._moving_samples

    def _unavoidable(self, pixels: float, part: float = 0.0) -> float:
        """What it takes before anything is shaded; nothing is filled in where all is."""
        return self._beside + self._primary(pixels) + (self._unshaded(pixels) if part < TURNS else 0.0)

    def plan(
        self,
        width: int,
        height: int,
        seconds: float,
        coarse: bool = True,
        playing: bool = True,
        lamp_samples: int = 1,
    ) -> Plan:
        """How to begin a picture that is to be shown so many seconds later, and how to go on; at full resolution unless
        it may be a `coarse` one, and at once where nothing moves and the whole does not take long."""
        divisor = self._divisor(width, height, seconds) if coarse else 1
        if not coarse and not playing and self.seconds(width * height, TURNS, lamp_samples) <= SOON:
            return AT_ONCE
        w, h = divided(width, height, divisor)
        for part in PARTS:
            shaded = w * h * part / TURNS
            if self.seconds(w * h, part, lamp_samples) <= (seconds if shaded <= self._finest else SPARE * seconds):
                break
        self._finest = shaded
        return Plan(divisor, self._onward(w * h, part, self._shading_with(lamp_samples)))

    def _divisor(self, width: int, height: int, seconds: float) -> int:
        """The finest resolution whose primary rays fit into so many seconds."""
        for divisor in range(1, LARGEST_DIVISOR):
            w, h = divided(width, height, divisor)
            limit = (LENIENCE if divisor >= self._last_divisor else REGAINED) * seconds
            if self._unavoidable(w * h) <= limit:
                break
        else:
            divisor = LARGEST_DIVISOR
        self._last_divisor = divisor
        return divisor

    def _onward(self, pixels: int, part: float, shading: Cost) -> tuple[float, ...]:
        """From a part to the whole, in steps that are worth showing."""
        parts, more = [part], part
        while more < TURNS:
            more = min(2 * more, TURNS)
            if more == TURNS or shading(pixels * (more - parts[-1]) / TURNS) > SHOWN_AGAIN:
                parts.append(more)
        return tuple(parts)


def _sum(phases: dict[str, float], names: tuple[str, ...]) -> float:
    return sum(phases.get(name, 0.0) for name in names)


def divided(width: int, height: int, divisor: int) -> tuple[int, int]:
    """The size of a frame that is coarser by `divisor`, never empty."""
    return max(1, round(width / divisor)), max(1, round(height / divisor))
