"""What became of the rays of the clicked pixel: a tree that folds, with filters."""

from __future__ import annotations

from imgui_bundle import ImVec2, imgui

from viewer.output.ray_rows import Row, Shown, totals
from viewer.services.ray_inspector import RayInspector
from viewer.window.panels import lights
from viewer.window.panels.ray_overlay import MOST_DRAWN
from viewer.window.setting_rows import ALL, setting_switch
from viewer.window.ui import RaysState, Ui
from viewer.window.widgets import (
    QUIET,
    clipped,
    em,
    fitted,
    paragraph,
    same_line_for,
    swatch,
    tooltip,
    tooltip_at,
)

_ROWS = 14  # of the tree that are seen at once
_LIGHT = 7.0  # ems of width, at least, for the name of a light


def section(ui: Ui) -> None:
    """A part of the panel that folds; rays are listed, and drawn in the picture, where it is open."""
    state = ui.state(RaysState)
    rays = ui.controller.rays
    wanted, state.unfold = state.unfold, max(state.unfold - 1, 0)
    imgui.dummy(ImVec2(0.0, em(0.15)))
    if wanted:
        imgui.set_next_item_open(True)
    opened = imgui.collapsing_header("Rays")
    tooltip(f"what became of each ray of the clicked pixel{ui.key('Rays of the clicked pixel')}")
    if wanted:
        imgui.set_scroll_here_y(0.0)
    if opened:
        rays.watch()
        rays.pointed = None
        if rays.rows is not None:
            _tree(ui, rays)
        elif ui.controller.selection.picked is None:
            paragraph("Click a pixel to see what became of each of its rays.", QUIET)
        else:
            paragraph("The rays are listed when the picture is whole.", QUIET)  # what it waits for is said above
    setting_switch(ui, ALL["draw.rays"])


# --- the tree ---------------------------------------------------------------------------------------


def _filters(ui: Ui, rays: RayInspector) -> None:
    """Which shadow rays are listed and drawn."""
    for number, shown in enumerate(Shown):
        if number:
            same_line_for(shown.value)
        if imgui.radio_button(shown.value, rays.shown.shown is shown):
            rays.refilter(rays.shown._replace(shown=shown))
        tooltip(shown.meaning)
    edge = imgui.get_cursor_screen_pos().x + imgui.get_content_region_avail().x
    if imgui.get_item_rect_max().x + em(_LIGHT) <= edge:
        imgui.same_line()
    imgui.set_next_item_width(min(em(2.0 * _LIGHT), imgui.get_content_region_avail().x))

    def choose(light: int | None) -> None:
        rays.refilter(rays.shown._replace(light=light))

    lights.combo(ui, "rays", rays.shown.light, choose, lambda: choose(None))


def _tree(ui: Ui, rays: RayInspector) -> None:
    """Those rows that are seen; resting on one picks its rays out in the picture."""
    assert rays.tree is not None
    _filters(ui, rays)
    height = imgui.get_text_line_height_with_spacing()
    clipped(totals(rays.tree), QUIET)
    if sum(rays.tree.counts.values()) > MOST_DRAWN:
        tooltip(f"{totals(rays.tree)}\n\nAt most {MOST_DRAWN} shadow rays are drawn at once, and the selected one.")
    changed: Row | None = None
    if imgui.begin_child("rows", ImVec2(0.0, min(len(rays.seen) + 0.3, _ROWS) * height)):
        selected, clipper = rays.selected, imgui.ListClipper()
        clipper.begin(len(rays.seen), height)
        while clipper.step():
            for level, row in rays.seen[clipper.display_start : clipper.display_end]:
                if _row(rays, level, row, selected is not None and selected.key == row.key):
                    changed = row
        clipper.end()
    imgui.end_child()
    if changed is not None:
        rays.toggle(changed)


def _row(rays: RayInspector, level: int, row: Row, selected: bool) -> bool:
    """One row; whether it is to be folded or unfolded."""
    flags = imgui.TreeNodeFlags_.no_tree_push_on_open | imgui.TreeNodeFlags_.span_avail_width
    flags |= imgui.TreeNodeFlags_.open_on_arrow | imgui.TreeNodeFlags_.open_on_double_click
    if row.below is None or not row.rows:
        flags |= imgui.TreeNodeFlags_.leaf
    if selected:
        flags |= imgui.TreeNodeFlags_.selected
    imgui.push_id(str(row.key))
    imgui.indent(max(em(0.8) * level, 0.01))
    imgui.set_next_item_open(rays.is_open(row))
    imgui.tree_node_ex("##row", int(flags))
    toggled = imgui.is_item_toggled_open()
    if imgui.is_item_clicked() and not toggled:
        rays.select(None if selected else row)
    if imgui.is_item_hovered():
        rays.pointed = row
    imgui.same_line(0.0, em(0.2))
    if len(row.places):
        swatch(row.color)
    text = fitted(row.text, imgui.get_content_region_avail().x)
    imgui.text_unformatted(text)
    imgui.unindent(max(em(0.8) * level, 0.01))
    imgui.pop_id()
    tip = "\n".join(([] if text == row.text else [row.text]) + ([row.tip] if row.tip else []))
    if rays.pointed is row and tip and not imgui.is_mouse_down(0):
        tooltip_at(tip)
    return bool(toggled)
