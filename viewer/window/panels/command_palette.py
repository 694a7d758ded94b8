"""The command palette: a line to type in, and below it what is meant by that."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from pathlib import Path

from imgui_bundle import ImVec2, imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from viewer.state.preferences import RECENT_COMMANDS
from viewer.util.resources import embedded_scenes
from viewer.window import setting_rows
from viewer.window.command import Command, Kind
from viewer.window.finder import Finder
from viewer.window.menus import ANY_POPUP, run
from viewer.window.panels.named_states import preset_commands
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
    area, size = imgui.get_main_viewport().work_pos, imgui.get_main_viewport().work_size
    top = ImVec2(area.x + 0.5 * size.x, area.y + 0.08 * size.y)
    imgui.set_next_window_pos(top, int(imgui.Cond_.always), ImVec2(0.5, 0.0))
    imgui.set_next_window_size(ImVec2(min(em(_WIDTH), 0.95 * size.x), 0.0))
    if not imgui.begin_popup(TITLE):
        return
    preferences = ui.controller.preferences
    finder.update(items(ui), preferences.used)
    aimed = finder.aimed
    entered = _line(finder)
    clicked = _list(ui, finder) if finder.setting is None else None
    hint = finder.setting.tip if finder.setting is not None else aimed.why_not if aimed is not None else ""
    if finder.problem or hint:
        paragraph(finder.problem or hint, ERROR if finder.problem else QUIET)
    chosen = clicked or finder.aimed or finder.setting
    done = (entered or clicked is not None) and finder.enter(clicked or finder.aimed)
    if done or imgui.is_key_pressed(imgui.Key.escape):
        imgui.close_current_popup()
    imgui.end_popup()
    if done and chosen is not None:
        names = [chosen.name, *(name for name in preferences.used if name != chosen.name)]
        preferences.used = names[:RECENT_COMMANDS]
        run(ui, chosen)


def close() -> None:
    """Take it away, whatever it is at."""
    if imgui.is_popup_open("", ANY_POPUP):
        imgui.internal.close_popup_to_level(0, True)


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


def _list(ui: Ui, finder: Finder) -> Command | None:
    """Show what was found; returns what was clicked."""
    if not finder.found:
        imgui.text_colored(QUIET, "no matches")
        return None
    clicked = None
    height = min(len(finder.found), _LINES) * imgui.get_text_line_height_with_spacing()
    if imgui.begin_child("found", ImVec2(0.0, min(height, 0.7 * imgui.get_main_viewport().work_size.y))):
        for number, item in enumerate(finder.found):
            if _row(ui, item, number == finder.marked):
                finder.marked, clicked = number, item
            if number == finder.marked and finder.moved:
                imgui.set_scroll_here_y()
                finder.moved = False
    imgui.end_child()
    return clicked


def _row(ui: Ui, item: Command, marked: bool) -> bool:
    imgui.push_id(item.name)
    clicked = imgui.selectable("##row", marked, _ROW)[0]
    if item.why_not or item.tip:
        tooltip(item.why_not or item.tip)
    imgui.same_line(em(0.3))
    imgui.text_colored(QUIET, icons.ICON_FA_CHECK if item.is_checked else _ICONS[item.kind])
    imgui.same_line(em(1.9))
    left, edge = imgui.get_cursor_pos_x(), imgui.get_content_region_avail().x
    shown, menu = ui.key_label(item.name) or item.value or "", item.menu.replace("/", " > ")
    key_room = imgui.calc_text_size(shown).x + em(0.3)
    clipped(item.label, None if item.enabled() else imgui.get_style_color_vec4(imgui.Col_.text_disabled))
    path_room = edge - key_room - imgui.calc_text_size(item.label).x - em(1.8)
    if menu and path_room > em(3.0):
        imgui.same_line(0.0, em(0.8))
        imgui.text_colored(QUIET, fitted(menu, path_room))
    if shown:
        imgui.same_line(left + edge - key_room)
        clipped(shown, QUIET)
    imgui.pop_id()
    return bool(clicked)


def items(ui: Ui) -> list[Command]:
    """Return everything, as it is now; commands first, in the order of the menus."""
    own = [command for command in ui.commands if command.label and command.name != Dialog.PALETTE.value]
    return [*own, *setting_rows.entries(ui), *_others(ui)]


def _others(ui: Ui) -> Iterator[Command]:
    """Return presets, panels, bookmarks and scenes."""
    c, own = ui.controller, embedded_scenes()
    yield from preset_commands(ui)
    for label in ui.panel_labels:
        yield Command(f"panel {label}", "Panels", partial(ui.show_panel, label), title=f"Panel {label}", also="open")
    for number, mark in enumerate(c.bookmarks.all):
        go = partial(c.go_to_bookmark, number)
        yield Command(f"bookmark {number}", "go there", go, title=mark.name, kind=Kind.BOOKMARK)
    scenes = {path: (name, "comes with Shadowcull") for name, path in own.items()}
    recent = {path: (path.name, str(path.parent)) for path in map(Path, c.preferences.recent)}
    for path, (name, place) in (recent | scenes).items():
        open_ = partial(c.loader.open, path)
        yield Command(f"scene {path}", place, open_, title=name, kind=Kind.SCENE, also="open recent")
