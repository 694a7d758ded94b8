"""What became of the rays of the clicked pixel: a tree that folds, in the Inspector, and its rays over the picture.

Rays are drawn on their way, and shadow rays as far as light comes, and on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import Enum
from typing import NamedTuple

import numpy as np
from imgui_bundle import ImVec2, ImVec4, imgui
from numpy.typing import NDArray

from tracer.frame import Frame
from tracer.inspect.path_records import AWAY, TRACED, RayTree
from tracer.inspect.projection import Stroke, place, strokes
from viewer.output.ray_rows import SUBSET_HELP, RayFilter, RayKey, RayRow, RayRows, RaySubset, totals, unfolded
from viewer.state import palette
from viewer.state.picking import Pick
from viewer.window.panels import lights
from viewer.window.panels.area import SHADE, WHITE, Pen
from viewer.window.panels.links import Pointed
from viewer.window.setting_rows import ALL, setting_switch
from viewer.window.ui import Ui
from viewer.window.widgets import QUIET, clipped, em, fitted, one_of, paragraph, seen_rows, swatch, tooltip, tooltip_at

_ROWS = 14  # of the tree that are seen at once
_LIGHT = 14.0  # ems of width, at most, for the name of a light


@dataclass
class RaysState:
    """The tree of a pixel's rays: which shadow rays are `shown`, the keys of the rows that are folded otherwise than at
    first and of the `selected` one, the row that the pointer is on, for how many frames it is to `unfold`, the
    window's frame in which it was `drawn` last, and whose rays these are."""

    shown: RayFilter = field(default_factory=RayFilter)
    toggled: frozenset[RayKey] = frozenset()
    selected: RayKey | None = None
    pointed: RayRow | None = None
    unfold: int = 0
    drawn: int = -2
    of: Pick | None = None

    def is_open(self, row: RayRow) -> bool:
        """Whether what is below a row is seen: at first, what is below rays on their way."""
        return (len(row.places) == 0) != (row.key in self.toggled)


def show_rays(ui: Ui) -> None:
    """Show the rays of the clicked pixel."""
    ui.state(RaysState).unfold = 3  # until what is to be scrolled is laid out
    ui.show_panel("Inspector")


def section(ui: Ui) -> None:
    """A part of the panel that folds; rays are listed, and drawn in the picture, where it is open."""
    state, tree, picked = ui.state(RaysState), ui.controller.inspector.tree, ui.controller.selection.picked
    if picked is not state.of:  # what was left out of another pixel's rays may be what one clicked for
        state.of, state.shown = picked, RayFilter()
    imgui.dummy(ImVec2(0.0, em(0.15)))
    if state.unfold:
        imgui.set_next_item_open(True)
    opened = imgui.collapsing_header("Rays")
    tooltip(f"what became of each ray of the clicked pixel{ui.key('Rays of the clicked pixel')}")
    if state.unfold:
        state.unfold -= 1
        imgui.set_scroll_here_y(0.0)
    if opened:
        state.drawn, state.pointed = imgui.get_frame_count(), None
        if ui.controller.selection.picked is None:
            paragraph("Click a pixel to see what became of each of its rays.", QUIET)
        elif tree is None:
            paragraph("The rays are listed when the picture is complete.", QUIET)
        else:
            _tree(ui, tree)
    setting_switch(ui, ALL["draw.rays"])


def are_listed(ui: Ui) -> bool:
    """Whether the panel lists the rays of a clicked pixel now."""
    drawn_now = ui.state(RaysState).drawn >= imgui.get_frame_count() - 1  # the picture may be drawn first
    return drawn_now and ui.controller.selection.picked is not None


def rows(ui: Ui) -> list[tuple[int, RayRow]]:
    """The rows that are seen, with their levels: at first, all that is below rays on their way."""
    state, tree, scene = ui.state(RaysState), ui.controller.inspector.tree, ui.controller.session.scene
    if tree is None or scene is None:
        return []
    top = ui.cached("rows of rays", tree, state.shown, lambda: RayRows(tree, scene, state.shown).top)
    found: list[tuple[int, RayRow]] = ui.cached(
        "rows of rays that are seen", top, state.toggled, lambda: list(unfolded(top, state.is_open))
    )
    return found


# --- the tree ---------------------------------------------------------------------------------------


