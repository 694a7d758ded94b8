"""The command line in this process, and a small room to try it on."""

from __future__ import annotations

import pytest

from viewer.__main__ import main

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


def run(capfd: pytest.CaptureFixture[str], *arguments: object) -> tuple[int, str, str]:
    """Exit code, standard output and standard error of a command line."""
    try:
        code = main([str(a) for a in arguments])
    except SystemExit as end:
        code = int(end.code or 0)
    out, err = capfd.readouterr()
    return code, out, err


def render(capfd: pytest.CaptureFixture[str], *arguments: object) -> tuple[int, str, str]:
    return run(capfd, "render", *arguments, "--size", "48x32", "--threads", 1)


def complaint(result: tuple[int, str, str]) -> str:
    """The one line that a failed command says."""
    code, out, err = result
    assert code != 0
    assert out == ""
    assert err.startswith("shadowcull: error: ") and err.count("\n") == 1 and err.endswith("\n"), err
    return err
