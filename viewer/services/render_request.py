"""What is asked of the thread that traces, frames (`RenderRequest`) and queries, and what comes of it (`Traced`).

A query is about a frame: `query(function, frame, *arguments)` has `function(renderer, frame, *arguments, cancelled)`
called on the render thread between two frames, while the world stands as it did in that frame, and returns a future.
Asked the same again, it returns the same future, so that a panel may ask in each frame of the window.  Of each function
the newest query alone is answered: an older one is cancelled, and so is one about a frame whose moment has passed.  Who
gets a cancelled future asks again about the frame that is shown by then.  What a function raises is in its future."""

from __future__ import annotations

from collections.abc import Callable, Generator, Hashable, Iterator
from concurrent.futures import Future, InvalidStateError
from contextlib import closing, suppress
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple, TypeVar

from tracer.frame import Frame, Settings
from tracer.renderer import Renderer
from tracer.scene.model import Camera, Cancelled
from tracer.settings import RECORDS
from tracer.statistics import FrameStatistics
from viewer.util.messages import one_line

T = TypeVar("T")
REFINEMENT_SECONDS = 0.4
"""That a frame that refines another may spend on certificates: the picture is there already, and a movement ends it."""
FramesBefore = tuple[tuple[float, Camera], ...]
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
    warmup: FramesBefore | None = None

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


# --- queries: what the window asks about a frame, without waiting for the answer -------------------------

Function = Callable[..., Any]
"""Called with the renderer, the frame, the arguments, and `cancelled()`, which says that nobody waits any more."""
Ask = Callable[..., Future[Any]]
"""`RenderThread.query`."""


class Query(NamedTuple):
    """One query.  Its future stays pending until there is an answer, so that it can be cancelled at any time."""

    function: Function
    frame: Frame
    arguments: tuple[Hashable, ...]
    future: Future[Any]


def fulfil(future: Future[T], work: Callable[[], T]) -> Exception | None:
    """Give a future the result of some work, and return what went wrong with that; Cancelled cancels the future."""
    with suppress(InvalidStateError):  # it was cancelled meanwhile
        try:
            future.set_result(work())
        except Cancelled:
            future.cancel()
        except Exception as problem:
            future.set_exception(problem)
            return problem
    return None


class Queries:
    """The queries of one renderer, waiting and answered.  `RenderThread` holds its lock around every call."""

    def __init__(self) -> None:
        self._newest: dict[Function, Query] = {}
        self._waiting: dict[Function, Query] = {}

    def __bool__(self) -> bool:
        """Return whether a query waits."""
        return bool(self._waiting)

    def ask(self, function: Function, frame: Frame, arguments: tuple[Hashable, ...]) -> Future[Any]:
        """Return the future of an answer: the known one, or a new one in the place of the last of the function."""
        last = self._newest.get(function)
        if last is not None:
            if last.arguments == arguments and is_same_picture(last.frame, frame) and not last.future.cancelled():
                return last.future
            last.future.cancel()  # does nothing to one that is answered
        query = self._newest[function] = self._waiting[function] = Query(function, frame, arguments, Future())
        return query.future

    def take(self) -> Query | None:
        """Return the query to answer now; it waits no longer."""
        while self._waiting:
            query = self._waiting.pop(next(iter(self._waiting)))
            if not query.future.cancelled():
                return query
        return None

    def cancel(self) -> None:
        """Cancel and forget all: another scene is traced, or none."""
        for query in self._newest.values():
            query.future.cancel()
        self._newest, self._waiting = {}, {}


def is_same_picture(one: Frame, other: Frame) -> bool:
    """Return whether two frames are one picture with more or fewer samples, and both of them whole or neither."""
    return one.primitive is other.primitive and (one.statistics.part < 1.0) == (other.statistics.part < 1.0)


class Newest:
    """What a function answered last, for those who look in each frame of the window.

    `answer` stays while the next is on its way; `problem` says in one line why there is none."""

    def __init__(self) -> None:
        self._future: Future[Any] | None = None
        self.answer: Any = None
        self.problem = ""

    def take(self, newest: Future[Any]) -> None:
        """Take up what has been answered, to what was asked last and to this."""
        for future in (self._future, newest):
            if future is not None and future.done() and not future.cancelled():
                problem = future.exception()
                self.problem = "" if problem is None else one_line(problem)
                self.answer = self.answer if problem is not None else future.result()
        self._future = newest

    def forget(self) -> None:
        """Drop the answer, and cancel what has been asked."""
        if self._future is not None:
            self._future.cancel()
        self._future, self.answer, self.problem = None, None, ""
