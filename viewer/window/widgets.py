"""Small pieces that the panels share, all sized in ems so that they fit any screen."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from typing import TypeVar

from imgui_bundle import ImVec2, ImVec4, hello_imgui, imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from viewer.util.numbers import count as count
from viewer.window.style import ERROR as ERROR
from viewer.window.style import QUIET as QUIET
from viewer.window.style import WARNING as WARNING

T = TypeVar("T")
_PALE = 0.85  # least channel of colours that need a border on a light panel
_LABELS = 0.45  # of a panel's width, at most, is for the names of what is in it
SIZES = ((128, 128), (256, 256), (512, 512), (800, 600), (1024, 1024), (1280, 720), (1920, 1080))


def em(size: float) -> float:
    return hello_imgui.em_size(size)


def centred(width: float, height: float = 0.0) -> None:
    """Put the next window at the middle, so large at first; without a height it is as high as its content."""
    viewport, appearing = imgui.get_main_viewport(), int(imgui.Cond_.appearing)
    size = ImVec2(min(width, 0.95 * viewport.work_size.x), min(height, 0.92 * viewport.work_size.y))
    imgui.set_next_window_pos(viewport.get_work_center(), appearing, ImVec2(0.5, 0.5))
    imgui.set_next_window_size(size, appearing if height else int(imgui.Cond_.always))


def begin_modal(title: str, width: float) -> tuple[bool, bool]:
    """Begin a dialog that has the keyboard to itself, so many ems wide; returns whether it is shown, and then has to be
    ended by `imgui.end_popup`, and whether the user wants it closed."""
    if not imgui.is_popup_open(title):
        imgui.open_popup(title)
    centred(em(width))
    flags = imgui.WindowFlags_.no_resize | imgui.WindowFlags_.no_saved_settings
    shown, stays = imgui.begin_popup_modal(title, True, int(flags))
    return shown, not stays or imgui.is_key_pressed(imgui.Key.escape)


@contextmanager
def properties(name: str, label_width: float = 7.0) -> Iterator[bool]:
    """A table of two columns, names on the left; yields whether it is visible."""
    shown = imgui.begin_table(name, 2, int(imgui.TableFlags_.sizing_stretch_prop))
    if shown:
        label = min(em(label_width), _LABELS * imgui.get_content_region_avail().x)
        imgui.table_setup_column("name", int(imgui.TableColumnFlags_.width_fixed), label)
        imgui.table_setup_column("value", int(imgui.TableColumnFlags_.width_stretch))
    try:
        yield shown
    finally:
        if shown:
            imgui.end_table()


def row(name: str, tip: str = "", room: float = 0.0) -> None:
    """Begin a row of `properties`: write its name and stand ready for its value, which leaves `room` in ems."""
    imgui.table_next_row()
    imgui.table_next_column()
    imgui.align_text_to_frame_padding()
    _name(name, tip)
    imgui.set_next_item_width(-em(room) if room else -1.0)


def _name(name: str, tip: str) -> None:
    """Write a row's name in the first column, to go on in the second."""
    clipped(name, QUIET)
    if tip:
        tooltip(tip)
    imgui.table_next_column()


def value(name: str, text: str, tip: str = "", wraps: bool = False) -> None:
    """Show a row of text; long text wraps, or is cut with an ellipsis and shown in full on hovering."""
    imgui.table_next_row()
    imgui.table_next_column()
    _name(name, tip)
    (paragraph if wraps else clipped)(text)


def right(text: str, color: ImVec4 | None = None) -> None:
    """Text at the right edge of its column."""
    room = imgui.get_content_region_avail().x - imgui.calc_text_size(text).x
    imgui.set_cursor_pos_x(imgui.get_cursor_pos_x() + max(0.0, room))
    clipped(text, color)


def width_of(text: str) -> float:
    return float(imgui.calc_text_size(text).x)


