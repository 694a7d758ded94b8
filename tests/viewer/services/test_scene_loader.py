"""Opening scenes and saved pictures beside the window: what arrives, and what is said of what does not."""

from __future__ import annotations

import gc
import threading
import time
import weakref
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from tests.viewer.fakes import make_frame, make_scene
from tracer.scene.model import SceneError
from viewer.services.capture_service import CaptureService
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
    assert arrival.opened.scene.path == tiny_scene_file and arrival.place is None
    assert arrival.opened.renderer.scene is arrival.opened.scene and arrival.opened.info["lights"] == 2
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
    assert door.arrival().opened.scene.path == other


def door_opened(door: Door, path: Path):
    door.loader.open(path)
    return door.arrival().opened.scene


def test_a_saved_picture_of_the_open_scene_is_a_place_in_it(door: Door, tiny_scene_file: Path, tmp_path: Path):
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
    assert arrival.opened is None and arrival.text == f"restored {picture.name}"
    assert (arrival.place.time, arrival.place.draw.view) == (1.0, View.DEPTH)
    door.session.scene = None
    door.loader.open(picture)
    arrival = door.arrival()
    assert arrival.opened.scene.path == tiny_scene_file and arrival.place.camera == frame.camera


def test_settings_from_the_command_line_win_over_the_first_picture_alone(
    door: Door, tiny_scene_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr("viewer.services.scene_loader.warm_up", lambda progress: None)
    door.session.open(door_opened(door, tiny_scene_file))
    door.captures.capture(make_frame(time=1.0), np.zeros((8, 16, 3), np.uint8))
    assert door.captures.saving[0].join(20.0)
    (picture,) = (tmp_path / "pictures").iterdir()
    door.session.scene = None
    door.loader.start(picture, {"lamp_radius": 0.5})
    first = door.arrival().place
    assert first.settings.lamp_radius == 0.5 and first.settings.lamp_samples is None
    assert door.session.settings.lamp_radius == 0.5, "also where a scene is opened that says nothing of it"
    door.loader.open(picture)
    assert door.arrival().place.settings.lamp_radius is None


def test_a_load_that_cannot_stop_is_left_to_itself_when_it_is_cancelled(
    door: Door, tiny_scene_file: Path, monkeypatch: pytest.MonkeyPatch
):
    deaf, opened = threading.Event(), door_opened(door, tiny_scene_file)
    monkeypatch.setattr("viewer.services.scene_files.open_scene", lambda *arguments: deaf.wait(60.0))
    monkeypatch.setattr("viewer.services.scene_loader.PATIENCE", 0.05)
    door.session.open(opened)
    door.loader.open(tiny_scene_file)
    door.loader.cancel()
    assert door.loader.load_job is not None and door.arrival() is None
    assert door.loader.load_job is None and door.said == "loading cancelled: the scene that was open stays"
    monkeypatch.undo()
    assert door_opened(door, tiny_scene_file).path == tiny_scene_file, "another is opened meanwhile"
    deaf.set()
    (job,) = door.loader._abandoned or [None]
    assert job is None or job.join(20.0)
    assert door.loader.take_finished() is None


@pytest.mark.parametrize("end", ["cancelled", "abandoned", "failed"])
def test_a_scene_that_waited_in_vain_is_let_go(door: Door, tiny_scene_file: Path, monkeypatch, end: str):
    go_on, read = threading.Event(), []

    def waits(_read, settings, ready, progress, seen):
        scene = make_scene()
        read.append(weakref.ref(scene))
        seen(scene)
        while not go_on.is_set():
            if end == "cancelled":
                progress("waiting", 0.5)
            go_on.wait(0.01)
        raise SceneError("no more")

    monkeypatch.setattr("viewer.services.scene_files.open_scene", waits)
    monkeypatch.setattr("viewer.services.scene_loader.PATIENCE", 60.0 if end == "cancelled" else 0.05)
    door.loader.open(tiny_scene_file)
    until = time.monotonic() + 20.0
    while door.loader.waiting is None:
        assert time.monotonic() < until, "in vain"
        time.sleep(0.002)
    if end == "failed":
        go_on.set()
    else:
        door.loader.cancel()
    assert door.arrival() is None and door.loader.waiting is None
    go_on.set()
    assert all([job.join(20.0) for job in door.loader._abandoned])
    door.loader.take_finished()
    gc.collect()
    assert read[0]() is None
