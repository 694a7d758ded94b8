"""Changes of settings, view and light; places that are kept."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.viewer.fakes import make_scene
from viewer.services.named_states import Bookmarks
from viewer.services.settings_controller import SAVED_EVERY, SettingsController
from viewer.state import codec
from viewer.state.notices import Notices
from viewer.state.preferences import Preferences
from viewer.state.session import Session
from viewer.state.views import View
from viewer.util.files import file_lock


class Parts:
    def __init__(self) -> None:
        self.preferences, self.notices = Preferences(), Notices()
        self.session = Session(state=codec.recalled({}))
        self.session.open(make_scene(lights=3))
        self.locked = False
        self.settings = SettingsController(self.session, self.preferences, self.notices, lambda: self.locked)
        self.bookmarks = Bookmarks(self.session, self.preferences, self.notices, self.settings.save)

    def follow_settings(self) -> None:
        self.settings.save_changes()
        if self.settings._writing is not None:
            self.settings._writing.result(30.0)


def test_a_setting_is_changed_and_remembered_unless_it_is_no_good_or_locked():
    parts = Parts()
    parts.settings.change(depth=3, symmetric=True)
    assert parts.session.settings.depth == 3 and parts.session.settings.symmetric
    for wrong in ({"depth": -1}, {"method": "fast"}):
        parts.settings.change(**wrong)
        assert parts.session.settings.depth == 3 and parts.session.settings.method == "paper"
        assert parts.notices.current.error
    for light, chosen in ((2, 2), (3, 0), (-1, 2)):
        parts.settings.set_light(light)
        assert parts.session.draw.light == chosen, "around"
    parts.locked = True
    parts.settings.change(depth=5)
    parts.settings.reset(())
    assert parts.session.settings.depth == 3


@pytest.mark.parametrize(
    ("chosen", "toggled"), [("paper+rest", ["none", "paper+rest"]), ("none+rest", ["paper+rest", "none", "paper+rest"])]
)
def test_culling_is_turned_off_and_on_as_it_was_with_what_was_added_meanwhile(chosen: str, toggled: list[str]):
    parts = Parts()
    parts.settings.change(method=chosen)
    for method in toggled:
        parts.settings.toggle_culling()
        assert parts.session.settings.method == method


def test_a_reset_keeps_what_it_is_told_to(own_settings: Path):
    parts = Parts()
    parts.bookmarks.save("here")
    parts.session.set_draw(view=View.DEPTH)
    parts.settings.change(depth=3)
    parts.settings.reset(["bookmarks"])
    parts.settings.finish()
    assert parts.session.draw.view is View.COLOR and parts.session.settings.depth == 10
    stored = json.loads((own_settings / "settings.json").read_text())
    assert stored["state"]["draw"]["view"] == "color" and len(stored["bookmarks"]) == 1


def test_the_radius_of_lamps_is_that_of_the_scene_and_their_samples_are_kept():
    parts = Parts()
    parts.settings.change(lamp_radius=0.25, lamp_samples=64)
    assert codec.remembered(parts.session.state)["settings"]["lamp_samples"] == 64
    parts.settings.change(lamp_radius=-1.0)
    assert parts.session.settings.lamp_radius == 0.25 and parts.notices.current.error
    parts.session.open(make_scene())
    assert parts.session.settings.lamp_radius == 0.25, "the same scene, reloaded"
    parts.session.open(make_scene(path="other.aff"))
    assert (parts.session.settings.lamp_radius, parts.session.settings.lamp_samples) == (None, 64)


def test_a_change_that_rests_is_saved_and_other_windows_changes_stay(own_settings: Path, monkeypatch):
    now = [100.0]
    monkeypatch.setattr("time.monotonic", lambda: now[0])
    one, other = Parts(), Parts()
    saved = own_settings / "settings.json"

    def pass_time() -> None:
        now[0] += SAVED_EVERY
        for parts in (one, other):
            parts.follow_settings()

    pass_time()
    assert not saved.exists(), "nothing was changed"
    one.preferences.theme = "light"
    one.settings.save_changes()
    assert not saved.exists(), "it may change on"
    pass_time()
    other.settings.change(depth=3)
    pass_time()
    read = json.loads(saved.read_text())
    assert (read["theme"], read["state"]["settings"]["depth"]) == ("light", 3)


def test_no_window_waits_while_another_saves(own_settings: Path):
    parts = Parts()
    own_settings.mkdir(exist_ok=True)
    with file_lock(own_settings / "settings.json", 0.0):
        parts.settings.save()
        assert not parts.settings._writing.done(), "it waits for the other on a thread of its own"
    parts.settings.finish()
    assert (own_settings / "settings.json").exists()


def test_preferences_that_cannot_be_saved_are_said_once(own_settings: Path, monkeypatch):
    now = [100.0]
    monkeypatch.setattr("time.monotonic", lambda: now[0])
    own_settings.write_text("a file is in its place")
    parts = Parts()
    for depth in (3, 4):
        parts.settings.change(depth=depth)
        for _ in range(4):
            now[0] += SAVED_EVERY
            parts.follow_settings()
    said = [entry.text for entry in parts.notices.entries()]
    assert len(said) == 1 and said[0].startswith("settings not saved: ") and parts.notices.current.error, said
