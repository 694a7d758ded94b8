"""How a window ends, or does not begin: by signals, without OpenGL."""

from __future__ import annotations

import os
import signal

import pytest

from tests.platforms import posix_only

pytest.importorskip("imgui_bundle")
from viewer.window import app
from viewer.window.gl_window import closing_by_signals


@posix_only
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP, signal.SIGINT])
def test_a_signal_closes_and_a_second_one_ends(number: int) -> None:
    before, closed = signal.getsignal(number), []
    with closing_by_signals(lambda: closed.append(True)):
        os.kill(os.getpid(), number)
        assert closed == [True] and signal.getsignal(number) == before
    assert signal.getsignal(number) == before


@pytest.mark.parametrize(
    ("opened", "error", "said"),
    [(False, OSError, r"no OpenGL 3\.3; without one, use: shadowcull render"), (True, RuntimeError, "a mistake")],
)
def test_only_what_happens_before_a_window_is_lack_of_opengl(opened: bool, error: type[Exception], said: str) -> None:
    window = app.App(None)

    def fail(*_: object) -> None:
        window.was_open = opened
        raise RuntimeError("a mistake")

    with pytest.raises(error, match=said):
        window.run(fail)
