"""What the viewer's tests share: settings of their own, a clock, controllers, and desks where something is traced."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from tests.viewer.desk import Desk
from tests.viewer.fakes import TINY_SCENE, Clock, make_scene
from viewer.services import refinement
from viewer.services.controller import Controller
from viewer.state.preferences import Preferences
from viewer.util.resources import embedded_scenes
from viewer.window import commands
from viewer.window.ui import Ui


@pytest.fixture(autouse=True)
def own_settings(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A configuration folder of each test's own."""
    folder = tmp_path / "config"
    monkeypatch.setenv("SHADOWCULL_CONFIG_DIR", str(folder))
    return folder


@pytest.fixture
def tiny_scene_file(tmp_path: Path) -> Path:
    """A sphere on a square with two lights, 20 frames long, as an AFF file."""
    path = tmp_path / "tiny.aff"
    path.write_text(TINY_SCENE)
    return path


@pytest.fixture
def desk_at(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[[Path], Desk]]:
    """Opens the scene of a file at a desk."""
    monkeypatch.setattr(refinement, "MOST_FRAMES", 4)  # at rest with certificates: more show nothing that these do not
    desks: list[Desk] = []

    def at(path: Path) -> Desk:
        desks.append(Desk(path, tmp_path / "pictures"))
        return desks[-1]

    yield at
    for desk in desks:
        assert desk.c.close()


@pytest.fixture
def desk(desk_at: Callable[[Path], Desk], tiny_scene_file: Path) -> Desk:
    return desk_at(tiny_scene_file)


@pytest.fixture
def figure4(desk_at: Callable[[Path], Desk]) -> Desk:
    return desk_at(embedded_scenes()["figure4"])


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    clock = Clock()
    monkeypatch.setattr("time.monotonic", lambda: clock.now)
    return clock


@pytest.fixture
def c() -> Iterator[Controller]:
    """A controller with the scene of numbers open, of which nothing is traced."""
    c = Controller(Preferences())
    c.session.open(make_scene())
    yield c
    assert c.close()


@pytest.fixture
def ui() -> Iterator[Ui]:
    """What panels share, with its commands, without a window."""
    ui = Ui(Controller(Preferences(keys={"Focus": ["Hyper+X", "Ctrl+J", "Nonsense", ""], "No command": ["X"]})))
    ui.take_commands(commands.build(ui))
    yield ui
    ui.controller.close()
