"""The slice through space: its rows in the panel View, going through its layers, and what the pointer is on."""

from __future__ import annotations

from imgui_bundle import imgui

from tracer.culling.voxels.tell import STATE_NAMES
from viewer.state.draw_options import AXES
from viewer.state.pixels import pixel_at
from viewer.state.views import View
from viewer.views import cell_lights, view_of
from viewer.views.slices import part_seen, part_words, slice_seen, voxel_seen
from viewer.views.tree import tree_of
from viewer.views.voxels import voxels_of
from viewer.window.panels.area import Area, write_beside
from viewer.window.panels.legend import LegendState
from viewer.window.ui import Ui
from viewer.window.widgets import count, em, row


def rows(ui: Ui) -> None:
    """Rows of the panel's table."""
    session = ui.controller.session
    cut = session.draw.slice
    row("Slice", "The axis that the slice goes across.")
    for axis, name in enumerate(AXES):
        if axis:
            imgui.same_line(0.0, em(0.6))
        if imgui.radio_button(f"{name}##slice", cut.axis == axis):
            session.set_draw(slice=cut._replace(axis=axis))
    frame = ui.controller.frame
    layer = view_of(session.draw.view).layer(frame, cut) if frame is not None else None
    if layer is None:
        return
    row("Layer", "Where along the axis it is. Ctrl+click to type a number.")
    flags, shown = int(imgui.SliderFlags_.always_clamp), f"%d  ({AXES[cut.axis]} = {layer.place:.4g})"
    changed, number = imgui.slider_int("##layer", layer.number, 0, layer.many - 1, shown, flags)
    if changed:
        session.set_draw(slice=layer.goes_to(cut, number))


def lines_at(ui: Ui, x: int, y: int) -> list[str]:
    """What a pixel of the newest frame shows of space, in a view of that; nothing where it shows none."""
    c = ui.controller
    frame, view, light = c.frame, c.scheduler.drawn_view, c.session.draw.light
    if frame is None:
        return []
    if view is View.VOXELS:
        states, cut = voxels_of(frame), c.session.draw.slice
        seen = ui.cached("slice", frame, cut, lambda: slice_seen(frame, states.grid, cut))
        number = int(seen.numbers[y, x])
        if number < 0:
            return []
        found = voxel_seen(states, light, number)
        block = f"with the block of {found.level} x {found.level} x {found.level} around it" if found.level > 1 else ""
        inside = "something static lies in it" if found.occupied else "nothing static lies in it"
        named = "{}, {}, {}".format(*found.place)
        return [f"voxel {named}: {STATE_NAMES[found.state]}", *([block] if block else []), inside]
    if view is View.TREE:
        tree, cut = tree_of(frame), c.session.draw.slice
        part = part_seen(frame, tree, cut, x, y)
        return [] if part is None else list(part_words(part, tree.owner))
    if view is View.CELL_LIGHTS and frame.primitive[y, x] >= 0:
        asked = int(cell_lights.VIEW.found(frame)[y, x])
        return ["not known yet"] if asked < 0 else [f"its cell asks {count(asked)} of {count(frame.lights)} lights"]
    return []


def show(ui: Ui, area: Area) -> None:
    """Beside the pointer, what is under it."""
    c = ui.controller
    at, frame = c.selection.hovered, c.frame
    if at is None or frame is None or imgui.is_mouse_down(0):
        return
    lines = lines_at(ui, *pixel_at(frame, *at))
    if not lines:
        return
    room = area.corner.x, area.corner.y, area.end.x, area.end.y
    write_beside(lines, imgui.get_io().mouse_pos, room, ui.state(LegendState).place)