def fitted(text: str, room: float) -> str:
    """The text, or as much of it as there is room for, with an ellipsis."""
    if imgui.calc_text_size(text).x <= room + 0.5:
        return text
    low, high = 0, len(text)
    while low < high:
        middle = (low + high + 1) // 2
        fits = imgui.calc_text_size(text[:middle] + "...").x <= room + 0.5
        low, high = (middle, high) if fits else (low, middle - 1)
    return text[:low] + "..."


def same_line_for(label: str) -> None:
    """Go on in this line if a tick with such a label fits into what is left of it."""
    spacing = em(1.0)
    needed = imgui.calc_text_size(label).x + imgui.get_frame_height() + imgui.get_style().item_inner_spacing.x
    edge = imgui.get_cursor_screen_pos().x + imgui.get_content_region_avail().x
    if imgui.get_item_rect_max().x + spacing + needed <= edge:
        imgui.same_line(0.0, spacing)


def clipped(text: str, color: ImVec4 | None = None, room: float | None = None) -> None:
    """One line of text that ends in an ellipsis where there is no room, with all of it as a tooltip."""
    shown = fitted(text, imgui.get_content_region_avail().x if room is None else room)
    write(shown, color)
    if shown != text:
        tooltip(text)


def paragraph(text: str, color: ImVec4 | None = None) -> None:
    """Text that wraps at the panel's edge."""
    imgui.push_text_wrap_pos(0.0)
    write(text, color)
    imgui.pop_text_wrap_pos()


def write(text: str, color: ImVec4 | None = None) -> None:
    """A line of text, whatever room there is."""
    imgui.push_style_color(imgui.Col_.text, color or imgui.get_style_color_vec4(imgui.Col_.text))
    imgui.text_unformatted(text)
    imgui.pop_style_color()


def tooltip(text: str) -> None:
    """Explain the last item when the pointer rests on it."""
    if imgui.is_item_hovered(int(imgui.HoveredFlags_.for_tooltip)):
        tooltip_at(text)


def tooltip_at(text: str) -> None:
    """Explain what is under the pointer."""
    if imgui.begin_tooltip():
        imgui.push_text_wrap_pos(em(24.0))
        imgui.text_unformatted(text)
        imgui.pop_text_wrap_pos()
        imgui.end_tooltip()


def seen_rows(number: int, height: float = -1.0, wanted: int | None = None) -> Iterator[int]:
    """Yield those of so many rows that are seen, each so high, and the one that is to be scrolled to."""
    clipper = imgui.ListClipper()
    clipper.begin(number, height)
    if wanted is not None:
        clipper.include_item_by_index(wanted)
    while clipper.step():
        yield from range(clipper.display_start, clipper.display_end)
    clipper.end()


def one_of(choices: Iterable[tuple[T, str, str]], now: T) -> T:
    """Show a button for each value, with its label and tip, as many in a line as there is room for; returns the one
    that is set."""
    for number, (choice, label, tip) in enumerate(choices):
        if number:
            same_line_for(label.partition("##")[0])
        if imgui.radio_button(label, choice == now):
            now = choice
        if tip:
            tooltip(tip)
    return now


def dropdown(name: str, shown: str, flags: int = 0) -> bool:
    """Begin a list to be opened; returns whether it is.  What it shows else ends in an ellipsis where it is narrow."""
    room = imgui.calc_item_width() - imgui.get_frame_height() - 2.0 * imgui.get_style().frame_padding.x
    return bool(imgui.begin_combo(name, fitted(shown, room), flags))


def one_of_list(name: str, shown: str, choices: Iterable[tuple[T, str, str]], now: T, tip: str = "") -> T:
    """Show a list to be opened, of values with their labels and tips; returns the one that is chosen."""
    if dropdown(name, shown):
        for choice, label, meaning in choices:
            if imgui.selectable(label, choice == now)[0]:
                now = choice
            if meaning:
                tooltip(meaning)
        imgui.end_combo()
    elif tip:
        tooltip(tip)
    return now


