"""Over the picture, for what was clicked: its rays to the lights and what blocks them, what hides it, and where it
is itself."""

from __future__ import annotations

from imgui_bundle import ImVec2, ImVec4

from tracer.culling.fate import Fate
from tracer.culling.modes import ShadowMode
from tracer.frame import Frame
from tracer.reasons import Why
from viewer.services.inspector import Inspection, drawn_primitives
from viewer.state.palette import FATE_COLORS, SHADOW_COLORS
from viewer.state.picking import outline_of, part_points, primitive_points
from viewer.state.projection import Stroke, place, strokes
from viewer.window.panels import rays
from viewer.window.panels.area import Area
from viewer.window.panels.links import Pointed
from viewer.window.panels.marks import Pen, pen
from viewer.window.ui import Ui
from viewer.window.widgets import em

LIT, STOPPED = SHADOW_COLORS[ShadowMode.NON_SHADOW], (0.34, 0.71, 0.91)
BLOCKER, OCCLUDER = SHADOW_COLORS[ShadowMode.PARTIAL_SHADOW], (0.90, 0.62, 0.0)
"""Colours of a shadow ray as far as light comes, of its rest, of what blocks it, and of what a certificate names."""
_FADED = 0.18  # opacity of other lights than the one that is pointed at
_OUTLINE = 0.13  # width in ems
_HIDER, _WHITE = ImVec4(*FATE_COLORS[Fate.PARTLY_OCCLUDED], 1.0), ImVec4(1.0, 1.0, 1.0, 1.0)
_SAME, _MISSED = ImVec4(0.6, 0.64, 0.7, 1.0), ImVec4(0.3, 0.85, 0.95, 1.0)
_SIDE = 0.5  # ems, of a pixel's square at least


def show(ui: Ui, area: Area) -> None:
    """Draw all that is to be seen of what was clicked, or is pointed at."""
    c = ui.controller
    state = ui.state(Pointed)
    pointed, state.light = state.light, None  # the inspector says so in each frame
    frame = c.frame
    if frame is None:
        return
    with pen(area, frame) as made:
        picked, answer = c.selection.picked, c.inspector.answer
        tree = rays.listed(ui)
        if tree is not None:  # it has the same rays, and more
            rays.draw(ui, made, frame, tree)
        elif picked is not None and answer is not None and c.session.draw.rays:
            _shadow_rays(ui, made, frame, answer, pointed)
        _why(ui, made, frame)
        _occluded_selection(ui, made, frame)


Line = tuple[tuple[float, float, float], float, int, list[Stroke]]
"""Colour, width in ems, light and strokes."""


def shadow_lines(answer: Inspection, frame: Frame) -> list[Line]:
    """Outlines of what is named, then, for each light that is drawn, its ray to the point as far as it gets, and on."""
    lines: list[Line] = []
    for one in answer.drawn:
        for number in drawn_primitives(one):
            color, width = (BLOCKER, 0.16) if number == one.blocker else (OCCLUDER, 0.1)
            lines += [(color, width, one.light, strokes(frame, line)) for line in answer.outlines[number]]
    for one in answer.drawn:
        end = one.point if one.blocked_at is None else one.blocked_at
        lines.append((LIT, 0.13, one.light, strokes(frame, [one.light_position, end])))
        if one.blocked_at is not None:
            lines.append((STOPPED, 0.13, one.light, strokes(frame, [one.blocked_at, one.point])))
    return lines


def _shadow_rays(ui: Ui, made: Pen, frame: Frame, answer: Inspection, pointed: int | None) -> None:
    """The lights' rays to the point, with a disc at each light and a cross where its ray ends before the point."""

    def alpha(light: int) -> float:
        return 1.0 if pointed in (None, light) else _FADED

    point = place(frame, answer.lights[0].point) if answer.lights else None
    lines: list[Line] = ui.cached("shadow rays", frame, answer, lambda: shadow_lines(answer, frame))
    for color, width, light, pieces in lines:
        made.strokes(pieces, ImVec4(*color, alpha(light)), width, hole=point)
    for one in answer.drawn:
        at = place(frame, one.light_position)
        if at is not None:
            made.disc(at, ImVec4(*LIT, alpha(one.light)), 0.3)
        stop = place(frame, one.blocked_at) if one.blocked_at is not None else None
        if stop is not None:
            made.cross(stop, ImVec4(*BLOCKER, alpha(one.light)))
    if point is not None:
        made.ring(point)


