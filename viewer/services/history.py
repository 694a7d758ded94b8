"""The history of the frames that the window traces: their counters for the plots, and which of them set each mode."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Hashable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tracer.experiments.warmup_frames import WarmupFrame
from tracer.frame import Frame
from tracer.inspect.mode_origins import ModeOrigins, Origins
from tracer.state import ModeKey, mode_key
from tracer.statistics import SampleCounts
from viewer.services.render_request import RenderRequest, Traced
from viewer.state.session import Session
from viewer.state.view_state import ViewState
from viewer.state.views import has_modes_of_cells

PLOTTED_FRAMES = 600
KEPT_FRAMES = 10_000
"""Frames that can be gone back to, the newest."""
RATE_SECONDS = 1.0
"""Seconds back that frames count for their rate, or as far as the last two reach."""
KEPT_MODE_HISTORIES = 4
"""Mode histories, of resolutions and lamps, whose origins are known."""

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
    part of the tree that is built, in per cent; 0 where that is not told.  `came` is when it came, in seconds."""
    s = frame.statistics
    shadow, samples = s.shadow, s.samples or SampleCounts()
    return {
        "due": shadow.due,
        "culled": shadow.culled,
        "dynamic_only": shadow.dynamic_only,
        "candidates_only": shadow.candidates_only,
        "cache_hits": shadow.cache_hits,
        "traced": shadow.traced,
        "steps": s.traversal_steps + s.certificate_steps,
        "tests": s.intersection_tests + s.certificate_tests,
        "shadow_steps": shadow.traversal_steps + s.certificate_steps,
        "shadow_tests": shadow.intersection_tests + s.certificate_tests,
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
        "came": time.monotonic(),
    }


@dataclass(frozen=True)
class FrameRecord:
    """A traced frame: what it takes to come back to it, and its `counters`.

    `state` has the settings that were chosen; `size` is that of the window's picture then, of which this may be a
    coarser version."""

    state: ViewState
    size: tuple[int, int]
    counters: dict[str, float]


