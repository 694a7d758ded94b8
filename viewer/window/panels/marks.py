"""A pen that draws over the picture: strokes, rings around pixels, and crosses where light is blocked."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from contextlib import contextmanager

from imgui_bundle import ImVec2, ImVec4, imgui

from tracer.frame import Frame
from viewer.state.projection import Stroke
from viewer.window.panels.area import Area
from viewer.window.widgets import em

SHADE = ImVec4(0.05, 0.06, 0.08, 0.6)
"""Around what is drawn, so that it is seen on any picture."""
Point = tuple[float, float]
"""Of the picture, 0 to 1 from left and top."""


def with_alpha(color: ImVec4, alpha: float) -> ImVec4:
    """The colour, so much more transparent."""
    return ImVec4(color.x, color.y, color.z, color.w * alpha)


class Pen:
    """Draws in places of the picture of a frame; widths are in ems.  `radius` is that of a ring around a pixel which
    covers none of it."""

    def __init__(self, area: Area, frame: Frame) -> None:
        self.area, self.draw = area, imgui.get_window_draw_list()
        self._corner, self._size = area.whole, area.whole_size  # asked for once, as there are thousands of strokes
        self.pixel = self._size.x / frame.width, self._size.y / frame.height
        self.radius = max(0.4, 0.5 * math.hypot(*self.pixel) / em(1.0) + 0.2)

    def to_screen(self, u: float, v: float) -> ImVec2:
        """The point of the screen that shows a point of the picture."""
        return ImVec2(self._corner.x + u * self._size.x, self._corner.y + v * self._size.y)

    def strokes(
        self,
        strokes: Iterable[Stroke],
        color: ImVec4,
        width: float,
        behind: float = 0.6,
        around: ImVec4 = SHADE,
        rim: float = 0.06,
    ) -> None:
        """Draw strokes with a rim `around` them; what lies behind something has the opacity `behind`."""
        outer, inner = (  # of what lies behind something, and of what is seen
            [imgui.get_color_u32(with_alpha(one, alpha)) for alpha in (behind, 1.0)]
            for one in (with_alpha(around, color.w), color)
        )
        for stroke in strokes:
            a, b = self.to_screen(*stroke.start), self.to_screen(*stroke.end)
            self.draw.add_line(a, b, outer[stroke.seen], em(width + 2.0 * rim))
            self.draw.add_line(a, b, inner[stroke.seen], max(1.0, em(width)))

    def ring(self, at: Point, radius: float | None = None, alpha: float = 1.0) -> None:
        """A white ring, around a pixel unless it has another radius."""
        centre, size = self.to_screen(*at), em(self.radius if radius is None else radius)
        self.draw.add_circle(centre, size, imgui.get_color_u32(SHADE), 0, em(0.22))
        self.draw.add_circle(centre, size, imgui.get_color_u32(ImVec4(1.0, 1.0, 1.0, alpha)), 0, em(0.1))

    def disc(self, at: Point, color: ImVec4, radius: float) -> None:
        """A disc with a rim."""
        centre, shade = self.to_screen(*at), imgui.get_color_u32(with_alpha(SHADE, color.w))
        self.draw.add_circle_filled(centre, em(radius + 0.1), shade)
        self.draw.add_circle_filled(centre, em(radius), imgui.get_color_u32(color))

    def cross(self, at: Point, color: ImVec4) -> None:
        """A cross, where light is blocked."""
        centre, shown, arm = self.to_screen(*at), imgui.get_color_u32(color), em(0.28)
        for way in (arm, -arm):
            a, b = ImVec2(centre.x - arm, centre.y - way), ImVec2(centre.x + arm, centre.y + way)
            self.draw.add_line(a, b, shown, em(0.14))

    def square(self, middle: ImVec2, size: Point, color: ImVec4) -> None:
        """The outline of a pixel around a point of the screen."""
        half = 0.5 * size[0] - 1.0, 0.5 * size[1] - 1.0
        a, b = ImVec2(middle.x - half[0], middle.y - half[1]), ImVec2(middle.x + half[0], middle.y + half[1])
        self.draw.add_rect(a, b, imgui.get_color_u32(ImVec4(0.03, 0.04, 0.05, 0.9)), 0.0, max(3.0, em(0.2)))
        self.draw.add_rect(a, b, imgui.get_color_u32(color), 0.0, max(1.0, em(0.1)))


@contextmanager
def pen(area: Area, frame: Frame) -> Iterator[Pen]:
    """A pen that leaves what is around the picture alone."""
    made = Pen(area, frame)
    made.draw.push_clip_rect(area.corner, area.end, True)
    yield made
    made.draw.pop_clip_rect()
