"""Where the picture is shown: a rectangle of the screen, and how closely the picture is looked at in it."""

from __future__ import annotations

from dataclasses import dataclass

from imgui_bundle import ImVec2

from viewer.state.zooming import Zoom


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
