"""Every action once, each key once, and every key exists."""

from __future__ import annotations

from collections import Counter

import pytest
from imgui_bundle import imgui

from tracer.method import DEFAULT_METHOD
from viewer.services.controller import Controller
from viewer.state.keymap import HELD
from viewer.state.preferences import SCALES, Preferences
from viewer.state.views import View
from viewer.window import command, commands, keyboard, picture_commands
from viewer.window.ui import Ui


@pytest.fixture
def ui():
    ui = Ui(Controller(Preferences()))
    ui.take_commands(commands.build(ui))
    yield ui
    ui.controller.close()


def test_keys_and_names_are_unique(ui):
    keys = Counter(keyboard.chord(key) for c in ui.commands for key in c.keys)
    assert [k for k, n in keys.items() if n > 1] == []
    names = Counter(c.name for c in ui.commands)
    assert [n for n, count in names.items() if count > 1] == []


def test_no_command_takes_a_key_that_flies(ui):
    flying = {keyboard.chord(key) for key in HELD.values() if key}
    assert flying.isdisjoint(keyboard.chord(key) for c in ui.commands for key in c.keys)


def test_the_plus_of_every_keyboard_makes_the_interface_larger(ui):
    by_name = {c.name: {keyboard.chord(key) for key in c.keys} for c in ui.commands}
    ctrl, key = int(imgui.Key.mod_ctrl), imgui.Key
    plus = {ctrl | int(key.equal), ctrl | int(key.mod_shift) | int(key.equal), ctrl | int(key.keypad_add)}
    assert by_name["Larger interface"] == plus
    assert by_name["Smaller interface"] == {ctrl | int(key.minus), ctrl | int(key.keypad_subtract)}


def test_every_command_is_in_a_menu(ui):
    assert {c.menu.split("/")[0] for c in ui.commands} == set(command.MENUS)


def test_unknown_keys_are_refused():
    with pytest.raises(ValueError, match="Hyper"):
        keyboard.chord("HyperKey")


def test_every_command_can_be_asked_for_its_state_without_a_scene(ui):
    for each in ui.commands:
        each.enabled()
        if each.checked is not None:
            each.checked()


def test_what_cannot_be_run_says_why(ui):
    silent = [c.name for c in ui.commands if not c.enabled() and not c.why_not]
    assert any(not c.enabled() for c in ui.commands) and silent == []
    ui.controller.preferences.ui_scale = SCALES[-1]
    assert next(c for c in ui.commands if c.name == "Larger interface").why_not == "the interface is at its largest"


def test_no_panel_opens_by_itself_where_it_would_cover_the_picture(ui):
    shown = []
    ui.show_panel = shown.append
    for name in ("folded", "hidden"):
        setattr(ui.fold, name, True)
        picture_commands.offer(ui, "Pixels")
        setattr(ui.fold, name, False)
    assert shown == []
    picture_commands.offer(ui, "Pixels")
    assert shown == ["Pixels"]


def test_views_are_chosen_and_ticked(ui):
    by_name = {c.name: c for c in ui.commands}
    by_name[View.SHADOW.label].run()
    assert ui.controller.session.draw.view is View.SHADOW
    assert by_name[View.SHADOW.label].checked() and not by_name[View.COLOR.label].checked()
    assert by_name[View.SHADOW.label].key == "3"


def test_culling_is_switched(ui):
    culling = next(c for c in ui.commands if c.name == "Shadow culling")
    assert culling.checked()
    culling.run()
    assert ui.controller.session.settings.method == "none"
    culling.run()
    assert ui.controller.session.settings.method == DEFAULT_METHOD
    ui.controller.settings.change(method="cells+cache")
    culling.run()
    assert ui.controller.session.settings.method == "none"
    culling.run()
    assert ui.controller.session.settings.method == "cells+cache"


def test_the_keys_of_views_are_those_of_their_commands(ui):
    by_name = {c.name: c for c in ui.commands}
    assert [by_name[view.label].key for view in View] == [view.key for view in View]


def test_what_one_panel_needs_is_not_kept_for_all():
    assert len(Ui.__slots__) <= 21, "keep it in the panel's own state: ui.state(YourState)"