@contextmanager
def outlined() -> Iterator[None]:
    """Ticks within it have a border, so that those that are not set are seen as well."""
    imgui.push_style_var(int(imgui.StyleVar_.frame_border_size), 1.0)
    imgui.push_style_color(imgui.Col_.border, imgui.get_style_color_vec4(imgui.Col_.text_disabled))
    yield
    imgui.pop_style_color()
    imgui.pop_style_var()


def checkbox(label: str, state: bool, change: Callable[[bool], None] = lambda on: None, tip: str = "") -> bool:
    """Show a tick that calls `change` with its new state; returns what it is now.  A label that is too long for its
    line ends in an ellipsis."""
    room = imgui.get_content_region_avail().x - imgui.get_frame_height() - imgui.get_style().item_inner_spacing.x
    shown = label if label.startswith("##") else fitted(label, room)
    with outlined():
        changed, now = imgui.checkbox(label if shown == label else f"{shown}###{label}", state)
    if shown != label:
        tip = f"{label}: {tip}" if tip else label
    if tip:
        tooltip(tip)
    if changed:
        change(now)
    return bool(now)


def size_field(size: tuple[int, int], longest: int, say: Callable[[str], None]) -> tuple[int, int]:
    """Width and height in pixels, typed or chosen from a list, across what room there is; returns what is set now.

    Says so where a side that is typed is none, or longer than `longest`, and another taken for it."""
    imgui.set_next_item_width(-em(2.2))
    changed, typed = imgui.input_int2("##size", list(size))
    if changed:
        width, height = (min(max(pixels, 1), longest) for pixels in typed)
        size = width, height
        if list(size) != list(typed):
            say(f"{typed[0]} x {typed[1]} became {width} x {height}: a side has 1 to {longest} pixels here")
    imgui.same_line(0.0, em(0.2))
    if imgui.button(icons.ICON_FA_CHEVRON_DOWN, (-1.0, 0.0)):
        imgui.open_popup("sizes")
    if imgui.begin_popup("sizes"):
        for width, height in SIZES:
            if imgui.menu_item(f"{width} x {height}", "", False, True)[0]:
                size = width, height
        imgui.end_popup()
    return size


def wide_button(label: str, tip: str = "", columns: int = 1) -> bool:
    """A button that shares what is left of the line with those after it, `columns` in all; where that is too narrow for
    a label of an icon and words, the words are in the tip alone."""
    style = imgui.get_style()
    width = (imgui.get_content_region_avail().x - style.item_spacing.x * (columns - 1)) / columns
    text, _, _ = label.partition("##")
    icon, _, words = text.partition("  ")
    if words and imgui.calc_text_size(text).x > width - 2.0 * style.frame_padding.x:
        label, tip = f"{icon}###{label}", f"{words}: {tip}" if tip else words
    clicked = imgui.button(label, ImVec2(max(width, em(2.0)), 0.0))
    if tip:
        tooltip(tip)
    return clicked


def swatch(color: tuple[float, float, float]) -> None:
    """A square of a colour, for the word that follows on its line."""
    side = imgui.get_text_line_height()
    at = imgui.get_cursor_screen_pos()
    end = ImVec2(at.x + 0.8 * side, at.y + 0.9 * side)
    start = ImVec2(at.x, at.y + 0.1 * side)
    draw = imgui.get_window_draw_list()
    draw.add_rect_filled(start, end, packed(color), em(0.15))
    if min(color) > _PALE:
        draw.add_rect(start, end, imgui.get_color_u32(QUIET), em(0.15))
    imgui.dummy(ImVec2(0.8 * side, side))
    imgui.same_line(0.0, em(0.4))


def packed(color: tuple[float, float, float], alpha: float = 1.0) -> int:
    """A colour as lists of what is to be drawn take it."""
    return int(imgui.get_color_u32(ImVec4(*color, alpha)))


def heading(text: str) -> None:
    imgui.dummy(ImVec2(0.0, em(0.15)))
    imgui.separator_text(text)


def in_window_style(text: str) -> str:
    """Shares of a text written as they are here: 0.499 % for 0.499%."""
    return re.sub(r"(?<=\d)%", " %", text)
