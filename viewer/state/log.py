"""What has happened while the window is open: every message with its time, newest last, and what lies behind it.

Threads may write to it at any time.  The same thing said again is counted, so that what fails in every frame is one
entry."""

from __future__ import annotations

import threading
from collections import deque
from dataclasses import dataclass
from datetime import datetime
from enum import Enum

MOST = 500
_ALIKE_WITHIN = 20  # entries back that the same fault is looked for


class Level(Enum):
    """How bad it is."""

    NOTICE = "notice"
    ERROR = "error"  # something the user asked for could not be done
    FAULT = "fault"  # a mistake of the program


@dataclass
class Entry:
    """One line, how often it was said, and when last; `details` may be many lines, such as a traceback."""

    level: Level
    text: str
    details: str = ""
    count: int = 1
    at: datetime = datetime.min

    @property
    def matters(self) -> bool:
        """Whether it is to be read, and not merely a notice."""
        return self.level is not Level.NOTICE

    @property
    def as_text(self) -> str:
        """All of it as text, to be copied."""
        times = f" ({self.count} times)" if self.count > 1 else ""
        head = f"{self.at:%Y-%m-%d %H:%M:%S}  {self.level.value}: {self.text}{times}"
        return f"{head}\n{self.details.rstrip()}\n" if self.details else f"{head}\n"


class Log:
    """The newest entries, MOST at most."""

    def __init__(self) -> None:
        self._entries: deque[Entry] = deque(maxlen=MOST)
        self._lock = threading.Lock()
        self._unread: list[Entry] = []

    @property
    def unread(self) -> list[Entry]:
        """Errors and faults that came since the log was read, oldest first."""
        with self._lock:
            return list(self._unread)

    def read(self) -> None:
        """All of it has been seen."""
        with self._lock:
            self._unread = []

    def add(self, level: Level, text: str, details: str = "") -> Entry:
        """Note it, or count it where it was said before: anything just now, a fault a while ago too."""
        with self._lock:
            back = _ALIKE_WITHIN if level is Level.FAULT else 1
            recent = list(self._entries)[-back:]
            entry = next((e for e in reversed(recent) if (e.level, e.text, e.details) == (level, text, details)), None)
            if entry is not None:
                entry.count += 1
            else:
                entry = Entry(level, text, details)
                self._entries.append(entry)
            entry.at = datetime.now()
            if entry.matters and not any(entry is other for other in self._unread):
                self._unread.append(entry)
            return entry

    def entries(self) -> list[Entry]:
        """Oldest first."""
        with self._lock:
            return list(self._entries)

    def clear(self) -> None:
        with self._lock:
            self._entries.clear()
            self._unread = []
