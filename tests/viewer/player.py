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
        self._process: subprocess.Popen[bytes] | None = None
        self._said = tempfile.TemporaryFile()  # noqa: SIM115
        # Windows on one screen take the keyboard from each other, and other processes may be testing as well.
        made = with_screen.start_screen() if shutil.which("Xvfb") else None
        self._screen, self._display = made or (None, os.environ.get("DISPLAY", ""))

    def play(self, name: str, size: tuple[int, int], scene: Path, settings: Path, last: bool) -> tuple[int, str]:
        """The exit code of the window, of its process if it is to be the `last` one there, and what was said."""
        if self._process is None:
            environment = os.environ | {"DISPLAY": self._display, "LIBGL_ALWAYS_SOFTWARE": "1"}
            self._process = subprocess.Popen(
                [sys.executable, "-m", "tests.viewer.real_window"], cwd=ROOT, env=environment,
                stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=self._said,
            )  # fmt: skip
        before = self._said.seek(0, os.SEEK_END)
        asked = {"name": name, "size": size, "scene": str(scene), "folder": str(scene.parent)}
        self._process.stdin.write(json.dumps(asked | {"settings": str(settings)}).encode() + b"\n")
        self._process.stdin.flush()
        ready = select.select([self._process.stdout], [], [], LONGEST)[0]
        code = int((self._process.stdout.readline() if ready else b"") or 1)
        if code or last:
            code = self.stop() or code
        self._said.seek(before)
        return code, self._said.read().decode(errors="replace")

    def stop(self) -> int:
        """Ask for no more, so that the process ends by itself; its exit code."""
        if self._process is None:
            return 0
        process, self._process = self._process, None
        process.stdin.close()
        try:
            return process.wait(timeout=60.0)
        except subprocess.TimeoutExpired:
            process.kill()
            return process.wait()

    def close(self) -> None:
        """End the process and the screen."""
        code = self.stop()
        if self._screen is not None:
            self._screen.terminate()
            self._screen.wait()
        self._said.close()
        assert code == 0, "the process that opens windows did not end well"
