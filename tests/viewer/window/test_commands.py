"""Every action once, each key once, and what the palette finds of them."""

from __future__ import annotations

from collections import Counter

import pytest

from viewer.state.preferences import SCALES
from viewer.state.views import View
from viewer.window.command import MENUS, Command, Kind
from viewer.window.layout import PANELS
from viewer.window.panels.command_palette import Finder, find, items, match
from viewer.window.ui import Ui


@pytest.fixture
def by_name(ui: Ui) -> dict[str, Command]:
    return {each.name: each for each in ui.commands}


def test_names_are_unique_and_in_a_menu(ui: Ui) -> None:
    assert [name for name, count in Counter(item.name for item in items(ui)).items() if count > 1] == []
    assert {c.menu.split("/")[0] for c in ui.commands} == set(MENUS)


def test_every_command_says_without_a_scene_whether_it_can_be_run_and_why_not(ui: Ui, by_name) -> None:
    assert all(each.is_checked in (True, False) for each in ui.commands)
    assert any(each.why_not for each in ui.commands)
    assert all(each.enabled is None or each.enabled.reason for each in ui.commands)
    ui.controller.preferences.ui_scale = SCALES[-1]
    assert by_name["Larger interface"].why_not == "the interface is at its largest"


def test_no_panel_opens_by_itself_while_panels_are_hidden(ui: Ui) -> None:
    shown: list[str] = []
    ui.show_panel = shown.append
    for hidden, then in ((True, []), (False, ["Pixels"])):
        ui.panels_hidden = hidden
        ui.offer_panel("Pixels")
        assert shown == then


def test_views_are_chosen_and_ticked(ui: Ui, by_name) -> None:
    assert [by_name[view.label].key for view in View] == [view.key for view in View]
    by_name[View.SHADOW.label].run()
    assert ui.controller.session.draw.view is View.SHADOW
    assert by_name[View.SHADOW.label].is_checked and not by_name[View.COLOR.label].is_checked


# --- the palette -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("typed", "meant"),
    [
        ("undo", "Undo"), ("nl", "Next light"), ("occl", "Occlusion mode"), ("bounces", "setting Bounces"),
        ("paper as", "preset As in the paper"), ("figure4", None), ("reload", "Reload"),
        ("occulsion", "Occlusion mode"),
        ("why traced", "Fate of shadow rays"), ("culled view", "Fate of shadow rays"),
        ("dynamic darkened", "Moving shadows"), ("soft", "setting Lamp radius"), ("bart", "Scenes"),
        ("why", "panel Inspector"), ("wrong", "Difference"), ("dynamic", "Moving shadows"),
        ("faster", "Two methods live"), ("table 1", "Table 1"),
        ("figure 4", "Figure 4"), ("lazy", "setting Tree kdtree-lazy"), ("theme", "Light theme"),
    ],
)  # fmt: skip
def test_what_is_meant_is_found_first(ui: Ui, typed: str, meant: str | None) -> None:
    ui.panel_labels = tuple(PANELS)
    first = find(typed, items(ui), [])[0]
    assert first.name == meant if meant else first.kind is Kind.SCENE


def test_after_the_view_of_wrong_pixels_comes_the_hunt_and_nothing_is_there_twice(ui: Ui) -> None:
    ui.panel_labels = tuple(PANELS)
    assert find("wrong", items(ui), [])[1].name == "Start hunt"
    assert [label for label, count in Counter(item.label.lower() for item in items(ui)).items() if count > 1] == []


def test_what_was_used_last_comes_first(ui: Ui) -> None:
    everything = items(ui)
    names = [item.name for item in find("", everything, ["Start zoom test", "Depth"])]
    assert names[:2] == ["Start zoom test", "Depth"]
    assert find("next", everything, [])[0].name == "Next view"
    assert find("next", everything, ["Next light"])[0].name == "Next light"


def looked_for(ui: Ui, typed: str) -> Finder:
    finder = Finder()
    finder.begin()
    finder.type(typed)
    finder.update(items(ui), [])
    return finder


def test_a_setting_is_typed(ui: Ui) -> None:
    finder, session = looked_for(ui, "bounces"), ui.controller.session
    assert not finder.enter(finder.aimed) and finder.setting.label == "Bounces" and finder.typed == "10"
    for wrong in ("many", "200", "-1", "", "1.5"):
        finder.type(wrong)
        assert not finder.enter(None) and "0 to 100" in finder.problem and session.settings.depth == 10
    finder.type("3")
    assert finder.enter(None) and session.settings.depth == 3


def test_lines_are_stepped_through_around_the_end(ui: Ui) -> None:
    finder = looked_for(ui, "light")
    first = finder.aimed
    finder.step(-1)
    assert finder.aimed is finder.found[-1]
    finder.step(1)
    assert finder.aimed is first
    nothing = looked_for(ui, "zzzz")
    assert nothing.found == [] and nothing.aimed is None and not nothing.enter(None)


def test_words_elsewhere_count_for_less_and_a_whole_word_for_most() -> None:
    assert match("view", "Colour", "View") < match("view", "Next view")
    assert match("light", "Light theme") > match("light", "Lighter")
    assert match("default", "default") > match("default", "Default layout") + 19.0, "the name itself"
    assert match("xyz", "Occlusion mode") is None and match("mode x", "Shadow mode") is None
    assert match("oclusion", "Occlusion mode") is not None and match("zebra", "Occlusion mode") is None
