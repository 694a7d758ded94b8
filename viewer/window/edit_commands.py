"""The menu Edit: undo and redo, the command palette, presets; what if a light were off, an object were not there?"""

from __future__ import annotations

from dataclasses import dataclass

from viewer.window.command import Command, Condition, switch
from viewer.window.ui import Dialog, Ui


@dataclass
class WhatIfState:
    """The frame of ImGui's in which the panel was drawn last, how high all is below its list of lights, the light that
    the pointer drags, and whether changed pixels are marked."""

    drawn: int = -9
    below: float = 0.0
    held_light: int | None = None
    changed_shown: bool = False


def build(ui: Ui) -> list[Command]:
    """All of them, in the order of the menu."""
    undo = ui.controller.undo
    return [
        Command("Undo", "Edit", undo.undo, "Ctrl+Z", repeats=True, title=lambda: f"Undo {undo.undoes}".rstrip(),
                enabled=Condition(lambda: bool(undo.undoes), "there is nothing to undo")),
        Command("Redo", "Edit", undo.redo, "Ctrl+Shift+Z", repeats=True, title=lambda: f"Redo {undo.redoes}".rstrip(),
                enabled=Condition(lambda: bool(undo.redoes), "there is nothing to redo"), other_keys=("Ctrl+Y",)),
        Command("Command palette", "Edit", lambda: ui.open(Dialog.PALETTE), "Ctrl+Shift+P",
                separated=True, while_typing=True,
                tip="finds commands, settings, scenes, bookmarks and presets as you type"),
        Command("Presets...", "Edit/Presets", lambda: ui.toggle(Dialog.PRESETS),
                checked=lambda: Dialog.PRESETS in ui.dialogs,
                tip="save the settings under a name; rename and delete presets"),
        *_what_if(ui),
    ]  # fmt: skip


def _what_if(ui: Ui) -> list[Command]:
    """Commands that change the scene that is shown, not its file."""
    c, state = ui.controller, ui.state(WhatIfState)
    hides = Condition(lambda: thing_pointed_at(ui) is not None, "click an object first, or point at one")
    hidden = Condition(
        lambda: bool(c.editing.now.hidden or c.editing.now.hidden_primitives), "everything is shown already"
    )
    edited = Condition(lambda: bool(c.editing.now), "the scene is as its file says")
    return [
        Command("What if...", "Edit/What if", lambda: ui.show_panel("What if"), separated=True,
                tip="switch off a light, hide an object, and see what changes"),
        Command("Hide the object", "Edit/What if", lambda: hide(ui), enabled=hides,
                tip="that was clicked, or is under the pointer"),
        Command("Show everything", "Edit/What if", c.editing.show_everything, enabled=hidden),
        switch("Changed pixels", "Edit/What if", state, "changed_shown", enabled=edited,
               tip="by the edits: in magenta on the dimmed picture"),
        Command("Take all edits back", "Edit/What if", c.editing.clear, enabled=edited,
                tip="the scene as its file says"),
    ]  # fmt: skip


def thing_pointed_at(ui: Ui) -> str | None:
    """The name of the object that was clicked, else of that under the pointer; None for nothing."""
    c, now = ui.controller, ui.controller.session.edited
    pick = c.selection.picked or c.selection.at(c.selection.hovered)
    if now is None or pick is None or not 0 <= pick.primitive < len(now.primitives):
        return None
    return now.thing_of(pick.primitive).name


def hide(ui: Ui) -> None:
    """Hide what was clicked, or is under the pointer."""
    name = thing_pointed_at(ui)
    if name is not None:
        ui.controller.editing.hide(name)
