"""What the dialog that opens a file offers, and what it takes typed text for."""

from __future__ import annotations

import os
import time
from pathlib import Path

import numpy as np
import pytest
from PIL import Image, PngImagePlugin

from tests.viewer.fakes import TINY_SCENE
from tracer.scene.model import Cancelled
from viewer.output import capture
from viewer.services import file_browser
from viewer.services.file_browser import Browser, Kind, completed, entries, kind_of

PART = "# v\n# from 0 0 1\nf 1 0 0 1 0 1 0 1 % v from 1 1 1\ns 0 0 0 1\nk v { transl 0 }\n"


def _picture(path: Path, key: str = "", late: bool = False) -> Path:
    info = PngImagePlugin.PngInfo()
    if late:
        info.add(b"tEXt", key.encode() + b"\0{}", after_idat=True)
    elif key:
        info.add_itxt(key, "{}")
    Image.fromarray(np.zeros((40, 40, 3), np.uint8)).save(path, pnginfo=info)
    return path


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with something of every kind."""
    home = tmp_path / "scenes"
    (home / "textures").mkdir(parents=True)
    (home / "deep" / "deeper").mkdir(parents=True)
    (home / "deep" / "inner.aff").write_text(TINY_SCENE)
    (home / "Robot.aff").write_text(TINY_SCENE)
    (home / "Robot1.aff").write_text(PART)
    (home / "arm.aff").write_text(PART)
    (home / "bunny.ply").write_bytes(b"ply")
    (home / ".hidden.aff").write_text(TINY_SCENE)
    (home / "notes.txt").write_text("v from")
    _picture(home / "plot.png")
    _picture(home / "saved.png", capture.CHUNK)
    return home


def _opened(folder: Path, typed: str = "") -> Browser:
    browser = Browser(open=True, folder=folder)
    browser.begin()
    return _typed(browser, typed)


def _typed(browser: Browser, text: str) -> Browser:
    browser.type(text)
    end = time.monotonic() + 20.0
    browser.follow(lambda: None)
    while browser._job is not None:
        assert time.monotonic() < end, "the folder was never read"
        time.sleep(0.002)
        browser.follow(lambda: None)
    return browser


def _names(browser: Browser) -> list[str]:
    return [e.name for e in browser.shown()]


def test_only_what_can_be_opened_is_listed_and_parts_come_last(folder: Path):
    browser = _opened(folder)
    assert [(e.name, e.kind) for e in browser.shown()] == [
        ("deep/", Kind.FOLDER), ("textures/", Kind.FOLDER), ("bunny.ply", Kind.SCENE), ("Robot.aff", Kind.SCENE),
        ("saved.png", Kind.PICTURE), ("arm.aff", Kind.PART), ("Robot1.aff", Kind.PART)]  # fmt: skip
    assert _names(_typed(browser, ".hid")) == [".hidden.aff"]


@pytest.mark.parametrize(
    ("text", "kind"),
    [
        (TINY_SCENE, Kind.SCENE),
        ("f 1 1 1 1 0 1 0 1 v from 0 0 1 at 0 0 0", Kind.SCENE),
        ("xs 1 1 1 0 0 0 0 0 0 { s 0 0 0 1 }v # a comment\nangle 40 from 0 0 1 at 0 0 0", Kind.SCENE),
        (PART, Kind.PART),
        ("m vertices 3 0 0 0 1 0 0 0 1 0", Kind.PART),
        ("", Kind.PART),
    ],
)
def test_a_whole_scene_has_a_camera(tmp_path: Path, text: str, kind: Kind):
    path = tmp_path / "some.AFF"
    path.write_text(text)
    assert kind_of(path) is kind


def test_a_picture_counts_only_if_it_carries_a_state(tmp_path: Path):
    assert kind_of(_picture(tmp_path / "state.png", capture.CHUNK)) is Kind.PICTURE
    assert kind_of(_picture(tmp_path / "late.PNG", capture.CHUNK, late=True)) is Kind.PICTURE
    assert kind_of(_picture(tmp_path / "other.png", "Comment")) is None
    assert kind_of(_picture(tmp_path / "longer.png", capture.CHUNK + "s")) is None
    cut = tmp_path / "cut.png"
    cut.write_bytes((tmp_path / "state.png").read_bytes()[:20])
    fake = tmp_path / "fake.png"
    fake.write_bytes(b"GIF89a")
    assert kind_of(cut) is None and kind_of(fake) is None


def test_files_are_read_again_only_when_they_have_changed(folder: Path, monkeypatch: pytest.MonkeyPatch):
    read: list[str] = []
    monkeypatch.setattr(file_browser, "kind_of", lambda path: read.append(path.name) or kind_of(path))
    known: file_browser.Known = {}
    first = entries(folder, known, lambda *_: None)
    assert len(read) == 8
    read.clear()
    assert entries(folder, known, lambda *_: None) == first and read == []
    (folder / "arm.aff").write_text(TINY_SCENE)
    again = {e.name: e.kind for e in entries(folder, known, lambda *_: None)}
    assert read == ["arm.aff"] and again["arm.aff"] is Kind.SCENE


def test_reading_a_folder_stops_when_it_is_no_longer_wanted(folder: Path):
    def stop(label: str, fraction: float) -> None:
        raise Cancelled(label)

    with pytest.raises(Cancelled):
        entries(folder, {}, stop)


def test_new_files_are_seen(folder: Path):
    browser = _opened(folder)
    (folder / "new.obj").write_text("v 0 0 0\n")
    os.utime(folder, ns=(1, 1))  # clocks of file systems may be coarse
    assert "new.obj" in _names(_typed(browser, ""))


def test_the_last_part_of_what_is_typed_filters(folder: Path):
    browser = _opened(folder, "ROBOT")
    assert _names(browser) == ["Robot.aff", "Robot1.aff"]
    assert _names(_typed(browser, "bot1")) == ["Robot1.aff"]
    assert _names(_typed(browser, "deep/")) == ["deeper/", "inner.aff"]
    assert _names(_typed(browser, "deep/INN")) == ["inner.aff"]
    assert _names(_typed(browser, f"{folder}/deep/inn")) == ["inner.aff"]
    assert _names(_typed(browser, "gone/x")) == [] and "gone" in browser.problem


def test_names_of_another_folder_are_never_meant(folder: Path):
    browser = _opened(folder)
    browser.type("deep/Robot.aff")  # not read yet
    assert browser.reading and browser.shown() == [] and browser.meant() == folder / "deep" / "Robot.aff"


@pytest.mark.parametrize(
    ("typed", "after"),
    [
        ("", ""),
        ("de", "deep/"),
        ("Rob", "Robot"),
        ("Robot", "Robot"),
        ("rob", "Robot"),
        ("Robot1", "Robot1.aff"),
        ("deep/", "deep/"),
        ("deep/i", "deep/inner.aff"),
        ("plot", "plot"),
        ("nothing", "nothing"),
        ("..", "../"),
        ("deep/..", "deep/../"),
        ("~", "~/"),
    ],
)
def test_tab_completes_as_a_shell_does(folder: Path, typed: str, after: str):
    assert _opened(folder, typed).completed() == after


def test_names_in_several_cases_are_completed_only_as_far_as_they_agree():
    assert completed("r", ["Robot.aff", "room.aff"]) == "room.aff"
    assert completed("x", ["Xa1", "xa2"]) == "xa2"
    assert completed("xA", ["Xa1", "xa2"]) == "xA"


def test_arrows_mark_and_enter_takes_what_is_marked(folder: Path):
    browser = _opened(folder)
    assert browser.aimed() is None and browser.meant() is None
    browser.step(1)
    assert browser.marked == "deep/"
    browser.step(-1)
    assert browser.marked == "deep/"
    browser.type("")
    browser.step(-1)
    assert browser.marked == "Robot1.aff"
    browser.step(1)
    assert browser.meant() == folder / "Robot1.aff"
    _typed(browser, "rob")
    assert browser.marked == "" and browser.meant() == folder / "rob"
    browser.step(1)
    assert browser.meant() == folder / "Robot.aff"
    assert _typed(browser, "bun").meant() == folder / "bunny.ply", "the only one left"
    assert _typed(browser, "Robot.aff").meant() == folder / "Robot.aff"
    assert _typed(browser, "deep").meant() == folder / "deep"
    _typed(browser, "nothing").step(1)
    assert browser.meant() == folder / "nothing"


def test_taking_enters_folders_opens_files_and_refuses_in_one_line(folder: Path):
    browser = _opened(folder, "deep")
    assert browser.take(folder / "deep" / ".." / "deep") is None
    assert browser.open and browser.folder == folder / "deep" and browser.typed == ""
    for name, told in [("gone.aff", "no such file"), ("../notes.txt", "not a scene"),
                       ("../plot.png", "not one captured"), ("a" * 300 + ".aff", "too long"),
                       ("~nobody-here/x.aff", "no such file")]:  # fmt: skip
        path = _typed(browser, name).meant()
        assert path is not None and browser.take(path) is None
        assert told in browser.problem and "\n" not in browser.problem and browser.open
    assert browser.take(folder / "saved.png") == folder / "saved.png"
    assert not browser.open and browser.folder == folder and browser.problem == ""
