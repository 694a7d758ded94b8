"""Has scenarios played in windows, by a process that lives as long as they go well, on a screen of its own."""

from __future__ import annotations

import json
import os
import select
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from tools import with_screen

ROOT = Path(__file__).resolve().parents[2]
LONGEST = 600.0  # seconds that a scenario may take


class Player:
    """Plays scenarios; starts its process when there is none, and has it end after one that went wrong."""

    def __init__(self) -> None:
        self._process: subprocess.Popen | None = None
        self._said = tempfile.TemporaryFile()  # noqa: SIM115
        # Windows on one screen take the keyboard from each other, and other processes may be testing as well.
        made = with_screen.start_screen() if shutil.which("Xvfb") else None
        self._screen, self._display = made or (None, os.environ.get("DISPLAY", ""))

    def play(self, name: str, size: tuple[int, int], scene: Path, settings: Path, last: bool) -> tuple[int, str]:
        """The exit code of the window, of its process if it is to be the `last` one there, and what was said."""
        if self._process is None:
            self._process = self._start()
        before = self._said.seek(0, os.SEEK_END)
        asked = {"name": name, "size": size, "scene": str(scene), "folder": str(scene.parent)}
        self._process.stdin.write(json.dumps(asked | {"settings": str(settings)}).encode() + b"\n")
        self._process.stdin.flush()
        ready = select.select([self._process.stdout], [], [], LONGEST)[0]
        answer = self._process.stdout.readline() if ready else b""
        code = int(answer or 1)
        if code or last:
            code = code or self._end()
            self.stop()
        self._said.seek(before)
        return code, self._said.read().decode(errors="replace")

    def stop(self) -> None:
        """End the process, however it is."""
        if self._process is not None:
            self._process.kill()
            self._process.communicate()
            self._process = None

    def close(self) -> None:
        """End the process, which must go by itself, and the screen."""
        code = 0 if self._process is None else self._end()
        self.stop()
        if self._screen is not None:
            self._screen.terminate()
            self._screen.wait()
        self._said.close()
        assert code == 0, "the process that opens windows did not end well"

    def _start(self) -> subprocess.Popen:
        environment = os.environ | {"DISPLAY": self._display, "LIBGL_ALWAYS_SOFTWARE": "1"}
        return subprocess.Popen(
            [sys.executable, "-m", "tests.viewer.real_window"],
            cwd=ROOT,
            env=environment,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._said,
        )

    def _end(self) -> int:
        """The exit code of the process, which ends as nobody asks it for more."""
        self._process.stdin.close()
        self._process.stdin = None
        return self._process.wait(timeout=60.0)
