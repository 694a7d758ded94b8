"""The command line in this process, and a small room to try it on."""

from __future__ import annotations

import os
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from viewer.__main__ import main
from viewer.cli.console import Work

ROOM = """\
b 0.2 0.3 0.4
v from 0 1 4 at 0 0 0 up 0 1 0 angle 50 hither 1 resolution 32 32
a 0 9 10
l 2 4 3 1 1 1
l -3 4 2 0.5 0.5 0.5
f 0.8 0.6 0.4 0.9 0.1 10 0 1
p 4 -2 -1 -2 -2 -1 2 2 -1 2 2 -1 -2
f 0.3 0.5 0.8 0.9 0.1 10 0 1
s 0 0 0 0.5
x flyer { p 3 -0.2 0.8 0 0.2 0.8 0 0 1.1 0 }
k flyer { visibility 1 0 1
          transl 4 -1 0 0 0 0 0 0  0 0 0 0 0 0 0  9 1 0 0 0 0 0  10 1 0 0 0 0 0 }
"""


CAMERA = {"position": [0, 2, 3], "direction": [0, -0.5, -1], "up": [0, 1, 0], "angle": 40}


def shell_words(line: str) -> list[str]:
    """The words of a line as a shell takes them."""
    said = subprocess.run(["bash", "-c", f"printf '%s\\0' {line}"], capture_output=True, env={"LC_ALL": "C.UTF-8"})
    return [os.fsdecode(word) for word in said.stdout.split(b"\0")[:-1]]


def run(capfd: pytest.CaptureFixture[str], *arguments: object) -> tuple[int, str, str]:
    """Exit code, standard output and standard error of a command line."""
    try:
        code = main([str(a) for a in arguments])
    except SystemExit as end:
        code = int(end.code or 0)
    out, err = capfd.readouterr()
    return code, out, err


def complaint(result: tuple[int, str, str]) -> str:
    """The one line that a failed command says."""
    code, out, err = result
    assert code != 0
    assert out == ""
    assert err.startswith("shadowcull: error: ") and err.count("\n") == 1 and err.endswith("\n"), err
    return err


class Run:
    """Command lines of a test: what they print, and the files they write in the current folder."""

    def __init__(self, capfd: pytest.CaptureFixture[str]) -> None:
        self._capfd = capfd

    def __call__(self, *arguments: object) -> tuple[int, str, str]:
        """Exit code, standard output and standard error."""
        return run(self._capfd, *arguments)

    def ok(self, *arguments: object) -> str:
        """The standard output of a command that succeeds."""
        code, out, err = self(*arguments)
        assert code == 0, err
        return out

    def fails(self, *arguments: object) -> str:
        """The one line that a failing command says."""
        return complaint(self(*arguments))


def pixels(path: Path | str) -> NDArray[np.uint8]:
    """(h, w, 3) uint8 of a written picture."""
    with Image.open(path) as image:
        return np.asarray(image.convert("RGB"))


def stop_at(monkeypatch: pytest.MonkeyPatch, wanted: Callable[[str, int], bool]) -> None:
    """Press Ctrl-C once a command's progress, a label and how much is done, is as wanted."""
    count = Work.count

    def counted(work: Work, label: str, done: int, total: int) -> None:
        count(work, label, done, total)
        work.stopped = work.stopped or wanted(label, done)

    monkeypatch.setattr(Work, "count", counted)
