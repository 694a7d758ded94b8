"""A standing answer to "is it faster?": the picture that is shown, traced by `none` and by the chosen method in turn.

It is measured in spare time, while the picture rests and nothing else is wanted, by renderers of its own beside the
window's, so that the window's modes and certificates stay what they are, and so that `none` keeps no modes and the
method records and verifies nothing.  The method begins with the modes that the window has.  It ends once the spread is
small, or after so many rounds, and begins anew for another picture.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace

from tracer.frame import Settings
from tracer.geometry.accelerators import LAZY
from tracer.renderer import Renderer
from tracer.scene.model import Camera, Cancelled
from tracer.statistics import FrameStatistics
from viewer.services import refinement
from viewer.services.render_request import Traced
from viewer.services.render_thread import RenderThread
from viewer.state.in_turn import InTurn, Spread
from viewer.state.methods import NO_CULLING
from viewer.util.messages import one_line

STILL = 0.7
"""Seconds that the picture must have rested before anything is measured."""
FIRST = 2
"""Frames of each method that do not count, at least: the first finds memory and caches cold, and learns."""
PROVING = 2.0
"""Seconds that each of these may spend on certificates, which takes fewer frames than where each is shown."""
MOST_PROVING = round(refinement.MOST_FRAMES * refinement.SECONDS / PROVING)
"""Frames that do not count, at most: as much time for certificates as the window's own take at rest."""
MOST = 40
"""Rounds, each of one frame by every method."""
NARROW, CLEAR = 0.01, 0.25
"""The margin of the median ratio that is small enough: in any case, and as a part of what it is away from 1."""
FAILED = "tracing the picture in turn has failed"
BUILDS = "the tree is built where rays arrive: none would have more of it built"


@dataclass(frozen=True)
class Subject:
    """What is measured: one picture, whole and with one sample a pixel, by these methods."""

    time: float
    camera: Camera
    settings: Settings
    methods: tuple[str, ...]

    def is_of(self, other: Subject) -> bool:
        """Whether it is the same picture, by whichever methods."""
        return (self.time, self.camera, self.settings) == (other.time, other.camera, other.settings)


def subject_of(traced: Traced, second: str = "") -> Subject | None:
    """What is to be measured of a picture, and by a second method that it is compared with; None where there is only
    one method."""
    frame = traced.frame
    methods = tuple(dict.fromkeys(filter(None, (NO_CULLING, frame.settings.method, second))))
    if len(methods) < 2:
        return None
    settings = replace(
        frame.settings.recording_only(), method=NO_CULLING, samples=1, modes=False,
        certificate_seconds=traced.request.settings.certificate_seconds, patient=False,
    )  # fmt: skip
    return Subject(frame.time, frame.camera, settings, methods)


class Rounds:
    """Measures a subject, a frame at a time, and goes on from what is known of it.  `so_far`, and `why_not` where it
    failed, may be read from any thread."""

    def __init__(self, subject: Subject, so_far: InTurn | None = None) -> None:
        self.subject = subject
        self.so_far = so_far or InTurn(subject.methods)
        self.why_not = ""
        self._renderers: dict[str, Renderer] = {}
        self._prepared: dict[str, int] = {}
        self._round: dict[str, FrameStatistics] = {}

    def step(self, renderer: Renderer, cancelled: Callable[[], bool]) -> bool:
        """Trace one more frame, in the world of this renderer; returns whether more are to come.

        Raises Cancelled, and then the frame is traced again by the next step; all else that goes wrong ends it."""
        if self.ended:
            return False
        try:
            return self._step(renderer, cancelled)
        except Cancelled:
            raise
        except Exception as problem:
            self.why_not, self._renderers = f"{FAILED}: {one_line(problem)}", {}
            raise

    @property
    def ended(self) -> bool:
        """Whether no more is measured."""
        return self.so_far.settled or bool(self.why_not)

    def _step(self, renderer: Renderer, cancelled: Callable[[], bool]) -> bool:
        waiting = [method for method in self.subject.methods if self._prepared.get(method, 0) >= 0]
        if waiting:
            self._prepare(renderer, waiting[0], cancelled)
            return True
        left = [method for method in self._order if method not in self._round]
        self._round[left[0]] = self._trace(renderer, left[0], cancelled)
        if len(left) == 1:
            self._end_round()
        return not self.so_far.settled

    @property
    def _order(self) -> tuple[str, ...]:
        """Who comes first changes from round to round: what drifts concerns all alike."""
        methods = self.subject.methods
        return methods if self.so_far.count % 2 == 0 else methods[::-1]

    def _prepare(self, renderer: Renderer, method: str, cancelled: Callable[[], bool]) -> None:
        """A frame that does not count: until nothing is left to be made for the picture."""
        made = self._trace(renderer, method, cancelled, proves=True).certificates
        done = self._prepared.get(method, 0) + 1
        ready = done >= FIRST and (not made or done >= MOST_PROVING)
        self._prepared[method] = -1 if ready else done

    def _trace(
        self, renderer: Renderer, method: str, cancelled: Callable[[], bool], proves: bool = False
    ) -> FrameStatistics:
        subject = self.subject
        if method not in self._renderers:
            self._renderers[method] = made = renderer.beside()
            made.settings = replace(subject.settings, method=method)
            made.take_modes(renderer)
        own = self._renderers[method]
        seconds = PROVING if proves else subject.settings.certificate_seconds
        own.settings = replace(subject.settings, method=method, certificate_seconds=seconds, patient=proves)
        return own.render(subject.time, subject.camera, cancelled).statistics

    def _end_round(self) -> None:
        methods = self.subject.methods
        rounds = (*self.so_far.rounds, tuple(self._round[method] for method in methods))
        self._round = {}
        so_far = InTurn(methods, rounds, prepares=False)
        speeds = [so_far.speed(method, methods[0]) for method in methods[1:]]
        settled = len(rounds) >= MOST or (so_far.tells and all(map(_is_narrow, speeds)))
        self.so_far = replace(so_far, settled=settled)
        if settled:
            self._renderers = {}  # with all that they have learnt


