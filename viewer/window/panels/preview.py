"""The preview in the picture's place: the camera follows the pointer, and words say what it is."""

from __future__ import annotations

import math
from collections.abc import Callable

from imgui_bundle import ImVec2, ImVec4, imgui

from viewer.window.panels.tour import TourState
from viewer.window.ui import Ui
from viewer.window.widgets import count, em

_BUTTONS = tuple(int(b) for b in (imgui.MouseButton_.left, imgui.MouseButton_.right, imgui.MouseButton_.middle))
_ALL_BUTTONS = int(
    imgui.ButtonFlags_.mouse_button_left
    | imgui.ButtonFlags_.mouse_button_right
    | imgui.ButtonFlags_.mouse_button_middle
)
_BEHIND, _WORDS = (0.05, 0.06, 0.08, 0.85), (0.93, 0.94, 0.96, 1.0)


def show(ui: Ui, room: ImVec2, drag: Callable[[Ui, int, float, float], None]) -> bool:
    """The preview, if there is any; `drag` moves the camera by a drag with a button of so many picture heights."""
    texture = ui.graphics.preview.texture_id if ui.graphics.preview is not None else None
    if texture is None:
        return False
    corner = imgui.get_cursor_screen_pos()
    imgui.set_next_item_allow_overlap()
    imgui.invisible_button("preview", room, _ALL_BUTTONS)
    end = ImVec2(corner.x + room.x, corner.y + room.y)
    imgui.get_window_draw_list().add_image(imgui.ImTextureRef(texture), corner, end)
    _pointer(ui, room.y, drag)
    _words(ui, corner, room)
    return True


def make_room(ui: Ui, height: float) -> None:
    """Put the next window, so high, along the lower edge of the picture."""
    viewport = imgui.get_main_viewport()
    whole = viewport.work_pos.x, viewport.work_pos.y + viewport.work_size.y, viewport.work_size.x
    left, lower, across = ui.state(TourState).place or whole
    imgui.set_next_window_pos(ImVec2(left, lower - height))
    imgui.set_next_window_size(ImVec2(across, height))


def _pointer(ui: Ui, height: float, drag: Callable[[Ui, int, float, float], None]) -> None:
    io = imgui.get_io()
    if imgui.is_item_activated():
        ui.picture.pressed_at = (io.mouse_pos.x, io.mouse_pos.y)
        ui.picture.pressed = next((b for b in _BUTTONS if imgui.is_mouse_clicked(b)), _BUTTONS[0])
    if imgui.is_item_active() and math.dist(ui.picture.pressed_at, (io.mouse_pos.x, io.mouse_pos.y)) > 0.0:
        drag(ui, ui.picture.pressed, io.mouse_delta.x / height, io.mouse_delta.y / height)


def words(ui: Ui) -> list[str]:
    """What is said over the preview, a line each."""
    c = ui.controller
    geometry, job = c.preview.geometry, c.loader.warm_up_job or c.loader.load_job
    compiling = f"Compiling the ray tracer: {100.0 * job.fraction:.0f} %. " if job is not None else ""
    lines = ["Preview: no shadows, no reflections", f"{compiling}Then the picture is traced."]
    if geometry is not None and geometry.left_out:
        kept = count(geometry.of - geometry.left_out)
        lines.append(f"Simplified: {kept} of {count(geometry.of)} triangles, spheres and cones")
    return lines


def _words(ui: Ui, corner: ImVec2, room: ImVec2) -> None:
    lines, pad, line = words(ui), em(0.35), imgui.get_text_line_height_with_spacing()
    width = max(imgui.calc_text_size(text).x for text in lines) + 3.0 * pad
    draw = imgui.get_window_draw_list()
    draw.push_clip_rect(corner, ImVec2(corner.x + room.x, corner.y + room.y), True)
    back, front = (imgui.get_color_u32(ImVec4(*color)) for color in (_BEHIND, _WORDS))
    draw.add_rect_filled(corner, ImVec2(corner.x + width, corner.y + len(lines) * line + pad), back, em(0.3))
    for number, text in enumerate(lines):
        draw.add_text(ImVec2(corner.x + 1.5 * pad, corner.y + pad + number * line), front, text)
    draw.pop_clip_rect()
