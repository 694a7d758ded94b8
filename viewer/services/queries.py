"""Queries: what the window asks the renderer about a frame, without waiting for the answer.

`query(function, frame, *arguments)` has `function(renderer, frame, *arguments, cancelled)` called on the render thread
between two frames, while the world stands as it did in that frame, and returns a future.  Asked the same again, it
returns the same future, so that a panel may ask in each frame of the window.  Of each function the newest query alone
is answered: an older one is cancelled, and so is one about a frame whose moment has passed.  Who gets a cancelled
future asks again about the frame that is shown by then.  What a function raises is in its future.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable
from concurrent.futures import Future, InvalidStateError
from contextlib import suppress
from typing import Any, NamedTuple, TypeVar

from tracer.frame import Frame
from tracer.scene.model import Cancelled
from viewer.util.messages import one_line

T = TypeVar("T")
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
