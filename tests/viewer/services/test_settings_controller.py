"""Changes of settings and of the chosen light, and when they are saved."""

from __future__ import annotations

import json
from contextlib import closing
from pathlib import Path
from threading import Event

import pytest

from tests.viewer.fakes import Clock, make_scene
from viewer.services.controller import Controller
from viewer.services.settings_controller import SAVED_EVERY
from viewer.state import codec
from viewer.state.preferences import Preferences


def test_a_setting_is_changed_unless_it_is_no_good_and_reset(c: Controller):
    c.settings.change(depth=3, symmetric=True)
    assert c.session.settings.depth == 3 and c.session.settings.symmetric
    for wrong in ({"depth": -1}, {"method": "fast"}):
        c.settings.change(**wrong)
        assert c.session.settings.depth == 3 and c.session.settings.method == "paper"
        assert c.notices.current.error
    for light, chosen in ((2, 2), (3, 0), (-1, 2)):
        c.settings.set_light(light)
        assert c.session.draw.light == chosen, "around"
    c.settings.reset(())
    assert c.session.settings.depth == 10 and not c.session.settings.symmetric


@pytest.mark.parametrize(
    ("chosen", "toggled"), [("paper+rest", ["none", "paper+rest"]), ("none+rest", ["paper+rest", "none", "paper+rest"])]
)
def test_culling_is_turned_off_and_on_as_it_was_with_what_was_added_meanwhile(
    c: Controller, chosen: str, toggled: list[str]
):
    c.settings.change(method=chosen)
    for method in toggled:
        c.settings.toggle_culling()
        assert c.session.settings.method == method


def test_the_radius_of_lamps_is_that_of_the_scene_and_their_samples_are_kept(c: Controller):
    c.settings.change(lamp_radius=0.25, lamp_samples=64)
    assert codec.remembered(c.session.state)["settings"]["lamp_samples"] == 64
    c.settings.change(lamp_radius=-1.0)
    assert c.session.settings.lamp_radius == 0.25 and c.notices.current.error
    c.session.open(make_scene())
    assert c.session.settings.lamp_radius == 0.25, "the same scene, reloaded"
    c.session.open(make_scene(path="other.aff"))
    assert (c.session.settings.lamp_radius, c.session.settings.lamp_samples) == (None, 64)


def saved_soon(clock: Clock, *windows: Controller) -> None:
    """Windows look after a while whether there is something to save, and have saved it."""
    clock.now += SAVED_EVERY
    for c in windows:
        c.settings.save_changes()
        if c.settings._writing is not None:
            c.settings._writing.result(30.0)


def test_a_change_that_rests_is_saved_and_other_windows_changes_stay(clock: Clock, own_settings: Path, c: Controller):
    saved = own_settings / "settings.json"
    with closing(Controller(Preferences())) as other:
        saved_soon(clock, c, other)
        assert not saved.exists(), "nothing was changed"
        c.preferences.theme = "light"
        c.settings.save_changes()
        assert not saved.exists(), "it may change on"
        saved_soon(clock, c, other)
        other.settings.change(depth=3)
        saved_soon(clock, c, other)
        read = json.loads(saved.read_text())
        assert (read["theme"], read["state"]["settings"]["depth"]) == ("light", 3)


def test_no_window_waits_for_the_disk_and_of_what_waits_only_the_newest_is_written(
    c: Controller, monkeypatch: pytest.MonkeyPatch
):
    disk, began, written = Event(), Event(), list[str]()

    def slowly(data: dict, base: dict) -> None:
        began.set()
        assert disk.wait(30.0)
        written.append(data["theme"])

    monkeypatch.setattr("viewer.services.settings_controller.save_preferences", slowly)
    for c.preferences.theme in ("first", "second", "third"):
        c.settings.save()
        assert began.wait(30.0)
    assert not written, "nobody waited"
    disk.set()
    c.settings._writing.result(30.0)
    assert written == ["first", "third"]


def test_preferences_that_cannot_be_saved_are_said_once(clock: Clock, own_settings: Path, c: Controller):
    own_settings.write_text("a file is in its place")
    for depth in (3, 4):
        c.settings.change(depth=depth)
        for _ in range(4):
            saved_soon(clock, c)
    said = [entry.text for entry in c.notices.entries()]
    assert len(said) == 1 and said[0].startswith("settings not saved: ") and c.notices.current.error, said
