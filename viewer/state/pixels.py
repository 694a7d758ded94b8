"""Places of the picture, 0 to 1 from left and top, which mean the same at every resolution: what part of it is looked
at closely."""

from __future__ import annotations

import math
from dataclasses import dataclass

from tracer.frame import Frame

MOST = 64.0
"""How much larger than it fits a picture can be shown."""
STEP = 2.0**0.5
"""By what a notch of the wheel, or a key, enlarges."""
GRID_FROM = 8.0
"""Pixels of the screen that one of the picture has from side to side, from which on there is a grid."""

Point = tuple[float, float]


def pixel_at(frame: Frame, u: float, v: float) -> tuple[int, int]:
    """The pixel under a point of the picture."""
    return min(max(int(u * frame.width), 0), frame.width - 1), min(max(int(v * frame.height), 0), frame.height - 1)


# --- looking closely, which moves no camera ---------------------------------------------------------


@dataclass(frozen=True)
class Zoom:
    """`scale` is how much larger than it fits the picture is shown, `x` and `y` is the point of it that lies in the
    middle."""

    scale: float = 1.0
    x: float = 0.5
    y: float = 0.5

    @property
    def fits(self) -> bool:
        """Whether all of the picture is shown."""
        return self.scale <= 1.0

    def in_words(self) -> str:
        """Return how closely it looks."""
        return "to the whole picture" if self.fits else f"to {self.scale:.3g} x"

    @property
    def left(self) -> float:
        return self.x - 0.5 / self.scale

    @property
    def top(self) -> float:
        return self.y - 0.5 / self.scale

    def shown(self) -> tuple[float, float, float, float]:
        """The part of the picture that is shown: left, top, right and bottom."""
        return self.left, self.top, self.left + 1.0 / self.scale, self.top + 1.0 / self.scale

    def to_picture(self, x: float, y: float) -> Point:
        """The point of the picture at a point, 0 to 1, of the rectangle in which it is shown."""
        return self.left + x / self.scale, self.top + y / self.scale


FIT = Zoom()


def zoomed(zoom: Zoom, factor: float, at: Point) -> Zoom:
    """Enlarged by a factor; `at`, a point of the rectangle in which it is shown, keeps what it shows."""
    scale = min(max(zoom.scale * factor, 1.0), MOST)
    if math.isclose(scale, 1.0, rel_tol=1e-6):
        return FIT
    u, v = zoom.to_picture(*at)
    return around(u + (0.5 - at[0]) / scale, v + (0.5 - at[1]) / scale, scale)


def around(x: float, y: float, scale: float) -> Zoom:
    """Enlarged so much, with a point of the picture in the middle, or as near to it as the borders let it."""
    scale = min(max(scale, 1.0), MOST)
    margin = 0.5 / scale
    return Zoom(scale, min(max(x, margin), 1.0 - margin), min(max(y, margin), 1.0 - margin))


def panned(zoom: Zoom, dx: float, dy: float) -> Zoom:
    """Moved along with a hand that goes so far, in widths and heights of the rectangle in which it is shown."""
    return around(zoom.x - dx / zoom.scale, zoom.y - dy / zoom.scale, zoom.scale)


def pixels_shown(zoom: Zoom, width: int, height: int) -> tuple[range, range]:
    """Columns and rows of the pixels, of so many, that are seen in whole or in part."""
    left, top, right, bottom = zoom.shown()
    columns = range(max(0, math.floor(left * width)), min(width, math.ceil(right * width)))
    return columns, range(max(0, math.floor(top * height)), min(height, math.ceil(bottom * height)))
