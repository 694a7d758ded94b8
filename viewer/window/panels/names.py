"""A name in a list while it is being edited."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from imgui_bundle import imgui

from viewer.window.ui import Ui

_FLAGS = int(imgui.InputTextFlags_.enter_returns_true) | int(imgui.InputTextFlags_.auto_select_all)


@dataclass
class NameField:
    """The list and the place in it of a name that is being edited, what is typed, and whether the field is new."""

    place: tuple[str, int] | None = None
    text: str = ""
    fresh: bool = False


def begin_edit(ui: Ui, place: tuple[str, int], name: str) -> None:
    """Begin to edit a name in a list."""
    field = ui.state(NameField)
    field.place, field.text, field.fresh = place, name, True


def edit_name(ui: Ui, rename: Callable[[str], object]) -> None:
    """A field in the name's place: Enter takes what was typed; Escape and a click elsewhere leave it."""
    state = ui.state(NameField)
    fresh, state.fresh = state.fresh, False
    if fresh:
        imgui.set_keyboard_focus_here()
    entered, state.text = imgui.input_text("##name", state.text, _FLAGS)
    if entered:
        rename(state.text)
    left = not fresh and imgui.is_item_deactivated()
    if entered or left or imgui.is_key_pressed(imgui.Key.escape):
        state.place = None
