"""What tests of the command line share: a folder of their own, which is the current one and holds the room."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.commands import ROOM, Run


@pytest.fixture(autouse=True)
def room(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "room.aff"
    path.write_text(ROOM)
    return path


@pytest.fixture
def run(capfd: pytest.CaptureFixture[str]) -> Run:
    return Run(capfd)
