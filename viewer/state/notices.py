"""Messages to the user: one line in the status bar, a log of all lines, and internal errors.

Threads may write at any time.  What is said again is counted, so that what fails in every frame is one entry of the
log."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from datetime import datetime, timedelta
from enum import Enum
from pathlib import Path

from viewer.util.messages import Failure, in_one_line

INFO_LASTS = timedelta(seconds=6.0)
MOST_ENTRIES = 500
RECENT_ENTRIES = 20
"""Entries back that the same internal error is looked for."""


class Level(Enum):
    """How bad it is."""

    NOTICE = "notice"
    ERROR = "error"  # something the user asked for could not be done
    FAULT = "internal error"


@dataclass
class Entry:
    """One line, how often it was said, and when last; `details` may be many lines, such as a traceback, and `file` is
    one that was written.

    `unread` says that it is an error or a fault that nobody has seen in the log."""

    level: Level
    text: str
    details: str = ""
    count: int = 0
    at: datetime = datetime.min
    unread: bool = False
    file: Path | None = None

    @property
    def error(self) -> bool:
        return self.level is not Level.NOTICE

    @property
    def as_text(self) -> str:
        """All of it as text, to be copied."""
        times = f" ({self.count} times)" if self.count > 1 else ""
        head = f"{self.at:%Y-%m-%d %H:%M:%S}  {self.level.value}: {self.text}{times}"
        return f"{head}\n{self.details.rstrip()}\n" if self.details else f"{head}\n"


class Notices:
    """`message` is the newest line for the status bar; the log has the newest entries, MOST_ENTRIES at most.

    May be used from any thread; `wake` makes the window draw a frame soon."""

    def __init__(self, wake: Callable[[], None] = lambda: None) -> None:
        self._wake, self._lock = wake, threading.Lock()
        self._entries: deque[Entry] = deque(maxlen=MOST_ENTRIES)
        self.message: Entry | None = None

    def say(self, text: str, error: bool = False, details: str = "", file: Path | None = None) -> None:
        """Show one line in the status bar: a notice for some seconds, an error until the next line.  The log keeps
        both.  `file` can be opened from there."""
        self.message = entry = self._add(Level.ERROR if error else Level.NOTICE, in_one_line(text), details)
        entry.file = file

    def report(self, failed: Failure) -> None:
        """Report a failure: in the status bar if such a thing may happen, else as an internal error."""
        if failed.expected:
            self.say(failed.text, error=True, details=failed.details)
        else:
            self.fault(failed)

    def fault(self, failed: Failure) -> Entry:
        """Report an internal error, also in the status bar; returns its entry in the log."""
        self.message = entry = self._add(Level.FAULT, failed.text, failed.details)
        return entry

    def _add(self, level: Level, text: str, details: str) -> Entry:
        """Add an entry to the log, or count it where it was said before: anything just now, a fault a while ago too."""
        now, fault = datetime.now(), level is Level.FAULT
        with self._lock:
            recent = list(self._entries)[-(RECENT_ENTRIES if fault else 1) :]
            entry = next((e for e in reversed(recent) if (e.level, e.text, e.details) == (level, text, details)), None)
            if entry is None:
                entry = Entry(level, text, details)
                self._entries.append(entry)
            entry.count, entry.at, entry.unread = entry.count + 1, now, entry.error
        self._wake()
        return entry

    @property
    def current(self) -> Entry | None:
        """The line to show now."""
        message = self.message
        expired = message is not None and not message.error and message.at < datetime.now() - INFO_LASTS
        return None if expired else message

    # --- the log ---------------------------------------------------------------------------------

    def entries(self) -> list[Entry]:
        """Return all entries, oldest first."""
        with self._lock:
            return list(self._entries)

    @property
    def unread(self) -> list[Entry]:
        """Errors and faults since the log was read."""
        return [entry for entry in self.entries() if entry.unread]

    def mark_read(self) -> None:
        for entry in self.entries():
            entry.unread = False

    @property
    def newest_fault(self) -> Entry | None:
        """The newest internal error since the log was read."""
        return next((entry for entry in reversed(self.unread) if entry.level is Level.FAULT), None)

    def clear(self) -> None:
        """Empty the log."""
        with self._lock:
            self._entries.clear()
