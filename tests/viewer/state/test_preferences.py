"""Settings are found again, whatever happened to their file."""

from __future__ import annotations

import json
import os
from dataclasses import asdict
from pathlib import Path

import pytest

from tracer.frame import Settings
from viewer.state import preferences as prefs
from viewer.state.preferences import Preferences, load_preferences, save_preferences


def test_what_was_saved_is_read(tmp_path: Path):
    mine = Preferences(target_fps=30.0, fixed_resolution=True, fixed_width=300, view="depth", recent=["/a.aff"])
    mine.bookmarks["/a.aff"] = [{"name": "here", "state": {}}]
    assert save_preferences(mine, tmp_path) is None
    assert load_preferences(tmp_path) == (mine, None)


def test_the_method_to_cull_by_is_kept_while_culling_is_off(tmp_path: Path):
    mine = Preferences()
    mine.keep(Settings(method="certified+cache"))
    mine.keep(Settings(method="none"))
    save_preferences(mine, tmp_path)
    read, _ = load_preferences(tmp_path)
    assert (read.culling, read.method, read.settings().method) == (False, "certified+cache", "none")


@pytest.mark.parametrize(
    ("stored", "found"),
    [
        ({"method": "auto"}, "paper"),
        ({"method": "auto+rest"}, "paper+rest"),
        ({"method": "certified"}, "certified"),
        ({"method": "auto", "format": 2}, "auto"),
        ({"method": 3}, "paper"),
    ],
)
def test_the_default_method_of_version_0_2_was_not_chosen(tmp_path: Path, stored: dict, found: str):
    """That version has written `auto` whether anybody chose it or not; since then, what is stored was chosen."""
    (tmp_path / prefs.SETTINGS_FILE).write_text(json.dumps(stored))
    read, problem = load_preferences(tmp_path)
    assert (read.method, problem) == (found, None)
    save_preferences(read, tmp_path, base=asdict(read))
    assert load_preferences(tmp_path)[0].method == found, "nor is it when two windows' changes are put together"
    read.keep(Settings(method="auto"))
    save_preferences(read, tmp_path, base=asdict(load_preferences(tmp_path)[0]))
    assert load_preferences(tmp_path)[0].method == "auto"


def test_samples_of_lamps_are_kept(tmp_path: Path):
    for samples in (64, None):
        mine = Preferences()
        mine.keep(Settings(lamp_samples=samples, lamp_radius=0.5))
        save_preferences(mine, tmp_path)
        read, _ = load_preferences(tmp_path)
        assert (read.settings().lamp_samples, read.settings().lamp_radius) == (samples, None), "another scene's units"


def test_without_a_file_there_are_defaults(tmp_path: Path):
    assert load_preferences(tmp_path / "nowhere") == (Preferences(), None)


def test_odd_values_keep_their_defaults_and_the_rest_is_read(tmp_path: Path):
    odd = {"target_fps": 1e9, "loop": "yes", "fixed_width": True, "depth": 3, "unknown": 1, "recent": [1, "/b"],
           "bookmarks": [], "speed": 2, "view": 7, "method": "telepathy"}  # fmt: skip
    (tmp_path / prefs.SETTINGS_FILE).write_text(json.dumps(odd))
    read, problem = load_preferences(tmp_path)
    assert problem is None
    assert read == Preferences(depth=3, recent=["/b"], speed=2.0, tour=False), "who has settings has used the program"


@pytest.mark.parametrize("content", [b"{", b"[1]", b"\x00\xff", b""])
def test_a_damaged_file_is_kept_aside_and_told_of(tmp_path: Path, content: bytes):
    (tmp_path / prefs.SETTINGS_FILE).write_bytes(content)
    read, problem = load_preferences(tmp_path)
    assert read == Preferences()
    assert problem is not None and "\n" not in problem
    kept = [p for p in tmp_path.iterdir() if p.read_bytes() == content]
    assert len(kept) == 1


def test_a_failed_write_leaves_the_old_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    save_preferences(Preferences(depth=5), tmp_path)

    def full(*_args):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "replace", full)
    problem = save_preferences(Preferences(depth=9), tmp_path)
    assert problem is not None and "No space left" in problem
    monkeypatch.undo()
    assert load_preferences(tmp_path)[0].depth == 5
    assert [p.name for p in tmp_path.iterdir() if p.suffix != ".lock"] == [prefs.SETTINGS_FILE]


def test_the_environment_names_another_folder(own_settings: Path):
    assert prefs.config_folder() == own_settings
    assert save_preferences(Preferences()) is None
    assert (own_settings / prefs.SETTINGS_FILE).exists()


def test_recent_scenes_are_few_and_newest_first():
    mine = Preferences()
    for i in range(20):
        mine.remember_scene(Path(f"/{i}.aff"))
    mine.remember_scene(Path("/15.aff"))
    assert mine.recent[:2] == ["/15.aff", "/19.aff"] and len(mine.recent) == 10
