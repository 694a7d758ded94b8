"""How a window ends, or does not begin: by signals, without OpenGL, with a layout that is not whole."""

from __future__ import annotations

import os
import signal
from pathlib import Path

import pytest

from tests.platforms import posix_only

pytest.importorskip("imgui_bundle")
from viewer.window import app
from viewer.window.layout_file import END, LayoutFile
from viewer.window.signals import closing_by_signals


@posix_only
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP, signal.SIGINT])
def test_a_signal_closes_and_a_second_one_ends(number: int) -> None:
    before, closed = signal.getsignal(number), []
    with closing_by_signals(lambda: closed.append(True)):
        os.kill(os.getpid(), number)
        assert closed == [True] and signal.getsignal(number) == before
    assert signal.getsignal(number) == before


def test_a_display_without_opengl_is_one_line() -> None:
    def fail(*_: object) -> None:
        raise RuntimeError('IM_ASSERT( false && "Failed to create temporary window." )')

    with pytest.raises(OSError, match=r"no OpenGL 3\.3; without one, use: shadowcull render"):
        app.App(None).run(fail)


def test_a_mistake_in_an_open_window_is_no_lack_of_opengl() -> None:
    window = app.App(None)

    def fail(*_: object) -> None:
        window.was_open = True
        raise RuntimeError("a mistake")

    with pytest.raises(RuntimeError, match="a mistake"):
        window.run(fail)


@pytest.mark.parametrize("written", ["", "[Layout]\n" * 9, f"[Layout]\n{END}\n", f'{END}\n{{"a":'])
def test_a_layout_that_is_not_whole_is_neither_kept_nor_read(tmp_path: Path, written: str) -> None:
    whole = f'[Layout]\nName=Default\n{END}\n{{"a":1}}\n'
    first = LayoutFile(tmp_path)
    first.working_copy.write_text(whole)
    first.keep()
    second = LayoutFile(tmp_path)
    assert second.working_copy.read_text() == whole
    second.working_copy.write_text(written)
    second.keep()
    assert [path.name for path in tmp_path.iterdir()] == ["layout.ini"]
    assert (tmp_path / "layout.ini").read_text() == whole
    (tmp_path / "layout.ini").write_text(written)
    third = LayoutFile(tmp_path)
    assert third.working_copy.read_text() == ""
    third.keep()
