"""The last frames' numbers, ready to plot.

Each series is kept twice in one buffer, half its length apart, so that the newest values are
always one contiguous slice, which is what ImPlot reads without a copy.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tracer.frame import Frame
from tracer.statistics import SampleCounts

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
    "all_pixels",
    "steps_of_all",
    "tests_of_all",
    "certificate_steps",
    "certificate_tests",
    "built",
    "traced_ms",
    "drawn_ms",
)

_OF_ALL = {
    "steps": "steps_of_all",
    "tests": "tests_of_all",
    "shadow_steps": "certificate_steps",
    "shadow_tests": "certificate_tests",
}
"""What is part of a series, and done for all pixels, however many of them are shaded: primary rays and proofs."""


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
        those of primary hits, 0 where they were not recorded.  `pixels` are those that are shaded, of `all_pixels`.
        `built` is the part of the tree that is built, in per cent; 0 where that is not told."""
        if again and self.frames > 0:
            self.frames -= 1
        s = frame.statistics
        samples = s.samples or SampleCounts()
        self._put(
            due=s.shadow.due,
            culled=s.shadow.culled,
            dynamic_only=s.shadow.dynamic_only,
            candidates_only=s.shadow.candidates_only,
            cache_hits=s.shadow.cache_hits,
            traced=s.shadow.traced,
            steps=s.traversal_steps + s.certificate_steps,
            tests=s.intersection_tests + s.certificate_tests,
            shadow_steps=s.shadow.traversal_steps + s.certificate_steps,
            shadow_tests=s.shadow.intersection_tests + s.certificate_tests,
            samples_due=samples.due,
            samples_reached=samples.reached,
            penumbra=samples.penumbra,
            pixels=frame.width * frame.height * s.part,
            all_pixels=frame.width * frame.height,
            steps_of_all=s.primary.traversal_steps + s.certificate_steps,
            tests_of_all=s.primary.intersection_tests + s.certificate_tests,
            certificate_steps=s.certificate_steps,
            certificate_tests=s.certificate_tests,
            built=100.0 * s.built.share if s.built is not None else 0.0,
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

    def per_pixel(self, name: str) -> NDArray[np.float64]:
        """A series for each pixel, so that frames compare of which only a part is shaded yet: what is done for all
        pixels is shared by all, the rest by those that are shaded."""
        of_all = self.values(_OF_ALL[name]) if name in _OF_ALL else 0.0
        shaded, every = (np.maximum(self.values(pixels), 1.0) for pixels in ("pixels", "all_pixels"))
        return (self.values(name) - of_all) / shaded + of_all / every

    def shaded(self) -> NDArray[np.float64]:
        """The part of each frame's pixels that is shaded, 0 to 1."""
        return self.values("pixels") / np.maximum(self.values("all_pixels"), 1.0)

    def shaded_of(self, number: int) -> float:
        """That part of one frame by its number; 1 for one that is no longer kept."""
        place = number - self.first
        return float(self.shaded()[place]) if 0 <= place < len(self) else 1.0

    def _put(self, **numbers: float) -> None:
        at = self.frames % self.capacity
        for name, value in numbers.items():
            self._values[name][at] = self._values[name][at + self.capacity] = value
        self.frames += 1
