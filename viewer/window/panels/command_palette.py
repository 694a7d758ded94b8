"""The command palette: a line to type in, and below it what is meant by that."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

from imgui_bundle import ImVec2, imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from viewer.state.preferences import RECENT_COMMANDS
from viewer.util.resources import embedded_scenes
from viewer.window import setting_rows
from viewer.window.command import Command
from viewer.window.finder import Finder, Item, Kind
from viewer.window.menus import ANY_POPUP
from viewer.window.ui import Dialog, Ui
from viewer.window.widgets import ERROR, QUIET, clipped, em, fitted, paragraph, tooltip

TITLE = "##command palette"
_WIDTH, _LINES, _PAGE = 42.0, 13, 10
_ICONS = {
    Kind.COMMAND: icons.ICON_FA_ANGLE_RIGHT,
    Kind.SETTING: icons.ICON_FA_SLIDERS,
    Kind.PRESET: icons.ICON_FA_LAYER_GROUP,
    Kind.BOOKMARK: icons.ICON_FA_BOOKMARK,
    Kind.SCENE: icons.ICON_FA_CUBES,
}
_LINE = int(imgui.InputTextFlags_.enter_returns_true) | int(imgui.InputTextFlags_.callback_history)
_ROW = int(imgui.SelectableFlags_.no_auto_close_popups)


def show(ui: Ui) -> None:
    """It lies at the top of the window, and goes with Escape, with a click elsewhere, and when something is run."""
    finder = ui.state(Finder)
    if Dialog.PALETTE in ui.dialogs:
        ui.close(Dialog.PALETTE)  # it is a popup from here on, which knows itself whether it is open
        finder.begin()
        imgui.open_popup(TITLE)
    if not imgui.is_popup_open(TITLE):
        return
    viewport = imgui.get_main_viewport()
    width = min(em(_WIDTH), 0.95 * viewport.work_size.x)
    top = viewport.work_pos.y + 0.08 * viewport.work_size.y
    imgui.set_next_window_pos(
        ImVec2(viewport.work_pos.x + 0.5 * viewport.work_size.x, top), int(imgui.Cond_.always), ImVec2(0.5, 0.0)
    )
    imgui.set_next_window_size(ImVec2(width, 0.0))
    if not imgui.begin_popup(TITLE):
        return
    finder.update(items(ui), ui.controller.preferences.used)
    taken = finder.aimed
    entered = _line(finder)
    clicked = None
    if finder.setting is None:
        clicked = _list(finder, viewport.work_size.y)
    elif not finder.problem:
        paragraph(finder.setting.hint, QUIET)
    if finder.problem:
        paragraph(finder.problem, ERROR)
    elif taken is not None and not taken.enabled and taken.why_not:
        paragraph(taken.why_not, QUIET)
    do = None
    if entered or clicked is not None:
        chosen = clicked or finder.aimed or finder.setting
        do = finder.enter(clicked or finder.aimed)
        if do is not None and chosen is not None:
            _remember(ui, chosen)
    if do is not None or imgui.is_key_pressed(imgui.Key.escape):
        imgui.close_current_popup()
    imgui.end_popup()
    if do is not None:
        do()


def close() -> None:
    """Take it away, whatever it is at."""
    if imgui.is_popup_open("", ANY_POPUP):
        imgui.internal.close_popup_to_level(0, True)


def _remember(ui: Ui, item: Item) -> None:
    p = ui.controller.preferences
    p.used = [item.name, *(name for name in p.used if name != item.name)][:RECENT_COMMANDS]


def _line(finder: Finder) -> bool:
    """The line to type in, which always has the keyboard; returns whether Enter was pressed."""

    def key(data: imgui.InputTextCallbackData) -> int:
        finder.step(1 if data.event_key == imgui.Key.down_arrow else -1)
        return 0

    for pressed, lines in ((imgui.Key.page_down, _PAGE), (imgui.Key.page_up, -_PAGE)):
        if imgui.is_key_pressed(pressed):
            finder.step(lines)
    setting = finder.setting
    if setting is not None:
        imgui.align_text_to_frame_padding()
        imgui.text_unformatted(setting.label)
        imgui.same_line()
    imgui.set_next_item_width(-1.0)
    if finder.fresh or not imgui.is_any_item_active():
        imgui.set_keyboard_focus_here()
    hint = "find commands, settings, presets, bookmarks and scenes"
    name = f"##value {setting.name}" if setting is not None else "##typed"
    flags = _LINE | (int(imgui.InputTextFlags_.auto_select_all) if setting is not None else 0)
    entered, text = imgui.input_text_with_hint(name, "" if setting is not None else hint, finder.typed, flags, key)
    finder.fresh = False
    if text != finder.typed and finder.setting is setting:
        finder.type(text)
    return bool(entered)


def _list(finder: Finder, room: float) -> Item | None:
    """What was found; returns what was clicked."""
    if not finder.found:
        imgui.text_colored(QUIET, "no matches")
        return None
    height = math.ceil(imgui.get_text_line_height_with_spacing())
    lines = min(len(finder.found), _LINES, max(3, int(0.7 * room / height)))
    clicked = None
    style = imgui.get_style()
    imgui.push_style_var(imgui.StyleVar_.item_spacing, ImVec2(style.item_spacing.x, math.floor(style.item_spacing.y)))
    if imgui.begin_child("found", ImVec2(0.0, lines * height)):
        if finder.moved:
            finder.moved = False
            top, seen = imgui.get_scroll_y(), lines * height
            at = finder.marked * height
            if at < top:
                imgui.set_scroll_y(at)
            elif at + height > top + seen:
                imgui.set_scroll_y(at + height - seen)
        clipper = imgui.ListClipper()
        clipper.begin(len(finder.found), height)
        while clipper.step():
            for number in range(clipper.display_start, clipper.display_end):
                imgui.set_cursor_pos_y(number * height)
                if _row(finder.found[number], number == finder.marked, height):
                    finder.marked = number
                    clicked = finder.found[number]
        clipper.end()
    imgui.end_child()
    imgui.pop_style_var()
    return clicked


def _row(item: Item, marked: bool, height: float) -> bool:
    imgui.push_id(item.name)
    clicked = imgui.selectable("##row", marked, _ROW, ImVec2(0.0, height - imgui.get_style().item_spacing.y))[0]
    if item.why_not:
        tooltip(item.why_not)
    elif item.hint:
        tooltip(item.hint)
    imgui.same_line(em(0.3))
    imgui.text_colored(QUIET, icons.ICON_FA_CHECK if item.checked else _ICONS[item.kind])
    imgui.same_line(em(1.9))
    left, edge = imgui.get_cursor_screen_pos(), imgui.get_content_region_avail().x
    right = item.key or (item.value if item.value is not None else "")
    key_room = imgui.calc_text_size(right).x + em(0.6) if right else 0.0
    clipped(item.label, None if item.enabled else imgui.get_style_color_vec4(imgui.Col_.text_disabled))
    path_room = edge - key_room - (imgui.get_item_rect_max().x - left.x) - em(1.2)
    if item.path and path_room > em(3.0):
        imgui.same_line(0.0, em(0.8))
        imgui.text_colored(QUIET, fitted(item.path, path_room))
    if right:
        imgui.same_line()
        imgui.set_cursor_screen_pos(ImVec2(left.x + edge - key_room + em(0.3), left.y))
        clipped(right, QUIET)
    imgui.pop_id()
    return clicked


def items(ui: Ui) -> list[Item]:
    """Everything, as it is now; commands first, in the order of the menus."""
    return [*_commands(ui), *setting_rows.entries(ui), *_presets(ui), *_panels(ui), *_bookmarks(ui), *_scenes(ui)]


def _commands(ui: Ui) -> Iterator[Item]:
    for command in ui.commands:
        label = command.label
        if label and command.name != Dialog.PALETTE.value:
            yield Item(
                command.name,
                label,
                Kind.COMMAND,
                _running(ui, command),
                path=command.menu.replace("/", " > "),
                key=ui.keyboard.label(ui.keymap.shown(command.name)),
                checked=command.checked() if command.checked is not None else None,
                enabled=command.enabled(),
                why_not=command.why_not,
                also=f"{command.name} {command.also}",
            )


def _running(ui: Ui, command: Command) -> Callable[[], None]:
    return lambda: ui.guard.step(f"The command {command.name}", command.run)


def _presets(ui: Ui) -> Iterator[Item]:
    presets = ui.controller.presets
    for name in presets.names:
        yield Item(f"preset {name}", name, Kind.PRESET, partial(presets.apply, name), "Edit > Presets",
                   also="apply")  # fmt: skip


def _panels(ui: Ui) -> Iterator[Item]:
    for label in ui.panel_labels:
        yield Item(f"panel {label}", f"Panel {label}", Kind.COMMAND, partial(ui.show_panel, label), "Panels",
                   also="show open")  # fmt: skip


def _bookmarks(ui: Ui) -> Iterator[Item]:
    c = ui.controller
    for number, mark in enumerate(c.bookmarks.all):
        yield Item(
            f"bookmark {number}",
            mark.name,
            Kind.BOOKMARK,
            partial(c.go_to_bookmark, number),
            "go there",
        )


def _scenes(ui: Ui) -> Iterator[Item]:
    loader, own = ui.controller.loader, embedded_scenes()
    for name, path in own.items():
        yield Item(f"scene {path}", name, Kind.SCENE, partial(loader.open, path), "comes with Shadowcull",
                   also="open")  # fmt: skip
    for text in ui.controller.preferences.recent:
        path = Path(text)
        if path not in own.values():
            yield Item(f"scene {path}", path.name, Kind.SCENE, partial(loader.open, path), str(path.parent),
                       also="open recent")  # fmt: skip
