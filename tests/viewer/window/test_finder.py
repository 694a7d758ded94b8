"""The command palette without a window: what it finds, and what Enter does."""

from __future__ import annotations

import pytest

from viewer.services.controller import Controller
from viewer.state.preferences import Preferences
from viewer.window import commands
from viewer.window.command import Command, Kind
from viewer.window.finder import Finder, find, match
from viewer.window.guard import Guard
from viewer.window.panels.command_palette import items
from viewer.window.ui import Ui


@pytest.fixture
def ui():
    ui = Ui(Controller(Preferences()))
    ui.guard = Guard(ui.controller.notices, lambda name, fault: None)
    ui.take_commands(commands.build(ui))
    yield ui
    ui.controller.close()


def look_for(ui: Ui, typed: str) -> list[Command]:
    return find(typed, items(ui), ui.controller.preferences.used)


def test_every_item_has_a_name_of_its_own(ui):
    names = [item.name for item in items(ui)]
    assert len(set(names)) == len(names) > 100


@pytest.mark.parametrize(
    ("typed", "meant"),
    [
        ("undo", "Undo"), ("nl", "Next light"), ("occl", "Occlusion mode"), ("bounces", "setting Bounces"),
        ("paper as", "preset As in the paper"), ("figure4", None), ("reload", "Reload"),
        ("occulsion", "Occlusion mode"),
        ("why traced", "Fate of shadow rays"), ("culled view", "Fate of shadow rays"),
        ("dynamic darkened", "Moving shadows"),
        ("lazy", "setting Tree kdtree-lazy"), ("theme", "Light theme"),
    ],
)  # fmt: skip
def test_what_is_meant_is_found_first(ui, typed: str, meant: str | None):
    first = look_for(ui, typed)[0]
    assert first.name == meant if meant else first.kind is Kind.SCENE


def test_what_was_used_last_comes_first(ui):
    ui.controller.preferences.used = ["Zoom test", "Depth"]
    assert [item.name for item in look_for(ui, "")[:2]] == ["Zoom test", "Depth"]
    assert look_for(ui, "next")[0].name == "Next view"
    ui.controller.preferences.used = ["Next light"]
    assert look_for(ui, "next")[0].name == "Next light"


def test_what_cannot_be_run_says_why_and_stays_open(ui):
    finder = Finder()
    (play,) = (item for item in items(ui) if item.name == "Play")
    assert play.why_not == "nothing moves in this scene" and play.key == "Space"
    assert not finder.enter(play) and "nothing moves" in finder.problem


def test_a_setting_is_typed(ui):
    finder, c = Finder(), ui.controller
    finder.begin()
    finder.type("bounces")
    finder.update(items(ui), [])
    assert not finder.enter(finder.aimed) and finder.setting.label == "Bounces" and finder.typed == "10"
    for wrong in ("many", "200", "-1", "", "1.5"):
        finder.type(wrong)
        assert not finder.enter(None) and "0 to 100" in finder.problem and c.session.settings.depth == 10
    finder.type("3")
    assert finder.enter(None) and c.session.settings.depth == 3


def test_lines_are_stepped_through_around_the_end(ui):
    finder = Finder()
    finder.begin()
    finder.type("light")
    finder.update(items(ui), [])
    first = finder.aimed
    finder.step(-1)
    assert finder.aimed is finder.found[-1]
    finder.step(1)
    assert finder.aimed is first
    finder.type("zzzz")
    finder.update(items(ui), [])
    assert finder.found == [] and finder.aimed is None and not finder.enter(None)


def test_words_elsewhere_count_for_less_and_a_whole_word_for_most():
    assert match("view", "Colour", "View") < match("view", "Next view")
    assert match("light", "Light theme") > match("light", "Lighter")
    assert match("default", "default") > match("default", "Default layout") + 19.0, "the name itself"
    assert match("xyz", "Occlusion mode") is None and match("mode x", "Shadow mode") is None
    assert match("oclusion", "Occlusion mode") is not None and match("zebra", "Occlusion mode") is None
