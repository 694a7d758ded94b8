"""Messages to the user: one line in the status bar, a log of all lines, and faults of the program."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

from viewer.state.faults import Faults
from viewer.state.log import Entry, Level, Log
from viewer.util.failures import Failure
from viewer.util.messages import in_one_line

INFO_SECONDS = 6.0


@dataclass(frozen=True)
class Message:
    """One line for the status bar; `at` is when it was said, by the monotonic clock."""

    text: str
    error: bool
    at: float


class Notices:
    """`message` is the newest line; may be used from any thread."""

    def __init__(self, wake: Callable[[], None] = lambda: None) -> None:
        """`wake` makes the window draw a frame soon."""
        self._wake = wake
        self.log = Log()
        self.faults = Faults(self.log)
        self.message: Message | None = None

    def say(self, text: str, error: bool = False, details: str = "") -> None:
        """Show one line in the status bar: a notice for some seconds, an error until the next line.  The log keeps
        both."""
        self.message = Message(in_one_line(text), error, time.monotonic())
        self.log.add(Level.ERROR if error else Level.NOTICE, self.message.text, details)
        self._wake()

    def report(self, failed: Failure) -> None:
        """Report a failure: in the status bar if such a thing may happen, else as a fault of the program."""
        if failed.expected:
            self.say(failed.text, error=True, details=failed.details)
        else:
            self.fault(failed)

    def fault(self, failed: Failure) -> Entry:
        """Report a mistake of the program; returns its entry in the log."""
        entry = self.faults.add(failed)
        self._wake()
        return entry

    @property
    def current(self) -> Message | None:
        """The line to show now."""
        message = self.message
        if message is not None and not message.error and time.monotonic() - message.at > INFO_SECONDS:
            self.message = message = None
        return message
