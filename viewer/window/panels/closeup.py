"""Looking closely at the picture: zoom and pan, a grid of its pixels with their exact values, watched pixels, a region.

The wheel with Ctrl zooms around the pointer, a drag with Ctrl pans, and a drag with Shift chooses a region.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from imgui_bundle import ImVec2, ImVec4, imgui

from viewer.state.comparison import Side
from viewer.state.keymap import HELD
from viewer.state.pixels import GRID_FROM, STEP, Point, panned, pixels_shown, region_between
from viewer.window import picture_commands
from viewer.window.panels import sides
from viewer.window.panels.area import Area
from viewer.window.ui import Ui
from viewer.window.widgets import em

_MENU = "menu of the picture"
_FLYING = tuple(name for name in HELD if name.startswith("Fly"))
_GRID, _BACK = ImVec4(0.5, 0.5, 0.5, 0.45), ImVec4(0.03, 0.04, 0.05, 0.66)
_FRONT, _DARK = ImVec4(0.97, 0.97, 0.98, 1.0), ImVec4(0.03, 0.04, 0.05, 0.9)
_REGION = ImVec4(0.42, 0.70, 0.96, 1.0)
_SMALLEST = 0.62  # of the usual size of letters, for the numbers in pixels
_MOST_NUMBERS = 1500  # pixels whose values are written at once


# --- hands ---------------------------------------------------------------------------------------


@dataclass
class CloseupState:
    """What a drag does that moves no camera, where in the picture it began, and the point that the menu is about."""

    gesture: str = ""
    gesture_at: Point = (0.0, 0.0)
    menu_at: Point = (0.0, 0.0)


def wheel(ui: Ui, area: Area) -> bool:
    """Zoom around the pointer, with Ctrl; whether the wheel was for that."""
    io = imgui.get_io()
    if not io.key_ctrl:
        return False
    if io.mouse_wheel:
        at = (io.mouse_pos.x - area.corner.x) / area.size.x, (io.mouse_pos.y - area.corner.y) / area.size.y
        picture_commands.zoom_by(ui, STEP**io.mouse_wheel, at)
    return True


def drag(ui: Ui, area: Area) -> bool:
    """Pan with Ctrl, choose a region with Shift; whether the pointer, on ImGui's last item, does either."""
    state = ui.state(CloseupState)
    io = imgui.get_io()
    if imgui.is_item_activated() and imgui.is_mouse_clicked(imgui.MouseButton_.left):
        flying = any(ui.keyboard.is_down(ui.keymap.of(name)) for name in _FLYING)  # then Shift flies faster
        state.gesture = "pan" if io.key_ctrl else "region" if io.key_shift and not flying else ""
        state.gesture_at = area.to_picture(io.mouse_pos.x, io.mouse_pos.y)
    released = imgui.is_item_deactivated()
    if not state.gesture or not (imgui.is_item_active() or released):
        return False
    if state.gesture == "pan":
        session, by = ui.controller.session, io.mouse_delta
        session.set_draw(zoom=panned(session.draw.zoom, by.x / area.size.x, by.y / area.size.y))
        imgui.set_mouse_cursor(imgui.MouseCursor_.resize_all)
    else:
        start, here = state.gesture_at, area.to_picture(io.mouse_pos.x, io.mouse_pos.y)
        frame = ui.controller.frame
        moved = frame is not None and (abs(start[0] - here[0]) * frame.width, abs(start[1] - here[1]) * frame.height)
        ui.pixels.region = region_between(start, here) if moved and max(moved) >= 0.5 else None
    if released:
        if state.gesture == "region" and ui.pixels.region is not None:
            picture_commands.offer(ui, "Pixels")
        state.gesture = ""
    return True


def open_menu(ui: Ui, point: Point) -> None:
    """The menu over the picture, about this point of it."""
    ui.state(CloseupState).menu_at = point
    imgui.open_popup(_MENU)


def menu(ui: Ui) -> None:
    """The menu, while it is open."""
    state = ui.state(CloseupState)
    if not imgui.begin_popup(_MENU):
        return
    c, frame = ui.controller, ui.controller.frame
    if frame is not None:
        if imgui.menu_item("Inspect this pixel", "Click", False, True)[0]:
            c.selection.select(state.menu_at)
        if imgui.menu_item("Watch this pixel, or no longer", ui.key_label("Watch pixel"), False, True)[0]:
            picture_commands.pin(ui, state.menu_at)
        imgui.separator()
    for name in ("Keep as A", "Fit picture", "Clear region"):
        command = next((one for one in ui.commands if one.name == name), None)
        if command is not None and imgui.menu_item(name, ui.key_label(name), False, command.enabled())[0]:
            ui.guard.step(f"The command {name}", command.run)
    imgui.end_popup()


# --- eyes ----------------------------------------------------------------------------------------


