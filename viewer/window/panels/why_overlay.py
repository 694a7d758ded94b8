"""Over the picture: what hides the clicked primitive, where, and the pixels that the clicked pixel is compared with."""

from __future__ import annotations

from collections.abc import Callable

from imgui_bundle import ImVec2, ImVec4, imgui

from tracer.culling.fate import Fate
from tracer.frame import Frame
from tracer.reasons import Why
from viewer.state.palette import FATE_COLORS
from viewer.state.projection import Stroke, strokes
from viewer.state.whereabouts import lines_of
from viewer.window.panels import marks
from viewer.window.panels.area import Area
from viewer.window.panels.marks import SHADE, with_alpha
from viewer.window.ui import Ui
from viewer.window.widgets import em

_HIDER = ImVec4(*FATE_COLORS[Fate.PARTLY_OCCLUDED], 1.0)
_POINTED = ImVec4(1.0, 1.0, 1.0, 1.0)
_CURRENT, _SAME, _MISSED = ImVec4(1.0, 1.0, 1.0, 1.0), ImVec4(0.6, 0.64, 0.7, 1.0), ImVec4(0.3, 0.85, 0.95, 1.0)
_DARK = ImVec4(0.03, 0.04, 0.05, 0.9)
_SIDE = 0.5  # in ems, of a pixel's square at least
_WIDTH = 0.13  # of outlines


def show(ui: Ui, area: Area) -> None:
    """Draw it, and what the pointer's link stands for."""
    c = ui.controller
    link, ui.pointed_link = ui.pointed_link, None  # the panel says so in each frame
    frame, found = c.frame, c.inspector.why
    if frame is None:
        return
    in_place = c.inspector.names_pixels_of(frame)
    draw = imgui.get_window_draw_list()
    draw.push_clip_rect(area.corner, area.end, True)
    if c.selection.picked is not None and c.preferences.draw_explanation and found is not None:
        _hider(ui, draw, area, frame, found, in_place)
        if in_place and c.selection.pixel == (found.x, found.y):
            _figure_3(draw, area, frame, found)
    if link is not None and link.primitive is not None:
        _outline(ui, draw, area, frame, link.primitive, _POINTED, "pointed link")
    if link is not None and link.pixel is not None and link.frame is None and in_place:
        _square(draw, *_place(area, frame, link.pixel), _POINTED)
    draw.pop_clip_rect()


def _hider(ui: Ui, draw: imgui.ImDrawList, area: Area, frame: Frame, found: Why, in_place: bool) -> None:
    """The outline of what hides the primitive, and the pixel at which it does where that is still `in_place`."""
    by = None if found.coverage is None else found.coverage.occluded
    if by is None:
        return
    if not by.at_edge and by.primitive >= 0:
        _outline(ui, draw, area, frame, by.primitive, _HIDER, "hider")
    if in_place and by.pixel != (found.x, found.y):
        _square(draw, *_place(area, frame, by.pixel), _HIDER)


def _outline(
    ui: Ui, draw: imgui.ImDrawList, area: Area, frame: Frame, primitive: int, color: ImVec4, name: str
) -> None:
    scene = ui.controller.session.scene
    if scene is None or primitive >= scene.primitive_count:
        return
    made: Callable[[], list[Stroke]] = lambda: [  # noqa: E731
        stroke for line in lines_of(scene, primitive, frame.time) for stroke in strokes(frame, line)
    ]
    for stroke in ui.cached(name, frame, primitive, made):
        alpha = 1.0 if stroke.seen else 0.6
        a, b = area.to_screen(*stroke.start), area.to_screen(*stroke.end)
        marks.line(draw, a, b, with_alpha(color, alpha), _WIDTH, with_alpha(SHADE, alpha))


def _figure_3(draw: imgui.ImDrawList, area: Area, frame: Frame, found: Why) -> None:
    """The clicked pixel and its left and upper neighbours, as in the paper's Figure 3; where pixels are small, larger
    than they are."""
    middle, (width, height) = _place(area, frame, (found.x, found.y))
    for one in found.references:
        color = _HIDER if one.occluded else _MISSED if one.tested else _SAME
        across, down = one.pixel[0] - found.x, one.pixel[1] - found.y
        _square(draw, ImVec2(middle.x + across * width, middle.y + down * height), (width, height), color)
    if found.references:
        _square(draw, middle, (width, height), _CURRENT)


def _place(area: Area, frame: Frame, pixel: tuple[int, int]) -> tuple[ImVec2, tuple[float, float]]:
    """The middle of a pixel on the screen, and the size of its square there."""
    middle = area.to_screen((pixel[0] + 0.5) / frame.width, (pixel[1] + 0.5) / frame.height)
    size = area.whole_size
    return middle, (max(size.x / frame.width, em(_SIDE)), max(size.y / frame.height, em(_SIDE)))


def _square(draw: imgui.ImDrawList, middle: ImVec2, size: tuple[float, float], color: ImVec4) -> None:
    half = 0.5 * size[0] - 1.0, 0.5 * size[1] - 1.0
    start, end = ImVec2(middle.x - half[0], middle.y - half[1]), ImVec2(middle.x + half[0], middle.y + half[1])
    draw.add_rect(start, end, imgui.get_color_u32(_DARK), 0.0, max(3.0, em(0.2)))
    draw.add_rect(start, end, imgui.get_color_u32(color), 0.0, max(1.0, em(0.1)))
