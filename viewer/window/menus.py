"""Menus and keys, both made from the one list of commands, so that they cannot disagree; and what Escape closes."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from imgui_bundle import ImVec2, imgui

from viewer.window.command import MENUS, Command
from viewer.window.keyboard import works_while_typing
from viewer.window.ui import Ui
from viewer.window.widgets import em, tooltip, wide_button

ANY_POPUP = int(imgui.PopupFlags_.any_popup_id) | int(imgui.PopupFlags_.any_popup_level)


def run(ui: Ui, command: Command) -> None:
    """Run a command; what goes wrong in it ends nothing else."""
    ui.guard.step(f"The command {command.name}", command.run)


def button(ui: Ui, name: str, icon: str, words: str = "", columns: int = 1, width: float = 0.0) -> None:
    """Show a button that runs a command, where it can be run, and is explained by it and its key: a wide one, or one of
    the icon alone, of a `width` in ems."""
    command = next(one for one in ui.commands if one.name == name)
    tip = f"{command.more or name}{ui.key(name)}"
    imgui.begin_disabled(bool(command.why_not))
    if width:
        clicked = imgui.button(f"{icon}##{name}", ImVec2(em(width), 0.0))
        tooltip(tip)
    else:
        clicked = wide_button(f"{icon}  {words or name}", tip, columns)
    imgui.end_disabled()
    if clicked:
        run(ui, command)


# --- keys ------------------------------------------------------------------------------------------


def handle_keys(ui: Ui) -> None:
    """Run the commands whose keys were just pressed, or say why they cannot be run, unless a dialog is up, or the user
    types and may mean the text."""
    ui.keyboard.update()
    modifiers = ui.keyboard.update_modifiers(ui.keymap)
    typing = imgui.get_io().want_text_input
    if ui.keyboard.wanted_for:
        return
    if not typing and imgui.is_key_pressed(imgui.Key.escape, repeat=False) and close_newest(ui):
        return
    if imgui.is_popup_open("", ANY_POPUP):
        return
    for command in ui.commands:
        pressed = [key for key in ui.keymap.of(command.name) if ui.keyboard.is_pressed(key, modifiers, command.repeats)]
        if not pressed or (typing and not any(map(works_while_typing, pressed))):
            continue
        if not command.why_not:
            run(ui, command)
        elif "Escape" not in pressed:  # which many press only to be sure
            ui.controller.notices.say(f"{command.label or command.name}: {command.why_not}")


def close_newest(ui: Ui) -> bool:
    """Close one menu, list or dialog; returns whether there was one.  A dialog that has the keyboard to itself closes
    itself."""
    if imgui.is_popup_open("", ANY_POPUP):
        _close_list()
    elif ui.dialogs:
        ui.dialogs.pop()
    else:
        return False
    return True


def _close_list() -> None:
    """Close the menu or list that was opened last; ImGui does so itself only where it steers the keyboard."""
    opened = imgui.get_current_context().open_popup_stack
    newest = opened[len(opened) - 1].window
    if newest is not None and not newest.flags & int(imgui.WindowFlags_.modal):
        imgui.internal.close_popup_to_level(len(opened) - 1, True)


# --- menus -----------------------------------------------------------------------------------------


def show(ui: Ui, commands: Callable[[], Sequence[Command]]) -> None:
    """Show all menus of the menu bar, the open one made of these commands."""
    for name in MENUS:
        if imgui.begin_menu(name):
            show_menu(ui, name, commands())
            imgui.end_menu()


def show_menu(ui: Ui, path: str, commands: Sequence[Command]) -> None:
    """Show the commands of a menu, and the menus within it where the first of their commands stands."""
    inner: list[str] = []
    first = True
    for command in commands:
        here = command.menu == path and bool(command.label)
        begins = command.menu.startswith(f"{path}/") and command.menu not in inner
        if (here or begins) and command.separated and not first:
            imgui.separator()
        first = first and not (here or begins)
        if here:
            _menu_item(ui, command)
        elif begins:
            inner.append(command.menu)
            if imgui.begin_menu(command.menu.removeprefix(f"{path}/")):
                show_menu(ui, command.menu, commands)
                imgui.end_menu()


def _menu_item(ui: Ui, command: Command) -> None:
    label = command.label if command.label == command.name else f"{command.label}###{command.name}"
    clicked, _ = imgui.menu_item(label, ui.key_label(command.name), command.is_checked, not command.why_not)
    if command.more:
        tooltip(command.more)
    if clicked:
        run(ui, command)
