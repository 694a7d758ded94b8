"""The real window, driven by keyboard and pointer: the scenarios of `tests.viewer.scenarios`.

All in the smaller of two sizes, and by `make test-all` at both in turn."""

from __future__ import annotations

import json
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

from tests.sweeps import cases
from tests.viewer.driver import SIZES
from tests.viewer.player import Player
from tests.viewer.scenarios import SCENARIOS

pytestmark = pytest.mark.gui


@pytest.fixture(scope="module")
def player() -> Iterator[Player]:
    player = Player()
    yield player
    player.close()


def size_of(number: int) -> tuple[int, int]:
    return cases(SIZES[0], SIZES[number % len(SIZES)])


def _ends_the_process(name: str) -> bool:
    return name.startswith("closing_while")


@pytest.mark.parametrize(
    ("name", "size"),
    [
        pytest.param(name, size_of(number), id=name, marks=() if name == "flying" else pytest.mark.slow)
        for number, name in enumerate(sorted(SCENARIOS, key=_ends_the_process))
    ],
)
def test_window(name: str, size: tuple[int, int], player: Player, tiny_scene_file: Path, own_settings: Path) -> None:
    (tiny_scene_file.parent / "big.aff").write_text(_big_scene())
    code, said = player.play(name, size, tiny_scene_file, own_settings, last=_ends_the_process(name))
    assert code == 0, said[-6000:]
    assert "[imgui-error]" not in said, "ImGui was used wrongly"
    settings = json.loads((own_settings / "settings.json").read_text())
    assert str(tiny_scene_file) in settings["recent"]
    kept = {p.name for p in own_settings.iterdir() if p.suffix != ".lock"}
    assert kept == {"settings.json", "layout.ini"}, "something was left half-written"


@cache
def _big_scene() -> str:
    """Enough triangles for loading to take a while."""
    lines = ["v", "from 0 0 50", "at 0 0 0", "up 0 1 0", "angle 40", "hither 0.1", "resolution 8 8", "l 1 9 30"]
    lines.append("f 1 0 0 1 0 1 0 1")
    for i in range(60000):
        x, y, z = i % 40, i // 40 % 40, i // 1600
        lines.append(f"p 3\n{x} {y} {z}\n{x + 1} {y} {z}\n{x} {y + 1} {z + 0.5}")
    return "\n".join(lines) + "\n"
