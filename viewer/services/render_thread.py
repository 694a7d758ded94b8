"""Tracing in the background: one thread, and the newest request wins.

The window submits what it wants to see and looks, frame after frame, whether a picture has come.
Requests are not queued: one waits at most, and a newer one takes its place.  A picture is shown with
a part of its pixels shaded, and becomes whole as long as nothing newer is wanted, then gets more samples
a pixel.  A trace that is under way is cut short when it has become worthless (another scene, other
settings, a picture that has been shown), but the first part of one is let finish: while the camera
moves, the next request comes before the last picture is ready, and cancelling each would show none at all.

An experiment is a `Task`: it has the thread, and with it the scene's world, to itself until it is
done; the newest request of that time waits for its end.  A query (`render_request.py`) takes a moment: it is answered
between two frames, while the world still stands as it did in the frame that it is about.  `Spare` work is done
a step at a time while nothing else is wanted, and anything that is wanted ends a step."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Hashable
from concurrent.futures import Future
from contextlib import closing
from dataclasses import replace
from functools import partial
from typing import Any

from tracer.frame import Frame
from tracer.renderer import Renderer
from tracer.scene.model import Cancelled
from viewer.services.beside import Pair
from viewer.services.jobs import TRACER, lower_priority
from viewer.services.render_request import Function, Parts, Queries, Query, RenderRequest, Spare, Task, Traced, fulfil
from viewer.util.messages import Failure, failure

QUERY_SECONDS = 0.25
"""That a picture waits at most for the answer to a query; a longer one is cancelled, and may be asked for anew."""
_KNOWN = (MemoryError, OSError)  # what may go wrong here without a mistake of the program's


class RenderThread:
    """Owns the renderer: nobody else calls it while this lives."""

    def __init__(self, wake: Callable[[], None] = lambda: None) -> None:
        self._wake = wake
        self._changed = threading.Condition()
        self._renderer: Renderer | None = None
        self._pair: Pair | None = None  # of the renderer, with a second one; the thread's own
        self._waiting: RenderRequest | None = None
        self._running: RenderRequest | None = None
        self._shown = self._whole = False  # whether a part of what is running, or all of it, has been
        self._task: tuple[Renderer, Task[Any], Future[Any]] | None = None
        self._queries = Queries()
        self._spare: Spare | None = None
        self._placed_at: float | None = None  # the time of what was traced last
        self._performing = self._cancel = self._reset = self._closing = False
        self._finished: Traced | None = None
        self._learnt: list[Traced] = []  # frames that have set modes; the window takes them before it asks for the next
        self._fresh = True  # nothing is known of modes
        self._problems: list[Failure] = []
        self._frame_failed = False
        self._thread = threading.Thread(target=self._run, name="shadowcull render", daemon=True)
        self._thread.start()

    # --- what is wanted ---------------------------------------------------------------------------

    def use(self, renderer: Renderer | None, fresh: bool = True) -> None:
        """Trace this renderer's scene from now on; whatever was asked of the old one is dropped, and a task ended.

        `fresh` says that it knows nothing of modes yet."""
        with self._changed:
            self._renderer, self._fresh, self._cancel = renderer, fresh, True
            self._waiting = self._finished = self._placed_at = self._spare = None
            self._frame_failed = False
            self._learnt.clear()
            self._queries.cancel()
            self._changed.notify_all()

    def submit(self, request: RenderRequest) -> None:
        """Ask for a frame; an older request that still waits is forgotten."""
        with self._changed:
            under_way = request == self._running and not self._cancel
            self._waiting = None if under_way or self._closing else request
            if self._waiting is not None and self._running is not None:
                self._cancel = self._cancel or request.supersedes(self._running, self._shown)
            self._changed.notify_all()

    def perform(self, task: Task[Any]) -> Future[Any]:
        """Do this instead of frames, from now on until it is done; what is under way is cut short, or dropped.

        The task gets the renderer that is in use now; what it raises is in the future.  Raises RuntimeError if none
        is."""
        future: Future[Any] = Future()
        with self._changed:
            if self._renderer is None:
                raise RuntimeError("there is no scene to work on")
            self._task, self._waiting, self._cancel = (self._renderer, task, future), None, True
            self._changed.notify_all()
        return future

    def query(self, function: Function, frame: Frame, *arguments: Hashable) -> Future[Any]:
        """Return the future of `function(renderer, frame, *arguments, cancelled)` (see `render_request.py`)."""
        with self._changed:
            future = self._queries.ask(function, frame, arguments)
            self._changed.notify_all()
            return future

    def in_spare_time(self, work: Spare | None) -> None:
        """Do this, and nothing else of its kind, while nothing is wanted; None for nothing."""
        with self._changed:
            self._spare = work
            self._changed.notify_all()

    def reset_modes(self) -> None:
        """Forget all modes before the next frame, or the next task."""
        with self._changed:
            self._reset = True
            self._cancel = self._cancel or not self._performing  # a task has modes of its own

    def close(self, timeout: float = 10.0) -> bool:
        """Cancel and end the thread; false if it did not end in time (it is a daemon and dies with the program)."""
        with self._changed:
            self._closing = self._cancel = True
            self._waiting = None
            self._queries.cancel()
            self._changed.notify_all()
        self._thread.join(timeout)
        return not self._thread.is_alive()

    # --- what has come ----------------------------------------------------------------------------

    def take(self) -> Traced | None:
        """The newest finished frame, once."""
        with self._changed:
            traced, self._finished = self._finished, None
            return traced

    def take_learnt(self) -> list[Traced]:
        """The frames that have set modes since the last time, in their order: those that became whole, as they were
        before further samples, and those that were left before, as they were shown last."""
        with self._changed:
            learnt, self._learnt = self._learnt, []
            return learnt

    def take_problems(self) -> tuple[list[Failure], bool]:
        """What has failed, each once, and whether a frame has: else frames come all the same."""
        with self._changed:
            told = self._problems, self._frame_failed
            self._problems, self._frame_failed = [], False
            return told

    @property
    def busy(self) -> bool:
        """Whether anything is to come but more samples of a whole picture."""
        with self._changed:
            if (self._running is not None and not self._whole) or self._performing or self._task is not None:
                return True
            return self._renderer is not None and self._waiting is not None

    # --- the thread -------------------------------------------------------------------------------

    def _run(self) -> None:
        lower_priority(TRACER)
        while (turn := self._next()) is not None:
            turn()

    def _complain(self, problem: Exception, what: str) -> None:
        with self._changed:
            self._problems.append(failure(problem, what, _KNOWN))

    def _next(self) -> Callable[[], None] | None:
        """What to do now, once there is something: a task before all, then a query, then a frame."""
        with self._changed:
            while not self._closing:
                renderer = self._renderer
                if self._task is not None:
                    (of_task, task, future), self._task = self._task, None
                    self._performing, self._cancel = True, of_task is not renderer
                    self._placed_at = None
                    return partial(self._perform, of_task, task, future, of_task is renderer and self._take_reset())
                if renderer is None:
                    self._changed.wait()
                elif self._placed_at is not None and (query := self._queries.take()):
                    moved = query.frame.time != self._placed_at  # a later frame has failed, or has not been taken yet
                    if not moved or self._waiting is None:
                        self._placed_at = query.frame.time
                        return partial(self._answer, renderer, query, moved)
                    query.future.cancel()
                elif self._waiting is not None:
                    request, self._waiting = self._waiting, None
                    self._cancel = self._shown = self._whole = False
                    self._running, self._placed_at = request, request.time
                    return partial(self._trace, renderer, request, self._take_reset())
                elif self._spare is not None and self._placed_at is not None and not self._reset:
                    return partial(self._spend, renderer, self._spare, self._placed_at)
                else:
                    self._changed.wait()
            return None

    def _take_reset(self) -> bool:
        """Whether all modes are to be forgotten, once."""
        reset, self._reset = self._reset, False
        return reset

    def _forget(self, renderer: Renderer) -> None:
        """Forget all modes, as was asked."""
        renderer.reset_modes()
        self._fresh, self._pair = True, None

    def _perform(self, renderer: Renderer, task: Task[Any], future: Future[Any], reset: bool) -> None:
        if reset:
            self._forget(renderer)
        fulfil(future, lambda: task(renderer, lambda: self._cancel))
        with self._changed:
            self._performing = False
        self._wake()

    def _spend(self, renderer: Renderer, work: Spare, moment: float) -> None:
        """One step of spare work; the world stands as it did before when it ends."""

        def wanted() -> bool:
            others = self._task is not None or self._waiting is not None or bool(self._queries)
            return self._closing or self._reset or self._spare != work or others

        more = False
        try:
            more = work(renderer, wanted)
        except Cancelled:
            more = True
        except Exception as problem:
            self._complain(problem, "not measured")
        finally:
            renderer.take_turn(moment)
        if not more:
            with self._changed:
                self._spare = None if self._spare == work else self._spare
            self._wake()

    def _answer(self, renderer: Renderer, query: Query, moved: bool = False) -> None:
        """Answer a query; `moved` says that the world stands as in another frame than the query's."""
        began = time.monotonic()

        def cancelled() -> bool:
            if query.future.cancelled() or self._closing or self._task is not None or renderer is not self._renderer:
                return True
            return self._waiting is not None and time.monotonic() - began > QUERY_SECONDS

        if moved:
            renderer.take_turn(query.frame.time)
        work = partial(query.function, renderer, query.frame, *query.arguments, cancelled)
        if problem := fulfil(query.future, work):
            self._complain(problem, "no answer")
        self._wake()

    def _answer_meanwhile(self, renderer: Renderer, moment: float) -> None:
        """Answer what was asked about the picture that is being refined."""
        with self._changed:
            queries = list(iter(self._queries.take, None)) if renderer is self._renderer else []
        for query in queries:
            if query.frame.time == moment:
                self._answer(renderer, query)
            else:
                query.future.cancel()

    # --- a frame ----------------------------------------------------------------------------------

    def _trace(self, renderer: Renderer, request: RenderRequest, reset: bool) -> None:
        first = shown = None
        try:
            if reset or request.warmup is not None:
                self._forget(renderer)
            for before in request.frames_before(renderer, lambda: self._cancel):
                with self._changed:
                    self._note_learnt(before)
            renderer.settings = request.traced_settings
            with closing(self._parts_of(renderer, request)) as parts:
                for frame, second in parts:
                    first = first or frame.statistics
                    shown = Traced(request, frame, first, second)
                    self._answer_meanwhile(renderer, request.time)  # a newer picture makes the window ask anew
                    if not self._deliver(renderer, shown):
                        break
                    self._answer_meanwhile(renderer, request.time)
        except Cancelled:
            pass
        except Exception as problem:
            if renderer is self._renderer:
                self._complain(problem, "frame not traced")
                self._frame_failed = True
        with self._changed:
            self._running = None
            if renderer is self._renderer and shown is not None and not shown.whole:
                self._note_learnt(shown)
        self._wake()

    def _parts_of(self, renderer: Renderer, request: RenderRequest) -> Parts:
        """Return the parts and samples of a picture, each with that by the second method where there is one."""
        if not request.second:
            self._pair = None  # nor is what it has learnt kept in memory
            return request.refine(renderer, lambda: self._cancel)
        if self._pair is None or not self._pair.is_of(renderer):
            self._pair = Pair(renderer)
        return self._pair.refine(request, lambda: self._cancel)

    def _note_learnt(self, traced: Traced) -> Traced:
        """Note a frame that has set modes; returns it, with whether it is the first since these were forgotten."""
        fresh, self._fresh = self._fresh, False
        self._learnt.append(replace(traced, fresh=fresh))
        return self._learnt[-1]

    def _deliver(self, renderer: Renderer, traced: Traced) -> bool:
        """Hand out a frame, unless it is of a scene that was left meanwhile; whether more of it is wanted."""
        with self._changed:
            if renderer is self._renderer:
                learns = traced.whole and traced.frame.settings.samples == 1
                self._finished = self._note_learnt(traced) if learns else traced
                self._shown, self._whole = True, traced.whole
            newer = self._waiting is not None and self._waiting.supersedes(traced.request, shown=True)
            on = not (self._cancel or newer)
        self._wake()
        return on
