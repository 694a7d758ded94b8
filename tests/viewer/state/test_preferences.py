"""Settings are found again, whatever happened to their file."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from viewer.state import codec
from viewer.state import preferences as prefs
from viewer.state.draw_options import Tone
from viewer.state.preferences import NamedState, Preferences, load_preferences, merged, save_preferences
from viewer.state.view_state import ViewState
from viewer.state.views import View


def test_what_was_saved_is_read(tmp_path: Path):
    mine = Preferences(
        state={"pace": {"target_fps": 30.0}, "draw": {"view": "depth"}}, recent=["/a.aff"], theme="light"
    )
    mine.bookmarks["/a.aff"] = [NamedState("here", {"time": 1.0})]
    mine.presets = [NamedState("mine", {"settings": {"depth": 3}})]
    assert save_preferences(mine, tmp_path) is None
    assert load_preferences(tmp_path) == (mine, None)
    assert load_preferences(tmp_path / "nowhere") == (Preferences(), None)


def test_what_a_window_starts_with_is_what_the_last_one_remembered():
    state = ViewState.in_window().with_settings(depth=3, threads=2, lamp_samples=64, lamp_radius=0.5)
    state = state.with_draw(outlines=True, light=2, tone=Tone(1.0))
    found = codec.recalled(json.loads(json.dumps(codec.remembered(state))))
    assert (found.settings.depth, found.settings.threads, found.settings.lamp_samples) == (3, 2, 64)
    assert found.settings.lamp_radius is None, "it is in another scene's units"
    assert found.draw.outlines and found.draw.light == 0 and found.draw.tone.neutral
    odd = {"settings": {"depth": -1, "zoom_factor": 9.0}, "draw": {"view": 7, "outlines": True}, "pace": []}
    found = codec.recalled(odd)
    assert (found.settings.depth, found.settings.zoom_factor) == (10, 9.0)
    assert found.draw.view is View.COLOR and found.draw.outlines and found.pace == ViewState.in_window().pace


def test_of_an_older_format_what_has_the_same_name_is_read(tmp_path: Path):
    marks = {"/a.aff": [{"name": "here", "state": {"time": 1.0}}]}
    old = {"method": "auto", "depth": 4, "outlines": True, "theme": "light", "bookmarks": marks}
    old["presets"] = [{"name": "mine", "choices": {}}]
    (tmp_path / prefs.SETTINGS_FILE).write_text(json.dumps(old))
    read, problem = load_preferences(tmp_path)
    assert problem is None and (read.theme, read.format) == ("light", prefs.FORMAT)
    fresh = ViewState.in_window()
    assert codec.recalled(read.state) == fresh, "the default method, which that version stored unasked, too"
    assert read.bookmarks == {"/a.aff": [NamedState("here", {"time": 1.0})]} and read.presets == []


def test_odd_values_keep_their_defaults_and_the_rest_is_read(tmp_path: Path):
    odd = {"loop": "yes", "theme": "pink", "unknown": 1, "recent": [1, "/b"], "presets": [{"name": 3}, 5],
           "bookmarks": [], "speed": 2, "ui_scale": 1e9, "method": "telepathy", "format": 3, "pads": 7}  # fmt: skip
    (tmp_path / prefs.SETTINGS_FILE).write_text(json.dumps(odd))
    read, problem = load_preferences(tmp_path)
    assert problem is None
    assert read == Preferences(recent=["/b"], speed=2.0, tour=False), "who has settings has used the program"


@pytest.mark.parametrize("content", [b"{", b"[1]", b"\x00\xff", b""])
def test_a_damaged_file_is_kept_aside_and_told_of(tmp_path: Path, content: bytes):
    (tmp_path / prefs.SETTINGS_FILE).write_bytes(content)
    read, problem = load_preferences(tmp_path)
    assert read == Preferences()
    assert problem is not None and "\n" not in problem
    kept = [p for p in tmp_path.iterdir() if p.read_bytes() == content]
    assert len(kept) == 1


def test_recent_scenes_are_few_and_newest_first():
    mine = Preferences()
    for i in range(20):
        mine.remember_scene(Path(f"/{i}.aff"))
    mine.remember_scene(Path("/15.aff"))
    assert mine.recent[:2] == ["/15.aff", "/19.aff"] and len(mine.recent) == 10


A, B, C, D = ({"name": name, "state": {}} for name in "ABCD")
A2 = {**A, "name": "A2"}


@pytest.mark.parametrize(
    ("base", "mine", "theirs", "found"),
    [
        ({"depth": 1, "theme": "dark"}, {"depth": 2, "theme": "dark"}, {"depth": 1, "theme": "light"},
         {"depth": 2, "theme": "light"}),
        ({"depth": 1}, {"depth": 2}, {"depth": 3}, {"depth": 2}),
        ({"marks": [A, B]}, {"marks": [A, B, C]}, {"marks": [B, D]}, {"marks": [B, C, D]}),
        ({"marks": [A]}, {"marks": [A2]}, {"marks": [A, B]}, {"marks": [A2, B]}),
        ({"marks": {}}, {"marks": {"room": [A]}}, {"marks": {"hall": [B]}, "of a newer version": 7},
         {"marks": {"room": [A], "hall": [B]}, "of a newer version": 7}),
        ({"state": {"a": 1}}, {"state": {}}, {"state": {"a": 1}}, {"state": {}}),
    ],
)  # fmt: skip
def test_what_two_windows_have_changed_is_put_together(base: dict, mine: dict, theirs: dict, found: dict):
    assert merged(base, mine, theirs) == found
