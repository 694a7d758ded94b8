"""Opening scenes and saved pictures beside the window: what arrives, what is said of what does not, and what is read
again when its files change."""

from __future__ import annotations

import gc
import os
import threading
import time
import weakref
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from tests.viewer.desk import Desk
from tests.viewer.fakes import make_frame
from tracer.scene.files import Stamp, noting, stamp
from tracer.scene.load import load_scene
from tracer.scene.model import SceneError
from viewer.services.capture_service import CaptureService
from viewer.services.scene_files import FileWatch
from viewer.services.scene_loader import Arrival, SceneLoader
from viewer.state.notices import Notices
from viewer.state.preferences import Preferences
from viewer.state.session import Session
from viewer.state.views import View


class Door:
    """A loader with a session that it opens scenes for; `refuse` says no to every question."""

    def __init__(self, folder: Path) -> None:
        self.session, self.notices = Session(), Notices()
        self.preferences = Preferences(screenshot_folder=str(folder))
        self.refuse = False
        self.asked: list[str] = []
        self.loader = SceneLoader(self.session, self.preferences, self.notices, self.ask)
        self.captures = CaptureService(self.session, self.preferences, self.notices)

    def ask(self, name: str, go_on: Callable[[], None]) -> None:
        self.asked.append(name)
        if not self.refuse:
            go_on()

    def arrival(self) -> Arrival | None:
        """What comes of the load that is under way."""
        end = time.monotonic() + 300.0  # kernels may be compiled first
        while True:
            arrival = self.loader.take_finished()
            if arrival is not None or not self.loader.busy:
                return arrival
            assert time.monotonic() < end, "in vain"
            time.sleep(0.002)

    @property
    def said(self) -> str:
        return self.notices.current.text if self.notices.current is not None else ""


@pytest.fixture
def door(tmp_path: Path) -> Door:
    return Door(tmp_path / "pictures")


def test_a_scene_arrives_with_a_renderer_and_what_it_holds(door: Door, tiny_scene_file: Path):
    door.loader.open(tiny_scene_file)
    arrival = door.arrival()
    assert arrival.renderer.scene.path == tiny_scene_file and arrival.place is None
    assert arrival.info["lights"] == 2
    assert arrival.text.startswith("tiny.aff opened in ") and door.loader.take_finished() is None, "once"


def test_what_cannot_be_opened_is_one_line_and_nothing_arrives(door: Door, tmp_path: Path):
    (tmp_path / "broken.aff").write_text("v from nowhere\n")
    (tmp_path / "plain.png").write_bytes(b"no picture")
    for name, said in (("none.aff", "no such file"), ("broken.aff", "broken.aff:1"), ("plain.png", "plain.png"),
                       ("notes.txt", "not a scene")):  # fmt: skip
        door.loader.open(tmp_path / name)
        assert door.arrival() is None
        assert said in door.said and door.notices.current.error


def test_a_question_that_is_denied_opens_nothing(door: Door, tiny_scene_file: Path):
    door.refuse = True
    door.loader.open(tiny_scene_file)
    assert door.asked == ["tiny.aff"] and not door.loader.busy and door.arrival() is None


def test_a_load_that_is_overtaken_never_arrives(door: Door, tiny_scene_file: Path):
    other = tiny_scene_file.with_name("other.aff")
    other.write_text(tiny_scene_file.read_text())
    door.loader.open(tiny_scene_file)
    door.loader.open(other)
    assert door.arrival().renderer.scene.path == other


def door_opened(door: Door, path: Path):
    door.loader.open(path)
    return door.arrival().renderer.scene


def test_a_saved_picture_of_the_open_scene_is_a_place_in_it(
    door: Door, tiny_scene_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    door.session.open(door_opened(door, tiny_scene_file))
    door.session.set_draw(view=View.DEPTH)
    frame = make_frame(time=1.0)
    door.captures.capture(frame, np.zeros((8, 16, 3), np.uint8))
    (job,) = door.captures.saving
    assert job.join(20.0)
    door.captures.report_saved()
    (picture,) = (tmp_path / "pictures").iterdir()
    assert door.said == f"saved {picture}" and not door.captures.busy
    door.loader.open(picture)
    arrival = door.arrival()
    assert arrival.renderer is None and arrival.text == f"restored {picture.name}"
    assert (arrival.place.time, arrival.place.draw.view) == (1.0, View.DEPTH)
    door.session.scene = None
    monkeypatch.setattr("viewer.services.scene_loader.warm_up", lambda progress: None)
    door.loader.start({"lamp_radius": 0.5})
    door.loader.open(picture)
    arrival = door.arrival()
    assert arrival.renderer.scene.path == tiny_scene_file and arrival.place.camera == frame.camera
    assert arrival.place.settings.lamp_radius == 0.5, "as the command line says of what is opened first"
    assert door.session.settings.lamp_radius == 0.5, "also where a scene is opened that says nothing of it"
    door.loader.open(picture)
    assert door.arrival().place.settings.lamp_radius is None


def test_a_cancelled_load_is_gone_at_once_though_it_cannot_stop(door: Door, tiny_scene_file: Path, monkeypatch):
    """As within a library that reads a mesh; and the scene that has waited in vain is let go."""
    deaf, read, opened = threading.Event(), [], door_opened(door, tiny_scene_file)

    def waits(scene, settings, progress, ready, seen):
        read.append(weakref.ref(scene))
        seen(scene)
        deaf.wait(60.0)
        raise SceneError("no more")

    monkeypatch.setattr("viewer.services.scene_loader.build", waits)
    door.session.open(opened)
    door.loader.open(tiny_scene_file)
    end = time.monotonic() + 20.0
    while door.loader.waiting is None:
        assert time.monotonic() < end, "in vain"
        time.sleep(0.002)
    job = door.loader.load_job
    door.loader.cancel()
    assert not door.loader.busy and door.loader.waiting is None
    assert door.said == "loading cancelled: the scene that was open stays"
    monkeypatch.undo()
    assert door_opened(door, tiny_scene_file).path == tiny_scene_file, "another is opened meanwhile"
    deaf.set()
    assert job.join(20.0) and door.loader.take_finished() is None
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
