"""The menu Edit: undo and redo, the command palette, presets and keys."""

from __future__ import annotations

from functools import partial

from imgui_bundle import imgui

from viewer.services.presets import BUILT_IN
from viewer.window.command import Command, Condition
from viewer.window.ui import Ui
from viewer.window.widgets import tooltip


def build(ui: Ui) -> list[Command]:
    """All of them, in the order of the menu."""
    c = ui.controller
    undo = c.undo

    def manage() -> None:
        ui.presets_open = not ui.presets_open

    def keys() -> None:
        ui.shortcuts_open = not ui.shortcuts_open

    ui.more_in_menus["Edit/Presets"] = lambda: _presets(ui)
    return [
        Command("Undo", "Edit", undo.undo, "Ctrl+Z", repeats=True, title=lambda: f"Undo {undo.undoes}".rstrip(),
                enabled=Condition(lambda: bool(undo.undoes), "there is nothing to undo")),
        Command("Redo", "Edit", undo.redo, "Ctrl+Shift+Z", repeats=True, title=lambda: f"Redo {undo.redoes}".rstrip(),
                enabled=Condition(lambda: bool(undo.redoes), "there is nothing to redo"), other_keys=("Ctrl+Y",)),
        Command("Command palette", "Edit", ui.finder.begin, "Ctrl+Shift+P", separated=True,
                tip="finds commands, settings, scenes, bookmarks and presets as you type"),
        Command("Presets...", "Edit/Presets", manage, checked=lambda: ui.presets_open,
                tip="save the settings under a name; rename and delete presets"),
        Command("Keys...", "Edit", keys, checked=lambda: ui.shortcuts_open,
                tip="steer as in pbrt or Blender, and choose keys"),
    ]  # fmt: skip


def _presets(ui: Ui) -> None:
    """What can be applied."""
    presets = ui.controller.presets
    for number, name in enumerate(presets.names):
        if number in (0, len(BUILT_IN)):
            imgui.separator()
        if imgui.menu_item(f"{name}##preset {number}", "", False, True)[0]:
            ui.guard.step("Applying a preset", partial(presets.apply, name))
        tooltip(presets.tip(name))
