"""Commands that change the scene that is shown, not its file: what if a light were off, an object were not there?"""

from __future__ import annotations

from dataclasses import dataclass

from viewer.window.command import Command, Condition
from viewer.window.ui import Ui


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
    state = ui.state(WhatIfState)
    c = ui.controller
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
        Command("Changed pixels", "Edit/What if", lambda: setattr(state, "changed_shown", not state.changed_shown),
                checked=lambda: state.changed_shown, enabled=edited,
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
