"""What became of the rays of the clicked pixel: a tree that folds, with filters, and the way of the selected ray."""

from __future__ import annotations

from imgui_bundle import ImVec2, imgui

from viewer.output.ray_rows import Row, totals
from viewer.services.ray_inspector import RayInspector
from viewer.state.ray_lines import MOST_DRAWN
from viewer.state.verdicts import Shown
from viewer.window.panels import lights, ray_steps
from viewer.window.ui import Ui
from viewer.window.widgets import QUIET, checkbox, clipped, em, fitted, paragraph, same_line_for, swatch, tooltip

_SIDE_BY_SIDE = 38.0  # ems of width that leave room for both
_TREE_SHARE = 0.48
_ROWS, _ROWS_ABOVE = 14, 6  # lines of the tree, and of the steps; and of the tree above these
_DRAWN = (
    "in the picture, the shadow rays of the clicked point: yellow as far as light comes, then blue; outlined in "
    "red is what blocks it, in orange what a certificate names; dashes are hidden. In the colour of partially "
    "occluded, what hides its primitive; three squares are the pixel and the two that it is compared with (Figure 3)"
)
_LIGHT = 7.0  # ems of width, at least, for the name of a light
_SHOWN_TIPS = {
    Shown.ALL: "every shadow ray, and those that were not asked",
    Shown.TRACED: "shadow rays that were traced through the scene",
    Shown.UNTRACED: "shadow rays that were not, though they are due: culled, dynamic only, candidates and cache",
    Shown.BLOCKED: "shadow rays that do not reach their light",
    Shown.WRONG: "shadow rays whose answer is not true",
}


def section(ui: Ui) -> None:
    """A part of the panel that folds; rays are listed, and drawn in the picture, where it is open."""
    rays, p = ui.controller.rays, ui.controller.preferences
    wanted, ui.rays_wanted = ui.rays_wanted, max(ui.rays_wanted - 1, 0)
    imgui.dummy(ImVec2(0.0, em(0.15)))
    if wanted:
        imgui.set_next_item_open(True)
    opened = imgui.collapsing_header("Rays")
    tooltip(f"what became of each ray of the clicked pixel{ui.key('Rays of the clicked pixel')}")
    if wanted:
        imgui.set_scroll_here_y(0.0)
    if opened:
        _list(ui, rays)
    checkbox("Draw for a click", p.draw_explanation, lambda on: setattr(p, "draw_explanation", on), _DRAWN)


def _list(ui: Ui, rays: RayInspector) -> None:
    """The tree, and the steps of the selected ray: beside it where there is room, else below, and the tree in fewer
    lines."""
    rays.watch()
    rays.pointed = None
    if rays.rows is None:
        paragraph(_why_nothing(ui), QUIET)
        return
    _filters(ui, rays)  # across the whole panel, so that they stay where they are when the steps come
    room, line = imgui.get_content_region_avail().x, imgui.get_text_line_height_with_spacing()
    row = rays.selected
    steps, wide = row is not None and row.single, room >= em(_SIDE_BY_SIDE)
    most = _ROWS if wide or not steps else _ROWS_ABOVE
    lines = _ROWS if wide and steps else min(len(rays.seen) + 1.3, most)
    if imgui.begin_child("tree", ImVec2(_TREE_SHARE * room if wide and steps else 0.0, lines * line)):
        _tree(rays)
    imgui.end_child()
    if not steps:
        return
    if wide:
        imgui.same_line()
    if imgui.begin_child("steps", ImVec2(0.0, _ROWS * line)):
        ray_steps.show(ui)
    imgui.end_child()


def _why_nothing(ui: Ui) -> str:
    c = ui.controller
    if c.runs.current is not None:
        return f"Rays are listed when the {c.runs.current.name} has ended."
    if c.selection.picked is None:
        return "Click a pixel to see what became of each of its rays."
    if c.selection.pixel is None:
        return "The clicked point is not visible from here."
    return "The rays are listed when the picture is whole."


def _tree(rays: RayInspector) -> None:
    assert rays.tree is not None
    clipped(totals(rays.tree), QUIET)
    if sum(rays.tree.counts.values()) > MOST_DRAWN:
        tooltip(f"{totals(rays.tree)}\n\nAt most {MOST_DRAWN} shadow rays are drawn at once, and the selected one.")
    if imgui.begin_child("rows"):
        _rows(rays)
    imgui.end_child()


def _filters(ui: Ui, rays: RayInspector) -> None:
    """Which shadow rays are listed and drawn."""
    for number, shown in enumerate(Shown):
        if number:
            same_line_for(shown.value)
        if imgui.radio_button(shown.value, rays.shown.shown is shown):
            rays.refilter(rays.shown._replace(shown=shown))
        tooltip(_SHOWN_TIPS[shown])
    light, edge = rays.shown.light, imgui.get_cursor_screen_pos().x + imgui.get_content_region_avail().x
    if imgui.get_item_rect_max().x + em(_LIGHT) <= edge:
        imgui.same_line()
    imgui.set_next_item_width(min(em(2.0 * _LIGHT), imgui.get_content_region_avail().x))
    if imgui.begin_combo("##light", "all lights" if light is None else ui.light_name(light)):
        if imgui.is_window_appearing():
            ui.light_filters["rays"] = ""
        if imgui.selectable("all lights", light is None)[0]:
            rays.refilter(rays.shown._replace(light=None))
        for number in list(lights.found(ui, "rays"))[:64]:
            if imgui.selectable(f"{ui.light_name(number)}##{number}", light == number)[0]:
                rays.refilter(rays.shown._replace(light=number))
        imgui.end_combo()


def _rows(rays: RayInspector) -> None:
    """Those rows that are seen; resting on one picks its rays out in the picture."""
    seen, selected = rays.seen, rays.selected
    clipper = imgui.ListClipper()
    clipper.begin(len(seen), imgui.get_text_line_height_with_spacing())
    changed: Row | None = None
    while clipper.step():
        for level, row in seen[clipper.display_start : clipper.display_end]:
            if _row(rays, level, row, selected is not None and selected.key == row.key):
                changed = row
    clipper.end()
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
    open_ = rays.is_open(row)
    imgui.push_id(str(row.key))
    imgui.indent(max(em(0.8) * level, 0.01))
    imgui.set_next_item_open(open_)
    imgui.tree_node_ex("##row", int(flags))
    toggled = imgui.is_item_toggled_open()
    if imgui.is_item_clicked() and not toggled:
        rays.select(None if selected else row)
    if imgui.is_item_hovered():
        rays.pointed = row
    imgui.same_line(0.0, em(0.2))
    if len(row.places):
        swatch(row.color)
    room = imgui.get_content_region_avail().x
    text = fitted(row.text, room)
    imgui.text_unformatted(text)
    imgui.unindent(max(em(0.8) * level, 0.01))
    imgui.pop_id()
    if rays.pointed is row:
        _tip(row, whole=text == row.text)
    return bool(toggled)


def _tip(row: Row, whole: bool) -> None:
    tip = "\n".join(([] if whole else [row.text]) + ([row.tip] if row.tip else []))
    if tip and imgui.is_mouse_down(0) is False and imgui.begin_tooltip():
        imgui.push_text_wrap_pos(em(28.0))
        if not whole:
            swatch(row.color)
            imgui.text_unformatted(row.text)
        if row.tip:
            imgui.text_unformatted(row.tip)
        imgui.pop_text_wrap_pos()
        imgui.end_tooltip()
