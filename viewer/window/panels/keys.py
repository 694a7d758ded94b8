"""All keys as they are now, and what the pointer does: read as help, and changed by a click."""

from __future__ import annotations

from imgui_bundle import ImVec2, imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from viewer.window.command import MENUS
from viewer.window.keyboard import HELD
from viewer.window.ui import Ui
from viewer.window.widgets import ERROR, QUIET, clipped, em, paragraph, properties, tooltip, value

_KEY = 7.6  # width of a key in ems
_POINTER = (
    ("Left drag", "look around (fly); orbit around what was clicked (orbit)"),
    ("Right drag", "look around (fly); pan (orbit)"),
    ("Middle drag", "pan"),
    ("Wheel", "flying speed (fly); come nearer (orbit)"),
    ("Shift", "while flying: faster"),
    ("Ctrl + wheel, Ctrl + left drag", "zoom into the picture itself around the pointer; move it"),
    ("Drag the wipe's line", "compare the picture with the right one, or A with B"),
    ("Drag the legend", "move it within the picture"),
    ("Click", "inspect a pixel, and draw its shadow rays; click the background to clear the selection"),
)


def show(ui: Ui) -> None:
    """Show what is in the dialog."""
    _capture(ui)
    conflicts = ui.keymap.conflicts()
    _head(ui, len(conflicts))
    if imgui.begin_child("all keys"):
        _groups(ui, conflicts)
        _pointer()
    imgui.end_child()


def _capture(ui: Ui) -> None:
    """Take the key that is pressed for the command that waits for one."""
    name = ui.keyboard.wanted_for
    if name and imgui.is_key_pressed(imgui.Key.escape, repeat=False):
        ui.keyboard.wanted_for = ""
        return
    key = ui.keyboard.pressed() if name else None
    if key is None:
        return
    ui.keyboard.wanted_for = ""
    if name in HELD:
        key = key.split("+")[-1]  # it is held with any modifier: Shift flies faster
    ui.keymap.choose(name, [key, *ui.keymap.of(name)[1:]])
    others = ui.keymap.conflicts().get(name, [])
    also = f", and also {', '.join(others)}; give one of them another key" if others else ""
    ui.controller.notices.say(f"{ui.keyboard.label(key)}: {name}{also}", error=bool(others))


def _head(ui: Ui, conflicts: int) -> None:
    waiting = ui.keyboard.wanted_for
    imgui.begin_disabled(not ui.controller.preferences.keys)
    if imgui.button("Reset all keys"):
        ui.controller.preferences.keys.clear()
    imgui.end_disabled()
    tooltip("Restore the default keys of all commands.")
    if conflicts:
        imgui.same_line(0.0, em(1.0))
        imgui.text_colored(ERROR, f"{icons.ICON_FA_TRIANGLE_EXCLAMATION}  {conflicts} conflicts")
    paragraph(
        f"Press a key for {waiting}, or Escape to cancel." if waiting else
        "Click a key to change it, right-click for more. Keys without Ctrl or Alt are places on the "
        "keyboard, shown by what is printed there.",
        None if waiting else QUIET,
    )  # fmt: skip


def _groups(ui: Ui, conflicts: dict[str, list[str]]) -> None:
    """Show all that has a key, or could have one, menu by menu, in one or two columns of about the same length."""
    groups = {"While held": list(HELD)}
    groups |= {menu: [c.name for c in ui.commands if c.menu.split("/")[0] == menu] for menu in MENUS}
    columns, lines = 2 if imgui.get_content_region_avail().x > em(40.0) else 1, 0
    half = sum(len(names) + 2 for names in groups.values()) / 2
    if imgui.begin_table("keys", columns, int(imgui.TableFlags_.sizing_stretch_same)):
        imgui.table_next_column()
        for title, names in groups.items():
            if lines <= half < lines + len(names) + 2 and columns > 1:
                imgui.table_next_column()
            lines += len(names) + 2
            imgui.separator_text(title)
            for name in names:
                imgui.push_id(name)
                _line(ui, name, conflicts.get(name, []))
                imgui.pop_id()
        imgui.end_table()


def _line(ui: Ui, name: str, conflicts: list[str]) -> None:
    keymap, own, waiting = ui.keymap, ui.controller.preferences.keys, ui.keyboard.wanted_for == name
    changed = name in own
    label = "press a key" if waiting else ui.key_label(name) or "none"
    left = imgui.get_cursor_pos_x()
    imgui.push_style_color(imgui.Col_.text, ERROR if conflicts else imgui.get_style_color_vec4(imgui.Col_.text))
    if imgui.selectable(f"{label}##key", waiting, 0, ImVec2(em(_KEY - 0.6), 0.0))[0]:
        ui.keyboard.wanted_for = "" if waiting else name
    imgui.pop_style_color()
    also = conflicts or [ui.keyboard.label(key) for key in keymap.of(name)[1:]]
    if also:
        tooltip(f"also: {', '.join(also)}")
    if imgui.begin_popup_context_item("more"):
        if imgui.menu_item("No key", "", False, bool(keymap.of(name)))[0]:
            keymap.choose(name, [])
        usual = ", ".join(map(ui.keyboard.label, keymap.defaults[name])) or "no key"
        if imgui.menu_item(f"Default key: {usual}", "", False, changed)[0]:
            del own[name]
        imgui.end_popup()
    imgui.same_line()
    imgui.set_cursor_pos_x(left + em(_KEY))
    clipped(f"{name}{'  (changed)' if changed else ''}", ERROR if conflicts else None if changed else QUIET)


def _pointer() -> None:
    """Show what the pointer does on the picture."""
    imgui.separator_text("On the picture")
    with properties("pointer", 10.0) as shown:
        for gesture, meaning in _POINTER if shown else ():
            value(gesture, meaning, wraps=True)
