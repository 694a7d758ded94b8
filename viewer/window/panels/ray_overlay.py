"""Over the picture: the rays that the panel lists, the selected one picked out, and the node that it is in."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from imgui_bundle import ImVec2, ImVec4, imgui

from tracer.frame import Frame
from viewer.output.ray_rows import Row
from viewer.services.ray_inspector import RayInspector
from viewer.state.palette import Color
from viewer.state.projection import Stroke, place
from viewer.state.ray_lines import Part, RayLine, box_strokes, shadow_lines, way_strokes
from viewer.window.panels import marks
from viewer.window.panels.marks import SHADE, with_alpha
from viewer.window.ui import Ui

_COLORS: dict[Part, Color] = {
    Part.PATH: (0.36, 0.93, 0.72),
    Part.ASKED: (0.98, 0.87, 0.25),
    Part.SAVED: (0.98, 0.93, 0.66),
    Part.DARK: (0.06, 0.10, 0.24),
}
_WIDTHS = {Part.PATH: 0.2, Part.ASKED: 0.15, Part.SAVED: 0.08, Part.DARK: 0.13}  # in ems
_BEHIND = 0.4  # opacity of what lies behind something
_FADED = 0.16  # of rays other than the one that is pointed at or selected
_BESIDE = 0.2  # of all rays where clusters of lights are drawn over them
_BLOCKED = ImVec4(0.84, 0.37, 0.0, 1.0)
_PALE = ImVec4(0.8, 0.86, 1.0, 0.35)  # around what is dark
BOX, HIT_BOX, WAY = (1.0, 0.62, 0.10), (1.0, 0.25, 0.30), (1.0, 1.0, 1.0)
"""A node's box, one in which the ray hits something, and the part of the ray in it."""
_DARK = ImVec4(0.02, 0.02, 0.03, 0.9)  # around a box, which is to be seen on wood and on brick
_MANY = 40  # lines, from which on they are thin
_MOST_OF_A_ROW = 64  # shadow rays of a row that are picked out


def show(ui: Ui, corner: ImVec2, end: ImVec2) -> None:
    """Draw on the picture that fills the rectangle from a corner to its end."""
    rays, frame = ui.controller.rays, ui.controller.frame
    if frame is None or rays.tree is None:
        return
    width, height = end.x - corner.x, end.y - corner.y

    def on_screen(at: tuple[float, float]) -> ImVec2:
        return ImVec2(corner.x + at[0] * width, corner.y + at[1] * height)

    draw = imgui.get_window_draw_list()
    draw.push_clip_rect(corner, end, True)
    picked_out = [row for row in (rays.selected, rays.pointed) if row is not None]
    lines = rays.lines(frame)
    thin, beside = 0.55 if len(lines) > _MANY else 1.0, _BESIDE if ui.controller.cuts.cut is not None else 1.0
    clicked = place(frame, rays.tree.rays[0].end) if rays.tree.rays[0].shadows is not None else None
    radius = marks.radius_around_pixel(width / frame.width, height / frame.height)
    hole = (on_screen(clicked), radius) if clicked is not None else None
    for line in lines:
        _line(draw, on_screen, line, hole, _FADED if picked_out else beside, thin)
    for row in picked_out:
        for line in _of_row(rays, frame, lines, row):
            _line(draw, on_screen, line, hole, 1.0)
    _points(draw, on_screen, rays, frame, rays.pointed or rays.selected, radius)
    _node(draw, on_screen, rays, frame)
    draw.pop_clip_rect()


def _of_row(rays: RayInspector, frame: Frame, lines: Sequence[RayLine], row: Row) -> list[RayLine]:
    """The lines of a row's rays."""
    if not len(row.places):
        return [line for line in lines if line.ray == row.ray and line.place < 0]
    assert rays.tree is not None
    wanted = row.places[:: -(-len(row.places) // _MOST_OF_A_ROW)].tolist()
    known = {line.place for line in lines if line.ray == row.ray}
    found = [line for line in lines if line.ray == row.ray and line.place in wanted]
    for missing in (one for one in wanted if one not in known):
        found += shadow_lines(frame, rays.tree, row.ray, missing)
    return found


def _line(
    draw: imgui.ImDrawList,
    on_screen: Callable,
    line: RayLine,
    hole: tuple[ImVec2, float] | None,
    alpha: float,
    width: float = 1.0,
) -> None:
    """All of it but what would cover the clicked pixel, within so many ems of a point."""
    around = _PALE if line.part is Part.DARK else SHADE
    for stroke in line.strokes:
        seen = alpha * (1.0 if stroke.seen else _BEHIND)
        a, b, color = on_screen(stroke.start), on_screen(stroke.end), ImVec4(*_COLORS[line.part], seen)
        for start, end in [(a, b)] if hole is None else marks.outside(a, b, *hole):
            marks.line(draw, start, end, color, width * _WIDTHS[line.part], with_alpha(around, seen))


def _points(
    draw: imgui.ImDrawList,
    on_screen: Callable,
    rays: RayInspector,
    frame: Frame,
    chosen: Row | None,
    radius: float,
) -> None:
    """A ring around each point that is shaded, a larger one at the clicked one; a cross where the chosen ray ends."""
    assert rays.tree is not None
    for ray in rays.tree.rays:
        at = place(frame, ray.end) if ray.shadows is not None else None
        if at is not None:
            alpha = 1.0 if chosen is None or chosen.ray == ray.number else 0.5
            marks.ring(draw, on_screen(at), radius if ray.parent < 0 else 0.26, alpha)
    if chosen is None or len(chosen.places) != 1:
        return
    ray, one = rays.tree.rays[chosen.ray], int(chosen.places[0])
    s = ray.shadows
    if s is not None and s.blocker[one] >= 0:
        start = rays.tree.samples[one]
        at = place(frame, start + s.blocked_at[one] * (ray.end - start))
        if at is not None:
            marks.cross(draw, on_screen(at), _BLOCKED)


def _node(draw: imgui.ImDrawList, on_screen: Callable, rays: RayInspector, frame: Frame) -> None:
    """The box of the node that is looked at, and the part of the ray in it."""
    row, visits = rays.selected, rays.visits
    if row is None or rays.tree is None or not visits or rays.step >= len(visits):
        return
    visit, known = visits[rays.step], rays.tree
    one = int(row.places[0]) if len(row.places) else None
    _strokes(draw, on_screen, box_strokes(frame, visit), HIT_BOX if visit.hits else BOX, 0.2)
    _strokes(draw, on_screen, way_strokes(frame, known, row.ray, one, visit), WAY, 0.28)


def _strokes(draw: imgui.ImDrawList, on_screen: Callable, pieces: Sequence[Stroke], color: Color, width: float) -> None:
    for stroke in pieces:
        alpha = 1.0 if stroke.seen else 0.55
        a, b = on_screen(stroke.start), on_screen(stroke.end)
        marks.line(draw, a, b, ImVec4(*color, alpha), width, with_alpha(_DARK, alpha), rim=0.11)
