"""Every action once, each key once, and every key exists."""

from __future__ import annotations

from collections import Counter

import pytest

from tracer.method import DEFAULT_METHOD
from viewer.services.controller import Controller
from viewer.state.preferences import SCALES, Preferences
from viewer.state.views import View
from viewer.window import command, commands
from viewer.window.ui import Ui


@pytest.fixture
def ui():
    ui = Ui(Controller(Preferences()))
    ui.take_commands(commands.build(ui))
    yield ui
    ui.controller.close()


@pytest.fixture
def by_name(ui):
    return {each.name: each for each in ui.commands}


def test_names_are_unique_and_in_a_menu(ui):
    assert [name for name, count in Counter(c.name for c in ui.commands).items() if count > 1] == []
    assert {c.menu.split("/")[0] for c in ui.commands} == set(command.MENUS)


def test_every_command_says_without_a_scene_whether_it_can_be_run_and_why_not(ui, by_name):
    for each in ui.commands:
        assert each.checked is None or each.checked() in (True, False)
    silent = [c.name for c in ui.commands if not c.enabled() and not c.why_not]
    assert any(not c.enabled() for c in ui.commands) and silent == []
    ui.controller.preferences.ui_scale = SCALES[-1]
    assert by_name["Larger interface"].why_not == "the interface is at its largest"


def test_no_panel_opens_by_itself_while_panels_are_hidden(ui):
    shown = []
    ui.show_panel, ui.panels_hidden = shown.append, True
    ui.offer_panel("Pixels")
    assert shown == []
    ui.panels_hidden = False
    ui.offer_panel("Pixels")
    assert shown == ["Pixels"]


def test_views_are_chosen_and_ticked(ui, by_name):
    assert [by_name[view.label].key for view in View] == [view.key for view in View]
    by_name[View.SHADOW.label].run()
    assert ui.controller.session.draw.view is View.SHADOW
    assert by_name[View.SHADOW.label].checked() and not by_name[View.COLOR.label].checked()


@pytest.mark.parametrize("method", [DEFAULT_METHOD, "cells+cache"])
def test_culling_is_switched_and_comes_back_as_it_was(ui, by_name, method: str):
    ui.controller.settings.change(method=method)
    for expected in ("none", method):
        by_name["Shadow culling"].run()
        assert ui.controller.session.settings.method == expected


def test_what_one_panel_needs_is_not_kept_for_all():
    assert len(Ui.__slots__) <= 21, "keep it in the panel's own state: ui.state(YourState)"
