"""Commands as people see them: on a terminal, with keys pressed once something is shown."""

from __future__ import annotations

import os
import re
import select
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent


class Terminal:
    """A command on a terminal of its own: what it says, and keys for it."""

    def __init__(self, *arguments: str) -> None:
        pty = pytest.importorskip("pty", reason="Windows has no such terminals")
        self._end, inside = pty.openpty()
        command = [sys.executable, "-m", "viewer", *arguments]
        environment = os.environ | {"TERM": "xterm", "COLUMNS": "80"}
        self._process = subprocess.Popen(
            command, cwd=ROOT, env=environment, stdin=inside, stdout=inside, stderr=inside, start_new_session=True
        )
        os.close(inside)
        self.said = ""

    def lines(self, seconds: float = 120.0) -> Iterator[str]:
        """All that is said so far, each time there is more of it, until the command ends."""
        until = time.monotonic() + seconds
        while select.select([self._end], [], [], max(0.0, until - time.monotonic()))[0]:
            try:
                read = os.read(self._end, 65536)
            except OSError:  # what Linux says where the other side is closed
                return
            if not read:
                return
            self.said += re.sub(r"\x1b\[[0-9;?]*[a-zA-Z]", "", read.decode(errors="replace"))
            yield self.said
        raise AssertionError(f"it says no more and does not end: {self.said[-300:]}")

    def interrupt_once(self, shown: str) -> None:
        """Press Ctrl-C once a pattern is shown, and see it through to its end."""
        pressed = False
        for said in self.lines():
            if not pressed and re.search(shown, said):
                self._process.send_signal(signal.SIGINT)
                pressed = True
        assert pressed, f"never shown: {shown}: {self.said[-300:]}"

    def end(self) -> int:
        os.close(self._end)
        return self._process.wait(timeout=60)
