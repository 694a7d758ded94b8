"""What if: lights off or elsewhere, objects hidden, static or able to move; and what that changes.

While the panel is on the screen, lights are marked in the picture, to be dragged."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from imgui_bundle import ImVec2, ImVec4, imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons
from numpy.typing import NDArray

from tracer.editing.edits import Edited
from tracer.frame import Frame
from tracer.inspect.projection import at_depth, place, seen_from
from tracer.scene.lights import light_in_words
from tracer.scene.limits import LARGEST
from viewer.state.comparison import CompareMode
from viewer.state.palette import HELD
from viewer.state.picking import same_place
from viewer.state.view_state import one_by_one
from viewer.util.numbers import count
from viewer.window.command import Command, Condition
from viewer.window.panels import lights
from viewer.window.panels.area import SHADE, Area
from viewer.window.ui import Ui
from viewer.window.widgets import QUIET, checkbox, clipped, em, heading, paragraph, tooltip, tooltip_at, wide_button

_ROWS = 12  # of the list of lights that are seen at once
_MOST_MARKS = 64  # of lights: more would hide the picture
_REACH = 0.7  # ems from a mark's middle at which it can be taken hold of
_ON, _HELD, _OFF = ImVec4(1.0, 0.93, 0.45, 1.0), ImVec4(*HELD, 1.0), ImVec4(0.62, 0.65, 0.70, 1.0)
_DIGITS = 6  # of a place to which a light is brought
_STATIC = "It stays where it is at this moment, and counts as static: its primitives carry modes."
_CAN_MOVE = "It stays where it is, but counts as dynamic: it carries no modes, and its shadow rays are always traced."


@dataclass
class WhatIfState:
    """In which frame of ImGui the panel was drawn last, and whether the light that the pointer holds was dragged."""

    drawn: int = -9
    dragged: bool = False


def commands(ui: Ui) -> list[Command]:
    """What changes the scene that is shown, not its file."""
    editing = ui.controller.editing

    def hide() -> None:
        editing.change(editing.now.with_thing(_pointed_at(ui) or "", False))

    return [
        Command("What if...", "Edit/What if", lambda: ui.show_panel("What if"), separated=True,
                tip="switch off a light, hide an object, and see what changes"),
        Command("Hide the object", "Edit/What if", hide, tip="that was clicked, or is under the pointer",
                enabled=Condition(lambda: bool(_pointed_at(ui)), "click an object first, or point at one")),
        Command("Show everything", "Edit/What if", editing.show_everything,
                enabled=Condition(lambda: bool(editing.now.hidden or editing.now.hidden_primitives),
                                  "nothing is hidden")),
        Command("Clear all edits", "Edit/What if", editing.clear, tip="the scene as its file says",
                enabled=Condition(lambda: bool(editing.now), "the scene is as its file says")),
    ]  # fmt: skip


def _pointed_at(ui: Ui) -> str | None:
    """The name of the object that was clicked, else of that under the pointer; None for nothing."""
    c, now = ui.controller, ui.controller.session.edited
    pick = c.selection.picked or c.selection.at(c.selection.hovered)
    if now is None or pick is None or not 0 <= pick.primitive < len(now.primitives):
        return None
    return now.thing_of(pick.primitive).name


# --- the panel ---------------------------------------------------------------------------------------


def show(ui: Ui) -> None:
    """The panel."""
    edited = ui.controller.session.edited
    if edited is None:
        paragraph("No scene is open.", QUIET)
        return
    ui.state(WhatIfState).drawn = imgui.get_frame_count()
    if not ui.controller.editing.now:
        paragraph("Edits change the scene, but not its file. Undo takes them back.", QUIET)
    _object(ui, edited)
    _lights(ui, edited)
    _edits(ui)
    _changed(ui)


def _object(ui: Ui, edited: Edited) -> None:
    """What was clicked."""
    pick, editing = ui.controller.selection.picked, ui.controller.editing
    heading("Object")
    if pick is None or not 0 <= pick.primitive < len(edited.primitives):
        paragraph("Click an object in the picture to hide it, or to make it static or dynamic.", QUIET)
        return
    thing, primitive = edited.thing_of(pick.primitive), int(edited.primitives[pick.primitive])
    clipped(thing.name)
    wanted = now = editing.now
    if wide_button("Hide all of it", thing.name, 2):
        wanted = now.with_thing(thing.name, False)
    imgui.same_line()
    if wide_button("Hide primitive", f"primitive {primitive} alone", 1):
        wanted = now.with_primitive(primitive, False)
    static, moving = thing.name in dict(now.static), thing.name in now.moving
    if thing.moves and checkbox("Static", static, tip=_STATIC) != static:
        wanted = now.with_static(thing.name, None if static else ui.controller.session.time)
    elif not thing.moves and checkbox("Dynamic", moving, tip=_CAN_MOVE) != moving:
        wanted = now.with_moving(thing.name, not moving)
    if wanted is not now:
        editing.change(wanted)


def _lights(ui: Ui, edited: Edited) -> None:
    """All lights of the scene as it was read, with a tick for those that are on."""
    original = edited.original
    heading(f"Lights ({len(original.lights)})")
    if not original.lights:
        paragraph("The scene has no lights.", QUIET)
        return
    numbers = lights.found(ui, "what if", original)
    places = original.light_positions(ui.controller.session.time)

    for number in lights.rows(numbers, _ROWS, imgui.get_frame_height_with_spacing()):
        imgui.push_id(number)
        _light(ui, edited, number, places[number].tolist())
        imgui.pop_id()
    paragraph("Drag a light in the picture, or type where it is.", QUIET)


def _light(ui: Ui, edited: Edited, number: int, own_place: list[float]) -> None:
    editing = ui.controller.editing
    name, moved = light_in_words(number, edited.original.lights[number].name), editing.now.light_place(number)
    on = number not in editing.now.lights_off
    checkbox("##on", on, lambda now: editing.change(editing.now.with_light(number, now)), f"{name}: on or off")
    imgui.same_line()
    room, button = imgui.get_content_region_avail().x, imgui.get_frame_height() if moved is not None else 0.0
    names = max(em(2.5), min(imgui.calc_text_size(name).x + em(0.4), room - em(10.5)))
    start = imgui.get_cursor_pos_x()
    imgui.align_text_to_frame_padding()
    clipped(name, room=names - em(0.4))
    imgui.same_line(start + names)
    imgui.set_next_item_width(-button - 1.0)
    speed = 0.001 * lights.diagonal(ui.controller.info.get("bounds"))  # units for each pixel of the pointer's way
    exact = int(imgui.SliderFlags_.no_round_to_format)
    changed, typed = imgui.drag_float3("##place", list(moved or own_place), speed, -LARGEST, LARGEST, "%.3g", exact)
    tooltip("{} is at {:.6g}, {:.6g}, {:.6g}. Drag a number, or double-click it to type".format(name, *typed))
    if changed:
        _move(ui, number, typed)
    if moved is not None:
        imgui.same_line(0.0, 0.0)
        if imgui.button(icons.ICON_FA_ROTATE_LEFT, (button, button)):
            editing.change(editing.now.with_light_at(number, None))
        tooltip("back to its place in the scene")


def _move(ui: Ui, number: int, to: tuple[float, float, float] | list[float]) -> None:
    x, y, z = (float(f"{part:.{_DIGITS}g}") for part in to)
    editing = ui.controller.editing
    editing.change(editing.now.with_light_at(number, (x, y, z)))
    ui.controller.motion.by_hand()


def _edits(ui: Ui) -> None:
    """Each edit, to be taken back by itself."""
    editing = ui.controller.editing
    listed = one_by_one(editing.now)
    if not listed:
        return
    heading(f"Edits ({len(listed)})")
    for number, (words, without) in enumerate(listed):
        imgui.push_id(number)
        if imgui.small_button(icons.ICON_FA_XMARK):
            editing.change(without)
        tooltip("remove this edit")
        imgui.same_line()
        clipped(words)
        imgui.pop_id()
    if len(listed) > 1 and wide_button(f"{icons.ICON_FA_ROTATE_LEFT}  Clear all"):
        editing.clear()


def _changed(ui: Ui) -> None:
    """What became of the shadow rays, and the way to compare with the picture before the edits."""
    c = ui.controller
    before, frame, comparing = c.editing.before, c.frame, c.comparing
    if not c.editing.now or before is None or frame is None:
        return
    heading("What has changed")
    if not same_place(before.frame, frame):
        text = "The picture before the edits has another camera or time: clear the edits and undo that, to compare."
        paragraph(text, QUIET)
        return
    on = comparing.state.on and comparing.kept is before
    if wide_button("End the comparison" if on else "Compare with the picture before", "in the panel Compare"):
        if on:
            comparing.end()
        else:
            comparing.kept = before
            comparing.trace_by("")
            comparing.start(CompareMode.DIFFERENCE)
    then, now = before.frame.statistics.shadow, frame.statistics.shadow
    for name in ("due", "saved", "traced"):
        old, new = count(getattr(then, name)), count(getattr(now, name))
        clipped(f"Shadow rays {name}: {old} {icons.ICON_FA_ARROW_RIGHT} {new}")


# --- over the picture --------------------------------------------------------------------------------


@dataclass(frozen=True)
class Mark:
    """A light of the scene as it was read, where it is in the picture, 0 to 1 from the left and the top."""

    number: int
    name: str
    at: tuple[float, float]
    position: NDArray[np.float64]
    on: bool


def marks_of(ui: Ui, frame: Frame) -> list[Mark]:
    """The lights that are in the picture, those that are off as well."""
    edited = ui.controller.session.edited
    if edited is None or len(edited.original.lights) > _MOST_MARKS:
        return []
    wanted, found = ui.controller.editing.now, []
    positions = edited.original.light_positions(frame.time)
    for number, moved in wanted.moved_lights:
        positions[number] = moved
    for number, position in enumerate(positions):
        at = place(frame, position)
        if at is not None and 0.0 <= at[0] <= 1.0 and 0.0 <= at[1] <= 1.0:
            name = light_in_words(number, edited.original.lights[number].name)
            found.append(Mark(number, name, at, position, number not in wanted.lights_off))
    return found


def show_lights(ui: Ui, area: Area) -> None:
    """Mark each light while the panel is on the screen, a sun where it is on, a cross where it is off: to be dragged,
    or switched by a click."""
    frame, draw, reach = ui.controller.frame, imgui.get_window_draw_list(), em(_REACH)
    if frame is None or imgui.get_frame_count() - ui.state(WhatIfState).drawn > 2:
        return
    for mark in marks_of(ui, frame):
        at = area.to_screen(*mark.at)
        if not (area.corner.x <= at.x <= area.end.x and area.corner.y <= at.y <= area.end.y):
            continue
        imgui.set_cursor_screen_pos(ImVec2(at.x - reach, at.y - reach))
        clicked = imgui.invisible_button(f"light {mark.number}", ImVec2(2.0 * reach, 2.0 * reach))
        color = _HELD if imgui.is_item_active() else _ON if mark.on else _OFF
        icon = icons.ICON_FA_SUN if mark.on else icons.ICON_FA_CIRCLE_XMARK
        size = imgui.calc_text_size(icon)
        draw.add_circle_filled(at, 0.65 * size.y, imgui.get_color_u32(SHADE))
        draw.add_text(ImVec2(at.x - size.x / 2.0, at.y - size.y / 2.0), imgui.get_color_u32(color), icon)
        _hold(ui, area, frame, mark, clicked)


def _hold(ui: Ui, area: Area, frame: Frame, mark: Mark, clicked: bool) -> None:
    """Let the pointer drag a light, whose mark is ImGui's last item, as far along the view as it is; or switch it."""
    state, io, editing = ui.state(WhatIfState), imgui.get_io(), ui.controller.editing
    if imgui.is_item_activated():
        state.dragged = False
    if imgui.is_item_active():
        state.dragged |= imgui.is_mouse_dragging(imgui.MouseButton_.left, em(0.3))
        if state.dragged and (io.mouse_delta.x or io.mouse_delta.y):  # and no further than to the picture's edge
            x = min(max(io.mouse_pos.x, area.corner.x + 1.0), area.end.x - 1.0)
            y = min(max(io.mouse_pos.y, area.corner.y + 1.0), area.end.y - 1.0)
            depth = float(seen_from(frame.camera, mark.position)[2])
            _move(ui, mark.number, at_depth(frame, area.to_picture(x, y), depth))
    elif clicked and not state.dragged:
        editing.change(editing.now.with_light(mark.number, not mark.on))
    elif imgui.is_item_hovered():
        tooltip_at(f"{mark.name}: drag it; a click switches it {'off' if mark.on else 'on'}")
