"""Where the picture is shown: a rectangle of the screen, with the zoom in it; words on it, and a pen
that draws over it."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property

from imgui_bundle import ImVec2, ImVec4, imgui

from tracer.frame import Frame
from tracer.inspect.projection import Stroke
from viewer.state.palette import DARK, LIGHT
from viewer.state.pixels import Zoom
from viewer.window.widgets import em

BACK, FRONT = ImVec4(*DARK, 0.9), ImVec4(*LIGHT, 1.0)
_PAD, _RIM = 0.4, 0.06  # ems around words, and around strokes
SHADE, WHITE = ImVec4(*DARK, 0.6), ImVec4(1.0, 1.0, 1.0, 1.0)
"""Around what is drawn, so that it is seen on any picture: around light colours, and around blue."""


@dataclass(frozen=True)
class Area:
    """A rectangle of the screen from `corner` on, and the zoom in it.  `whole` is the rectangle that all of the picture
    would take, which is larger when it is zoomed into."""

    corner: ImVec2
    size: ImVec2
    zoom: Zoom

    @cached_property
    def end(self) -> ImVec2:
        return ImVec2(self.corner.x + self.size.x, self.corner.y + self.size.y)

    @cached_property
    def whole_size(self) -> ImVec2:
        return ImVec2(self.size.x * self.zoom.scale, self.size.y * self.zoom.scale)

    @cached_property
    def whole(self) -> ImVec2:
        size = self.whole_size
        return ImVec2(self.corner.x - self.zoom.left * size.x, self.corner.y - self.zoom.top * size.y)

    def to_picture(self, x: float, y: float) -> tuple[float, float]:
        """The point of the picture, 0 to 1 from left and top, at a point of the screen."""
        return self.zoom.to_picture((x - self.corner.x) / self.size.x, (y - self.corner.y) / self.size.y)

    def to_screen(self, u: float, v: float) -> ImVec2:
        """The point of the screen that shows a point of the picture."""
        corner, size = self.whole, self.whole_size
        return ImVec2(corner.x + u * size.x, corner.y + v * size.y)


def size_of(lines: Sequence[str]) -> tuple[float, float]:
    """The size of a few lines with the ground that they are written on."""
    width = max(imgui.calc_text_size(text).x for text in lines)
    return width + 2.0 * em(_PAD), imgui.get_text_line_height() * len(lines) + 2.0 * em(_PAD)


def write_lines(lines: Sequence[str], at: ImVec2, color: ImVec4 = FRONT) -> None:
    """Write a few lines on a dark ground, from a corner on."""
    (width, height), pad, draw = size_of(lines), em(_PAD), imgui.get_window_draw_list()
    draw.add_rect_filled(at, ImVec2(at.x + width, at.y + height), imgui.get_color_u32(BACK), em(0.3))
    for number, text in enumerate(lines):
        below = number * imgui.get_text_line_height()
        draw.add_text(ImVec2(at.x + pad, at.y + pad + below), imgui.get_color_u32(color), text)


def pointer() -> ImVec2:
    """The middle of the pixel of the screen that the pointer is on."""
    mouse = imgui.get_io().mouse_pos
    return ImVec2(mouse.x + 0.5, mouse.y + 0.5)


class Pen:
    """Draws over the picture of a frame: points are 0 to 1 from left and top, widths in ems.  `radius` is that of a
    ring around a pixel which covers none of it."""

    def __init__(self, area: Area, frame: Frame) -> None:
        self.area, self.draw = area, imgui.get_window_draw_list()
        self.to_screen = area.to_screen
        self.pixel = area.whole_size.x / frame.width, area.whole_size.y / frame.height
        self.radius = max(0.4, 0.5 * math.hypot(*self.pixel) / em(1.0) + 0.2)

    def strokes(
        self, strokes: Iterable[Stroke], color: ImVec4, width: float, behind: float = 0.6, around: ImVec4 = SHADE
    ) -> None:
        """Draw strokes with a rim `around` them; what lies behind something has the opacity `behind`."""
        edge = ImVec4(around.x, around.y, around.z, around.w * color.w)
        outer, inner = (  # of what lies behind something, and of what is seen
            [imgui.get_color_u32(ImVec4(one.x, one.y, one.z, one.w * alpha)) for alpha in (behind, 1.0)]
            for one in (edge, color)
        )
        for stroke in strokes:
            a, b = self.to_screen(*stroke.start), self.to_screen(*stroke.end)
            self.draw.add_line(a, b, outer[stroke.seen], em(width + 2.0 * _RIM))
            self.draw.add_line(a, b, inner[stroke.seen], max(1.0, em(width)))

    def ring(self, at: tuple[float, float], radius: float | None = None, alpha: float = 1.0) -> None:
        """Draw a white ring, around a pixel unless it has another radius."""
        centre, size = self.to_screen(*at), em(self.radius if radius is None else radius)
        self.draw.add_circle(centre, size, imgui.get_color_u32(SHADE), 0, em(0.22))
        self.draw.add_circle(centre, size, imgui.get_color_u32(ImVec4(1.0, 1.0, 1.0, alpha)), 0, em(0.1))

    def cross(self, at: tuple[float, float], color: ImVec4) -> None:
        """Draw a cross, where light is blocked."""
        centre, shown, arm = self.to_screen(*at), imgui.get_color_u32(color), em(0.28)
        for way in (arm, -arm):
            a, b = ImVec2(centre.x - arm, centre.y - way), ImVec2(centre.x + arm, centre.y + way)
            self.draw.add_line(a, b, imgui.get_color_u32(WHITE), em(0.14 + 2.0 * _RIM))
            self.draw.add_line(a, b, shown, em(0.14))

    def square(self, middle: ImVec2, size: tuple[float, float], color: ImVec4) -> None:
        """Draw the outline of a pixel around a point of the screen."""
        half = 0.5 * size[0] - 1.0, 0.5 * size[1] - 1.0
        a, b = ImVec2(middle.x - half[0], middle.y - half[1]), ImVec2(middle.x + half[0], middle.y + half[1])
        self.draw.add_rect(a, b, imgui.get_color_u32(BACK), 0.0, max(3.0, em(0.2)))
        self.draw.add_rect(a, b, imgui.get_color_u32(color), 0.0, max(1.0, em(0.1)))


@contextmanager
def inside(area: Area) -> Iterator[None]:
    """What is drawn here leaves what is around the picture alone."""
    draw = imgui.get_window_draw_list()
    draw.push_clip_rect(area.corner, area.end, True)
    try:
        yield
    finally:
        draw.pop_clip_rect()