def show(ui: Ui, area: Area, side: Side | None = None) -> None:
    """Over the picture of a side, or what else is seen: grid and values, watched pixels, the region."""
    found = sides.words(ui, sides.draw_options(ui), side)
    if found is None:
        return
    frame, words = found
    draw = imgui.get_window_draw_list()
    draw.push_clip_rect(area.corner, area.end, True)
    if ui.controller.preferences.pixel_values:
        _grid(draw, area, frame.width, frame.height)
        _numbers(draw, area, frame.width, frame.height, words)
    if ui.pixels.region is not None:
        _region(ui, draw, area)
    for number, point in enumerate(ui.pixels.watched):
        _mark(draw, area, point, number + 1, frame.width, frame.height)
    draw.pop_clip_rect()


def _grid(draw: imgui.ImDrawList, area: Area, width: int, height: int) -> None:
    """Lines between the picture's pixels, where these are large."""
    across, down = area.whole_size.x / width, area.whole_size.y / height
    if min(across, down) < GRID_FROM:
        return
    color, (columns, rows) = imgui.get_color_u32(_GRID), pixels_shown(area.zoom, width, height)
    for x in columns:
        at = round(area.whole.x + x * across)
        draw.add_line(ImVec2(at, area.corner.y), ImVec2(at, area.end.y), color)
    for y in rows:
        at = round(area.whole.y + y * down)
        draw.add_line(ImVec2(area.corner.x, at), ImVec2(area.end.x, at), color)


def _numbers(
    draw: imgui.ImDrawList, area: Area, width: int, height: int, words: Callable[[int, int], tuple[str, ...]]
) -> None:
    """The value of each pixel in it, as large as fits, where all fit."""
    across, down = area.whole_size.x / width, area.whole_size.y / height
    columns, rows = pixels_shown(area.zoom, width, height)
    letters = imgui.get_font_size()
    if down < _SMALLEST * letters or across < 2.0 * _SMALLEST * letters or len(columns) * len(rows) > _MOST_NUMBERS:
        return
    texts = {(x, y): words(x, y) for x in columns for y in rows}
    widest = max((imgui.calc_text_size(line).x for lines in texts.values() for line in lines), default=0.0)
    tallest = max((len(lines) for lines in texts.values()), default=0) * letters
    if not widest or not tallest:
        return
    part = min(0.9 * across / widest, 0.9 * down / tallest, 1.0)
    if part < _SMALLEST:
        return
    font, size = imgui.get_font(), part * letters
    back, front = imgui.get_color_u32(_BACK), imgui.get_color_u32(_FRONT)
    for (x, y), lines in texts.items():
        middle = area.to_screen((x + 0.5) / width, (y + 0.5) / height)
        half = 0.5 * part * max(imgui.calc_text_size(line).x for line in lines) if lines else 0.0
        top, pad = middle.y - 0.5 * size * len(lines), 0.12 * size
        draw.add_rect_filled(
            ImVec2(middle.x - half - pad, top), ImVec2(middle.x + half + pad, top + size * len(lines)), back, 2.0 * pad
        )
        for number, line in enumerate(lines):
            left = middle.x - 0.5 * part * imgui.calc_text_size(line).x
            draw.add_text(font, size, ImVec2(left, top + number * size), front, line)


def _region(ui: Ui, draw: imgui.ImDrawList, area: Area) -> None:
    """The chosen region, by whole pixels of the live picture."""
    frame, region = ui.controller.frame, ui.pixels.region
    if frame is None or region is None:
        return
    rows, columns = region.pixels(frame)
    start = area.to_screen(columns.start / frame.width, rows.start / frame.height)
    end = area.to_screen(columns.stop / frame.width, rows.stop / frame.height)
    draw.add_rect(start, end, imgui.get_color_u32(_DARK), 0.0, max(3.0, em(0.22)))
    draw.add_rect(start, end, imgui.get_color_u32(_REGION), 0.0, max(1.0, em(0.1)))


def _mark(draw: imgui.ImDrawList, area: Area, point: Point, number: int, width: int, height: int) -> None:
    """A watched pixel: a frame around it, and its number in the list."""
    x, y = int(point[0] * width), int(point[1] * height)
    start, end = area.to_screen(x / width, y / height), area.to_screen((x + 1) / width, (y + 1) / height)
    least = em(0.28)
    if end.x - start.x < 2.0 * least:
        middle = ImVec2((start.x + end.x) / 2.0, (start.y + end.y) / 2.0)
        start, end = ImVec2(middle.x - least, middle.y - least), ImVec2(middle.x + least, middle.y + least)
    dark, light = imgui.get_color_u32(_DARK), imgui.get_color_u32(_FRONT)
    draw.add_rect(start, end, dark, 0.0, 3.0)
    draw.add_rect(start, end, light, 0.0, 1.0)
    text, pad = str(number), em(0.2)
    size = imgui.calc_text_size(text)
    at = ImVec2(end.x + 2.0, start.y - size.y - 2.0)
    draw.add_rect_filled(ImVec2(at.x - pad, at.y), ImVec2(at.x + size.x + pad, at.y + size.y), dark, em(0.15))
    draw.add_text(at, light, text)