def _filters(ui: Ui, state: RaysState) -> None:
    """Which shadow rays are listed and drawn."""
    shown = one_of(((one, one.value, SUBSET_HELP[one]) for one in RaySubset), state.shown.shown)
    state.shown = state.shown._replace(shown=shown)
    imgui.set_next_item_width(min(em(_LIGHT), imgui.get_content_region_avail().x))

    def choose(light: int | None) -> None:
        state.shown = state.shown._replace(light=light)

    lights.combo(ui, "rays", state.shown.light, choose, lambda: choose(None))


def _tree(ui: Ui, tree: RayTree) -> None:
    """Those rows that are seen; resting on one picks its rays out in the picture."""
    state = ui.state(RaysState)
    _filters(ui, state)
    height = imgui.get_text_line_height_with_spacing()
    clipped(totals(tree), QUIET)
    if sum(tree.counts.values()) > MOST_DRAWN:
        tooltip(f"{totals(tree)}\n\nAt most {MOST_DRAWN} shadow rays are drawn at once, and the selected one.")
    seen = rows(ui)
    if imgui.begin_child("rows", ImVec2(0.0, min(len(seen) + 0.3, _ROWS) * height)):
        for place in seen_rows(len(seen), height):
            _row(state, *seen[place])
    imgui.end_child()


def _row(state: RaysState, level: int, row: RayRow) -> None:
    """One row: its arrow folds it, a click selects it."""
    flags = imgui.TreeNodeFlags_.no_tree_push_on_open | imgui.TreeNodeFlags_.span_avail_width
    flags |= imgui.TreeNodeFlags_.open_on_arrow | imgui.TreeNodeFlags_.open_on_double_click
    if row.below is None or not row.rows:
        flags |= imgui.TreeNodeFlags_.leaf
    if row.key == state.selected:
        flags |= imgui.TreeNodeFlags_.selected
    imgui.push_id(str(row.key))
    imgui.indent(max(em(0.8) * level, 0.01))
    imgui.set_next_item_open(state.is_open(row))
    imgui.tree_node_ex("##row", int(flags))
    if imgui.is_item_toggled_open():
        state.toggled ^= {row.key}
    elif imgui.is_item_clicked():
        state.selected = None if row.key == state.selected else row.key
    if imgui.is_item_hovered():
        state.pointed = row
    imgui.same_line(0.0, em(0.2))
    if len(row.places):
        swatch(row.color)
    text = fitted(row.text, imgui.get_content_region_avail().x)
    imgui.text_unformatted(text)
    imgui.unindent(max(em(0.8) * level, 0.01))
    imgui.pop_id()
    tip = "\n".join(filter(None, ("" if text == row.text else row.text, row.tip)))
    if state.pointed is row and tip and not imgui.is_mouse_down(0):
        tooltip_at(tip)


# --- the same rays over the picture -------------------------------------------------------------------

MOST_DRAWN = 160  # shadow rays
FAR = 3.0  # times the way to the first hit: how far a ray is drawn that leaves the scene
_BEHIND = 0.4  # opacity of what lies behind something
_FADED = 0.16  # of rays other than the one that is pointed at or selected
_MANY = 40  # lines, from which on they are thin
_MOST_CHOSEN = 64  # shadow rays that stand out together


class Part(Enum):
    """What a line stands for, with its colour and its width in ems."""

    PATH = palette.PATH, 0.2  # a reflected or refracted ray
    TRACED = palette.LIT, 0.16  # a shadow ray that was traced, as far as light comes
    SAVED = palette.LIT, 0.07  # one that was culled, as far as light comes
    BLOCKED = palette.BLOCKED, 0.12  # the rest of a shadow ray, behind what blocks it


class RayLine(NamedTuple):
    """A line of a ray: of which path ray, and which shadow ray of that, -1 for the path ray itself."""

    part: Part
    ray: int
    place: int
    strokes: list[Stroke]


def ray_lines(frame: Frame, tree: RayTree, shown: RayFilter, further: bool = True) -> list[RayLine]:
    """The rays on their way and the shadow rays that a filter lets be seen, MOST_DRAWN of these at most: those of the
    first points first, and of one point evenly.  Not `further`: those of the clicked point alone."""
    lines, left = [], MOST_DRAWN
    for ray in tree.rays if further else tree.rays[:1]:
        if ray.parent >= 0:
            length = ray.t if np.isfinite(ray.t) else FAR * tree.rays[0].t
            way = strokes(frame, [ray.origin, ray.origin + length * ray.direction])
            lines.append(RayLine(Part.PATH, ray.number, -1, way))
        if ray.shadows is None:
            continue
        places = shown.places(ray.shadows)
        places = places[ray.shadows.verdict[places] != AWAY]
        if len(places) > left:
            places = places[np.linspace(0, len(places) - 1, left).astype(int)]
        left -= len(places)
        lines += _shadow_lines(frame, tree, ray.number, places)
    return lines


