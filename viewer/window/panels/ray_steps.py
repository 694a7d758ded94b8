"""The way of the selected ray through a structure: the nodes that it enters, one by one."""

from __future__ import annotations

import math

from imgui_bundle import imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from tracer.geometry.accelerators import ACCELERATORS
from tracer.geometry.visits import Visit
from viewer.output.ray_rows import RayRows
from viewer.services.ray_inspector import RayInspector
from viewer.window.ui import Ui
from viewer.window.widgets import QUIET, clipped, count, em, fitted, paragraph, tooltip

_COLUMNS = ("", "node", "kind", "enters", "leaves", "tested", "hits")
_WIDTHS = (1.9, 4.2, 2.6, 3.3, 3.3, 3.0, 0.0)  # in ems; 0 takes what is left


def show(ui: Ui) -> None:
    """The steps of the selected ray, as a list, with what plays them."""
    rays = ui.controller.rays
    row = rays.selected
    assert row is not None and rays.rows is not None
    _structures(rays)
    if not rays.walked:
        imgui.new_line()
        paragraph("looking into it ...", QUIET)
        return
    visits = rays.visits
    if not visits:
        imgui.new_line()
        paragraph("This ray enters no node.", QUIET)
        return
    tests, leaves = sum(len(visit.tested) for visit in visits), sum(visit.leaf for visit in visits)
    nodes = f"{count(len(visits))} {'node' if len(visits) == 1 else 'nodes'}, {count(leaves)} of them leaves"
    clipped(f"{nodes}; {count(tests)} {'primitive' if tests == 1 else 'primitives'} tested", QUIET)
    _player(rays)
    _list(rays, rays.rows)


def _structures(rays: RayInspector) -> None:
    """Which structure's nodes are shown."""
    for accelerator in ACCELERATORS:
        if imgui.radio_button(accelerator, rays.structure == accelerator):
            rays.accelerator = accelerator
        if accelerator == "bvh8":
            tooltip("the nodes that the ray itself enters; rays are traced in packets, which may enter more")
        else:
            tooltip("the paper's structure: each node is a traversal step; built when it is first asked for")
        imgui.same_line()


def _player(rays: RayInspector) -> None:
    """Buttons, and a slider over all steps."""
    if imgui.button(f"{icons.ICON_FA_BACKWARD_STEP}##previous"):
        rays.go(-1)
    tooltip("previous step (,)")
    imgui.same_line()
    if imgui.button(f"{icons.ICON_FA_PAUSE if rays.playing else icons.ICON_FA_PLAY}##play"):
        rays.play()
    tooltip("play the steps (Shift+.)")
    imgui.same_line()
    if imgui.button(f"{icons.ICON_FA_FORWARD_STEP}##next"):
        rays.go(1)
    tooltip("next step (.)")
    imgui.same_line()
    imgui.set_next_item_width(-1.0)
    last = len(rays.visits)
    changed, step = imgui.slider_int("##step", rays.step + 1, 1, last, f"step %d of {last}")
    if changed:
        rays.go(step - 1 - rays.step)


def _list(rays: RayInspector, rows: RayRows) -> None:
    """All steps; a click goes to one."""
    flags = imgui.TableFlags_.scroll_y | imgui.TableFlags_.row_bg | imgui.TableFlags_.sizing_fixed_fit
    if not imgui.begin_table("visits", len(_COLUMNS), int(flags)):
        return
    imgui.table_setup_scroll_freeze(0, 1)
    for name, width in zip(_COLUMNS, _WIDTHS, strict=True):
        kind = imgui.TableColumnFlags_.width_fixed if width else imgui.TableColumnFlags_.width_stretch
        imgui.table_setup_column(name, int(kind), em(width) if width else 1.0)
    imgui.table_headers_row()
    clipper = imgui.ListClipper()
    clipper.begin(len(rays.visits))
    clipper.include_item_by_index(rays.step)  # which the list scrolls to
    while clipper.step():
        for number in range(clipper.display_start, clipper.display_end):
            _visit(rays, rows, number, rays.visits[number])
    clipper.end()
    imgui.end_table()


def _visit(rays: RayInspector, rows: RayRows, number: int, visit: Visit) -> None:
    imgui.table_next_row()
    imgui.table_next_column()
    spans = int(imgui.SelectableFlags_.span_all_columns)
    if imgui.selectable(f"{number + 1}##{number}", number == rays.step, spans)[0]:
        rays.go(number - rays.step)
    if number == rays.step and not imgui.is_item_visible():
        imgui.set_scroll_here_y(0.5)
    hits = ", ".join(f"{rows.name(primitive)} at {t:.4g}" for primitive, t in visit.hits)
    if imgui.is_item_hovered():
        lines = [f"{visit.tree}, node {visit.node}, {visit.level} below the root"]
        lines += [f"tested: {', '.join(map(rows.name, visit.tested[:8]))}"] if visit.tested else []
        lines += [f"hit: {hits}"] if hits else []
        imgui.set_tooltip("\n".join(lines))
    kind = "leaf" if visit.leaf else "inner"
    name = f"{visit.node}" if visit.tree == "static" else f"{visit.tree.removesuffix(' objects')} {visit.node}"
    for text in (name, kind, _distance(visit.enter), _distance(visit.leave)):
        imgui.table_next_column()
        imgui.text_unformatted(fitted(text, imgui.get_content_region_avail().x))
    imgui.table_next_column()
    imgui.text_unformatted(str(len(visit.tested)) if visit.leaf else "")
    imgui.table_next_column()
    imgui.text_unformatted(fitted(hits, imgui.get_content_region_avail().x))


def _distance(t: float) -> str:
    return f"{t:.4g}" if math.isfinite(t) and abs(t) < 1e20 else "far"
