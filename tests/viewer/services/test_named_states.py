"""Bookmarks and presets: saved, applied, renamed, put in order, deleted."""

from __future__ import annotations

from contextlib import closing

import pytest

from tests.viewer.fakes import make_scene
from tracer.scene.model import Camera
from viewer.services.controller import Controller
from viewer.services.named_states import BUILT_IN, NamedStates
from viewer.state.preferences import NamedState, Preferences, load_preferences
from viewer.state.views import View

AWAY = Camera((1.0, 2.0, 3.0), (0.0, 0.0, -1.0))


@pytest.mark.parametrize("kind", ["bookmarks", "presets"])
def test_names_are_unique_and_they_and_their_order_can_be_changed(c: Controller, kind: str):
    states: NamedStates = getattr(c, kind)
    for name in ("one", "  two \n words ", "three"):
        assert states.save(name)
    c.session.set_settings(depth=1)
    assert states.save("one") and c.notices.message.text == f"{states.kind} replaced: one"
    assert [one.name for one in states.all] == ["one", "two words", "three"]
    assert [one.state["settings"]["depth"] for one in states.all] == [1, 10, 10]
    for taken in ("three", " "):
        states.rename(0, taken)
        assert states.all[0].name == "one" and c.notices.message.error
    states.rename(0, "four")
    states.rename(1, "two words")
    states.move(2, 0)
    states.delete(1)
    c.settings.finish()
    stored = load_preferences()[0]
    kept = stored.presets or next(iter(stored.bookmarks.values()))
    assert [one.name for one in kept] == ["three", "two words"]


def test_a_bookmark_brings_back_the_place_and_not_the_settings(c: Controller):
    for _ in range(2):
        c.bookmarks.add()
    assert [mark.name for mark in c.bookmarks.all] == ["frame 0", "frame 0 (2)"]
    c.session.change(camera=AWAY, time=3.0)
    c.session.set_draw(view=View.DEPTH)
    c.bookmarks.save("here")
    c.session.change(camera=None, time=0.0)
    c.session.set_draw(view=View.COLOR, outlines=True)
    c.session.set_settings(depth=2)
    found = c.bookmarks.find(2)
    assert (found.camera, found.time, found.draw.view) == (AWAY, 3.0, View.DEPTH)
    assert found.settings.depth == 2 and found.draw.outlines
    c.bookmarks.all[2].state = {"time": "noon"}
    assert c.bookmarks.find(2) is None and c.notices.current.text.startswith("this bookmark is damaged")
    c.session.open(make_scene(path="other.aff"))
    assert c.bookmarks.all == []


def test_all_presets_can_be_applied_and_as_in_the_paper_is_what_the_paper_says(c: Controller):
    for preset in BUILT_IN:
        c.presets.apply(preset.name)
        assert not c.notices.message.error
        assert not c.presets.save(preset.name) and "comes with the program" in c.notices.message.text
    c.undo.note_changes()
    c.session.set_settings(method="certified", symmetric=True, zoom_factor=9.0, depth=2, lamp_radius=0.5)
    c.session.set_draw(view=View.DEPTH)
    c.presets.apply("As in the paper")
    s, pace = c.session.settings, c.session.state.pace
    assert (s.method, s.symmetric, s.zoom_factor, s.depth, s.samples) == ("paper", False, 4.0, 10, 1)
    assert s.lamp_radius == 0.0, "point lights"
    assert (pace.fixed_size, pace.width, pace.height, pace.progressive) == (True, 512, 512, False)
    assert pace.every_frame, "frame-to-frame coherence is that of one frame and the next"
    assert c.session.draw.view is View.DEPTH, "it says nothing of the view"
    assert c.notices.message.text.endswith("As in the paper")
    c.undo.note_changes()
    assert c.undo.undoes == "preset As in the paper"


def test_a_preset_is_applied_again_by_another_window(c: Controller):
    c.session.set_settings(method="paper+rest", depth=4, lamp_samples=64)
    c.session.set_draw(view=View.PENUMBRA, outlines=True)
    assert c.presets.save("soft shadows")
    c.settings.finish()
    with closing(Controller(Preferences(presets=load_preferences()[0].presets))) as other:
        other.session.open(make_scene())
        other.presets.apply("soft shadows")
        assert other.session.state == c.session.state


def test_a_damaged_preset_changes_nothing(c: Controller):
    c.preferences.presets = [NamedState("odd", {"settings": {"method": "fast"}}), NamedState("empty", {})]
    before = c.session.state
    for name in ("odd", "empty", "none such"):
        c.notices.message = None
        c.presets.apply(name)
        assert c.notices.message.error and c.session.state == before