def _shadow_lines(frame: Frame, tree: RayTree, number: int, places: NDArray[np.int64]) -> list[RayLine]:
    """Shadow rays from their lights to their point, blue behind what blocks them."""
    ray, lines = tree.rays[number], []
    s, end = ray.shadows, ray.end.astype(np.float64)
    assert s is not None
    for one in places.tolist():
        start, part = tree.samples[one].astype(np.float64), Part.TRACED if s.verdict[one] == TRACED else Part.SAVED
        stop = end if s.blocker[one] < 0 else start + float(s.blocked_at[one]) * (end - start)
        lines.append(RayLine(part, number, one, strokes(frame, [start, stop])))
        if s.blocker[one] >= 0:
            lines.append(RayLine(Part.BLOCKED, number, one, strokes(frame, [stop, end])))
    return lines


def draw(ui: Ui, made: Pen, frame: Frame) -> None:
    """Draw the rays that are listed or, where none are, the shadow rays of the clicked point; those of the rows and of
    the light that are selected or pointed at stand out."""
    state, pointed, c = ui.state(RaysState), ui.state(Pointed), ui.controller
    (of, light), pointed.light = (0, pointed.light), None  # the panel says so in each frame
    step = c.stepping.step_in(frame)
    if light is None and step is not None and step.part.light >= 0:
        of, light = step.part.ray, step.part.light
    tree, listed = c.inspector.tree, are_listed(ui)
    if tree is None or c.selection.picked is None or not (listed or c.session.draw.rays):
        return
    shown = state.shown if listed else RayFilter()
    lines: list[RayLine] = ui.cached(
        "rays", frame, (tree, shown, listed), lambda: ray_lines(frame, tree, shown, listed)
    )
    selected = next((row for _, row in rows(ui) if row.key == state.selected), None) if listed else None
    chosen = [row for row in (selected, state.pointed) if row is not None and listed]
    standing_out: list[RayLine] = ui.cached(
        "rays that stand out", lines, (chosen, of, light), lambda: _standing_out(tree, frame, lines, chosen, of, light)
    )
    for line in lines:
        _line(made, line, _FADED if standing_out else 1.0, 0.55 if len(lines) > _MANY else 1.0)
    for line in standing_out:
        _line(made, line, 1.0)
    _points(made, tree, frame, chosen[-1] if chosen else None, listed)


def _standing_out(
    tree: RayTree, frame: Frame, lines: Sequence[RayLine], chosen: Sequence[RayRow], of: int, light: int | None
) -> list[RayLine]:
    """The lines of chosen rows' rays, and of the shadow rays to a light from where ray number `of` ends."""
    found = [line for row in chosen for line in lines if line.ray == row.ray and line.place < 0 and not len(row.places)]
    groups = [(row.ray, row.places) for row in chosen if len(row.places)]
    s = tree.rays[of].shadows if of < len(tree.rays) else None
    if light is not None and s is not None:
        groups.append((of, RayFilter(RaySubset.ALL, light).places(s)))
    for ray, places in groups:
        found += _shadow_lines(frame, tree, ray, places[:: -(-len(places) // _MOST_CHOSEN) or 1])
    return found


def _line(made: Pen, line: RayLine, alpha: float, width: float = 1.0) -> None:
    color, ems = line.part.value
    around = WHITE if line.part is Part.BLOCKED else SHADE
    made.strokes(line.strokes, ImVec4(*color, alpha), width * ems, _BEHIND, around)


def _points(made: Pen, tree: RayTree, frame: Frame, chosen: RayRow | None, further: bool) -> None:
    """A ring around each point that is shaded, a larger one at the clicked one; a cross where the chosen ray ends."""
    for ray in tree.rays if further else tree.rays[:1]:
        at = place(frame, ray.end) if ray.shadows is not None else None
        if at is not None:
            alpha = 1.0 if chosen is None or chosen.ray == ray.number else 0.5
            made.ring(at, None if ray.parent < 0 else 0.26, alpha)
    if chosen is None or len(chosen.places) != 1:
        return
    ray, one = tree.rays[chosen.ray], int(chosen.places[0])
    s = ray.shadows
    if s is not None and s.blocker[one] >= 0:
        start = tree.samples[one]
        at = place(frame, start + s.blocked_at[one] * (ray.end - start))
        if at is not None:
            made.cross(at, ImVec4(*palette.BLOCKED, 1.0))
