"""Over the picture: the rays that the panel lists, the selected one picked out.

Rays are drawn on their way, and shadow rays as far as light comes, and on."""

from __future__ import annotations

from collections.abc import Sequence
from enum import Enum
from typing import NamedTuple

import numpy as np
from imgui_bundle import ImVec4

from tracer.frame import Frame
from tracer.told_rays import AWAY, TRACED, RayTree
from viewer.output.ray_rows import Filter, Row
from viewer.state.projection import Stroke, place, strokes
from viewer.window.panels.marks import SHADE, Pen, Point
from viewer.window.ui import Ui

MOST_DRAWN = 160  # shadow rays
FAR = 3.0  # times the way to the first hit: how far a ray is drawn that leaves the scene


class Part(Enum):
    """What a line stands for, with its colour and its width in ems."""

    PATH = (0.36, 0.93, 0.72), 0.2  # a reflected or refracted ray
    ASKED = (0.98, 0.87, 0.25), 0.15  # a shadow ray that was traced, as far as light comes
    SAVED = (0.98, 0.93, 0.66), 0.08  # one that was culled, as far as light comes
    DARK = (0.06, 0.10, 0.24), 0.13  # the rest of a shadow ray, behind what blocks it


class RayLine(NamedTuple):
    """A line of a ray: of which path ray, and which shadow ray of that, -1 for the path ray itself."""

    part: Part
    ray: int
    place: int
    strokes: list[Stroke]


def ray_lines(frame: Frame, tree: RayTree, shown: Filter) -> list[RayLine]:
    """The rays on their way and the shadow rays that a filter lets be seen, MOST_DRAWN of these at most: those of the
    first points first, and of one point evenly."""
    lines, left = [], MOST_DRAWN
    for ray in tree.rays:
        if ray.parent >= 0:
            length = ray.t if np.isfinite(ray.t) else FAR * tree.rays[0].t
            lines.append(
                RayLine(Part.PATH, ray.number, -1, strokes(frame, [ray.origin, ray.origin + length * ray.direction]))
            )
        if ray.shadows is None:
            continue
        s = ray.shadows
        places = shown.places(s)
        places = places[s.verdict[places] != AWAY]
        if len(places) > left:
            places = places[np.linspace(0, len(places) - 1, left).astype(int)] if left else places[:0]
        left -= len(places)
        for number in places.tolist():
            lines += shadow_lines(frame, tree, ray.number, number)
    return lines


def shadow_lines(frame: Frame, tree: RayTree, number: int, place: int) -> list[RayLine]:
    """A shadow ray from its light to its point."""
    ray = tree.rays[number]
    s = ray.shadows
    assert s is not None
    start, end = tree.samples[place].astype(np.float64), ray.end.astype(np.float64)
    part = Part.ASKED if s.verdict[place] == TRACED else Part.SAVED
    if s.blocker[place] < 0:
        return [RayLine(part, number, place, strokes(frame, [start, end]))]
    stop = start + float(s.blocked_at[place]) * (end - start)
    return [
        RayLine(part, number, place, strokes(frame, [start, stop])),
        RayLine(Part.DARK, number, place, strokes(frame, [stop, end])),
    ]


_BEHIND = 0.4  # opacity of what lies behind something
_FADED = 0.16  # of rays other than the one that is pointed at or selected
_BLOCKED = ImVec4(0.84, 0.37, 0.0, 1.0)
_PALE = ImVec4(0.8, 0.86, 1.0, 0.35)  # around what is dark
_MANY = 40  # lines, from which on they are thin
_MOST_OF_A_ROW = 64  # shadow rays of a row that are picked out


def draw(ui: Ui, made: Pen, frame: Frame, alpha: float) -> None:
    """Draw all rays, so transparent, and those of the rows that are selected or pointed at over them."""
    rays = ui.controller.rays
    tree = rays.tree
    if tree is None:
        return
    picked_out = [row for row in (rays.selected, rays.pointed) if row is not None]
    lines: list[RayLine] = ui.cached("rays", frame, (tree, rays.shown), lambda: ray_lines(frame, tree, rays.shown))
    clicked = place(frame, tree.rays[0].end) if tree.rays[0].shadows is not None else None
    for line in lines:
        _line(made, line, clicked, _FADED if picked_out else alpha, 0.55 if len(lines) > _MANY else 1.0)
    for row in picked_out:
        for line in _of_row(tree, frame, lines, row):
            _line(made, line, clicked, 1.0)
    _points(made, tree, frame, rays.pointed or rays.selected)


def _of_row(tree: RayTree, frame: Frame, lines: Sequence[RayLine], row: Row) -> list[RayLine]:
    """The lines of a row's rays."""
    if not len(row.places):
        return [line for line in lines if line.ray == row.ray and line.place < 0]
    wanted = row.places[:: -(-len(row.places) // _MOST_OF_A_ROW)].tolist()
    known = {line.place for line in lines if line.ray == row.ray}
    found = [line for line in lines if line.ray == row.ray and line.place in wanted]
    for missing in (one for one in wanted if one not in known):
        found += shadow_lines(frame, tree, row.ray, missing)
    return found


def _line(made: Pen, line: RayLine, hole: Point | None, alpha: float, width: float = 1.0) -> None:
    """All of it but what would cover the clicked pixel."""
    color, ems = line.part.value
    around = _PALE if line.part is Part.DARK else SHADE
    made.strokes(line.strokes, ImVec4(*color, alpha), width * ems, _BEHIND, around, hole=hole)


def _points(made: Pen, tree: RayTree, frame: Frame, chosen: Row | None) -> None:
    """A ring around each point that is shaded, a larger one at the clicked one; a cross where the chosen ray ends."""
    for ray in tree.rays:
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
            made.cross(at, _BLOCKED)
