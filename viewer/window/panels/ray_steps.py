"""The way of the selected ray through a structure: the nodes that it enters, one by one."""

from __future__ import annotations

import math

from imgui_bundle import ImVec2, imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from tracer.geometry.accelerators import ACCELERATORS, BVH8, KD_TREE, LAZY
from viewer.output import ray_way
from viewer.output.ray_rows import RayRows
from viewer.services.ray_inspector import RayInspector
from viewer.window.panels import ray_overlay
from viewer.window.ui import Ui
from viewer.window.widgets import QUIET, clipped, em, fitted, paragraph, swatch, tooltip, tooltip_at

_COLUMNS = {  # with their widths in ems, 0 for what is left, and what they are
    "": (1.7, "click a step to go to it"),
    "node": (5.4, "the node's number in its tree; leaves hold the primitives"),
    "enters": (4.6, "how far from {origin} the ray enters the node's box"),
    "leaves": (4.6, "how far from {origin} it leaves the box"),
    "tests": (2.6, "primitives that the ray is tested against there"),
    "hits": (0.0, "what it hits there, and how far from {origin}"),
}
_PLAYER = 12.0  # ems of width that its buttons and the slider need
_TABLE = 28.0  # and the columns
_LEGEND = (
    "in the picture: the box of the chosen node, red where the ray hits something in it, and in white the part of the "
    "ray that lies in the box"
)


def show(ui: Ui) -> None:
    """The steps of the selected ray, as a list, with what plays them."""
    rays = ui.controller.rays
    row, tree = rays.selected, rays.tree
    assert row is not None and tree is not None and rays.rows is not None
    _structures(rays)
    if not rays.walked:
        imgui.new_line()
        paragraph("looking into it ...", QUIET)
        return
    if not rays.visits:
        imgui.new_line()
        paragraph("This ray enters no node.", QUIET)
        return
    if imgui.get_content_region_avail().x < em(_PLAYER):
        imgui.new_line()
    _player(ui, rays)
    text, why = ray_way.summary(tree, row, rays.visits, rays.structure)
    clipped(text, QUIET)
    if why:
        tooltip(why)
    _legend(ray_way.origin_of(tree, row))
    _list(rays, rays.rows, ray_way.length_of(tree, row), ray_way.origin_of(tree, row))


def _legend(origin: str) -> None:
    """What is drawn in the picture, and from where distances are measured."""
    for color, word in ((ray_overlay.BOX, "node's box"), (ray_overlay.WAY, "ray in it")):
        swatch(color)
        imgui.text_colored(QUIET, word)
        tooltip(_LEGEND)
        imgui.same_line(0.0, em(0.8))
    clipped(f"distances from {origin}", QUIET)


_ABOUT = {
    KD_TREE: "the paper's structure: each node is a traversal step; built when it is first asked for",
    LAZY: "one kd-tree over everything, built where rays arrive: each node is a traversal step",
    BVH8: "the nodes that the ray itself enters; rays are traced in packets, which may enter more",
}


def _structures(rays: RayInspector) -> None:
    """Which structure's nodes are shown."""
    for accelerator in ACCELERATORS:
        if imgui.radio_button(accelerator, rays.structure == accelerator):
            rays.accelerator = accelerator
        tooltip(_ABOUT[accelerator])
        imgui.same_line()


def _player(ui: Ui, rays: RayInspector) -> None:
    """Buttons, and a slider over all steps."""
    if imgui.button(f"{icons.ICON_FA_BACKWARD_STEP}##previous"):
        rays.go(-1)
    tooltip(f"previous step{ui.key('Previous step of the ray')}")
    imgui.same_line()
    if imgui.button(f"{icons.ICON_FA_PAUSE if rays.playing else icons.ICON_FA_PLAY}##play"):
        rays.play()
    tooltip(f"play the steps{ui.key('Play the steps of the ray')}")
    imgui.same_line()
    if imgui.button(f"{icons.ICON_FA_FORWARD_STEP}##next"):
        rays.go(1)
    tooltip(f"next step{ui.key('Next step of the ray')}")
    imgui.same_line()
    imgui.set_next_item_width(-1.0)
    last = len(rays.visits)
    changed, step = imgui.slider_int("##step", rays.step + 1, 1, last, f"%d of {last}")
    if changed:
        rays.go(step - 1 - rays.step)


def _list(rays: RayInspector, rows: RayRows, length: float, origin: str) -> None:
    """All steps; a click goes to one.  Distances are from `origin`, of rays of this length."""
    flags = imgui.TableFlags_.scroll_y | imgui.TableFlags_.row_bg | imgui.TableFlags_.sizing_fixed_fit
    flags |= imgui.TableFlags_.scroll_x  # where the panel is narrow
    inner = max(imgui.get_content_region_avail().x - imgui.get_style().scrollbar_size, em(_TABLE))
    if not imgui.begin_table("visits", len(_COLUMNS), int(flags), ImVec2(0.0, 0.0), inner):
        return
    imgui.table_setup_scroll_freeze(0, 1)
    for name, (width, _) in _COLUMNS.items():
        kind = imgui.TableColumnFlags_.width_fixed if width else imgui.TableColumnFlags_.width_stretch
        imgui.table_setup_column(name, int(kind), em(width) if width else 1.0)
    imgui.table_next_row(int(imgui.TableRowFlags_.headers))
    for name, (_, tip) in _COLUMNS.items():
        imgui.table_next_column()
        imgui.table_header(name)
        tooltip(tip.format(origin=origin))
    clipper = imgui.ListClipper()
    clipper.begin(len(rays.visits))
    clipper.include_item_by_index(rays.step)  # which the list scrolls to
    while clipper.step():
        for number in range(clipper.display_start, clipper.display_end):
            _visit(rays, rows, number, length)
    clipper.end()
    imgui.end_table()


def _visit(rays: RayInspector, rows: RayRows, number: int, length: float) -> None:
    visit = rays.visits[number]
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
