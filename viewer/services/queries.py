"""Queries: what the window asks the renderer about a frame, without waiting for the answer.

`query(function, frame, *arguments)` has `function(renderer, frame, *arguments, cancelled)` called on the render thread
between two frames, while the world stands as it did in that frame, and returns a future.  Asked again, it returns the
same future, so that a panel may ask in each frame of the window.  Of each function the newest query alone is answered:
an older one is cancelled, and so is one about a frame whose moment has passed.  Who gets a cancelled future asks again
about the frame that is shown by then.  What a function raises is in its future.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable
from concurrent.futures import Future
from dataclasses import dataclass, field
from typing import Any, NamedTuple, Protocol

from tracer.frame import Frame
from tracer.scene.model import Cancelled
from viewer.util.messages import one_line

MOST_ANSWERS = 16
"""Answers of one function about one frame that are kept."""

Function = Callable[..., Any]
"""Called with the renderer, the frame, the arguments, and `cancelled()`, which says that nobody waits any more."""


class Query(NamedTuple):
    """One query.  Its future stays pending until there is an answer, so that it can be cancelled at any time."""

    function: Function
    frame: Frame
    arguments: tuple[Hashable, ...]
    future: Future[Any]

    def answer(self, renderer: object, cancelled: Callable[[], bool]) -> Exception | None:
        """Call the function and put its answer into the future; returns what it raised."""
        result = problem = None
        try:
            result = self.function(renderer, self.frame, *self.arguments, cancelled)
        except Cancelled:
            self.future.cancel()
        except Exception as raised:
            problem = raised
        if not self.future.set_running_or_notify_cancel():
            return None
        if problem is not None:
            self.future.set_exception(problem)
        else:
            self.future.set_result(result)
        return problem


@dataclass
class _Asked:
    """What one function has been asked about one frame; the newest query last."""

    frame: Frame
    queries: dict[tuple[Hashable, ...], Query] = field(default_factory=dict)


class Queries:
    """The queries of one renderer, waiting and answered.  `RenderThread` holds its lock around every call."""

    def __init__(self) -> None:
        self._asked: dict[Function, _Asked] = {}
        self._waiting: dict[Function, Query] = {}

    def __bool__(self) -> bool:
        """Return whether a query waits."""
        return bool(self._waiting)

    def ask(self, function: Function, frame: Frame, arguments: tuple[Hashable, ...]) -> Future[Any]:
        """Return the future of an answer: a known one, or a new one in the place of older queries of the function."""
        asked = self._asked.get(function)
        known = asked.queries.get(arguments) if asked is not None and is_same_picture(asked.frame, frame) else None
        if known is not None and not known.future.cancelled():
            return known.future
        for older in asked.queries.values() if asked is not None else ():
            older.future.cancel()  # does nothing to those that are answered
        if asked is None or not is_same_picture(asked.frame, frame):
            asked = self._asked[function] = _Asked(frame)
        asked.queries.pop(arguments, None)
        query = asked.queries[arguments] = self._waiting[function] = Query(function, frame, arguments, Future())
        if len(asked.queries) > MOST_ANSWERS:
            del asked.queries[next(iter(asked.queries))]
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
        for asked in self._asked.values():
            for query in asked.queries.values():
                query.future.cancel()
        self._asked, self._waiting = {}, {}


def is_same_picture(one: Frame, other: Frame) -> bool:
    """Return whether two frames are one picture with more or fewer samples, and both of them whole or neither."""
    return one.primitive is other.primitive and (one.statistics.part < 1.0) == (other.statistics.part < 1.0)


class Ask(Protocol):
    """`RenderThread.query`."""

    def __call__(self, function: Function, frame: Frame, *arguments: Hashable) -> Future[Any]: ...


class Newest:
    """What a function answered last, for those who look in each frame of the window.

    `answer` stays while the next is on its way; `problem` says in one line why there is none."""

    def __init__(self) -> None:
        self._future: Future[Any] | None = None
        self.answer: Any = None
        self.problem = ""

    @property
    def pending(self) -> bool:
        """Whether an answer is to come."""
        return self._future is not None and not self._future.done()

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
