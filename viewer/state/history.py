"""The last frames' numbers, ready to plot.

Each series is kept twice in one buffer, half its length apart, so that the newest values are
always one contiguous slice, which is what ImPlot reads without a copy.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tracer.frame import Frame
from tracer.statistics import SampleCounts, ShadowCounts

CAPACITY = 600

SERIES = (
    "due",
    "culled",
    "dynamic_only",
    "candidates_only",
    "cache_hits",
    "traced",
    "steps",
    "tests",
    "shadow_steps",
    "shadow_tests",
    "samples_due",
    "samples_reached",
    "penumbra",
    "pixels",
    "traced_ms",
    "drawn_ms",
)


def fully_traced(shadow: ShadowCounts) -> int:
    """Shadow rays that were due and that nothing was known of."""
    return shadow.due - shadow.culled - shadow.candidates_only - shadow.dynamic_only - shadow.cache_hits


class History:
    """Ring buffers of float64, one per name of `SERIES`; `frames` counts all that were ever added."""

    def __init__(self, capacity: int = CAPACITY) -> None:
        self.capacity = capacity
        self.frames = self._hidden = 0
        self._values = {name: np.zeros(2 * capacity) for name in SERIES}

    def add(self, frame: Frame, drawn_seconds: float, again: bool = False) -> None:
        """Append one traced frame's numbers, or put them in the place of the last where it is that frame `again`, with
        more of its pixels shaded; `drawn_seconds` is what the window needed for its last own frame.

        Steps and tests are all that were made for the frame, those of its certificates too.  Samples of lights are
        those of primary hits, 0 where they were not recorded."""
        if again and self.frames > 0:
            self.frames -= 1
        s = frame.statistics
        parts, samples = (s.primary, s.secondary, s.shadow), s.samples or SampleCounts()
        self._put(
            due=s.shadow.due,
            culled=s.shadow.culled,
            dynamic_only=s.shadow.dynamic_only,
            candidates_only=s.shadow.candidates_only,
            cache_hits=s.shadow.cache_hits,
            traced=fully_traced(s.shadow),
            steps=sum(p.traversal_steps for p in parts) + s.certificate_steps,
            tests=sum(p.intersection_tests for p in parts) + s.certificate_tests,
            shadow_steps=s.shadow.traversal_steps + s.certificate_steps,
            shadow_tests=s.shadow.intersection_tests + s.certificate_tests,
            samples_due=samples.due,
            samples_reached=samples.reached,
            penumbra=samples.penumbra,
            pixels=frame.width * frame.height * s.part,
            traced_ms=1e3 * s.seconds,
            drawn_ms=1e3 * drawn_seconds,
        )

    def clear(self) -> None:
        """Begin to count anew."""
        self.frames = self._hidden = 0

    def hide(self) -> None:
        """Keep what comes from here on; frames keep their numbers."""
        self._hidden = self.frames

    def __len__(self) -> int:
        return min(max(self.frames - self._hidden, 0), self.capacity)

    @property
    def first(self) -> int:
        """Number of the oldest frame that is kept."""
        return self.frames - len(self)

    def values(self, name: str) -> NDArray[np.float64]:
        """The kept values of a series, oldest first, contiguous."""
        end = self.capacity + self.frames % self.capacity if self.frames > self.capacity else self.frames
        return self._values[name][end - len(self) : end]

    def _put(self, **numbers: float) -> None:
        at = self.frames % self.capacity
        for name, value in numbers.items():
            self._values[name][at] = self._values[name][at + self.capacity] = value
        self.frames += 1
