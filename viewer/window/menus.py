"""Menus and keys, both made from the one list of commands, so that they cannot disagree."""

from __future__ import annotations

from imgui_bundle import imgui

from viewer.window import escape
from viewer.window.command import MENUS, Command, chord, key_label
from viewer.window.ui import Ui
from viewer.window.widgets import tooltip


def handle_keys(ui: Ui) -> None:
    """Run the commands whose keys were just pressed, unless the user is typing or a dialog is up."""
    # A chord that is quickly pressed and let go may be spread over two frames: first Ctrl goes down, then the
    # letter goes down and Ctrl up. So a modifier counts for one frame longer than it is held.
    held, before = int(imgui.get_io().key_mods), ui.modifiers
    ui.modifiers = held
    if imgui.get_io().want_text_input:
        return
    if imgui.is_key_pressed(imgui.Key.escape, repeat=False) and escape.close_newest(ui):
        return
    if imgui.is_popup_open("", escape.ANY_POPUP):
        return
    for command in ui.commands:
        if any(_pressed(command, key, held or before) for key in command.keys) and command.enabled():
            ui.guard.step(f"The command {command.name}", command.run)


def show(ui: Ui) -> None:
    """All menus of the menu bar."""
    for name in MENUS:
        if imgui.begin_menu(name):
            for command in ui.commands:
                if command.menu == name:
                    _menu_item(ui, command)
            imgui.end_menu()


def _pressed(command: Command, key: str, modifiers: int) -> bool:
    number = chord(key)
    if number & int(imgui.Key.mod_mask_) != modifiers:
        return False
    return imgui.is_key_pressed(imgui.Key(number & ~int(imgui.Key.mod_mask_)), repeat=command.repeats)


def _menu_item(ui: Ui, command: Command) -> None:
    if command.separated:
        imgui.separator()
    checked = command.checked() if command.checked is not None else False
    clicked, _ = imgui.menu_item(command.name, key_label(command.key), checked, command.enabled())
    if command.tip:
        tooltip(command.tip)
    if clicked:
        ui.guard.step(f"The command {command.name}", command.run)
