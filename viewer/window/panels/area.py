"""Where the picture is shown: a rectangle of the screen, with the zoom in it; and words on it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from imgui_bundle import ImVec2, ImVec4, imgui

from viewer.state.pixels import Zoom
from viewer.window.widgets import em

_BACK, _FRONT = ImVec4(0.05, 0.06, 0.08, 0.90), ImVec4(0.93, 0.94, 0.96, 1.0)
_PAD = 0.4  # ems around words


@dataclass(frozen=True)
class Area:
    """A rectangle of the screen from `corner` on, and the zoom in it.  `whole` is the rectangle that all of the picture
    would take, which is larger when it is zoomed into."""

    corner: ImVec2
    size: ImVec2
    zoom: Zoom

    @property
    def end(self) -> ImVec2:
        return ImVec2(self.corner.x + self.size.x, self.corner.y + self.size.y)

    @property
    def whole_size(self) -> ImVec2:
        return ImVec2(self.size.x * self.zoom.scale, self.size.y * self.zoom.scale)

    @property
    def whole(self) -> ImVec2:
        size = self.whole_size
        return ImVec2(self.corner.x - self.zoom.left * size.x, self.corner.y - self.zoom.top * size.y)

    @property
    def whole_end(self) -> ImVec2:
        return self.to_screen(1.0, 1.0)

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


def write_lines(lines: Sequence[str], at: ImVec2, color: ImVec4 = _FRONT) -> None:
    """Write a few lines on a dark ground, from a corner on."""
    (width, height), pad, draw = size_of(lines), em(_PAD), imgui.get_window_draw_list()
    draw.add_rect_filled(at, ImVec2(at.x + width, at.y + height), imgui.get_color_u32(_BACK), em(0.3))
    for number, text in enumerate(lines):
        below = number * imgui.get_text_line_height()
        draw.add_text(ImVec2(at.x + pad, at.y + pad + below), imgui.get_color_u32(color), text)


def pointer() -> ImVec2:
    """The middle of the pixel of the screen that the pointer is on."""
    mouse = imgui.get_io().mouse_pos
    return ImVec2(mouse.x + 0.5, mouse.y + 0.5)
