"""What became of the rays of the clicked pixel: a tree that folds, with filters, and the steps of the selected ray."""

from __future__ import annotations

import math

from imgui_bundle import ImVec2, imgui

from tracer.geometry.visits import Visit
from viewer.output.ray_rows import RayRows, Row, origin_of, steps_summary, totals
from viewer.services.ray_inspector import RayInspector
from viewer.state.verdicts import Shown
from viewer.window.panels import lights
from viewer.window.panels.ray_overlay import BOX, INSIDE, MOST_DRAWN
from viewer.window.ui import RaysState, Ui
from viewer.window.widgets import (
    QUIET,
    checkbox,
    clipped,
    em,
    fitted,
    paragraph,
    same_line_for,
    swatch,
    tooltip,
    tooltip_at,
)

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
    Shown.ALL: "every shadow ray, and those to lights that the surface faces away from",
    Shown.TRACED: "shadow rays that were traced through the scene",
    Shown.UNTRACED: "shadow rays that were not, though they are due: culled, dynamic only, candidates and cache",
    Shown.BLOCKED: "shadow rays that do not reach their light",
    Shown.WRONG: "shadow rays with a wrong answer",
}
_STEP_COLUMNS = {  # with their widths in ems, 0 for what is left, and what they are
    "": (1.7, "click a step to go to it"),
    "node": (5.4, "the node's number in its tree; leaves hold the primitives"),
    "enters": (4.6, "how far from {origin} the ray enters the node's box"),
    "leaves": (4.6, "how far from {origin} it leaves the box"),
    "tests": (2.6, "primitives that the ray is tested against there"),
    "hits": (0.0, "what it hits there, and how far from {origin}"),
}
_STEP_TABLE = 28.0  # ems that they need
_STEP_LEGEND = (
    "in the picture: the box of the chosen node, red where the ray hits something in it, and in white the part of the "
    "ray that lies in the box"
)


def section(ui: Ui) -> None:
    """A part of the panel that folds; rays are listed, and drawn in the picture, where it is open."""
    state = ui.state(RaysState)
    rays, p = ui.controller.rays, ui.controller.preferences
    wanted, state.unfold = state.unfold, max(state.unfold - 1, 0)
    imgui.dummy(ImVec2(0.0, em(0.15)))
    if wanted:
        imgui.set_next_item_open(True)
    opened = imgui.collapsing_header("Rays")
    tooltip(f"what became of each ray of the clicked pixel{ui.key('Rays of the clicked pixel')}")
    if wanted:
        imgui.set_scroll_here_y(0.0)
    if opened:
        _section(ui, rays)
    checkbox("Draw for a click", p.draw_explanation, lambda on: setattr(p, "draw_explanation", on), _DRAWN)


def _section(ui: Ui, rays: RayInspector) -> None:
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
    if not steps or row is None:
        return
    if wide:
        imgui.same_line()
    if imgui.begin_child("steps", ImVec2(0.0, _ROWS * line)):
        _steps(ui, rays, rays.rows, row)
    imgui.end_child()


def _why_nothing(ui: Ui) -> str:
    c = ui.controller
    if c.runs.current is not None:
        return f"Rays are listed when the {c.runs.current.name} has ended."
    if c.selection.picked is None:
        return "Click a pixel to see what became of each of its rays."
    if c.selection.pixel is None:
        return "The clicked point is not visible from here."
    return c.inspector.problem or "The rays are listed when the picture is whole."


# --- the tree ---------------------------------------------------------------------------------------


def _filters(ui: Ui, rays: RayInspector) -> None:
    """Which shadow rays are listed and drawn."""
    for number, shown in enumerate(Shown):
        if number:
            same_line_for(shown.value)
        if imgui.radio_button(shown.value, rays.shown.shown is shown):
            rays.refilter(rays.shown._replace(shown=shown))
        tooltip(_SHOWN_TIPS[shown])
    edge = imgui.get_cursor_screen_pos().x + imgui.get_content_region_avail().x
    if imgui.get_item_rect_max().x + em(_LIGHT) <= edge:
        imgui.same_line()
    imgui.set_next_item_width(min(em(2.0 * _LIGHT), imgui.get_content_region_avail().x))
    lights.combo_of_all(ui, "rays", rays.shown.light, lambda light: rays.refilter(rays.shown._replace(light=light)))


def _tree(rays: RayInspector) -> None:
    """Those rows that are seen; resting on one picks its rays out in the picture."""
    assert rays.tree is not None
    clipped(totals(rays.tree), QUIET)
    if sum(rays.tree.counts.values()) > MOST_DRAWN:
        tooltip(f"{totals(rays.tree)}\n\nAt most {MOST_DRAWN} shadow rays are drawn at once, and the selected one.")
    changed: Row | None = None
    if imgui.begin_child("rows"):
        selected, clipper = rays.selected, imgui.ListClipper()
        clipper.begin(len(rays.seen), imgui.get_text_line_height_with_spacing())
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


