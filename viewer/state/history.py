"""What is kept of past frames: counters to plot, records to go back to, and how many come in a second.

Each series of counters is kept twice in one buffer, half its length apart, so that the newest values are always one
contiguous slice, which is what ImPlot reads without a copy.
"""

from __future__ import annotations

from collections import defaultdict, deque
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tracer.frame import Frame, Settings
from tracer.scene.camera import Camera
from tracer.statistics import SampleCounts
from viewer.state.view_state import ViewState

CAPACITY = 600
MOST_RECORDS = 10_000
"""Frames that can be gone back to, the newest."""
RATE_SECONDS = 1.0
"""Seconds back that frames count for their rate, or as far as the last two reach."""

_OF_ALL = {
    "steps": "steps_of_all",
    "tests": "tests_of_all",
    "shadow_steps": "certificate_steps",
    "shadow_tests": "certificate_tests",
}
"""What is part of a series, and done for all pixels, however many of them are shaded: primary rays and proofs."""


def counters(frame: Frame, drawn_seconds: float) -> dict[str, float]:
    """Return a frame's numbers by the names of their series; `drawn_seconds` is what the window needed for its last own
    frame.

    Steps and tests are all that were made for the frame, those of its certificates too.  Samples of lights are those of
    primary hits, 0 where they were not recorded.  `pixels` are those that are shaded, of `all_pixels`.  `built` is the
    part of the tree that is built, in per cent; 0 where that is not told."""
    s = frame.statistics
    samples = s.samples or SampleCounts()
    return {
        "due": s.shadow.due,
        "culled": s.shadow.culled,
        "dynamic_only": s.shadow.dynamic_only,
        "candidates_only": s.shadow.candidates_only,
        "cache_hits": s.shadow.cache_hits,
        "traced": s.shadow.traced,
        "steps": s.traversal_steps + s.certificate_steps,
        "tests": s.intersection_tests + s.certificate_tests,
        "shadow_steps": s.shadow.traversal_steps + s.certificate_steps,
        "shadow_tests": s.shadow.intersection_tests + s.certificate_tests,
        "samples_due": samples.due,
        "samples_reached": samples.reached,
        "penumbra": samples.penumbra,
        "pixels": frame.width * frame.height * s.part,
        "all_pixels": frame.width * frame.height,
        "steps_of_all": s.primary.traversal_steps + s.certificate_steps,
        "tests_of_all": s.primary.intersection_tests + s.certificate_tests,
        "certificate_steps": s.certificate_steps,
        "certificate_tests": s.certificate_tests,
        "built": 100.0 * s.built.share if s.built is not None else 0.0,
        "traced_ms": 1e3 * s.seconds,
        "drawn_ms": 1e3 * drawn_seconds,
    }


class History:
    """Ring buffers of float64, one for each of the `counters`; `frames` counts all that were ever added."""

    def __init__(self, capacity: int = CAPACITY) -> None:
        self.capacity = capacity
        self.frames = self._hidden = 0
        self._values: dict[str, NDArray[np.float64]] = defaultdict(lambda: np.zeros(2 * capacity))

    def add(self, frame: Frame, drawn_seconds: float, again: bool = False) -> None:
        """Append one traced frame's numbers, or put them in the place of the last where it is that frame `again`, with
        more of its pixels shaded."""
        if again and self.frames > 0:
            self.frames -= 1
        at = self.frames % self.capacity
        for name, value in counters(frame, drawn_seconds).items():
            self._values[name][at] = self._values[name][at + self.capacity] = value
        self.frames += 1

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


@dataclass(frozen=True)
class FrameRecord:
    """What it takes to come back to a traced frame, by its `number` in the plots.

    `camera` is where it was seen from; `state` has the settings that were chosen, `settings` are those that the frame
    was traced with; `size` is that of the window's picture then, of which this may be a coarser version; `whole` says
    that all of its pixels were shaded, so that it set modes."""

    number: int
    state: ViewState
    camera: Camera
    settings: Settings
    size: tuple[int, int]
    whole: bool


class FrameRecords:
    """The last MOST_RECORDS frames."""

    def __init__(self, most: int = MOST_RECORDS) -> None:
        self._kept: dict[int, FrameRecord] = {}
        self._most = most

    def put(self, record: FrameRecord) -> None:
        """Keep a frame; it takes the place of those with its number and later ones."""
        while self._kept and next(reversed(self._kept)) >= record.number:
            self._kept.popitem()
        self._kept[record.number] = record
        if len(self._kept) > self._most:
            del self._kept[next(iter(self._kept))]

    def get(self, number: int) -> FrameRecord | None:
        """Return the frame of this number; None where it is not kept."""
        return self._kept.get(number)

    def clear(self) -> None:
        self._kept.clear()


class FrameRate:
    """Times of the newest frames, in seconds."""

    def __init__(self) -> None:
        self._came: deque[float] = deque()

    def count(self, now: float) -> None:
        """Note that a frame has come."""
        self._came.append(now)
        while len(self._came) > 2 and self._came[0] < now - RATE_SECONDS:
            self._came.popleft()

    def per_second(self, now: float) -> float | None:
        """Return frames a second, None while none are coming: before the second, and when the next is long overdue."""
        if len(self._came) < 2:
            return None
        first, last = self._came[0], self._came[-1]
        apart = (last - first) / (len(self._came) - 1)
        return 1.0 / apart if apart > 0.0 and now - last <= max(RATE_SECONDS, 2.0 * apart) else None

    def clear(self) -> None:
        self._came.clear()


def rate_in_words(rate: float) -> str:
    """Return frames a second as text; nothing where so few come that it would read 0.0."""
    shown = f"{rate:.0f}" if rate >= 9.5 else f"{rate:.1f}"
    return f"{shown} frames/s" if shown != "0.0" else ""
