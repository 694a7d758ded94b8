"""Over the picture, for what was clicked: the lights' ways to it, and what blocks them."""

from __future__ import annotations

from collections.abc import Callable

from imgui_bundle import ImVec2, ImVec4, imgui

from tracer.culling.modes import ShadowMode
from tracer.frame import Frame
from viewer.services.shadow_inspector import Answer, Part
from viewer.state.palette import SHADOW_COLORS
from viewer.state.projection import place
from viewer.window.panels import marks
from viewer.window.panels.marks import SHADE, with_alpha
from viewer.window.ui import Ui
from viewer.window.widgets import em

_LIT, _STOPPED = SHADOW_COLORS[ShadowMode.NON_SHADOW], (0.34, 0.71, 0.91)
_BLOCKER = SHADOW_COLORS[ShadowMode.PARTIAL_SHADOW]
_COLORS = {Part.REACHING: _LIT, Part.STOPPED: _STOPPED, Part.BLOCKER: _BLOCKER, Part.OCCLUDER: (0.90, 0.62, 0.0)}
_WIDTHS = {Part.REACHING: 0.13, Part.STOPPED: 0.13, Part.BLOCKER: 0.16, Part.OCCLUDER: 0.1}  # in ems
_UNSEEN = 0.6  # of the width of what is seen
_FADED = 0.18  # opacity of other lights than the one that is pointed at
_BESIDE = 0.2  # and of all of them where clusters of lights are drawn over them


def show(ui: Ui, corner: ImVec2, end: ImVec2) -> None:
    """Over the picture: the lights' ways to the point, and outlines of what blocks them."""
    c = ui.controller
    pointed, ui.pointed_light = ui.pointed_light, None  # the inspector says so in each frame
    answer, frame = c.inspector.answer, c.frame
    if answer is None or frame is None or c.selection.picked is None or not c.preferences.draw_explanation:
        return
    width, height = end.x - corner.x, end.y - corner.y

    def on_screen(at: tuple[float, float]) -> ImVec2:
        return ImVec2(corner.x + at[0] * width, corner.y + at[1] * height)

    draw = imgui.get_window_draw_list()
    draw.push_clip_rect(corner, end, True)
    lines, beside = c.inspector.lines(frame), _BESIDE if c.cuts.cut is not None else 1.0
    point = place(frame, answer.lights[0].point) if answer.lights else None
    centre = on_screen(point) if point is not None else None
    radius = marks.radius_around_pixel(width / frame.width, height / frame.height)
    for shade in (True, False):
        for part, light, strokes in lines:
            alpha = beside if pointed is None else 1.0 if pointed == light else _FADED
            color = imgui.get_color_u32(with_alpha(SHADE, alpha) if shade else ImVec4(*_COLORS[part], alpha))
            for stroke in strokes:
                wide = em(_WIDTHS[part]) * (1.0 if stroke.seen else _UNSEEN) + (em(0.12) if shade else 0.0)
                ends = on_screen(stroke.start), on_screen(stroke.end)
                for start, stop in [ends] if centre is None else marks.outside(*ends, centre, radius):
                    draw.add_line(start, stop, color, max(1.0, wide))
    _ends(answer, frame, pointed, beside, on_screen, draw)
    if centre is not None:
        marks.ring(draw, centre, radius)
    draw.pop_clip_rect()


def _ends(
    answer: Answer,
    frame: Frame,
    pointed: int | None,
    beside: float,
    on_screen: Callable[[tuple[float, float]], ImVec2],
    draw: imgui.ImDrawList,
) -> None:
    """A disc at each light that is drawn, and a cross where its way ends before the point."""
    for one in answer.drawn:
        alpha = beside if pointed is None else 1.0 if pointed == one.light else _FADED
        at = place(frame, one.light_position)
        if at is not None:
            draw.add_circle_filled(on_screen(at), em(0.42), imgui.get_color_u32(with_alpha(SHADE, alpha)))
            draw.add_circle_filled(on_screen(at), em(0.3), imgui.get_color_u32(ImVec4(*_LIT, alpha)))
        stop = place(frame, one.blocked_at) if one.blocked_at is not None else None
        if stop is not None:
            marks.cross(draw, on_screen(stop), ImVec4(*_BLOCKER, alpha))
