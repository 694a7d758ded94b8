"""Renderers beside the window's own, in its world: a second method live, and a standing answer to "is it faster?".

`Pair` traces each picture by a second method as well.  `Baseline` measures in spare time, while the picture rests and
nothing else is wanted: the picture that is shown, by `none` and by the chosen method in turn.  All of them have modes,
certificates and counters of their own, so that none gains by what another has found out, and the window's stay what
they are."""

from __future__ import annotations

import time
from collections.abc import Callable, Generator
from contextlib import closing
from dataclasses import dataclass, replace

from tracer.frame import Settings
from tracer.geometry.accelerators import LAZY
from tracer.renderer import Renderer
from tracer.scene.model import Camera, Cancelled
from tracer.statistics import FrameStatistics
from viewer.services.refinement import MOST_FRAMES
from viewer.services.render_request import REFINEMENT_SECONDS, Parts, RenderRequest, Spare, Traced
from viewer.state.methods import NO_CULLING
from viewer.state.savings import InTurn
from viewer.util.messages import one_line

STILL = 0.7
"""Seconds that the picture must have rested before anything is measured."""
FIRST = 2
"""Frames of each method that do not count, at least: the first finds memory and caches cold, and learns."""
PROVING = 2.0
"""Seconds that each of these may spend on certificates, which takes fewer frames than where each is shown."""
MOST_PROVING = round(MOST_FRAMES * REFINEMENT_SECONDS / PROVING)
"""Frames that do not count, at most: as much time for certificates as the window's own take at rest."""
MOST_ROUNDS = 40
"""Rounds, each of one frame by every method."""
NARROW, CLEAR = 0.01, 0.25
"""The margin of the median ratio that is small enough: in any case, and as a part of what it is away from 1."""
FAILED = "tracing the picture in turn has failed"
BUILDS = "the tree is built where rays arrive: none would have more of it built"

Cancel = Callable[[], bool]


class Pair:
    """A renderer and another beside it, which trace the same picture by two methods, part after part in turn.

    The world is placed again whenever the turn changes, as methods differ in what they count as static."""

    def __init__(self, first: Renderer) -> None:
        self._first, self._second = first, first.beside()
        self._world = getattr(first, "world", None)

    def is_of(self, renderer: Renderer) -> bool:
        """Return whether it is the pair of this renderer, in the world that this one has now."""
        return renderer is self._first and getattr(renderer, "world", None) is self._world

    def refine(self, request: RenderRequest, cancel: Cancel) -> Parts:
        """Yield each part of the picture by the first renderer, and the same by the second with the other method.

        The world is always left as the first has placed it: queries may be answered between two parts."""
        self._second.settings = replace(self._first.settings, method=request.second)
        self._second.take_scene(self._first)
        first, second = request.refine(self._first, cancel), request.refine(self._second, cancel)
        with closing(first) as ours, closing(second) as theirs:
            for number, (frame, _) in enumerate(ours):
                try:
                    if number > 0:
                        self._second.take_turn(request.time)
                    other, _ = next(theirs)
                finally:
                    self._first.take_turn(request.time)
                yield frame, other


@dataclass(frozen=True)
class Subject:
    """What is measured: one picture, whole and with one sample a pixel, by these methods; `none` keeps no modes, and
    nobody records or verifies."""

    time: float
    camera: Camera
    settings: Settings
    methods: tuple[str, ...]


