"""Pixels that are watched, and regions of which the values are counted.

Both are places of the picture, 0 to 1 from left and top, and so mean the same at every resolution.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from tracer.frame import Frame
from viewer.state.picking import pixel_at

MOST_WATCHED = 16

Point = tuple[float, float]


@dataclass(frozen=True)
class Region:
    """A rectangle of the picture."""

    left: float
    top: float
    right: float
    bottom: float

    def pixels(self, frame: Frame) -> tuple[slice, slice]:
        """Rows and columns of the pixels that it touches; one at least."""
        left, top = pixel_at(frame, self.left, self.top)
        right, bottom = pixel_at(frame, self.right, self.bottom)
        return slice(top, bottom + 1), slice(left, right + 1)


ALL = Region(0.0, 0.0, 1.0, 1.0)


def region_between(start: Point, end: Point) -> Region:
    """The rectangle from one corner to the other, as far as it lies in the picture."""
    (left, right), (top, bottom) = (
        sorted(min(max(place, 0.0), 1.0) for place in pair) for pair in zip(start, end, strict=True)
    )
    return Region(left, top, right, bottom)


@dataclass
class Pixels:
    """`watched` are the middles of pixels, in the order in which they were pinned; `region` is None for all of it;
    both are of the scene at `path`."""

    watched: list[Point] = field(default_factory=list)
    region: Region | None = None
    path: Path | None = None

    def enter(self, path: Path) -> None:
        """Clear the pixels and the region of another scene."""
        if path != self.path:
            self.watched.clear()
            self.region, self.path = None, path

    def pin(self, frame: Frame, point: Point) -> str:
        """Watch the pixel at a point, or no longer if it is watched already; says what was done."""
        x, y = pixel_at(frame, *point)
        for known in self.watched:
            if pixel_at(frame, *known) == (x, y):
                self.watched.remove(known)
                return f"pixel {x}, {y} is no longer watched"
        if len(self.watched) >= MOST_WATCHED:
            return f"{MOST_WATCHED} pixels are watched, which is the most: stop watching one first"
        self.watched.append(((x + 0.5) / frame.width, (y + 0.5) / frame.height))
        return f"watching pixel {x}, {y}"
