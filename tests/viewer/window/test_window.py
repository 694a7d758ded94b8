"""The real window, driven by keyboard and pointer: the scenarios of `tests.viewer.scenarios`.

All in the smaller of two sizes, and by `make test-all` at both in turn."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.sweeps import cases
from tests.viewer.driver import SIZES
from tests.viewer.fakes import wall_of_triangles
from tests.viewer.player import Player
from tests.viewer.scenarios import SCENARIOS

pytestmark = pytest.mark.gui
LAST = "closing_while_loading"
"""What ends its process, and so whatever threads windows have left."""


@pytest.fixture(scope="module")
def player() -> Iterator[Player]:
    player = Player()
    yield player
    player.close()


def size_of(number: int) -> tuple[int, int]:
    return cases(SIZES[0], SIZES[number % len(SIZES)])


@pytest.mark.parametrize(
    ("name", "size"),
    [
        pytest.param(name, size_of(number), id=name, marks=() if name == "flying" else pytest.mark.slow)
        for number, name in enumerate(sorted(SCENARIOS, key=lambda name: name == LAST))
    ],
)
def test_window(name: str, size: tuple[int, int], player: Player, tiny_scene_file: Path, own_settings: Path) -> None:
    (tiny_scene_file.parent / "big.aff").write_text(wall_of_triangles(40, 40, range(38)))  # takes a while to load
    code, said = player.play(name, size, tiny_scene_file, own_settings, last=name == LAST)
    assert code == 0, said[-6000:]
    assert "[imgui-error]" not in said, "ImGui was used wrongly"
    settings = json.loads((own_settings / "settings.json").read_text())
    assert str(tiny_scene_file) in settings["recent"]
    kept = {p.name for p in own_settings.iterdir() if p.suffix != ".lock"}
    assert kept == {"settings.json", "layout.ini"}, "something was left half-written"
