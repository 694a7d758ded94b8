"""Where the picture is shown: a rectangle of the screen, with the zoom in it; and words beside a point of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from imgui_bundle import ImVec2, ImVec4, imgui

from viewer.state.pixels import Zoom
from viewer.window.widgets import em

_BACK, _FRONT = ImVec4(0.05, 0.06, 0.08, 0.90), ImVec4(0.93, 0.94, 0.96, 1.0)
_GAPS = 1.2, 0.6  # ems from the point: to the right of it or below it, and on its other sides

Pair = tuple[float, float]
Rect = tuple[float, float, float, float]
"""Left, upper, right and lower edge."""


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
        corner, size = self.whole, self.whole_size
        return ImVec2(corner.x + size.x, corner.y + size.y)

    def to_picture(self, x: float, y: float) -> tuple[float, float]:
        """The point of the picture, 0 to 1 from left and top, at a point of the screen."""
        return self.zoom.to_picture((x - self.corner.x) / self.size.x, (y - self.corner.y) / self.size.y)

    def to_screen(self, u: float, v: float) -> ImVec2:
        """The point of the screen that shows a point of the picture."""
        corner, size = self.whole, self.whole_size
        return ImVec2(corner.x + u * size.x, corner.y + v * size.y)


def write_beside(lines: Sequence[str], at: ImVec2, room: Rect, taken: Rect | None) -> None:
    """Write a few lines, inside the room and not over what is taken, if that can be."""
    pad, line = em(0.4), imgui.get_text_line_height()
    width, height = max(imgui.calc_text_size(text).x for text in lines) + 2.0 * pad, line * len(lines) + 2.0 * pad
    left, top = beside((at.x, at.y), (width, height), (em(_GAPS[0]), em(_GAPS[1])), room, taken)
    draw = imgui.get_window_draw_list()
    back, front = imgui.get_color_u32(_BACK), imgui.get_color_u32(_FRONT)
    draw.add_rect_filled(ImVec2(left, top), ImVec2(left + width, top + height), back, em(0.3))
    for number, text in enumerate(lines):
        draw.add_text(ImVec2(left + pad, top + pad + number * line), front, text)


def beside(at: Pair, size: Pair, gaps: Pair, room: Rect, taken: Rect | None = None) -> Pair:
    """The left and the upper edge of what is so large and stands beside a point.

    It stands to the right and below by the first of the gaps, or else to the left or above by the second, wherever it
    fits into the room and covers nothing that is taken; where all of that would, it covers it all the same."""
    (x, y), (width, height), (after, before) = at, size, gaps
    lefts, tops = (x + after, x - before - width), (y + after, y - before - height)
    places = [(left, top) for top in tops for left in lefts if _inside((left, top), size, room)]
    if not places:
        return max(lefts[1], room[0]), max(tops[1], room[1])
    free = [place for place in places if taken is None or not _meets(place, size, taken)]
    return (free or places)[0]


def _inside(place: Pair, size: Pair, room: Rect) -> bool:
    left, top, right, lower = room
    return place[0] >= left and place[1] >= top and place[0] + size[0] <= right and place[1] + size[1] <= lower


def _meets(place: Pair, size: Pair, taken: Rect) -> bool:
    left, top, right, lower = taken
    return place[0] < right and place[0] + size[0] > left and place[1] < lower and place[1] + size[1] > top
