"""Presets: applied, saved, renamed, deleted."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.viewer.fakes import make_scene
from viewer.services.presets import BUILT_IN, Presets
from viewer.services.settings_controller import SettingsController
from viewer.state import codec
from viewer.state.notices import Notices
from viewer.state.preferences import Preferences, Preset, load_preferences
from viewer.state.session import Session
from viewer.state.view_state import ViewState
from viewer.state.views import View


class Parts:
    def __init__(self) -> None:
        self.preferences, self.notices = Preferences(), Notices()
        self.session = Session(state=codec.recalled({}))
        self.session.open(make_scene(lights=3))
        self.locked, self.named = False, []
        lock = lambda: self.locked  # noqa: E731
        self.settings = SettingsController(self.session, self.preferences, self.notices, lock)
        self.presets = Presets(
            self.session, self.preferences, self.notices, lock, self.settings.save, self.named.append
        )

    @property
    def now(self) -> ViewState:
        return self.session.state


@pytest.fixture
def parts() -> Parts:
    return Parts()


def test_all_can_be_applied_and_as_in_the_paper_is_what_the_paper_says(parts: Parts):
    for preset in BUILT_IN:
        parts.presets.apply(preset.name)
        assert not parts.notices.message.error and parts.presets.tip(preset.name)
    parts.named.clear()
    parts.settings.change(method="certified", symmetric=True, zoom_factor=9.0, depth=2, lamp_radius=0.5)
    parts.session.set_draw(view=View.DEPTH)
    parts.presets.apply("As in the paper")
    s, pace = parts.session.settings, parts.session.pace
    assert (s.method, s.symmetric, s.zoom_factor, s.depth, s.samples) == ("paper", False, 4.0, 10, 1)
    assert s.lamp_radius == 0.0, "point lights"
    assert (pace.fixed_size, pace.width, pace.height, pace.progressive) == (True, 512, 512, False)
    assert pace.every_frame, "frame-to-frame coherence is that of one frame and the next"
    assert parts.session.draw.view is View.DEPTH, "it says nothing of the view"
    assert parts.named == ["preset As in the paper"] and parts.notices.message.text.endswith("As in the paper")


def test_one_is_saved_and_applied_again_by_another_window(parts: Parts, own_settings: Path):
    parts.settings.change(method="paper+rest", depth=4, lamp_samples=64)
    parts.session.set_draw(view=View.PENUMBRA)
    parts.session.set_draw(outlines=True)
    kept = parts.now
    assert parts.presets.save("  soft   shadows ")
    parts.settings.finish()
    assert json.loads((own_settings / "settings.json").read_text())["presets"][0]["name"] == "soft shadows"
    other = Parts()
    other.preferences.presets = load_preferences()[0].presets
    other.presets.apply("soft shadows")
    assert other.now == kept


def test_names_are_unique(parts: Parts):
    assert parts.presets.save("one") and parts.presets.save("two")
    parts.settings.change(depth=1)
    assert parts.presets.save("one") and [p.name for p in parts.presets.own] == ["one", "two"]
    assert parts.presets.own[0].state["settings"]["depth"] == 1, "replaced"
    for taken in ("two", "", "As in the paper"):
        assert not parts.presets.rename(0, taken)
    assert not parts.presets.save("Every ray traced") and not parts.presets.save(" ")
    assert parts.presets.rename(0, "three") and parts.presets.rename(1, "two")
    assert parts.presets.names[-2:] == ["three", "two"]
    parts.presets.delete(0)
    assert parts.presets.names[-1] == "two" and len(parts.presets.own) == 1


def test_a_damaged_one_changes_nothing_and_says_so_and_nothing_is_applied_while_locked(parts: Parts):
    parts.preferences.presets = [Preset("odd", {"settings": {"method": "fast"}}), Preset("empty", {})]
    before = parts.now
    for name in ("odd", "empty", "none such"):
        parts.notices.message = None
        parts.presets.apply(name)
        assert parts.notices.message.error and parts.now == before and parts.named == []
    parts.locked = True
    parts.presets.apply("Every ray traced")
    assert parts.now == before
