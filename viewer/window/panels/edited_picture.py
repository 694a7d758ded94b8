"""Over the picture, while the panel *What if* is open: lights, to be dragged; and the pixels that edits changed."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from imgui_bundle import ImVec2, ImVec4, imgui
from numpy.typing import NDArray
from PIL import Image

from tracer.frame import Frame
from tracer.scene.lights import light_in_words
from viewer.state.palette import WRONG
from viewer.state.projection import at_depth, place, seen_from
from viewer.state.views import View
from viewer.window.edit_commands import WhatIfState
from viewer.window.panels.marks import SHADE
from viewer.window.ui import Ui
from viewer.window.widgets import count, em, tooltip_at

_REACH = 0.7  # ems from a mark's middle at which it can be taken hold of
_ON, _HELD, _OFF = ImVec4(1.0, 0.93, 0.45, 1.0), ImVec4(0.42, 0.70, 0.96, 1.0), ImVec4(0.62, 0.65, 0.70, 1.0)
_MOST_MARKS = 64  # of lights: more would hide the picture
_DIMMED, _LEAST = 0.3, 0.25  # the picture beneath changed pixels, and the colour of those that have changed least
_DIGITS = 6  # of a place to which a light is dragged


@dataclass(frozen=True)
class Mark:
    """A light of the scene as it was read, where it is in the picture, 0 to 1 from the left and the top."""

    number: int
    name: str
    at: tuple[float, float]
    position: NDArray[np.float64]
    on: bool


@dataclass(frozen=True)
class ChangedPixels:
    """The picture dimmed, and changed pixels the brighter in magenta the more they have changed."""

    frame: Frame
    changes: NDArray[np.uint8]

    def pixels(self) -> NDArray[np.uint8]:
        drawn = (self.frame.pixels * _DIMMED).astype(np.float32)
        changed = self.changes > 0
        strength = _LEAST + (1.0 - _LEAST) * np.sqrt(self.changes[changed] / max(1, int(self.changes.max(initial=0))))
        drawn[changed] = strength[:, None] * 255.0 * np.array(WRONG) + (1.0 - strength[:, None]) * drawn[changed]
        return drawn.astype(np.uint8)

    def thumbnail(self, height: int) -> NDArray[np.uint8]:
        image = Image.fromarray(self.pixels())
        image.thumbnail((4 * height, height), Image.Resampling.BOX)
        return np.asarray(image)


def _open(ui: Ui) -> bool:
    """Whether the panel is on the screen."""
    return imgui.get_frame_count() - ui.state(WhatIfState).drawn <= 2


def marks_of(ui: Ui, frame: Frame) -> list[Mark]:
    """The lights that are in the picture, those that are off as well."""
    edited = ui.controller.session.edited
    if edited is None or len(edited.original.lights) > _MOST_MARKS:
        return []
    wanted, lights = ui.controller.editing.now, edited.original.lights
    positions = edited.original.light_positions(frame.time)
    for number, moved in wanted.moved_lights:
        positions[number] = moved
    found = []
    for number, position in enumerate(positions):
        at = place(frame, position)
        if at is not None and 0.0 <= at[0] <= 1.0 and 0.0 <= at[1] <= 1.0:
            name = light_in_words(number, lights[number].name)
            found.append(Mark(number, name, at, position, number not in wanted.lights_off))
    return found


def handle(ui: Ui, corner: ImVec2, size: ImVec2) -> bool:
    """Let the pointer drag a light in the plane of the screen; whether it holds one.  The picture is ImGui's last
    item."""
    state = ui.state(WhatIfState)
    c, io = ui.controller, imgui.get_io()
    frame = c.frame
    if frame is None or not (_open(ui) or state.held_light is not None):
        state.held_light = None
        return False
    near = _nearest(marks_of(ui, frame), corner, size) if state.held_light is None and imgui.is_item_hovered() else None
    if near is not None and imgui.is_item_activated() and imgui.is_mouse_clicked(imgui.MouseButton_.left):
        state.held_light, ui.picture.dragged = near.number, False
        ui.picture.pressed_at = (io.mouse_pos.x, io.mouse_pos.y)
    held = state.held_light
    if held is None:
        if near is not None and not imgui.is_item_active():
            tooltip_at(f"{near.name}{'' if near.on else ', off'}: drag it; a click switches it {_other(near.on)}")
        return False
    ui.picture.dragged |= math.dist(ui.picture.pressed_at, (io.mouse_pos.x, io.mouse_pos.y)) > em(0.3)
    if ui.picture.dragged and (io.mouse_delta.x or io.mouse_delta.y):
        _drag(ui, frame, held, ((io.mouse_pos.x - corner.x) / size.x, (io.mouse_pos.y - corner.y) / size.y))
    if not imgui.is_item_active():
        if not ui.picture.dragged:
            c.editing.switch(held, held in c.editing.now.lights_off)
        state.held_light = None
    return True


def _other(on: bool) -> str:
    return "off" if on else "on"


def _nearest(marks: list[Mark], corner: ImVec2, size: ImVec2) -> Mark | None:
    mouse = imgui.get_io().mouse_pos

    def away(mark: Mark) -> float:
        return math.dist((mouse.x, mouse.y), (corner.x + mark.at[0] * size.x, corner.y + mark.at[1] * size.y))

    nearest = min(marks, key=away, default=None)
    return nearest if nearest is not None and away(nearest) <= em(_REACH) else None


def _drag(ui: Ui, frame: Frame, number: int, at: tuple[float, float]) -> None:
    """Bring a light to a place of the picture, as far along the view as it is."""
    mark = next((mark for mark in marks_of(ui, frame) if mark.number == number), None)
    if mark is None:  # it was dragged out of the picture
        return
    depth = float(seen_from(frame.camera, mark.position)[2])
    x, y, z = (float(f"{part:.{_DIGITS}g}") for part in at_depth(frame, at, depth))
    ui.controller.editing.move_light(number, (x, y, z))
    ui.controller.motion.by_hand()


def show_lights(ui: Ui, corner: ImVec2, end: ImVec2) -> None:
    """A disc with rays for each light that is on, a ring for each that is off."""
    frame = ui.controller.frame
    if frame is None or not _open(ui):
        return
    draw = imgui.get_window_draw_list()
    draw.push_clip_rect(corner, end, True)
    dark = imgui.get_color_u32(SHADE)
    for mark in marks_of(ui, frame):
        at = ImVec2(corner.x + mark.at[0] * (end.x - corner.x), corner.y + mark.at[1] * (end.y - corner.y))
        bright = imgui.get_color_u32(
            _HELD if mark.number == ui.state(WhatIfState).held_light else _ON if mark.on else _OFF
        )
        for color, wider in ((dark, 0.12), (bright, 0.0)):
            if mark.on:
                draw.add_circle_filled(at, em(0.26 + wider / 2), color)
                for k in range(8):
                    x, y = math.cos(k * math.pi / 4), math.sin(k * math.pi / 4)
                    start, tip = em(0.38 - wider / 2), em(0.58 + wider / 2)
                    draw.add_line(ImVec2(at.x + start * x, at.y + start * y), ImVec2(at.x + tip * x, at.y + tip * y),
                                  color, em(0.1 + wider))  # fmt: skip
            else:
                draw.add_circle(at, em(0.36), color, 0, em(0.12 + wider))
                draw.add_line(ImVec2(at.x - em(0.25), at.y + em(0.25)), ImVec2(at.x + em(0.25), at.y - em(0.25)),
                              color, em(0.1 + wider))  # fmt: skip
    draw.pop_clip_rect()


def show_changed(ui: Ui, corner: ImVec2, end: ImVec2) -> None:
    """In place of the picture: dimmed, with the pixels in magenta that the edits have changed."""
    c = ui.controller
    if not ui.state(WhatIfState).changed_shown or ui.graphics.textures is None:
        return
    found, frame = c.before_edits.effects, c.before_edits.frame
    if found is None or frame is None or found.changes is None or c.scheduler.drawn_view is not View.COLOR:
        return
    changes = found.changes
    shot = ui.cached("changed pixels", found, None, lambda: ChangedPixels(frame, changes))
    texture = ui.graphics.textures.texture_id(shot, small=False)
    if texture is None:
        return
    draw = imgui.get_window_draw_list()
    draw.add_image(imgui.ImTextureRef(texture), corner, end)
    text, pad = f"{count(found.pixels)} pixels changed by the edits", em(0.35)
    width, high = imgui.calc_text_size(text).x + 2.0 * pad, imgui.get_text_line_height() + 2.0 * pad
    low = ImVec2(corner.x + pad, end.y - pad - high)
    draw.add_rect_filled(low, ImVec2(low.x + width, low.y + high), imgui.get_color_u32(SHADE), em(0.3))
    draw.add_text(ImVec2(low.x + pad, low.y + pad), imgui.get_color_u32(ImVec4(0.95, 0.96, 0.97, 1.0)), text)
