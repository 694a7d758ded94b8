"""What if: lights off or elsewhere, objects hidden, static or able to move, and what that changes."""

from __future__ import annotations

from collections.abc import Sequence

from imgui_bundle import imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from tracer.scene.edits import Edited
from tracer.scene.lights import light_in_words
from tracer.scene.limits import LARGEST
from tracer.scene.things import Thing
from tracer.why_in_words import primitive_in_words
from viewer.services.edit_effects import Effects, Lack, Transitions
from viewer.state import terms
from viewer.state.changes import one_by_one
from viewer.window.edit_commands import WhatIfState
from viewer.window.panels import lights
from viewer.window.ui import Ui
from viewer.window.widgets import (
    QUIET,
    checkbox,
    clipped,
    count,
    em,
    fitted,
    heading,
    paragraph,
    right,
    tooltip,
    wide_button,
)

_TIPS = {
    "due": terms.MEANINGS[terms.DUE],
    "steps": "nodes of trees that rays of all kinds enter",
    "tests": "rays of all kinds tested against primitives",
    "certified": "certificates, voxels, cells or light buffers, whatever the method makes, in this frame",
}
_ROWS = 12  # of the list of lights that are seen at least: a few need no scroll bar in the panel, which has its own
_MOST_PAIRS = 4  # of transitions of a light that are listed
_MOST_BLOCKERS = 4


def show(ui: Ui) -> None:
    """The panel."""
    state = ui.state(WhatIfState)
    edited = ui.controller.session.edited
    if edited is None:
        paragraph("No scene is open.", QUIET)
        return
    state.drawn = imgui.get_frame_count()
    if not ui.controller.editing.now:
        paragraph("Change the scene, not its file, and see what that changes. Undo brings all back.", QUIET)
    _object(ui, edited)
    _lights(ui, edited)
    _edits(ui)
    _effects(ui)
    if state.below < 0.0:  # where the list of lights ends
        state.below += imgui.get_cursor_pos_y()


# --- what is edited ----------------------------------------------------------------------------------


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
        tooltip("take this edit back")
        imgui.same_line()
        clipped(words)
        imgui.pop_id()
    if len(listed) > 1 and wide_button(f"{icons.ICON_FA_ROTATE_LEFT}  Take all back"):
        editing.clear()


# --- the object --------------------------------------------------------------------------------------


def _object(ui: Ui, edited: Edited) -> None:
    """What was clicked, and what blocks its light."""
    c = ui.controller
    pick = c.selection.picked
    heading("Object")
    if pick is None or not 0 <= pick.primitive < len(edited.primitives):
        paragraph("Click an object in the picture to hide it, or to let it move.", QUIET)
        return
    thing = edited.thing_of(pick.primitive)
    clipped(thing.name)
    _thing(ui, thing, int(edited.primitives[pick.primitive]))
    answer = c.inspector.answer
    blockers = [] if answer is None else [one.blocker for one in answer.lights if one.blocker is not None]
    for primitive in list(dict.fromkeys(blockers))[:_MOST_BLOCKERS]:
        if 0 <= primitive < len(edited.primitives):
            _blocker(ui, edited, primitive)


def _thing(ui: Ui, thing: Thing, primitive: int) -> None:
    """What can be done with the object, and with this primitive of it."""
    editing = ui.controller.editing
    if wide_button("Hide all of it", thing.name, 2):
        editing.hide(thing.name)
    imgui.same_line()
    if wide_button("Hide primitive", f"primitive {primitive} alone", 1):
        editing.hide_primitive(primitive)
    if thing.moves:
        static = thing.name in dict(editing.now.static)
        tip = "it stays where it is at this moment, and counts as what never moves: it carries modes"
        checkbox("Static", static, lambda on: editing.make_static(thing.name, on), tip)
    else:
        tip = (
            "it stays where it is, but counts as an object that could move: no modes, and its shadows are always traced"
        )
        checkbox("Can move", thing.name in editing.now.moving, lambda on: editing.let_move(thing.name, on), tip)


def _blocker(ui: Ui, edited: Edited, primitive: int) -> None:
    """What blocks a light of the clicked point."""
    name, editing = edited.thing_of(primitive).name, ui.controller.editing
    imgui.push_id(f"blocker {primitive}")
    if imgui.small_button(icons.ICON_FA_EYE_SLASH):
        editing.hide(name)
    tooltip(f"hide {name}, all of it")
    imgui.same_line()
    if imgui.small_button("1"):
        editing.hide_primitive(int(edited.primitives[primitive]))
    tooltip("hide this primitive alone")
    imgui.same_line()
    clipped(f"blocks: {primitive_in_words(edited.scene, primitive)}")
    imgui.pop_id()


# --- lights ------------------------------------------------------------------------------------------


def _lights(ui: Ui, edited: Edited) -> None:
    """All lights of the scene as it was read, with a tick for those that are on."""
    state = ui.state(WhatIfState)
    original = edited.original
    heading(f"Lights ({len(original.lights)})")
    if not original.lights:
        paragraph("The scene has no lights.", QUIET)
        return
    numbers = lights.found(ui, "what if", original)
    line, room = imgui.get_frame_height_with_spacing(), imgui.get_content_region_avail().y - state.below
    height = min(max(len(numbers), 1) * line, max(_ROWS * line, room)) + 2.0
    if imgui.begin_child("switches", (0.0, height)):
        clipper = imgui.ListClipper()
        clipper.begin(len(numbers), imgui.get_frame_height_with_spacing())
        while clipper.step():
            for k in range(clipper.display_start, clipper.display_end):
                _light(ui, edited, numbers[k])
        clipper.end()
    imgui.end_child()
    state.below = -imgui.get_cursor_pos_y()
    paragraph("Drag a light in the picture, or type where it is.", QUIET)


