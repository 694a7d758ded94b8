"""All keys as they are now, and what the pointer does: read as help, and changed by a click."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from imgui_bundle import ImVec2, imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from viewer.state.keymap import HELD
from viewer.window.command import MENUS
from viewer.window.finder import match
from viewer.window.ui import Dialog, Ui
from viewer.window.widgets import ERROR, QUIET, clipped, em, paragraph, tooltip

TITLE = "Keyboard and mouse"
_FLYING = "While held"
_KEY = 7.6  # width of a key in ems
_BY_MODE = "look around (fly); orbit around what was clicked (orbit)"
_DRAGS = {
    "by mode": _BY_MODE,
    "pan by mode": "look around (fly); pan (orbit)",
    "look": "look around",
    "orbit": "orbit around what was clicked",
    "pan": "pan",
    "dolly": "come nearer or go farther",
}
_WHEELS = {
    "by mode": "set the speed (fly); come nearer or go farther (orbit)",
    "speed": "set the speed",
    "dolly": "come nearer or go farther",
}


@dataclass
class KeysState:
    """What is looked for."""

    filter: str = ""


def show(ui: Ui) -> None:
    """The dialog, while it is open."""
    if Dialog.KEYS not in ui.dialogs:
        ui.keyboard.wanted_for = ""
        return
    viewport = imgui.get_main_viewport()
    size = ImVec2(min(em(58.0), 0.96 * viewport.work_size.x), min(em(46.0), 0.92 * viewport.work_size.y))
    imgui.set_next_window_pos(viewport.get_work_center(), int(imgui.Cond_.appearing), ImVec2(0.5, 0.5))
    imgui.set_next_window_size(size, int(imgui.Cond_.appearing))
    flags = imgui.WindowFlags_.no_docking | imgui.WindowFlags_.no_saved_settings | imgui.WindowFlags_.no_collapse
    shown, open_ = imgui.begin(TITLE, True, int(flags))
    if not open_:
        ui.close(Dialog.KEYS)
    if shown:
        _capture(ui)
        conflicts = ui.keymap.conflicts()
        _head(ui, len(conflicts))
        if imgui.begin_child("all keys"):
            wide = imgui.get_content_region_avail().x > em(40.0)
            if imgui.begin_table("keys", 2 if wide else 1, int(imgui.TableFlags_.sizing_stretch_same)):
                groups = list(_groups(ui))
                half = _half(groups) if wide else len(groups)
                for number, (title, names) in enumerate(groups):
                    if number in (0, half):
                        imgui.table_next_column()
                    _group(ui, title, names, conflicts)
                imgui.end_table()
            _pointer(ui)
        imgui.end_child()
    imgui.end()


def _head(ui: Ui, at_odds: int) -> None:
    state = ui.state(KeysState)
    keymap = ui.keymap
    imgui.set_next_item_width(em(11.0))
    _, state.filter = imgui.input_text_with_hint("##filter", "find a command or a key", state.filter)
    imgui.same_line(0.0, em(1.0))
    imgui.begin_disabled(not ui.controller.preferences.keys)
    if imgui.button("Reset all keys"):
        keymap.reset()
    imgui.end_disabled()
    tooltip("give every command its usual key again")
    if at_odds:
        imgui.same_line(0.0, em(1.0))
        imgui.text_colored(ERROR, f"{icons.ICON_FA_TRIANGLE_EXCLAMATION}  {at_odds} conflicts")
    paragraph(
        f"Press a key for {ui.keyboard.wanted_for}, or Escape to leave it." if ui.keyboard.wanted_for else
        "Click a key to choose another; the right button offers more. Keys without Ctrl or Alt are places on the "
        "keyboard, shown by what is printed there.",
        None if ui.keyboard.wanted_for else QUIET,
    )  # fmt: skip


def _capture(ui: Ui) -> None:
    """Take the key that is pressed for the command that waits for one."""
    if not ui.keyboard.wanted_for:
        return
    if imgui.is_key_pressed(imgui.Key.escape, repeat=False):
        ui.keyboard.wanted_for = ""
        return
    key = ui.keyboard.pressed()
    if key is None:
        return
    name, ui.keyboard.wanted_for = ui.keyboard.wanted_for, ""
    if name in HELD:
        key = key.split("+")[-1]  # it is held with any modifier: Shift flies faster
    ui.keymap.choose(name, [key, *ui.keymap.of(name)[1:]])
    others = ui.keymap.conflicts().get(name, [])
    label = ui.keyboard.label(key)
    also = f", and also {', '.join(others)}; give one of them another key" if others else ""
    ui.controller.notices.say(f"{label}: {name}{also}", error=bool(others))


def _groups(ui: Ui) -> Iterator[tuple[str, list[str]]]:
    """Titles, and the names below them; only what is looked for."""
    typed = ui.state(KeysState).filter.strip()

    def wanted(name: str, menu: str) -> bool:
        keys = " ".join(ui.keyboard.label(key) for key in ui.keymap.of(name))
        return not typed or match(typed, f"{name} {keys}", menu) is not None

    flying = [name for name in HELD if wanted(name, _FLYING) and (typed or ui.keymap.of(name))]
    if flying:
        yield _FLYING, flying
    for menu in MENUS:
        names = [c.name for c in ui.commands if c.menu.split("/")[0] == menu and wanted(c.name, c.menu)]
        if names:
            yield menu, names


def _half(groups: list[tuple[str, list[str]]]) -> int:
    """How many groups go into the first column, so that both are about as long."""
    lines = [len(names) + 2 for _, names in groups]
    return min(range(1, len(groups) + 1), key=lambda n: abs(sum(lines[:n]) - sum(lines[n:]))) if groups else 0


def _group(ui: Ui, title: str, names: list[str], conflicts: dict[str, list[str]]) -> None:
    imgui.separator_text(title)
    for name in names:
        imgui.push_id(name)
        _line(ui, name, conflicts.get(name, []))
        imgui.pop_id()


def _line(ui: Ui, name: str, conflicts: list[str]) -> None:
    keymap, waiting = ui.keymap, ui.keyboard.wanted_for == name
    label = "press a key" if waiting else ui.keyboard.label(keymap.shown(name)) or "-"
    left = imgui.get_cursor_pos_x()
    color = ERROR if conflicts else imgui.get_style_color_vec4(imgui.Col_.text)
    imgui.push_style_color(imgui.Col_.text, color)
    if imgui.selectable(f"{label}##key", waiting, 0, ImVec2(em(_KEY - 0.6), 0.0))[0]:
        ui.keyboard.wanted_for = "" if waiting else name
    imgui.pop_style_color()
    others = ", ".join(ui.keyboard.label(key) for key in keymap.of(name)[1:])
    if conflicts:
        tooltip(f"also: {', '.join(conflicts)}")
    elif others:
        tooltip(f"also {others}")
    if imgui.begin_popup_context_item("more"):
        _more(ui, name, conflicts)
        imgui.end_popup()
    imgui.same_line()
    imgui.set_cursor_pos_x(left + em(_KEY))
    changed = keymap.changed(name)
    clipped(f"{name}{'  (changed)' if changed else ''}", ERROR if conflicts else None if changed else QUIET)


def _more(ui: Ui, name: str, conflicts: list[str]) -> None:
    keymap = ui.keymap
    if imgui.menu_item("No key", "", False, bool(keymap.of(name)))[0]:
        keymap.choose(name, [])
    usual = ", ".join(ui.keyboard.label(key) for key in keymap.usual(name)) or "no key"
    if imgui.menu_item(f"The usual key: {usual}", "", False, keymap.changed(name))[0]:
        keymap.reset(name)
    for other in conflicts:
        if imgui.menu_item(f"Take it from {other}", "", False, True)[0]:
            keymap.choose(other, [key for key in keymap.of(other) if key not in keymap.of(name)])


def _pointer(ui: Ui) -> None:
    """What the pointer does on the picture."""
    imgui.separator_text("On the picture")
    lines = [
        ("left drag", "look around (fly); orbit around what was clicked (orbit)"),
        ("right drag", "look around (fly); pan (orbit)"),
        ("middle drag", "pan"),
        ("wheel", "flying speed (fly); come nearer (orbit)"),
        ("Shift", "while flying: faster"),
        ("Ctrl + wheel, Ctrl + left drag", "zoom into the picture itself around the pointer; move it"),
        ("Shift + left drag", "choose a region, whose values the panel Pixels counts"),
        ("right click", "a menu for the pixel"),
        ("drag the wipe's line", "compare the picture with the right one, or A with B"),
        ("drag the legend", "put it elsewhere in the picture; it snaps to edges and corners"),
        ("click", "inspect a pixel, and draw its shadow rays; click the background to clear the selection"),
    ]
    if not imgui.begin_table("pointer", 2):
        return
    imgui.table_setup_column("gesture", int(imgui.TableColumnFlags_.width_fixed), em(10.0))
    imgui.table_setup_column("meaning", int(imgui.TableColumnFlags_.width_stretch))
    for gesture, meaning in lines:
        imgui.table_next_column()
        imgui.text_unformatted(gesture[0].upper() + gesture[1:])
        imgui.table_next_column()
        paragraph(meaning, QUIET)
    imgui.end_table()