def _is_narrow(speed: Spread | None) -> bool:
    return speed is not None and speed.margin <= max(NARROW, CLEAR * abs(speed.median - 1.0))


class Baseline:
    """Follows what is shown.  `moving` says that nothing can be measured, as pictures keep coming."""

    def __init__(self, thread: RenderThread, clock: Callable[[], float] = time.monotonic) -> None:
        self._thread, self._clock = thread, clock
        self._known: dict[Subject, Rounds] = {}  # of the picture that is shown, by whichever methods
        self._subject: Subject | None = None
        self._at_work: Rounds | None = None
        self._still_since: float | None = None
        self.moving = False
        self.why_not = ""

    def forget(self) -> None:
        """Begin anew: the scene is another, or modes were forgotten."""
        self._known, self._subject = {}, None
        self._stop()

    def update(self, traced: Traced | None, second: str, moving: bool, busy: bool) -> None:
        """Measure the picture that is shown, and compared with one by a `second` method, in each frame of the window;
        not while anything is `moving`, or the thread is `busy` with what is wanted more."""
        self.moving = moving
        whole = traced is not None and traced.whole and traced.request.divisor == 1
        if moving or not whole:
            self._leave()
            return
        assert traced is not None
        lazy = traced.frame.settings.accelerator == LAZY
        self._subject = None if lazy else subject_of(traced, second)
        rounds = self._rounds
        self.why_not = BUILDS if lazy else rounds.why_not if rounds is not None else ""
        if self._subject is None or busy:
            self._still_since = None
            self._stop()
            return
        now = self._clock()
        self._still_since = now if self._still_since is None else self._still_since
        if now - self._still_since >= STILL:
            self._measure(self._subject)

    def _measure(self, subject: Subject) -> None:
        self._known = {one: rounds for one, rounds in self._known.items() if one.is_of(subject)}
        rounds = self._known.setdefault(subject, Rounds(subject))
        if rounds is not self._at_work and not rounds.ended:
            self._at_work = rounds
            self._thread.in_spare_time(rounds)

    def _leave(self) -> None:
        """The picture is another: what was measured of the last stays known, without the renderers that did so."""
        self._stop()
        if self._subject is not None:
            self._known = {
                one: rounds if rounds.ended else Rounds(one, rounds.so_far) for one, rounds in self._known.items()
            }
        self._subject = self._still_since = None

    def _stop(self) -> None:
        """Leave the thread to others; what was measured of a picture is taken up again."""
        if self._at_work is not None:
            self._at_work = None
            self._thread.in_spare_time(None)

    @property
    def measured(self) -> InTurn | None:
        """What is known of the picture that is shown; None where nothing is measured of it."""
        return self._rounds.so_far if self._rounds is not None else None

    @property
    def _rounds(self) -> Rounds | None:
        return self._known.get(self._subject) if self._subject is not None else None
