"""Messages to the user: one line in the status bar, a log of all lines, and internal errors.

Threads may write at any time.  What is said again is counted, so that what fails in every frame is one entry of the
log."""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from datetime import datetime
from enum import Enum

from viewer.util.messages import Failure, in_one_line

INFO_SECONDS = 6.0
MOST_ENTRIES = 500
RECENT_ENTRIES = 20
"""Entries back that the same internal error is looked for."""
QUIET_AFTER = 0.5
"""Seconds without an internal error after which it is news again: longer than a frame, shorter than a hand.  What fails
in every frame would else come back at once when it is dismissed."""


class Level(Enum):
    """How bad it is."""

    NOTICE = "notice"
    ERROR = "error"  # something the user asked for could not be done
    FAULT = "internal error"


@dataclass
class Entry:
    """One line, how often it was said, and when last; `details` may be many lines, such as a traceback."""

    level: Level
    text: str
    details: str = ""
    count: int = 1
    at: datetime = datetime.min

    @property
    def as_text(self) -> str:
        """Return all of it as text, to be copied."""
        times = f" ({self.count} times)" if self.count > 1 else ""
        head = f"{self.at:%Y-%m-%d %H:%M:%S}  {self.level.value}: {self.text}{times}"
        return f"{head}\n{self.details.rstrip()}\n" if self.details else f"{head}\n"


class Log:
    """The newest entries, MOST_ENTRIES at most; `unread` are errors and faults since the log was read, oldest first."""

    def __init__(self) -> None:
        self._entries: deque[Entry] = deque(maxlen=MOST_ENTRIES)
        self._lock = threading.Lock()
        self._unread: list[Entry] = []

    @property
    def unread(self) -> list[Entry]:
        with self._lock:
            return list(self._unread)

    def mark_read(self) -> None:
        """Note that all of it has been seen."""
        with self._lock:
            self._unread = []

    def add(self, level: Level, text: str, details: str = "") -> Entry:
        """Add an entry, or count it where it was said before: anything just now, a fault a while ago too."""
        with self._lock:
            recent = list(self._entries)[-(RECENT_ENTRIES if level is Level.FAULT else 1) :]
            entry = next((e for e in reversed(recent) if (e.level, e.text, e.details) == (level, text, details)), None)
            if entry is not None:
                entry.count += 1
            else:
                entry = Entry(level, text, details)
                self._entries.append(entry)
            entry.at = datetime.now()
            if level is not Level.NOTICE and not any(entry is other for other in self._unread):
                self._unread.append(entry)
            return entry

    def entries(self) -> list[Entry]:
        """Return all entries, oldest first."""
        with self._lock:
            return list(self._entries)

    def clear(self) -> None:
        with self._lock:
            self._entries.clear()
            self._unread = []


@dataclass(frozen=True)
class Message:
    """One line for the status bar; `at` is when it was said, by the monotonic clock."""

    text: str
    error: bool
    at: float


class Notices:
    """`message` is the newest line; `faults` are the internal errors that nobody has dismissed yet, newest last.

    May be used from any thread; `wake` makes the window draw a frame soon."""

    def __init__(self, wake: Callable[[], None] = lambda: None) -> None:
        self._wake = wake
        self.log = Log()
        self.message: Message | None = None
        self.faults: list[Entry] = []
        self._failed_at: dict[str, float] = {}

    def say(self, text: str, error: bool = False, details: str = "") -> None:
        """Show one line in the status bar: a notice for some seconds, an error until the next line.  The log keeps
        both."""
        self.message = Message(in_one_line(text), error, time.monotonic())
        self.log.add(Level.ERROR if error else Level.NOTICE, self.message.text, details)
        self._wake()

    def report(self, failed: Failure) -> None:
        """Report a failure: in the status bar if such a thing may happen, else as an internal error."""
        if failed.expected:
            self.say(failed.text, error=True, details=failed.details)
        else:
            self.fault(failed)

    def fault(self, failed: Failure) -> Entry:
        """Report an internal error, and show it unless it was just dismissed; returns its entry in the log."""
        entry = self.log.add(Level.FAULT, failed.text, failed.details)
        now = time.monotonic()
        news = now - self._failed_at.get(entry.text, -QUIET_AFTER) >= QUIET_AFTER
        self._failed_at[entry.text] = now
        if news and entry not in self.faults:
            self.faults = [*self.faults, entry]
        self._wake()
        return entry

    def dismiss_faults(self) -> None:
        """Note that the internal errors have been seen."""
        self.faults = []

    @property
    def newest_fault(self) -> Entry | None:
        return self.faults[-1] if self.faults else None

    @property
    def current(self) -> Message | None:
        """The line to show now."""
        message = self.message  # once: another thread may say something newer meanwhile, which is not to be lost
        expired = message is not None and not message.error and time.monotonic() - message.at > INFO_SECONDS
        return None if expired else message
