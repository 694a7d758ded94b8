"""Arrows, boxes and words that are drawn on the picture, over it, as they will be in saved pictures."""

from __future__ import annotations

import math
from dataclasses import replace

from imgui_bundle import ImVec2, ImVec4, imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from viewer.output.annotations import EDGE, INK, head_of, letter_height, line_width
from viewer.state.annotations import LONGEST_TEXT, MOST, Annotation, Kind
from viewer.window.taking import choose, clear, undo
from viewer.window.ui import Ui
from viewer.window.widgets import em, tooltip

_LEAST = 6.0  # pixels of a drag that draws something
_TOOLS = {
    Kind.ARROW: (icons.ICON_FA_ARROW_RIGHT, "an arrow: drag from its end to its head"),
    Kind.BOX: (icons.ICON_FA_SQUARE, "a box: drag from corner to corner"),
    Kind.TEXT: (icons.ICON_FA_FONT, "words: click where they begin, type, and press Enter"),
}


def tools(ui: Ui) -> None:
    """A row of buttons: the tools, and undo and clear."""
    for kind, (icon, tip) in _TOOLS.items():
        chosen = ui.tool is kind
        if chosen:
            imgui.push_style_color(imgui.Col_.button, imgui.get_style_color_vec4(imgui.Col_.button_active))
        if imgui.button(f"{icon}##{kind}"):
            choose(ui, kind)
        if chosen:
            imgui.pop_style_color()
        tooltip(tip)
        imgui.same_line()
    imgui.begin_disabled(not ui.controller.session.annotations)
    if imgui.button(icons.ICON_FA_ROTATE_LEFT):
        undo(ui)
    tooltip("take back the last")
    imgui.same_line()
    if imgui.button(icons.ICON_FA_TRASH):
        clear(ui)
    tooltip("take back all")
    imgui.end_disabled()


def handle(ui: Ui, corner: ImVec2, size: ImVec2) -> bool:
    """Draw with the pointer, while a tool is taken up; returns whether it has the pointer."""
    if ui.tool is None:
        return False
    mouse = imgui.get_io().mouse_pos
    at = (mouse.x - corner.x) / size.x, (mouse.y - corner.y) / size.y
    if imgui.is_item_hovered():
        text = ui.tool is Kind.TEXT
        imgui.set_mouse_cursor(imgui.MouseCursor_.text_input if text else imgui.MouseCursor_.hand)
    if imgui.is_item_activated() and imgui.is_mouse_clicked(imgui.MouseButton_.left):
        ui.drawn = Annotation(ui.tool, *at, *at)
        ui.drawn_text = None if ui.tool is not Kind.TEXT else ""
    elif ui.drawn is not None and ui.tool is not Kind.TEXT and imgui.is_item_active():
        ui.drawn = replace(ui.drawn, x1=min(max(at[0], 0.0), 1.0), y1=min(max(at[1], 0.0), 1.0))
    elif ui.drawn is not None and ui.tool is not Kind.TEXT:
        way = (ui.drawn.x1 - ui.drawn.x0) * size.x, (ui.drawn.y1 - ui.drawn.y0) * size.y
        if math.hypot(*way) >= _LEAST:
            _add(ui, ui.drawn)
        ui.drawn = None
    return True


def _add(ui: Ui, annotation: Annotation) -> None:
    if len(ui.controller.session.annotations) < MOST:
        ui.controller.session.annotations.append(annotation)
    else:
        ui.controller.notices.say(f"there are {MOST} annotations already")


def show(ui: Ui, corner: ImVec2, end: ImVec2) -> None:
    """All of them over the picture from `corner` to `end`, with that which is being drawn, or typed."""
    drawn = ui.drawn if ui.drawn is not None and ui.drawn.kind is not Kind.TEXT else None
    wanted = [*ui.controller.session.annotations, *([drawn] if drawn is not None else [])]
    draw = imgui.get_window_draw_list()
    draw.push_clip_rect(corner, end, True)
    for annotation in wanted:
        _draw(draw, annotation, corner, ImVec2(end.x - corner.x, end.y - corner.y))
    draw.pop_clip_rect()
    if ui.drawn is not None and ui.drawn.kind is Kind.TEXT:
        _type(ui, ui.drawn, corner, end)


def _type(ui: Ui, drawn: Annotation, corner: ImVec2, end: ImVec2) -> None:
    """A field where the words will be; Enter keeps them, and Escape, or an empty field, does not."""
    width = em(14.0)
    x = min(corner.x + drawn.x0 * (end.x - corner.x), end.x - width)
    imgui.set_cursor_screen_pos(ImVec2(x, corner.y + drawn.y0 * (end.y - corner.y)))
    imgui.set_next_item_width(width)
    imgui.set_keyboard_focus_here()
    flags = int(imgui.InputTextFlags_.enter_returns_true)
    entered, text = imgui.input_text_with_hint("##annotation", "words, then Enter", ui.drawn_text or "", flags)
    ui.drawn_text = text[:LONGEST_TEXT]
    if entered and text.strip():
        _add(ui, replace(drawn, text=text.strip()[:LONGEST_TEXT]))
    if entered or imgui.is_key_pressed(imgui.Key.escape):
        ui.drawn, ui.drawn_text = None, None


def _draw(draw: imgui.ImDrawList, annotation: Annotation, corner: ImVec2, size: ImVec2) -> None:
    width, height = int(size.x), int(size.y)
    line = line_width(width, height)
    edge = max(1, line // 2)
    start = corner.x + annotation.x0 * size.x, corner.y + annotation.y0 * size.y
    end = corner.x + annotation.x1 * size.x, corner.y + annotation.y1 * size.y
    bright, dark = _packed(INK), _packed(EDGE)
    if annotation.kind is Kind.TEXT:
        font, letters = imgui.get_font(), float(letter_height(width, height))
        for dx, dy in ((-edge, 0), (edge, 0), (0, -edge), (0, edge)):
            draw.add_text(font, letters, ImVec2(start[0] + dx, start[1] + dy), dark, annotation.text)
        draw.add_text(font, letters, ImVec2(*start), bright, annotation.text)
    elif annotation.kind is Kind.BOX:
        low = ImVec2(min(start[0], end[0]), min(start[1], end[1]))
        high = ImVec2(max(start[0], end[0]), max(start[1], end[1]))
        draw.add_rect(low, high, dark, 0.0, line + 2.0 * edge)
        draw.add_rect(low, high, bright, 0.0, float(line))
    else:
        tip, left, right = (ImVec2(*point) for point in head_of(start, end, line))
        middle = ImVec2((left.x + right.x) / 2, (left.y + right.y) / 2)
        draw.add_line(ImVec2(*start), middle, dark, line + 2.0 * edge)
        draw.add_triangle(tip, left, right, dark, 2.0 * edge)
        draw.add_line(ImVec2(*start), middle, bright, float(line))
        draw.add_triangle_filled(tip, left, right, bright)


def _packed(color: tuple[int, int, int]) -> int:
    red, green, blue = (channel / 255.0 for channel in color)
    return imgui.get_color_u32(ImVec4(red, green, blue, 1.0))
