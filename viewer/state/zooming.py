"""Looking closely at the picture itself, which moves no camera: what part of it is shown, and how large."""

from __future__ import annotations

import math
from dataclasses import dataclass

MOST = 64.0
"""How much larger than it fits a picture can be shown."""
STEP = 2.0**0.5
"""By what a notch of the wheel, or a key, enlarges."""
GRID_FROM = 8.0
"""Pixels of the screen that one of the picture has from side to side, from which on there is a grid."""


@dataclass(frozen=True)
class Zoom:
    """`scale` is how much larger than it fits the picture is shown, `x` and `y` is the point of it, 0 to 1 from left
    and top, that lies in the middle."""

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
        """The part of the picture that is shown: left, top, right and bottom, 0 to 1."""
        return self.left, self.top, self.left + 1.0 / self.scale, self.top + 1.0 / self.scale

    def to_picture(self, x: float, y: float) -> tuple[float, float]:
        """The point of the picture at a point, 0 to 1, of the rectangle in which it is shown."""
        return self.left + x / self.scale, self.top + y / self.scale


FIT = Zoom()


def zoomed(zoom: Zoom, factor: float, at: tuple[float, float]) -> Zoom:
    """Enlarged by a factor; `at`, a point of the rectangle in which it is shown, keeps what it shows."""
    scale = min(max(zoom.scale * factor, 1.0), MOST)
    if math.isclose(scale, 1.0, rel_tol=1e-6):
        return FIT
    u, v = zoom.to_picture(*at)
    return _inside(scale, u + (0.5 - at[0]) / scale, v + (0.5 - at[1]) / scale)


def around(x: float, y: float, scale: float) -> Zoom:
    """Enlarged so much, with a point of the picture in the middle, or as near to it as the borders let it."""
    scale = min(max(scale, 1.0), MOST)
    return FIT if scale == 1.0 else _inside(scale, x, y)


def panned(zoom: Zoom, dx: float, dy: float) -> Zoom:
    """Moved along with a hand that goes so far, in widths and heights of the rectangle in which it is shown."""
    return zoom if zoom.fits else _inside(zoom.scale, zoom.x - dx / zoom.scale, zoom.y - dy / zoom.scale)


def _inside(scale: float, x: float, y: float) -> Zoom:
    """Nothing but the picture is shown."""
    margin = 0.5 / scale
    return Zoom(scale, min(max(x, margin), 1.0 - margin), min(max(y, margin), 1.0 - margin))


def pixels_shown(zoom: Zoom, width: int, height: int) -> tuple[range, range]:
    """Columns and rows of the pixels, of so many, that are seen in whole or in part."""
    left, top, right, bottom = zoom.shown()
    columns = range(max(0, math.floor(left * width)), min(width, math.ceil(right * width)))
    return columns, range(max(0, math.floor(top * height)), min(height, math.ceil(bottom * height)))
