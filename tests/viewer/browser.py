"""A real browser without a window: headless Chromium, driven over its debugging pipe."""

from __future__ import annotations

import json
import os
import select
import shutil
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

_NAMES = ("chromium", "chromium-browser", "google-chrome")
CHROMIUM = next((path for name in _NAMES if (path := shutil.which(name))), "")
_PATIENCE = 60.0  # seconds
_QUIET = ("--headless", "--disable-gpu", "--no-first-run", "--remote-debugging-pipe", "--window-size=1300,900")


class Page:
    """A page, to which commands of the DevTools protocol are sent as JSON, each ended by a NUL."""

    def __init__(self, send: int, receive: int) -> None:
        self._send, self._receive, self._number, self._session, self._read = send, receive, 0, {}, b""
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        self._session = {"sessionId": session}

    def call(self, method: str, **parameters: Any) -> dict[str, Any]:
        """Send a command; what it answers."""
        self._number += 1
        message = {"id": self._number, "method": method, "params": parameters} | self._session
        os.write(self._send, json.dumps(message).encode() + b"\0")
        while True:
            while b"\0" not in self._read:
                assert select.select([self._receive], [], [], _PATIENCE)[0], f"the browser does not answer {method}"
                more = os.read(self._receive, 1 << 16)
                assert more, "the browser has ended"
                self._read += more
            line, self._read = self._read.split(b"\0", 1)
            answer = json.loads(line)
            if answer.get("id") == self._number:
                assert "error" not in answer, answer
                return answer["result"]

    def ask(self, expression: str) -> Any:
        """Return the value of an expression of JavaScript, awaited if it is a promise."""
        answer = self.call("Runtime.evaluate", expression=expression, awaitPromise=True, returnByValue=True)
        assert "exceptionDetails" not in answer, answer
        return answer["result"].get("value")

    def open(self, path: Path, anchor: str = "") -> None:
        """Open a file, and wait until its script says that it is ready."""
        self.call("Page.navigate", url="about:blank")
        self.call("Page.navigate", url=f"{path.as_uri()}#{anchor}")
        ready = "new Promise((done) => { const look = () => document.body?.dataset.ready ? done(true) : "
        assert self.ask(ready + "setTimeout(look, 20); look(); })")

    def click(self, x: float, y: float) -> None:
        """Click a place of the window."""
        for kind in ("mousePressed", "mouseReleased"):
            self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", clickCount=1)

    def press(self, key: str) -> None:
        for kind in ("keyDown", "keyUp"):
            self.call("Input.dispatchKeyEvent", type=kind, key=key)


@contextmanager
def browser(folder: Path) -> Iterator[Page]:
    """Start a browser that keeps what it must in a folder."""
    commands, ours = os.pipe()
    theirs, answers = os.pipe()
    sandbox = ["--no-sandbox"] if os.geteuid() == 0 else []
    started = subprocess.Popen(
        ["bash", "-c", f'exec "$@" 3<&{commands} 4>&{answers}', "bash", CHROMIUM, *_QUIET, *sandbox,
         f"--user-data-dir={folder}"],
        pass_fds=(commands, answers), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
    )  # fmt: skip
    os.close(commands)
    os.close(answers)
    try:
        yield Page(ours, theirs)
    finally:
        started.kill()
        started.wait()
        os.close(ours)
        os.close(theirs)
