"""Opening scenes and saved pictures beside the window: what arrives, what is said of what does not, and what is read
again when its files change."""

from __future__ import annotations

import gc
import os
import threading
import time
import weakref
from pathlib import Path

import numpy as np
import pytest

from tests.viewer.desk import Desk
from tests.viewer.fakes import make_frame, until
from tracer.scene.files import stamp
from tracer.scene.model import Scene, SceneError
from viewer.services.controller import Controller
from viewer.services.scene_files import FileWatch
from viewer.services.scene_loader import Arrival


def arrival(c: Controller) -> Arrival | None:
    """What comes of the load that is under way."""
    came: list[Arrival | None] = []
    until(lambda: came.append(c.loader.take_finished()) or came[-1] is not None or not c.loader.busy)
    return came[-1]


def opened(c: Controller, path: Path) -> Scene:
    c.loader.open(path)
    return arrival(c).renderer.scene


def test_a_load_that_is_overtaken_never_arrives(c: Controller, tiny_scene_file: Path):
    other = tiny_scene_file.with_name("other.aff")
    other.write_text(tiny_scene_file.read_text())
    c.loader.open(tiny_scene_file)
    c.loader.open(other)
    assert arrival(c).renderer.scene.path == other


def test_settings_of_the_command_line_are_those_of_what_is_opened_first(
    c: Controller, tiny_scene_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    """Also where a saved place in it has others."""
    c.preferences.screenshot_folder = str(tmp_path / "pictures")
    c.session.open(opened(c, tiny_scene_file))
    c.captures.capture(make_frame(time=1.0), np.zeros((8, 16, 3), np.uint8))
    assert c.captures.saving.pop().join(20.0)
    (picture,) = (tmp_path / "pictures").iterdir()
    c.session.scene = None
    monkeypatch.setattr("viewer.services.scene_loader.warm_up", lambda progress: None)
    c.loader.start({"lamp_radius": 0.5})
    assert c.session.settings.lamp_radius == 0.5, "also where a scene is opened that says nothing of it"
    for radius in (0.5, None):
        c.loader.open(picture)
        came = arrival(c)
        assert came.renderer.scene.path == tiny_scene_file and came.place.time == 1.0
        assert came.place.settings.lamp_radius == radius


def test_a_cancelled_load_is_gone_at_once_though_it_cannot_stop(c: Controller, tiny_scene_file: Path, monkeypatch):
    """As within a library that reads a mesh; and the scene that has waited in vain is let go."""
    deaf, read, before = threading.Event(), [], opened(c, tiny_scene_file)

    def waits(scene, settings, progress):
        read.append(weakref.ref(scene))
        deaf.wait(60.0)
        raise SceneError("no more")

    monkeypatch.setattr("viewer.services.scene_loader.build", waits)
    c.session.open(before)
    c.loader.open(tiny_scene_file)
    until(lambda: read)
    job = c.loader.load_job
    c.loader.cancel()
    assert not c.loader.busy
    assert c.notices.message.text == "loading cancelled; the open scene stays"
    monkeypatch.undo()
    assert opened(c, tiny_scene_file).path == tiny_scene_file, "another is opened meanwhile"
    deaf.set()
    assert job.join(20.0) and c.loader.take_finished() is None
    del job
    gc.collect()
    assert read[0]() is None


# --- files that change -----------------------------------------------------------------------------


def write(path: Path, text: str) -> None:
    """So that its time differs, however coarse the clock of the disk is."""
    before = path.stat().st_mtime_ns if path.exists() else 0
    path.write_text(text)
    os.utime(path, ns=(before + 10**9, before + 10**9))


def test_what_has_changed_is_told_once_and_when_it_rests(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    for name in ("a.aff", "b.png"):
        (tmp_path / name).write_text(name)
    watch = FileWatch()
    watch.files = {path: stamp(path) for path in (tmp_path / "a.aff", tmp_path / "b.png", tmp_path / "later.png")}
    monkeypatch.setattr("viewer.services.scene_files.LOOK_SECONDS", 0.0)

    def looks() -> str:
        assert watch.changed() == ""
        watch._look.result()
        return watch.changed()

    assert [looks(), looks()] == ["", ""]
    for text in ("x", "xy", "xyz"):
        write(tmp_path / "a.aff", text)
        assert looks() == "", "it is being written"
    assert [looks(), looks()] == ["a.aff", ""]
    (tmp_path / "b.png").unlink()
    assert [looks(), looks(), looks()] == ["", "", ""], "it is about to be replaced"
    write(tmp_path / "b.png", "new")
    write(tmp_path / "later.png", "what was missed")
    assert [looks(), looks(), looks()] == ["", "b.png and 1 more", ""]


def test_a_broken_scene_is_told_of_and_read_once_it_is_mended_and_none_where_that_is_not_wanted(
    desk: Desk, tiny_scene_file: Path
):
    c, good = desk.c, tiny_scene_file.read_text()
    c.loader.open(tiny_scene_file)
    desk.rest()
    c.settings.change(depth=3)
    desk.rest()
    scene, state, undoes = c.session.scene, c.session.state, c.undo.undoes
    write(tiny_scene_file, good + "\nl 0 nine\n")
    desk.until(lambda: c.notices.message.error)
    line = len(good.splitlines()) + 2
    assert f"tiny.aff:{line}" in desk.said and "\n" not in desk.said and c.session.scene is scene
    write(tiny_scene_file, good + "\nl 0 9 0  0.1 0.1 0.1\n")
    desk.until(lambda: c.session.scene is not scene)
    assert len(c.session.scene.lights) == 3 and desk.said.endswith(": tiny.aff changed")
    assert c.session.state == state and c.undo.undoes == undoes, "place and steps are kept"
    c.preferences.watch_scene, scene = False, c.session.scene
    write(tiny_scene_file, good)
    end = time.monotonic() + 1.0
    desk.until(lambda: time.monotonic() > end)
    assert c.session.scene is scene
