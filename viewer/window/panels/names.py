"""A name in a list while it is being edited."""

from __future__ import annotations

from collections.abc import Callable

from imgui_bundle import imgui

from viewer.window.ui import Ui

_FLAGS = int(imgui.InputTextFlags_.enter_returns_true) | int(imgui.InputTextFlags_.auto_select_all)


def edit_name(ui: Ui, rename: Callable[[str], object]) -> None:
    """A field in the name's place: Enter takes what was typed; Escape and a click elsewhere leave it."""
    fresh, ui.editing_fresh = ui.editing_fresh, False
    if fresh:
        imgui.set_keyboard_focus_here()
    entered, ui.edited = imgui.input_text("##name", ui.edited, _FLAGS)
    if entered:
        rename(ui.edited)
    left = not fresh and imgui.is_item_deactivated()
    if entered or left or imgui.is_key_pressed(imgui.Key.escape):
        ui.editing = None
