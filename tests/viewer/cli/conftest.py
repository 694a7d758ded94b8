"""What tests of the command line share."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.commands import ROOM


@pytest.fixture
def room(tmp_path: Path) -> Path:
    path = tmp_path / "room.aff"
    path.write_text(ROOM)
    return path