# --- the steps of one ray ---------------------------------------------------------------------------


def _steps(ui: Ui, rays: RayInspector, rows: RayRows, row: Row) -> None:
    """The nodes that the selected ray enters, one by one, and a slider over them."""
    assert rays.tree is not None
    visits = rays.visits
    if not visits:
        paragraph("looking into it ..." if visits is None else "This ray enters no node.", QUIET)
        return
    imgui.set_next_item_width(-1.0)
    changed, step = imgui.slider_int("##step", rays.step + 1, 1, len(visits), f"step %d of {len(visits)}")
    tooltip(f"the step that is drawn in the picture; next{ui.key('Next step of the ray')}")
    if changed:
        rays.go(step - 1 - rays.step)
    text, why = steps_summary(rays.tree, row, visits)
    clipped(text, QUIET)
    if why:
        tooltip(why)
    origin, length = origin_of(rays.tree, row)
    for color, word in ((BOX, "node's box"), (INSIDE, "ray in it")):
        swatch(color)
        imgui.text_colored(QUIET, word)
        tooltip(_STEP_LEGEND)
        imgui.same_line(0.0, em(0.8))
    clipped(f"distances from {origin}", QUIET)
    _step_table(rays, rows, visits, origin, length)


def _step_table(rays: RayInspector, rows: RayRows, visits: list[Visit], origin: str, length: float) -> None:
    """All steps; a click goes to one.  Distances are from `origin`, of rays of this length."""
    flags = imgui.TableFlags_.scroll_y | imgui.TableFlags_.row_bg | imgui.TableFlags_.sizing_fixed_fit
    flags |= imgui.TableFlags_.scroll_x  # where the panel is narrow
    inner = max(imgui.get_content_region_avail().x - imgui.get_style().scrollbar_size, em(_STEP_TABLE))
    if not imgui.begin_table("visits", len(_STEP_COLUMNS), int(flags), ImVec2(0.0, 0.0), inner):
        return
    imgui.table_setup_scroll_freeze(0, 1)
    for name, (width, _) in _STEP_COLUMNS.items():
        kind = imgui.TableColumnFlags_.width_fixed if width else imgui.TableColumnFlags_.width_stretch
        imgui.table_setup_column(name, int(kind), em(width) if width else 1.0)
    imgui.table_next_row(int(imgui.TableRowFlags_.headers))
    for name, (_, tip) in _STEP_COLUMNS.items():
        imgui.table_next_column()
        imgui.table_header(name)
        tooltip(tip.format(origin=origin))
    clipper = imgui.ListClipper()
    clipper.begin(len(visits))
    clipper.include_item_by_index(rays.step)  # which the list scrolls to
    while clipper.step():
        for number in range(clipper.display_start, clipper.display_end):
            _step(rays, rows, visits[number], number, length)
    clipper.end()
    imgui.end_table()


def _step(rays: RayInspector, rows: RayRows, visit: Visit, number: int, length: float) -> None:
    imgui.table_next_row()
    imgui.table_next_column()
    spans = int(imgui.SelectableFlags_.span_all_columns)
    if imgui.selectable(f"{number + 1}##{number}", number == rays.step, spans)[0]:
        rays.go(number - rays.step)
    if number == rays.step and not imgui.is_item_visible():
        imgui.set_scroll_here_y(0.5)
    hits = ", ".join(f"{rows.name(primitive)} at {t * length:.4g}" for primitive, t in visit.hits)
    if imgui.is_item_hovered():
        kind = "leaf" if visit.leaf else "inner node"
        lines = [f"{kind} {visit.node} of {visit.tree}, {visit.level} below the root"]
        lines += [f"tested: {', '.join(map(rows.name, visit.tested[:8]))}"] if visit.tested else []
        lines += [f"hit: {hits}"] if hits else []
        tooltip_at("\n".join(lines))
    name = f"{visit.node}" if visit.tree == "static" else f"{visit.tree.removesuffix(' objects')} {visit.node}"
    name = f"leaf {name}" if visit.leaf else name
    tests = str(len(visit.tested)) if visit.leaf else ""
    for text in (name, _distance(visit.enter, length), _distance(visit.leave, length), tests, hits):
        imgui.table_next_column()
        imgui.text_unformatted(fitted(text, imgui.get_content_region_avail().x))


def _distance(t: float, length: float) -> str:
    return f"{t * length:.4g}" if math.isfinite(t) and abs(t) < 1e20 else "far"
