"""The dialog that opens a file: a line to type in, and a list of what can be opened."""

from __future__ import annotations

import math
from pathlib import Path

from imgui_bundle import ImVec2, imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from viewer.services.file_browser import Browser, Entry, Kind
from viewer.window.ui import Ui
from viewer.window.widgets import ERROR, QUIET, centred, clipped, em, fitted, paragraph, right, tooltip

NAME = "The dialog that opens a file"
TITLE = "Open a scene or a captured picture"
_ICONS = {
    Kind.FOLDER: icons.ICON_FA_FOLDER,
    Kind.SCENE: icons.ICON_FA_CUBES,
    Kind.PICTURE: icons.ICON_FA_IMAGE,
    Kind.PART: icons.ICON_FA_CUBE,
}
_ROW = int(imgui.SelectableFlags_.no_auto_close_popups) | int(imgui.SelectableFlags_.allow_double_click)
_LINE = (
    int(imgui.InputTextFlags_.enter_returns_true)
    | int(imgui.InputTextFlags_.callback_completion)
    | int(imgui.InputTextFlags_.callback_history)
)


def show(ui: Ui) -> None:
    """A file dialog of our own: it needs nothing from the desktop, and shows only what can be opened."""
    b = ui.browser
    if b.open and not imgui.is_popup_open(TITLE):
        imgui.open_popup(TITLE)
        b.begin()
    centred(em(38.0))
    shown, stays = imgui.begin_popup_modal(TITLE, b.open, int(imgui.WindowFlags_.no_resize))
    b.open = bool(stays)
    if not shown:
        return
    b.follow(ui.controller.wake)
    _folder_line(b)
    marked = b.marked
    chosen = _path_line(b)
    chosen = _listing(b, b.marked != marked) or chosen
    if b.problem:
        paragraph(b.problem, ERROR)
    if imgui.button("Open", ImVec2(em(6.0), 0.0)):
        chosen = b.meant()
    imgui.same_line()
    if imgui.button("Cancel", ImVec2(em(6.0), 0.0)) or imgui.is_key_pressed(imgui.Key.escape):
        b.open = False
    opened = b.take(chosen) if chosen is not None else None
    if not b.open:
        imgui.close_current_popup()
    imgui.end_popup()
    if opened is not None:
        ui.controller.loader.open(opened)


def _folder_line(b: Browser) -> None:
    if imgui.button(icons.ICON_FA_ARROW_UP):
        b.enter(b.folder.parent)
    tooltip("the folder above")
    imgui.same_line()
    if imgui.button(icons.ICON_FA_HOUSE):
        b.enter(Path.home())
    tooltip("home")
    imgui.same_line()
    clipped(str(b.folder))


def _path_line(b: Browser) -> Path | None:
    """The line to type in, which has the keyboard whenever nothing else wants it; returns what Enter chose."""

    def key(data: imgui.InputTextCallbackData) -> int:
        if data.event_flag == imgui.InputTextFlags_.callback_history:
            b.step(1 if data.event_key == imgui.Key.down_arrow else -1)
        else:
            text = b.completed()
            data.delete_chars(0, data.buf_text_len)
            data.insert_chars(0, text)
        return 0

    imgui.set_next_item_width(-1.0)
    if not imgui.is_any_item_active():
        imgui.set_keyboard_focus_here()
    hint = "type to search, Tab completes; or a path"
    entered, text = imgui.input_text_with_hint("##path", hint, b.typed, _LINE, key)
    if text != b.typed:
        b.type(text)
    return b.meant() if entered else None


def _listing(b: Browser, moved: bool) -> Path | None:
    """What the folder offers: a click marks a line, a double click takes it, and is returned."""
    chosen = None
    if imgui.begin_child("files", ImVec2(0.0, em(18.0)), int(imgui.ChildFlags_.borders)):
        shown, aimed = b.shown(), b.aimed()
        spacing = imgui.get_style().item_spacing
        # ImGui cuts fractions towards zero: rows above the screen would be higher than those on it.
        imgui.push_style_var(imgui.StyleVar_.item_spacing, ImVec2(spacing.x, math.floor(spacing.y)))
        size = ImVec2(1.0, math.ceil(imgui.get_text_line_height()))
        for entry in shown:
            if not imgui.is_rect_visible(size):
                imgui.dummy(size)
            elif _row(entry, entry is aimed, size.y):
                b.marked, b.problem = entry.name, ""
                if imgui.is_mouse_double_clicked(imgui.MouseButton_.left):
                    chosen = entry.path
            if moved and entry is aimed:
                imgui.set_scroll_here_y()
        imgui.pop_style_var()
        if not shown:
            nothing = "nothing to open with that in its name" if b.typed else "nothing to open here"
            imgui.text_colored(QUIET, "reading the folder" if b.reading else nothing)
    imgui.end_child()
    return chosen


def _row(entry: Entry, selected: bool, height: float) -> bool:
    part = entry.kind is Kind.PART
    imgui.push_id(entry.name)
    clicked = imgui.selectable("##row", selected, _ROW, ImVec2(0.0, height))[0]
    if part:
        tooltip("made to be included by a scene: it has no camera of its own")
    imgui.push_style_color(imgui.Col_.text, QUIET if part else imgui.get_style_color_vec4(imgui.Col_.text))
    imgui.same_line(em(0.4))
    imgui.text_unformatted(_ICONS[entry.kind])
    imgui.same_line(em(2.0))
    room = imgui.get_content_region_avail().x - (em(3.0) if part else 0.0)
    imgui.text_unformatted(fitted(entry.name, room))
    if part:
        imgui.same_line()
        right("part")
    imgui.pop_style_color()
    imgui.pop_id()
    return clicked
