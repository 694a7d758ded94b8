"""How a window ends, or does not begin: by signals, without OpenGL, with a layout that is not whole."""

from __future__ import annotations

import os
import signal
from pathlib import Path

import pytest

from tests.platforms import posix_only

pytest.importorskip("imgui_bundle")
from viewer.window import app, gl_window
from viewer.window.gl_window import LOSS_SECONDS, MOST_LOSSES, ContextLoss, closing_by_signals
from viewer.window.layout_file import END, LayoutFile


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


def test_a_window_that_was_full_begins_at_its_own_place(tmp_path: Path) -> None:
    written = f"[AppWindow]\nWindowPosition=0,0\nWindowSize=1600,1000\n{END}\n{{}}\n"
    layout = LayoutFile(tmp_path)
    layout.working_copy.write_text(written)
    layout.put_window(None)
    assert layout.working_copy.read_text() == written
    layout.put_window((5, -6, 700, 800))
    layout.keep()
    assert (tmp_path / "layout.ini").read_text() == (
        f"[AppWindow]\nWindowPosition=5,-6\nWindowSize=700,800\n{END}\n{{}}\n"
    )


def test_a_driver_that_is_reset_again_and_again_ends_the_window(monkeypatch: pytest.MonkeyPatch) -> None:
    window, opened = app.App(None), []
    monkeypatch.setattr(gl_window, "_gives_window", lambda robust: True)

    def lose(*_: object) -> None:
        window.was_open = True
        opened.append(True)
        window.context_loss.status = lambda: 0x8253
        assert window.context_loss.is_lost()

    with pytest.raises(OSError, match="took too long, again and again"):
        window.run(lose)
    assert len(opened) == MOST_LOSSES


def test_what_fails_as_the_context_is_lost_is_no_fault() -> None:
    window = app.App(None)
    notices = window.controller.notices

    def fail() -> None:
        raise RuntimeError("the driver said no")

    window._draws("Drawing", fail)
    assert notices.newest_fault is not None and "the driver said no" in notices.newest_fault.text
    notices.dismiss_faults()
    window.context_loss.status = lambda: 0x8253
    window._draws("Drawing", fail)
    assert notices.newest_fault is None and window.context_loss.cause


def test_losses_long_ago_do_not_count() -> None:
    now = [0.0]
    losses = ContextLoss(lambda: now[0])
    losses.status = lambda: 0x8254
    for _ in range(3 * MOST_LOSSES):
        now[0] += LOSS_SECONDS / 2
        assert losses.is_lost() and losses.is_lost() and "another program" in losses.cause and not losses.too_many
        losses.cause = ""


def test_a_driver_without_contexts_that_tell_of_their_loss_gives_another(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[bool] = []
    monkeypatch.setattr(gl_window, "_set_context_hints", lambda robust: asked.append(robust) or True)
    monkeypatch.setattr(gl_window, "_gives_window", lambda robust: not robust)

    def run() -> None:
        if asked[-1]:
            raise RuntimeError("this driver cannot")

    gl_window.open_window(run, lambda: False)
    assert asked == [True, False]
