"""What is asked of the thread that traces, and what comes of it."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator
from contextlib import closing
from dataclasses import dataclass, field, replace
from typing import TypeVar

from tracer.frame import Frame, Settings
from tracer.renderer import Renderer
from tracer.scene.model import Camera
from tracer.settings import RECORDS
from tracer.statistics import FrameStatistics

T = TypeVar("T")
REFINEMENT_SECONDS = 0.4
"""That a frame that refines another may spend on certificates: the picture is there already, and a movement ends it."""
Warmup = tuple[tuple[float, Camera], ...]
"""Frames by time and camera."""
Parts = Generator[tuple[Frame, Frame | None], None, None]
"""Frames of a picture, each with the same by a second method, if any."""
Task = Callable[[Renderer, Callable[[], bool]], T]
"""Long work with the renderer's world.  It ends soon after what it is given, `cancelled()`, turns true."""
Spare = Callable[[Renderer, Callable[[], bool]], bool]
"""A step of work for when nothing else is wanted, which leaves the renderer itself as it is.  It takes no longer than a
frame, returns whether more are to come, and ends soon after `cancelled()` turns true, by raising Cancelled: the same
step is then asked for again."""


@dataclass(frozen=True)
class RenderRequest:
    """What to trace: a picture, with so many samples a pixel in the end.

    `second` is the method that traces the same once more, if any, after each part of the picture.
    `divisor` is how much coarser than the window it is; `serial` tells requests apart that are otherwise alike; it
    `refines` where the picture is there already, and nobody waits for its certificates.  How the picture comes about
    does not tell requests apart: `parts` of it, in sixteenths, around a `focus`, and that a `quick` one is not cut
    short before some of it has been shown.  With `warmup` frames, all modes are forgotten and these are traced before
    it."""

    time: float
    camera: Camera
    settings: Settings
    divisor: int = 1
    serial: int = 0
    refines: bool = False
    samples: int = 1
    second: str = ""
    parts: tuple[float, ...] = field(default=(16,), compare=False)
    quick: bool = field(default=False, compare=False)
    focus: tuple[float, float] | None = field(default=None, compare=False)
    warmup: Warmup | None = None

    @property
    def traced_settings(self) -> Settings:
        """The settings it is traced by."""
        seconds = max(self.settings.certificate_seconds, REFINEMENT_SECONDS if self.refines else 0.0)
        return replace(self.settings, certificate_seconds=seconds, patient=self.refines)

    def frames_before(self, renderer: Renderer, cancel: Callable[[], bool]) -> Iterator[Traced]:
        """Trace the frames that set its modes, and yield them."""
        for moment, camera in self.warmup or ():
            renderer.settings = replace(self.traced_settings, verify=False)
            frame = renderer.render(moment, camera, cancel)
            yield Traced(RenderRequest(moment, camera, frame.settings), frame, frame.statistics)

    def refine(self, renderer: Renderer, cancel: Callable[[], bool]) -> Parts:
        """Yield its parts and samples, each of them a frame, by the renderer's settings."""
        refining = renderer.refine(self.time, self.camera, cancel, self.parts, self.samples, self.focus)
        with closing(refining):
            for frame in refining:
                yield frame, None

    def supersedes(self, running: RenderRequest, shown: bool = False) -> bool:
        """Whether a trace of `running`, part of which has been shown or not, is no longer worth going on with now that
        this is wanted."""
        if running == self:
            return False
        same_kind = replace(running.settings, width=1, height=1) == replace(self.settings, width=1, height=1)
        return shown or not running.quick or not same_kind

    def covers(self, other: RenderRequest) -> bool:
        """Whether what answers this answers another, as it holds the same or more."""
        recorded = replace(other, settings=_recording(other.settings, self.settings))
        return recorded == self and not missing_buffers(self.settings, other.settings)


def _recording(settings: Settings, other: Settings) -> Settings:
    """Return settings with as much recorded as others."""
    return replace(settings, **{name: getattr(other, name) for name in RECORDS})


def as_asked(settings: Settings, asked: Settings) -> Settings:
    """Return settings at the size, with as much recorded and as much time for certificates, as others."""
    same = ("width", "height", "modes", "patient", "samples", "lamp_samples", "certificate_seconds")
    return replace(_recording(settings, asked), **{name: getattr(asked, name) for name in same})


def missing_buffers(had: Settings, wanted: Settings) -> bool:
    """Return whether something is to be recorded that was not."""
    return any(getattr(wanted, name) and not getattr(had, name) for name in RECORDS)


@dataclass(frozen=True)
class Traced:
    """A frame and the request it answers, what the first part of this cost, and the same frame by a second method;
    `fresh` says of a frame that has set modes that it is the first to do so since all were forgotten."""

    request: RenderRequest
    frame: Frame
    first: FrameStatistics
    second: Frame | None = None
    fresh: bool = False

    @property
    def whole(self) -> bool:
        """Whether all of its pixels have been shaded."""
        return self.frame.statistics.part >= 1.0

    @property
    def complete(self) -> bool:
        """Whether it is whole, in the resolution of a picture at rest."""
        return self.whole and self.request.divisor == 1

    @property
    def full_size(self) -> tuple[int, int]:
        """The size whose aspect it has: its own, or what it is a coarser version of."""
        return self.frame.width * self.request.divisor, self.frame.height * self.request.divisor
