"""Bookmarks and presets: saved, applied, renamed, put in order, deleted."""

from __future__ import annotations

import pytest

from tests.viewer.fakes import make_scene
from tracer.scene.model import Camera
from viewer.services.named_states import BUILT_IN, Bookmarks, NamedStates, Presets
from viewer.state import codec
from viewer.state.notices import Notices
from viewer.state.preferences import NamedState, Preferences, load_preferences, save_preferences
from viewer.state.session import Session
from viewer.state.views import View

AWAY = Camera((1.0, 2.0, 3.0), (0.0, 0.0, -1.0))


class Parts:
    def __init__(self) -> None:
        self.preferences, self.notices = Preferences(), Notices()
        self.session = Session(state=codec.recalled({}))
        self.session.open(make_scene(lights=3))
        self.locked, self.named = False, []
        write = lambda: save_preferences(self.preferences)  # noqa: E731
        held = self.session, self.preferences, self.notices, write
        self.marks, self.presets = Bookmarks(*held), Presets(*held, lambda: self.locked, self.named.append)


@pytest.fixture
def parts(own_settings) -> Parts:
    return Parts()


@pytest.mark.parametrize("kind", ["marks", "presets"])
def test_names_are_unique_and_they_and_their_order_can_be_changed(parts: Parts, kind: str):
    states: NamedStates = getattr(parts, kind)
    for name in ("one", "  two \n words ", "three"):
        assert states.save(name)
    parts.session.set_settings(depth=1)
    assert states.save("one") and parts.notices.message.text == f"{states.kind} replaced: one"
    assert [one.name for one in states.all] == ["one", "two words", "three"]
    assert [one.state["settings"]["depth"] for one in states.all] == [1, 10, 10]
    for taken in ("three", " "):
        states.rename(0, taken)
        assert states.all[0].name == "one" and parts.notices.message.error
    states.rename(0, "four")
    states.rename(1, "two words")
    states.move(2, 0)
    states.delete(1)
    assert [one.name for one in load_preferences()[0].presets or states.all] == ["three", "two words"]


def test_a_bookmark_brings_back_the_place_and_not_the_settings(parts: Parts):
    for _ in range(2):
        parts.marks.add()
    assert [mark.name for mark in parts.marks.all] == ["frame 0", "frame 0 (2)"]
    parts.session.change(camera=AWAY, time=3.0)
    parts.session.set_draw(view=View.DEPTH)
    parts.marks.save("here")
    parts.session.change(camera=None, time=0.0)
    parts.session.set_draw(view=View.COLOR, outlines=True)
    parts.session.set_settings(depth=2)
    found = parts.marks.find(2)
    assert (found.camera, found.time, found.draw.view) == (AWAY, 3.0, View.DEPTH)
    assert found.settings.depth == 2 and found.draw.outlines
    parts.marks.all[2].state = {"time": "noon"}
    assert parts.marks.find(2) is None and parts.notices.current.text.startswith("this bookmark is damaged")
    parts.session.open(make_scene(path="other.aff"))
    assert parts.marks.all == []


def test_all_presets_can_be_applied_and_as_in_the_paper_is_what_the_paper_says(parts: Parts):
    for preset in BUILT_IN:
        parts.presets.apply(preset.name)
        assert not parts.notices.message.error
        assert not parts.presets.save(preset.name) and "comes with the program" in parts.notices.message.text
    parts.named.clear()
    parts.session.set_settings(method="certified", symmetric=True, zoom_factor=9.0, depth=2, lamp_radius=0.5)
    parts.session.set_draw(view=View.DEPTH)
    parts.presets.apply("As in the paper")
    s, pace = parts.session.settings, parts.session.state.pace
    assert (s.method, s.symmetric, s.zoom_factor, s.depth, s.samples) == ("paper", False, 4.0, 10, 1)
    assert s.lamp_radius == 0.0, "point lights"
    assert (pace.fixed_size, pace.width, pace.height, pace.progressive) == (True, 512, 512, False)
    assert pace.every_frame, "frame-to-frame coherence is that of one frame and the next"
    assert parts.session.draw.view is View.DEPTH, "it says nothing of the view"
    assert parts.named == ["preset As in the paper"] and parts.notices.message.text.endswith("As in the paper")


def test_a_preset_is_applied_again_by_another_window(parts: Parts):
    parts.session.set_settings(method="paper+rest", depth=4, lamp_samples=64)
    parts.session.set_draw(view=View.PENUMBRA, outlines=True)
    assert parts.presets.save("soft shadows")
    other = Parts()
    other.preferences.presets = load_preferences()[0].presets
    other.presets.apply("soft shadows")
    assert other.session.state == parts.session.state


def test_a_damaged_preset_changes_nothing_and_nothing_is_applied_while_locked(parts: Parts):
    parts.preferences.presets = [NamedState("odd", {"settings": {"method": "fast"}}), NamedState("empty", {})]
    before = parts.session.state
    for name in ("odd", "empty", "none such"):
        parts.notices.message = None
        parts.presets.apply(name)
        assert parts.notices.message.error and parts.session.state == before and parts.named == []
    parts.locked = True
    parts.presets.apply("Quick and exact")
    assert parts.session.state == before
