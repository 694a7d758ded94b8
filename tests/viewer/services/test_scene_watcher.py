"""Files that a scene was read from: seen to change, once they rest; what is broken is one line."""

from __future__ import annotations

import os
import time
from pathlib import Path

import pytest
from PIL import Image

from tests.viewer.desk import Desk
from tracer.scene.files import Stamp, noting, stamp
from tracer.scene.load import load_scene
from tracer.scene.model import SceneError
from viewer.services.scene_watcher import SceneWatcher
from viewer.state.preferences import Preferences


class Looking:
    """A watcher whose looks are taken by hand."""

    def __init__(self, *paths: Path) -> None:
        self.preferences = Preferences()
        self.files: dict[Path, Stamp] = {path: stamp(path) for path in paths}
        self.may, self.reloads = True, []
        self.watcher = SceneWatcher(self.preferences, lambda: self.files, lambda: self.may, self.reloads.append)
        self.watcher._thread = self  # type: ignore[assignment]  # else one of its own would look as well
        self.watcher.reload_changed()

    def look(self) -> list[str]:
        self.watcher.look()
        self.watcher.reload_changed()
        return self.reloads


@pytest.fixture
def looking(tmp_path: Path) -> Looking:
    for name in ("a.aff", "b.png"):
        (tmp_path / name).write_text(name)
    return Looking(tmp_path / "a.aff", tmp_path / "b.png")


def write(path: Path, text: str) -> None:
    """So that its time differs, however coarse the clock of the disk is."""
    before = path.stat().st_mtime_ns if path.exists() else 0
    path.write_text(text)
    os.utime(path, ns=(before + 10**9, before + 10**9))


def test_nothing_is_read_while_nothing_changes(looking: Looking):
    assert looking.look() == looking.look() == []


def test_what_is_being_written_is_waited_for(looking: Looking, tmp_path: Path):
    for text in ("x", "xy", "xyz"):
        write(tmp_path / "a.aff", text)
        assert looking.look() == []
    assert looking.look() == ["a.aff"]
    assert looking.look() == ["a.aff"], "once"


def test_a_file_that_is_replaced_is_missing_for_a_while(looking: Looking, tmp_path: Path):
    (tmp_path / "b.png").unlink()
    assert [*looking.look(), *looking.look(), *looking.look()] == []
    write(tmp_path / "b.png", "new")
    assert looking.look() == []
    assert looking.look() == ["b.png"]


def test_what_was_missed_is_taken_when_it_comes(tmp_path: Path):
    looking = Looking(tmp_path / "later.png")
    assert looking.look() == []
    write(tmp_path / "later.png", "here")
    looking.look()
    assert looking.look() == ["later.png"]


def test_nothing_is_read_again_while_that_is_switched_off_or_cannot_be(looking: Looking, tmp_path: Path):
    looking.preferences.watch_scene = False
    for name in ("a.aff", "b.png"):
        write(tmp_path / name, "other")
    assert [*looking.look(), *looking.look()] == []
    looking.preferences.watch_scene, looking.may = True, False
    assert looking.look() == []
    looking.may = True
    assert looking.look() == ["a.aff and 1 more"]


def test_all_that_a_scene_names_is_noted(tmp_path: Path, tiny_scene_file: Path):
    Image.new("RGB", (2, 2)).save(tmp_path / "there.png")
    part = tmp_path / "part.aff"
    part.write_text("tt there.png\n0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1\ntt gone.png\n0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1\n")
    tiny_scene_file.write_text(tiny_scene_file.read_text() + "\ni 0 part.aff\n")
    files: dict[Path, Stamp] = {}
    with noting(files):
        load_scene(tiny_scene_file)
    assert files == {p: stamp(p) for p in (tiny_scene_file, part, tmp_path / "there.png", tmp_path / "gone.png")}
    assert files[tmp_path / "gone.png"] is None

    mesh, materials = tmp_path / "mesh.obj", tmp_path / "mesh.mtl"
    materials.write_text("newmtl red\nKd 1 0 0\n")
    mesh.write_text("mtllib mesh.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n")
    files = {}
    with noting(files):
        load_scene(mesh)
    assert {mesh, materials} <= files.keys()
    part.write_text("p nonsense\n")
    files = {}
    with noting(files), pytest.raises(SceneError):
        load_scene(tiny_scene_file)
    assert part in files, "also where it is broken"


def test_a_scene_is_read_again_in_its_place_and_a_broken_one_is_not(desk: Desk, tiny_scene_file: Path):
    c = desk.c
    c.loader.open(tiny_scene_file)
    desk.until(lambda: c.loader.load_job is None)
    desk.rest()
    c.settings.change(method="paper", depth=3)
    c.motion.move(c.session.camera)
    c.session.change(time=0.5)
    desk.rest()
    here, good, undoes = c.session.state, tiny_scene_file.read_text(), c.undo.undoes

    write(tiny_scene_file, good + "\nl 0 9 0  0.1 0.1 0.1\n")
    desk.until(lambda: len(c.session.scene.lights) == 3)
    desk.rest()
    assert "tiny.aff reloaded" in desk.said and desk.said.endswith(": tiny.aff changed")
    assert c.session.state == here and c.undo.undoes == undoes, "place and steps are kept"
    scene = c.session.scene

    write(tiny_scene_file, good + "\nl 0 nine\n")
    desk.until(lambda: c.notices.message.error)
    line = len(good.splitlines()) + 2
    assert f"tiny.aff:{line}" in desk.said and "\n" not in desk.said and c.session.scene is scene
    write(tiny_scene_file, good)
    desk.until(lambda: c.session.scene is not scene)
    assert len(c.session.scene.lights) == 2 and c.session.state == here
    c.preferences.watch_scene = False
    now = c.session.scene
    write(tiny_scene_file, good + "\n")
    end = time.monotonic() + 1.0
    desk.until(lambda: time.monotonic() > end)
    assert c.session.scene is now
