"""Long work in the background: a thread with progress, a cancel button and one result.

The tracer reports what it does through a `Progress` callable and stops when that raises
`Cancelled`; a `Job` is the other end of it.  The window asks it each frame what to show and
never waits."""

from __future__ import annotations

import os
import sys
import threading
from collections.abc import Callable
from contextlib import suppress
from typing import Generic, TypeVar

from tracer.scene.model import Cancelled, Progress
from viewer.util.messages import KNOWN, Failure, failure

Result = TypeVar("Result")

JOB, TRACER = 2, 5  # niceness: what a window waits for, and what takes all cores for as long as it is open


class Wake:
    """Call it from any thread to make the window draw a frame soon; it does nothing while there is no window.

    The lock keeps a window from going while a thread is just waking it."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._refresh: Callable[[], None] | None = None

    def __call__(self) -> None:
        with self._lock:
            if self._refresh is not None:
                self._refresh()

    def connect(self, refresh: Callable[[], None] | None) -> None:
        """Let a window be woken by this from now on; None as the window goes."""
        with self._lock:
            self._refresh = refresh


class Job(Generic[Result]):
    """Runs `work(progress)` on a thread of its own.

    `label` and `fraction` say how far it is; after `done`, `result` is set, or `failure` says what went wrong, or
    neither where it was cancelled.  The end wakes the window; progress is seen often enough as it dozes."""

    def __init__(self, title: str, work: Callable[[Progress], Result], wake: Callable[[], None] = lambda: None) -> None:
        self.title, self.label, self.fraction = title, "", 0.0
        self.result: Result | None = None
        self.failure: Failure | None = None
        self._work, self._wake = work, wake
        self._stop, self._finished = threading.Event(), threading.Event()
        self._thread = threading.Thread(target=self._run, name=f"shadowcull {title}", daemon=True)
        self._thread.start()

    @property
    def done(self) -> bool:
        return self._finished.is_set()

    def cancel(self) -> None:
        """Ask the work to stop; it does at its next report of progress."""
        self._stop.set()

    def join(self, timeout: float) -> bool:
        """Wait for the end; false if it did not come in time."""
        self._thread.join(timeout)
        return self.done

    def _progress(self, label: str, fraction: float) -> None:
        if self._stop.is_set():
            raise Cancelled(self.title)
        self.label, self.fraction = label, min(max(float(fraction), 0.0), 1.0)

    def _run(self) -> None:
        lower_priority(JOB)
        try:
            result = self._work(self._progress)
            self.result = None if self._stop.is_set() else result
        except Cancelled:
            pass
        except Exception as error:
            self.failure = failure(error, "" if isinstance(error, KNOWN) else f"{self.title} failed")
        finally:
            self._finished.set()
            self._wake()


def lower_priority(niceness: int) -> None:
    """Let the window go before this thread, and the threads it starts, where cores are short (Linux only)."""
    if sys.platform.startswith("linux"):
        with suppress(OSError):
            os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), niceness)
