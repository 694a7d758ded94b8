"""The menu Edit: undo and redo, the command palette, and presets."""

from __future__ import annotations

from viewer.window.command import Command, Condition
from viewer.window.ui import Dialog, Ui


def build(ui: Ui) -> list[Command]:
    """All of them, in the order of the menu."""
    c = ui.controller
    undo = c.undo

    return [
        Command("Undo", "Edit", undo.undo, "Ctrl+Z", repeats=True, title=lambda: f"Undo {undo.undoes}".rstrip(),
                enabled=Condition(lambda: bool(undo.undoes), "there is nothing to undo")),
        Command("Redo", "Edit", undo.redo, "Ctrl+Shift+Z", repeats=True, title=lambda: f"Redo {undo.redoes}".rstrip(),
                enabled=Condition(lambda: bool(undo.redoes), "there is nothing to redo"), other_keys=("Ctrl+Y",)),
        Command("Command palette", "Edit", lambda: ui.open(Dialog.PALETTE), "Ctrl+Shift+P", separated=True,
                tip="finds commands, settings, scenes, bookmarks and presets as you type"),
        Command("Presets...", "Edit/Presets", lambda: ui.toggle(Dialog.PRESETS),
                checked=lambda: Dialog.PRESETS in ui.dialogs,
                tip="save the settings under a name; rename and delete presets"),
    ]  # fmt: skip
