"""How many pictures come in a second."""

from __future__ import annotations

from collections import deque

SPAN = 1.0
"""Seconds back that pictures count, or as far as the last two reach."""


def in_words(rate: float) -> str:
    """Pictures a second; nothing where so few come that it would read 0.0."""
    shown = f"{rate:.0f}" if rate >= 9.5 else f"{rate:.1f}"
    return f"{shown} pictures/s" if shown != "0.0" else ""


class Rate:
    """Times of the newest pictures, in seconds."""

    def __init__(self) -> None:
        self._came: deque[float] = deque()

    def count(self, now: float) -> None:
        """A picture has come."""
        self._came.append(now)
        while len(self._came) > 2 and self._came[0] < now - SPAN:
            self._came.popleft()

    def per_second(self, now: float) -> float | None:
        """Pictures a second, None while none are coming: before the second, and when the next is long overdue."""
        if len(self._came) < 2:
            return None
        first, last = self._came[0], self._came[-1]
        apart = (last - first) / (len(self._came) - 1)
        return 1.0 / apart if apart > 0.0 and now - last <= max(SPAN, 2.0 * apart) else None

    def forget(self) -> None:
        self._came.clear()
