"""What a drawing of Figure 1 consists of: boxes, bars, arrows and words, each at its place, for whatever draws them."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum

from viewer.state.palette import Color
from viewer.state.views import View

Point = tuple[float, float]


class Tone(Enum):
    """How a text, or a line, is meant."""

    PLAIN = "plain"
    STRONG = "strong"
    QUIET = "quiet"


@dataclass(frozen=True)
class Words:
    """A line of text; its upper left corner, or the upper right one where it is aligned to the `right`."""

    x: float
    y: float
    text: str
    tone: Tone = Tone.PLAIN
    right: bool = False


@dataclass(frozen=True)
class Box:
    """A rectangle: the frame of a stage where it has no colour, else filled with it, or, `hollow`, outlined."""

    x: float
    y: float
    width: float
    height: float
    color: Color | None = None
    hollow: bool = False


@dataclass(frozen=True)
class Arrow:
    """A line from point to point, with a head at its end or none."""

    points: tuple[Point, ...]
    head: bool = True

    def head_of(self, size: float) -> tuple[Point, Point, Point]:
        """The corners of its head; the last part of an arrow goes along an axis."""
        (x0, y0), (x, y) = self.points[-2:]
        along = ((x > x0) - (x < x0), (y > y0) - (y < y0))
        back = x - 2.0 * size * along[0], y - 2.0 * size * along[1]
        side = size * along[1], size * along[0]
        return (x, y), (back[0] + side[0], back[1] + side[1]), (back[0] - side[0], back[1] - side[1])


@dataclass(frozen=True)
class Area:
    """A rectangle that is about something: what is said of it, and the view that shows it."""

    x: float
    y: float
    width: float
    height: float
    tip: str
    view: View | None = None

    def holds(self, x: float, y: float) -> bool:
        return self.x <= x < self.x + self.width and self.y <= y < self.y + self.height


@dataclass
class Drawing:
    """All of a figure, laid out: its size, and what is drawn, in this order; areas that come later lie above."""

    width: float
    height: float
    boxes: list[Box] = field(default_factory=list)
    bars: list[Box] = field(default_factory=list)
    times: list[Box] = field(default_factory=list)
    arrows: list[Arrow] = field(default_factory=list)
    words: list[Words] = field(default_factory=list)
    areas: list[Area] = field(default_factory=list)

    def at(self, x: float, y: float) -> Area | None:
        """What lies at a point, above all else."""
        return next((area for area in reversed(self.areas) if area.holds(x, y)), None)