def subject_of(traced: Traced, second: str = "") -> Subject | None:
    """Return what is to be measured of a picture, and by a second method that it is compared with; None where there is
    only one method."""
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
    """Measures a subject, a frame at a time.  `so_far`, and `why_not` where it failed, may be read from any thread."""

    def __init__(self, subject: Subject) -> None:
        self.subject, self.so_far, self.why_not = subject, InTurn(subject.methods), ""
        self._renderers: dict[str, Renderer] = {}
        self._turns = self._all_turns()
        self._turn = next(self._turns)

    @property
    def ended(self) -> bool:
        """Whether no more is measured."""
        return self.so_far.settled or bool(self.why_not)

    def step(self, renderer: Renderer, cancelled: Cancel) -> bool:
        """Trace one more frame, in the world of this renderer; returns whether more are to come.

        Raises Cancelled, and then the frame is traced again by the next step; all else that goes wrong ends it."""
        if self.ended:
            return False
        try:
            self._turn = self._turns.send(self._trace(renderer, self._turn, cancelled))
        except StopIteration:
            self._renderers = {}  # with all that they have learnt
        except Cancelled:
            raise
        except Exception as problem:
            self.why_not, self._renderers = f"{FAILED}: {one_line(problem)}", {}
            raise
        return not self.ended

    def _all_turns(self) -> Generator[Settings, FrameStatistics, None]:
        """Yield the settings of the next frame, and get what was measured of it.

        Before the first round, until nothing is left to be made for the picture, frames do not count.  Who comes first
        changes from round to round, as what drifts concerns all alike."""
        methods, settings = self.subject.methods, self.subject.settings
        for method in methods:
            for number in range(1, MOST_PROVING + 1):
                found = yield replace(settings, method=method, certificate_seconds=PROVING, patient=True)
                if number >= FIRST and not found.certificates:
                    break
        while not self.so_far.settled:
            one = {}
            for method in methods if self.so_far.count % 2 == 0 else methods[::-1]:
                one[method] = yield replace(settings, method=method)
            now = InTurn(methods, (*self.so_far.rounds, tuple(one[method] for method in methods)))
            speeds = [now.speed(method, methods[0]) for method in methods[1:]] if now.tells else []
            narrow = now.tells and all(one.margin <= max(NARROW, CLEAR * abs(one.median - 1.0)) for one in speeds)
            self.so_far = replace(now, settled=narrow or now.count >= MOST_ROUNDS)

    def _trace(self, renderer: Renderer, settings: Settings, cancelled: Cancel) -> FrameStatistics:
        """Trace a frame, beginning with the modes that the window has."""
        own = self._renderers.get(settings.method)
        if own is None:
            own = self._renderers[settings.method] = renderer.beside()
            own.settings = settings
            own.take_modes(renderer)
        own.settings = settings
        return own.render(self.subject.time, self.subject.camera, cancelled).statistics


class Baseline:
    """Measures what is shown; `why_not` says why nothing can be measured of it."""

    def __init__(self, in_spare_time: Callable[[Spare | None], None]) -> None:
        """`in_spare_time` has rounds measured by the render thread, until it is given others or None."""
        self._in_spare_time = in_spare_time
        self._known: dict[Subject, Rounds] = {}  # of the picture that is shown, by whichever methods
        self._shown: Subject | None = None
        self._at_work: Rounds | None = None
        self._still_since: float | None = None
        self.why_not = ""

    @property
    def measured(self) -> InTurn | None:
        """What is known of the picture that is shown; None where nothing is measured of it."""
        rounds = self._known.get(self._shown) if self._shown is not None else None
        return rounds.so_far if rounds is not None else None

    def forget(self) -> None:
        """Begin anew: the scene is another, or modes were forgotten."""
        self._known, self._shown, self.why_not = {}, None, ""
        self._work_on(None)

    def update(self, traced: Traced | None, second: str, moving: bool, busy: bool) -> None:
        """Measure the picture that is shown, and compared with one by a `second` method, in each frame of the window;
        not while anything is `moving`, or the thread is `busy` with what is wanted more."""
        whole = traced if traced is not None and traced.complete else None
        if moving or whole is None:  # what was measured to the end stays known, without the renderers of the rest
            self._known = {subject: rounds for subject, rounds in self._known.items() if rounds.ended}
            self._shown, self.why_not = None, ""
        else:
            lazy = whole.frame.settings.accelerator == LAZY
            self._shown = None if lazy else subject_of(whole, second)
            rounds = self._known.get(self._shown) if self._shown is not None else None
            self.why_not = BUILDS if lazy else rounds.why_not if rounds is not None else ""
        if self._shown is None or busy:
            self._still_since = None
            self._work_on(None)
            return
        now = time.monotonic()
        self._still_since = now if self._still_since is None else self._still_since
        if now - self._still_since >= STILL:
            self._work_on(self._shown)

    def _work_on(self, subject: Subject | None) -> None:
        """Measure this; leave the thread to others where there is none, or all is known of it."""
        rounds = None
        if subject is not None:
            picture = replace(subject, methods=())
            self._known = {one: known for one, known in self._known.items() if replace(one, methods=()) == picture}
            self._known[subject] = known = self._known.get(subject) or Rounds(subject)
            rounds = None if known.ended else known
        if rounds is not self._at_work:
            self._at_work = rounds
            self._in_spare_time(rounds.step if rounds is not None else None)
