"""Paths that are typed, and the desktop's own dialog."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import pytest

from viewer.window.panels import dialogs
from viewer.window.panels.dialogs import OpenFileState
from viewer.window.ui import Dialog


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name in ("Robot.aff", "robot_2.aff", "plot.PNG", "notes.txt", ".hidden.aff", "deep/inner.obj", "deep/way.ply"):
        path = tmp_path / name
        path.parent.mkdir(exist_ok=True)
        path.touch()
    return tmp_path


@pytest.mark.parametrize(
    ("typed", "names"),
    [
        ("", ["deep/", "plot.PNG", "Robot.aff", "robot_2.aff"]),
        ("p", ["plot.PNG"]),
        ("rob", ["robot_2.aff"]),
        (".h", [".hidden.aff"]),
        ("de", ["deep/"]),
        ("deep/", ["deep/inner.obj", "deep/way.ply"]),
        ("deep/in", ["deep/inner.obj"]),
        ("gone/x", []),
    ],
)
def test_what_begins_as_typed_and_can_be_opened_is_listed(folder: Path, typed: str, names: list[str]) -> None:
    state = OpenFileState(folder=folder)
    state.type(typed)
    assert state.found == names


def test_where_the_desktop_has_a_dialog_it_asks(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    opened: list[Path] = []
    state, wanted, ready = OpenFileState(folder=folder), [Dialog.OPEN_FILE], [False, False, True]
    ui = SimpleNamespace(
        state=lambda kind: state, dialogs=wanted, close=wanted.remove,
        controller=SimpleNamespace(loader=SimpleNamespace(open=opened.append)),
    )  # fmt: skip
    chosen = SimpleNamespace(ready=lambda wait: ready.pop(0), result=lambda: [str(folder / "deep/inner.obj")])
    monkeypatch.setattr(dialogs, "has_native_dialog", lambda: True)
    monkeypatch.setattr(dialogs.native, "open_file", lambda *given: chosen)
    while ready:
        dialogs._open_file(ui)
    assert opened == [folder / "deep/inner.obj"] and state.folder == folder / "deep" and not wanted