def _light(ui: Ui, edited: Edited, number: int) -> None:
    editing, light = ui.controller.editing, edited.original.lights[number]
    imgui.push_id(number)
    on = number not in editing.now.lights_off
    name = light_in_words(number, light.name)
    checkbox("##on", on, lambda now: editing.switch(number, now), f"{name}: on or off")
    imgui.same_line()
    moved = editing.now.light_place(number)
    button = imgui.get_frame_height() if moved is not None else 0.0
    x, y, z = moved or edited.original.light_positions(ui.controller.session.time)[number].tolist()
    names = max(em(4.0), imgui.get_content_region_avail().x - em(13.0) - button)
    start = imgui.get_cursor_pos_x()
    imgui.align_text_to_frame_padding()
    imgui.text_unformatted(fitted(name, names - em(0.4)))
    imgui.same_line(start + names)
    imgui.set_next_item_width(-button - 1.0)
    speed = 0.001 * lights.diagonal(ui.controller.info.get("bounds"))  # units for each pixel of the pointer's way
    changed, place = imgui.drag_float3("##place", [x, y, z], speed, -LARGEST, LARGEST, "%.4g")
    tooltip(f"where {name} is: x, y, z. Drag a number, or double-click it to type")
    if changed and list(place) != [x, y, z]:
        editing.move_light(number, (float(f"{place[0]:.6g}"), float(f"{place[1]:.6g}"), float(f"{place[2]:.6g}")))
        ui.controller.motion.by_hand()
    if moved is not None:
        imgui.same_line(0.0, 0.0)
        if imgui.button(icons.ICON_FA_ROTATE_LEFT, (button, button)):
            editing.move_light(number, None)
        tooltip("back to where it was")
    imgui.pop_id()


# --- what has changed --------------------------------------------------------------------------------


def _effects(ui: Ui) -> None:
    """From the picture before the edits to this one."""
    before = ui.controller.before_edits
    if before.lack is Lack.NO_EDITS:
        return
    heading("What has changed")
    if before.taking:
        paragraph("The picture without the edits is being traced.", QUIET)
        return
    found = before.effects
    if found is None:
        paragraph(before.lack.value, QUIET)
        if before.lack is Lack.ELSEWHERE and wide_button("Trace it", "the edits are put aside until it has come"):
            before.take_anew()
        return
    _pixels(ui, found)
    _counters(found)
    _transitions(ui, "Occlusion modes", [found.occlusion] if found.occlusion is not None else [], "primitives")
    _transitions(ui, "Shadow modes", found.shadows, "primitives")
    _transitions(ui, "Certificates", found.certificates, "pixels")


def _pixels(ui: Ui, found: Effects) -> None:
    if found.changes is None:
        paragraph("The pictures have different numbers of samples until this one is done.", QUIET)
        return
    share = 100.0 * found.pixels / max(found.changes.size, 1)
    paragraph(f"{count(found.pixels)} pixels ({share:.1f} %), by up to {found.most} of 255")
    tooltip(f"{count(found.exact)} where differences count that a screen does not show")
    state = ui.state(WhatIfState)
    checkbox("Show changed pixels", state.changed_shown, lambda on: setattr(state, "changed_shown", on),
             "in magenta on the dimmed picture, the brighter the more they changed; in the view Colour")  # fmt: skip


def _counters(found: Effects) -> None:
    flags = int(imgui.TableFlags_.sizing_stretch_prop)
    if not imgui.begin_table("counters", 4, flags):
        return
    columns = {"": 1.5, "before": 1.0, "now": 1.0, "change": 1.1}
    for name, width in columns.items():
        imgui.table_setup_column(name, int(imgui.TableColumnFlags_.width_stretch), width)
    imgui.table_next_row()
    for name in columns:
        imgui.table_next_column()
        right(name, QUIET)
    for one in found.counters:
        imgui.table_next_row()
        imgui.table_next_column()
        clipped(one.name.capitalize(), QUIET)
        tooltip(_TIPS.get(one.name, terms.MEANINGS.get(one.name, "")) or one.name)
        change = one.after - one.before
        for text in (count(one.before), count(one.after), f"{'+' if change > 0 else ''}{count(change)}"):
            imgui.table_next_column()
            right(text)
    imgui.end_table()


def _transitions(ui: Ui, title: str, listed: Sequence[Transitions], units: str) -> None:
    """How many went from which state to which, by light."""
    if not listed:
        return
    changed = sum(one.changed for one in listed)
    flags = imgui.TreeNodeFlags_.span_avail_width | imgui.TreeNodeFlags_.default_open
    if not imgui.tree_node_ex(f"{title}: {count(changed)} changed###{title}", int(flags)):
        return
    kept = sum(int(one.counts.trace() - one.counts[0, 0]) for one in listed)
    of_lights = ", summed over the lights" if listed[0].light is not None and len(listed) > 1 else ""
    paragraph(f"{count(kept)} {units} have the same as before{of_lights}", QUIET)
    for one in listed:
        pairs = one.pairs()
        if not pairs:
            continue
        if one.light is not None:
            edited = ui.controller.session.edited
            assert edited is not None
            clipped(light_in_words(one.light, edited.original.lights[one.light].name))
        for before, after, number in pairs[:_MOST_PAIRS]:
            clipped(f"   {before} {icons.ICON_FA_ARROW_RIGHT} {after}: {count(number)}", QUIET)
        others = sum(number for _, _, number in pairs[_MOST_PAIRS:])
        if others:
            clipped(f"   others: {count(others)}", QUIET)
    imgui.tree_pop()
