"""Mistakes of the program that its window outlives: the newest is a notice until it is dismissed, all are in the log.

What fails in every frame would come back at once when it is dismissed; it stays away until it has not failed for a
while."""

from __future__ import annotations

import time

from viewer.state.log import Entry, Level, Log
from viewer.util.failures import Failure

QUIET_AFTER = 0.5  # seconds without it after which a fault is news again: longer than a frame, shorter than a hand


class Faults:
    """`notice` is the fault to be shown, `others` how many different ones came since and before it, unseen."""

    def __init__(self, log: Log) -> None:
        self._log = log
        self._unseen: list[Entry] = []
        self._last: dict[str, float] = {}

    @property
    def notice(self) -> Entry | None:
        return self._unseen[-1] if self._unseen else None

    @property
    def others(self) -> int:
        return max(0, len(self._unseen) - 1)

    def add(self, failed: Failure) -> Entry:
        """Log it, and show it unless it was just dismissed; may be called from any thread."""
        entry = self._log.add(Level.FAULT, failed.text, failed.details)
        now = time.monotonic()
        news = now - self._last.get(entry.text, -QUIET_AFTER) >= QUIET_AFTER
        self._last[entry.text] = now
        if news and entry not in self._unseen:
            self._unseen.append(entry)
        return entry

    def dismiss(self) -> None:
        """They have been seen."""
        self._unseen = []