class FrameHistory:
    """The `records` of the last frames by their numbers, the newest last, and the origins of the modes; `frames` counts
    all that there were."""

    def __init__(self, session: Session) -> None:
        self._session = session
        # Origins look at all units of each frame, for which the window need not wait.
        self._worker = ThreadPoolExecutor(1, "shadowcull mode origins")
        self.clear()

    def clear(self) -> None:
        """Begin anew: another scene is open."""
        self.frames = 0
        self._question: tuple[Any, Future[Origins | None] | None] = None, None  # whose origins were asked for last
        self._known: tuple[Any, Origins | None] = None, None  # whose are known, and what they are
        self.records: dict[int, FrameRecord] = {}
        self._came: deque[float] = deque()  # when the newest frames came
        self._request: RenderRequest | None = None
        self._shown: ModeKey | None = None
        self._repeats: dict[tuple[int, int], tuple[Hashable, int]] = {}  # by size: what set the modes, and how often
        self.clear_plots()
        self.forget_modes()

    def clear_plots(self) -> None:
        """Plot what comes from here on; frames keep their numbers."""
        self._plotted_from = self.frames
        self._series: dict[str, NDArray[np.float64]] = {}  # as plots are drawn more often than frames come

    # --- plots ------------------------------------------------------------------------------------

    def __len__(self) -> int:
        return self.frames - self.first

    @property
    def first(self) -> int:
        """Number of the oldest frame that is plotted."""
        return max(self._plotted_from, self.frames - PLOTTED_FRAMES)

    def values(self, name: str) -> NDArray[np.float64]:
        """The values of a series, oldest first, contiguous."""
        if name not in self._series:
            plotted = range(self.first, self.frames)
            self._series[name] = np.array([self.records[number].counters[name] for number in plotted], np.float64)
        return self._series[name]

    def per_pixel(self, name: str) -> NDArray[np.float64]:
        """A series for each pixel, so that frames compare of which only a part is shaded yet: what is done for all
        pixels is shared by all, the rest by those that are shaded."""
        of_all = self.values(_OF_ALL[name]) if name in _OF_ALL else 0.0
        shaded, every = (np.maximum(self.values(pixels), 1.0) for pixels in ("pixels", "all_pixels"))
        return (self.values(name) - of_all) / shaded + of_all / every

    def forget_modes(self, blank: bool = True) -> None:
        """Forget who set which mode; `blank` says that no modes are left from frames before."""
        self._origins: dict[ModeKey, ModeOrigins] = {}
        self._lights: dict[ModeKey, NDArray[np.float64]] = {}
        self._blank, self._learnt_from = blank, self.frames
        self._repeats = {} if blank else dict.fromkeys(self._repeats, (None, 0))

    @property
    def frames_per_second(self) -> float | None:
        """How many frames come in a second; None while none are coming: before the second, and when the next is long
        overdue."""
        if len(self._came) < 2:
            return None
        first, last = self._came[0], self._came[-1]
        apart = (last - first) / (len(self._came) - 1)
        return 1.0 / apart if apart > 0.0 and time.monotonic() - last <= max(RATE_SECONDS, 2.0 * apart) else None

    def take(self, learnt: Sequence[Traced], newest: Traced | None, drawn_seconds: float) -> None:
        """Take up the frames that have set modes since the last time, in their order, and the newest that is shown,
        which may be one of them or not be whole yet; `drawn_seconds` is what the window needed last."""
        for traced in learnt:
            self._note_origins(traced, self._count(traced, drawn_seconds))
        last = learnt[-1].request if learnt else None
        if newest is not None and newest.request is not last and newest.frame.settings.samples == 1:
            self._count(newest, drawn_seconds)

    def _count(self, traced: Traced, drawn_seconds: float) -> int:
        """Record a frame, in the place of the last where it is that frame with more of its pixels shaded; returns its
        number."""
        again, self._request, frame = traced.request is self._request, traced.request, traced.frame
        if not again:
            self.frames += 1
            now = time.monotonic()
            self._came.append(now)
            while len(self._came) > 2 and self._came[0] < now - RATE_SECONDS:
                self._came.popleft()
        chosen, number = self._session.settings, self.frames - 1
        state = self._session.state_of(frame).with_settings(  # of these the frame may have had others
            samples=chosen.samples, lamp_samples=chosen.lamp_samples, verify=chosen.verify, method=chosen.method
        )
        self.records[number] = FrameRecord(state, traced.full_size, counters(frame, drawn_seconds))
        self._series.clear()
        if len(self.records) > KEPT_FRAMES:
            del self.records[next(iter(self.records))]
        return number

    # --- which frame set which mode ---------------------------------------------------------------

    def _note_origins(self, traced: Traced, number: int) -> None:
        frame, scene = traced.frame, self._session.scene
        if traced.fresh:
            self.forget_modes()
        # A frame that was left before it was whole cannot be traced again as it was.
        size, what = (frame.width, frame.height), _what_sets_modes(frame) if traced.whole else None
        known, count = self._repeats.get(size, (what, 0))
        self._repeats[size] = (what, count + 1) if known == what else (None, 0)
        if scene is None or not frame.settings.keeps_modes:
            return
        key = _key(frame)
        if traced.request.divisor == 1:
            self._shown = key
        origins = self._origins.pop(key, None) or ModeOrigins(frame.lights, blank=self._blank)
        self._origins[key] = origins  # the newest last
        if len(self._origins) > KEPT_MODE_HISTORIES:
            del self._origins[next(iter(self._origins))]
            self._blank = False  # should that come again, it would have modes from before
        lights, before = scene.light_positions(frame.time), self._lights.get(key)
        moved = None if before is None or len(before) != len(lights) else (lights != before).any(axis=1)
        self._lights[key] = lights
        self._worker.submit(origins.add, number, frame.modes, moved)

    def origins_of(self, frame: Frame, unit: int, wait: bool = False) -> Origins | None:
        """Return which frames set what a frame knows of a unit; None where that is not known, or, unless one is to
        `wait`, not yet."""
        origins = self._origins.get(self._shown) if self._shown is not None else None
        if origins is None or self._shown is None or self._shown[2] != has_modes_of_cells(frame):
            return None
        (asked, answer), now = self._question, (self._shown, unit, self.frames)
        if answer is not None and answer.done():
            self._known = asked[:2], answer.result()
        if answer is None or (asked != now and answer.done()) or wait:
            answer = self._worker.submit(origins.of, unit)
            self._question = now, answer
        if wait:
            self._known = now[:2], answer.result()
        return self._known[1] if self._known[0] == now[:2] else None

    def before(self, frame: Frame) -> tuple[WarmupFrame, ...]:
        """Return the frames of the size of the newest frame that were traced before it since modes were forgotten, as
        far as they are kept."""
        first, size = max(self._learnt_from, next(iter(self.records), 0)), (frame.width, frame.height)
        states = [self.records[number].state for number in range(first, self.frames - 1)]
        return tuple(WarmupFrame(state.time, state.camera) for state in states if state.size == size)

    def repeats_of(self, frame: Frame) -> int | None:
        """Return how often this very frame was traced since modes were forgotten, before it; None where others were as
        well, at its resolution, which has modes of its own."""
        what, count = self._repeats.get((frame.width, frame.height), (None, 0))
        return count - 1 if what is not None and what == _what_sets_modes(frame) and count else None


def _what_sets_modes(frame: Frame) -> Hashable:
    s = frame.settings
    of_settings = s.method, s.symmetric, s.zoom_factor, s.depth, s.lamp_radius, s.lamp_samples, s.accelerator
    return frame.time, frame.camera, of_settings


def _key(frame: Frame) -> ModeKey:
    return mode_key(frame.settings, has_modes_of_cells(frame))
