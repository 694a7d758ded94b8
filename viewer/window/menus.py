"""Menus and keys, both made from the one list of commands, so that they cannot disagree; and what Escape closes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial

from imgui_bundle import imgui

from viewer.window.command import MENUS, Command
from viewer.window.ui import Ui
from viewer.window.widgets import tooltip

PANELS_MENU, ALL_MENUS = "Panels", "Menu"
ANY_POPUP = int(imgui.PopupFlags_.any_popup_id) | int(imgui.PopupFlags_.any_popup_level)


def handle_keys(ui: Ui) -> None:
    """Run the commands whose keys were just pressed; while the user is typing only those for that, and none while a
    dialog is up."""
    ui.keyboard.update()
    modifiers, typing = ui.keyboard.update_modifiers(ui.keymap), imgui.get_io().want_text_input
    if ui.keyboard.wanted_for:
        return
    if not typing and imgui.is_key_pressed(imgui.Key.escape, repeat=False) and close_newest(ui):
        return
    if imgui.is_popup_open("", ANY_POPUP):
        return
    for command in ui.commands:
        keys = ui.keymap.of(command.name) if command.while_typing or not typing else ()
        if any(_pressed(ui, command, key, modifiers) for key in keys) and command.enabled():
            ui.guard.step(f"The command {command.name}", command.run)


Contents = Mapping[str, Callable[[], None]]


def show(ui: Ui, others: Contents, more: Contents) -> None:
    """All menus of the menu bar, and `others` after them; within a single one where there is no room for their names.
    Some menus, by their paths, have `more` after their commands."""
    contents: dict[str, Callable[[], None]] = {name: partial(_menu, ui, name, more) for name in MENUS}
    contents |= others
    gap = imgui.get_style().item_spacing.x
    needed = sum(imgui.calc_text_size(name).x + 2.0 * gap for name in contents)
    if needed <= imgui.get_content_region_avail().x:
        _menus(contents)
    elif imgui.begin_menu(ALL_MENUS):
        _menus(contents)
        imgui.end_menu()


def _menus(contents: Contents) -> None:
    for name, show_content in contents.items():
        if imgui.begin_menu(name):
            show_content()
            imgui.end_menu()


def _menu(ui: Ui, path: str, more: Contents) -> None:
    """The commands of a menu, and the menus within it where the first of their commands stands."""
    inner: list[str] = []
    first = True
    for command in ui.commands:
        if command.menu == path:
            if command.label:
                _menu_item(ui, command, command.separated and not first)
                first = False
        elif command.menu.startswith(f"{path}/") and command.menu not in inner:
            inner.append(command.menu)
            if command.separated and not first:
                imgui.separator()
            first = False
            if imgui.begin_menu(command.menu.removeprefix(f"{path}/")):
                _menu(ui, command.menu, more)
                if command.menu in more:
                    more[command.menu]()
                imgui.end_menu()


def _pressed(ui: Ui, command: Command, key: str, modifiers: int) -> bool:
    number = ui.keyboard.chord(key)
    if number & int(imgui.Key.mod_mask_) != modifiers:
        return False
    pressed = imgui.is_key_pressed(imgui.Key(number & ~int(imgui.Key.mod_mask_)), repeat=command.repeats)
    return pressed and ui.keyboard.is_meant(key)


def _menu_item(ui: Ui, command: Command, separated: bool) -> None:
    label = command.label
    if separated:
        imgui.separator()
    checked = command.checked() if command.checked is not None else False
    key = ui.keyboard.label(ui.keymap.shown(command.name))
    clicked, _ = imgui.menu_item(label if label == command.name else f"{label}###{command.name}", key, checked,
                                 command.enabled())  # fmt: skip
    if command.tip:
        tooltip(command.tip)
    if clicked:
        ui.guard.step(f"The command {command.name}", command.run)


def close_newest(ui: Ui) -> bool:
    """Close one menu, list, dialog or folded panel; returns whether there was one.

    A dialog that has the keyboard to itself closes itself."""
    if imgui.is_popup_open("", ANY_POPUP):
        _close_list()
    elif ui.dialogs:
        ui.dialogs.pop()
    elif ui.fold.drawer:
        ui.fold.drawer = ""
    elif ui.frame_preview is not None:
        ui.frame_preview = None
    elif ui.controller.notices.newest_fault is not None:
        ui.controller.notices.dismiss_faults()
    else:
        return False
    return True


def _close_list() -> None:
    """Close the menu or list that was opened last; ImGui does so itself only where it steers the keyboard."""
    opened = imgui.get_current_context().open_popup_stack
    newest = opened[len(opened) - 1].window
    if newest is not None and not newest.flags & int(imgui.WindowFlags_.modal):
        imgui.internal.close_popup_to_level(len(opened) - 1, True)