# --- why -------------------------------------------------------------------------------------------


def _why(ui: Ui, made: Pen, frame: Frame) -> None:
    """What hides the clicked primitive, where, the pixels that the clicked one is compared with, and what the pointer's
    link stands for."""
    c = ui.controller
    state = ui.state(Pointed)
    link, state.link = state.link, None  # the panel says so in each frame
    found, in_place = c.inspector.why, c.inspector.names_pixels_of(frame)
    if c.selection.picked is not None and c.session.draw.rays and found is not None:
        by = None if found.coverage is None else found.coverage.occluded
        if by is not None and not by.at_edge and by.primitive >= 0:
            _outline(ui, made, frame, by.primitive, _HIDER, "occluder")
        if by is not None and in_place and by.pixel != (found.x, found.y):
            made.square(*_square_of(made, frame, by.pixel), _HIDER)
        if in_place and c.selection.pixel == (found.x, found.y):
            _figure_3(made, frame, found)
    if link is not None and link.primitive is not None:
        _outline(ui, made, frame, link.primitive, _WHITE, "pointed link")
    if link is not None and link.pixel is not None and link.frame is None and in_place:
        made.square(*_square_of(made, frame, link.pixel), _WHITE)


def _outline(ui: Ui, made: Pen, frame: Frame, primitive: int, color: ImVec4, name: str) -> None:
    scene = ui.controller.session.scene
    if scene is not None and primitive < scene.primitive_count:

        def lines() -> list[Stroke]:
            return _projected(frame, outline_of(primitive_points(scene, primitive, frame.time)))

        pieces = ui.cached(name, frame, primitive, lines)
        made.strokes(pieces, color, _OUTLINE)


def _projected(frame: Frame, lines: list) -> list[Stroke]:
    return [stroke for line in lines for stroke in strokes(frame, line)]


def _figure_3(made: Pen, frame: Frame, found: Why) -> None:
    """The clicked pixel and its left and upper neighbours, as in the paper's Figure 3; where pixels are small, larger
    than they are."""
    middle, (width, height) = _square_of(made, frame, (found.x, found.y))
    for one in found.references:
        color = _HIDER if one.occluded else _MISSED if one.tested else _SAME
        across, down = one.pixel[0] - found.x, one.pixel[1] - found.y
        made.square(ImVec2(middle.x + across * width, middle.y + down * height), (width, height), color)
    if found.references:
        made.square(middle, (width, height), _WHITE)


def _square_of(made: Pen, frame: Frame, pixel: tuple[int, int]) -> tuple[ImVec2, tuple[float, float]]:
    """The middle of a pixel on the screen, and the size of its square there."""
    middle = made.to_screen((pixel[0] + 0.5) / frame.width, (pixel[1] + 0.5) / frame.height)
    return middle, (max(made.pixel[0], em(_SIDE)), max(made.pixel[1], em(_SIDE)))


# --- what is selected -------------------------------------------------------------------------------


def _occluded_selection(ui: Ui, made: Pen, frame: Frame) -> None:
    """Where what is selected lies behind something, as dashed lines."""
    c = ui.controller
    now, picked, part, at = c.session.edited, c.selection.picked, c.selection.part, c.selection.pixel
    if now is None or picked is None:
        return
    if at is not None and (part is not None or frame.primitive[at[1], at[0]] == picked.primitive):
        return

    def lines() -> list[Stroke]:
        points = primitive_points(now.scene, picked.primitive, frame.time)
        return _projected(frame, outline_of(points if part is None else part_points(now, part, frame.time)))

    made.strokes(ui.cached("occluded selection", frame, (picked.primitive, part), lines), _WHITE, 0.12, behind=0.75)
