"""Figure 1 as a drawing: where its boxes, texts and arrows lie, for the window and for SVG alike.

The stages stand below each other, in one column or several side by side.  Lengths are those of the unit in which texts
are measured; y goes down."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cache
from itertools import combinations, pairwise
from pathlib import Path
from xml.sax.saxutils import escape

from tracer.frame import Frame
from tracer.scene.model import Scene
from tracer.util.text import wrapped
from viewer.output.figure1 import Figure, Stage, figure_of
from viewer.output.overlays import font
from viewer.state.palette import Color
from viewer.state.session import Session
from viewer.state.views import View
from viewer.util.files import write_text

# --- what a drawing consists of ------------------------------------------------------------------

BOX, TIME, TEXT, STRONG, QUIET = "box", "time", "text", "strong", "quiet"
"""Inks, whose colours are those of the page or the window: a stage's box, the bar of its time, and three of letters."""
Point = tuple[float, float]


@dataclass(frozen=True)
class Box:
    """A rectangle, filled with an ink or a colour, outlined in it where it is `hollow`, or, without any, only a place
    about which something is said: `tip` says what it means, `view` shows it."""

    x: float
    y: float
    width: float
    height: float
    ink: str | Color = ""
    hollow: bool = False
    tip: str = ""
    view: View | None = None


@dataclass(frozen=True)
class Words:
    """A line of text; its upper left corner, or the upper right one where it is aligned to the `right`."""

    x: float
    y: float
    text: str
    ink: str = TEXT
    right: bool = False


@dataclass(frozen=True)
class Arrow:
    """A line from point to point along the axes, with a head of this half width at its end, or none."""

    points: tuple[Point, ...]
    head: float = 0.0

    @property
    def corners(self) -> tuple[Point, Point, Point]:
        """The corners of its head."""
        (x0, y0), (x, y) = self.points[-2:]
        along, down = (x > x0) - (x < x0), (y > y0) - (y < y0)
        back, side = (x - 2.0 * self.head * along, y - 2.0 * self.head * down), (self.head * down, self.head * along)
        return (x, y), (back[0] + side[0], back[1] + side[1]), (back[0] - side[0], back[1] - side[1])


@dataclass
class Drawing:
    """What is drawn, in this order, in so much room; whoever draws it makes all of it `scale` times as large."""

    width: float
    height: float = 0.0
    scale: float = 1.0
    parts: list[Box | Words | Arrow] = field(default_factory=list)

    def write(self, x: float, text: str, ink: str, step: float = 0.0, right: bool = False) -> None:
        """Add a line of text at the bottom, and go on so far below."""
        self.parts.append(Words(x, self.height, text, ink, right))
        self.height += step

    def at(self, x: float, y: float) -> Box | None:
        """Return what is said something about at a point of the drawing as it is seen, above all else."""
        x, y = x / self.scale, y / self.scale
        said = (part for part in reversed(self.parts) if isinstance(part, Box) and part.tip)
        return next((b for b in said if 0.0 <= x - b.x < b.width and 0.0 <= y - b.y < b.height), None)


# --- where its parts lie ----------------------------------------------------------------------------

# All in lines' heights.
_PAD, _STEP, _GAP = 0.35, 1.15, 0.7  # the room inside a box and around it, from line to line, and between two texts
_ARROW, _ROWS, _NAMES = 0.7, 1.35, 2.4  # from a box's left edge to the arrow that leaves it, the rows, and their names
_LOOP, _GUTTER = 1.1, 1.6  # the way back to the first stage, at the left edge, and the room between columns
_TIME, _SQUARE, _HEAD = 0.14, 0.7, 0.28  # the bar of a stage's time, a row's square, and half of an arrow's head
_WIDEST = 28.0  # a column, where there is room for several: else numbers stand far from their names
_BOLD = 1.12  # how much wider bold letters are
_SMALLEST = 0.6  # of the size of letters: what finds no room by smaller ones is scrolled

Measure = Callable[[str], float]


Arrangement = tuple[int, bool, float]
"""In how many columns stages stand, whether their rules are written out, and how large letters can be."""


def arrange(figure: Figure, measure: Measure, line: float, width: float, height: float) -> Arrangement:
    """Return how the figure finds room, in lines of text so high.

    Rules are written out where they find room in letters of full size.  Else they are tips, and letters get smaller
    until all is seen."""
    sheet, stages, best = _Sheet(cache(measure), line), len(figure.stages), (0.0, 1)
    fewest = min(max(1, int(width / (_WIDEST * line))), stages)
    for rules in (True, False):
        for columns in range(fewest, stages + 1):
            drawing = sheet.draw(figure, width, columns, rules)
            scale = min(1.0, width / drawing.width, height / drawing.height)
            if scale == 1.0:
                return columns, rules, scale
            best = max(best, (scale, columns))
    scale, columns = best
    return columns, False, scale


def lay_out(
    figure: Figure, measure: Measure, line: float, width: float, height: float, arranged: Arrangement | None = None
) -> Drawing:
    """Return the figure in so much room, as it is `arranged` for one of the same stages, or else for itself.

    Letters are not so small that nobody can read them: then the figure is higher than the room."""
    columns, rules, scale = arranged or arrange(figure, measure, line, width, height)
    drawing = _Sheet(cache(measure), line).draw(figure, width / scale, columns, rules)
    drawing.scale = min(1.0, width / drawing.width, max(height / drawing.height, _SMALLEST))
    return drawing


@dataclass(frozen=True)
class _Sheet:
    """What texts measure, and how high lines are."""

    measure: Measure
    line: float

    def bold(self, text: str) -> float:
        return _BOLD * self.measure(text)

    def draw(self, figure: Figure, width: float, columns: int, rules: bool) -> Drawing:
        """Return the figure in so many columns, which are as wide as their texts at least."""
        line = self.line
        gaps = (_LOOP + (columns - 1) * _GUTTER) * line
        column = max((width - gaps) / columns, *map(self._least_width, figure.stages))
        drawing = Drawing(columns * column + gaps)
        for text in wrapped(figure.title, self.bold, drawing.width) if figure.title else ():
            drawing.write(0.0, text, STRONG, _STEP * line)
        drawing.height += 0.3 * line if figure.title else 0.0
        self._columns(drawing, figure.stages, column, columns, rules)
        for text in wrapped(" ".join(figure.notes), self.measure, drawing.width - _LOOP * line):
            drawing.write(_LOOP * line, text, QUIET, _STEP * line)
        return drawing

    def _columns(self, drawing: Drawing, stages: Sequence[Stage], width: float, columns: int, rules: bool) -> None:
        """Add all stages, from column to column, with arrows between them and from the last back to the first."""
        line, top, foot, end = self.line, drawing.height, 0.0, (0.0, 0.0)
        entrance, head, heights = top + (_PAD + 0.5) * line, _HEAD * line, []
        for stage in stages:  # each is as high as it comes out alone
            alone = Drawing(width)
            self._stage(alone, stage, 0.0, width, rules)
            heights.append(alone.height)
        for number, span in enumerate(_split(heights, columns)):
            x, drawing.height = _LOOP * line + number * (width + _GUTTER * line), top
            if number:  # from the foot of the column before
                turn = x - 0.5 * _GUTTER * line
                drawing.parts.append(Arrow((end, (turn, end[1]), (turn, entrance), (x, entrance)), head))
            for place in span:
                leaves = self._stage(drawing, stages[place], x, width, rules)
                end = x + _ARROW * line, drawing.height
                drawing.parts.append(Arrow(((end[0], leaves), end), 0.0 if place == span[-1] else head))
            foot = max(foot, drawing.height + 0.15 * line)
        left, drawing.height = 0.35 * line, foot + 0.2 * line
        back = (end[0], foot), (left, foot), (left, entrance), (_LOOP * line, entrance)
        drawing.parts.append(Arrow((end, *back), head))

    def _least_width(self, stage: Stage) -> float:
        """Return the width in which nothing of a stage is cut: its name, its time, and the rows that leave it."""
        texts = max(self.bold(stage.heading), self.measure(stage.time)) + 2.0 * _PAD * self.line
        names = max((self.measure(flow.name) for flow in stage.flows), default=0.0)
        numbers = max((self.bold(f"{flow.number:,}") for flow in stage.flows), default=0.0)
        return max(texts, (_NAMES + _GAP) * self.line + names + numbers + self._shares(stage))

    def _shares(self, stage: Stage) -> float:
        """Return the width of a stage's shares, with the room before them."""
        widest = max((self.measure(flow.share) for flow in stage.flows), default=0.0)
        return widest + _GAP * self.line if widest else 0.0

    def _stage(self, drawing: Drawing, stage: Stage, x: float, width: float, rules: bool) -> float:
        """Add a stage: its box, and below it the rows of what leaves it; returns where the box ends."""
        line, pad, step = self.line, _PAD * self.line, _STEP * self.line
        top, place, inner, right = drawing.height, len(drawing.parts), width - 2.0 * pad, x + width
        drawing.height += pad
        beside = self.bold(stage.heading) + self.measure(stage.time) + _GAP * line <= inner
        drawing.write(x + pad, stage.heading, STRONG, 0.0 if beside else step)
        drawing.write(right - pad, stage.time, QUIET, step, right=True)
        for text in wrapped(stage.rule, self.measure, inner) if rules else ():
            drawing.write(x + pad, text, TEXT, step)
        foot = drawing.height + pad - 0.15 * line
        tip = f"{stage.heading}\n{stage.rule}\n{stage.time}"
        drawing.parts.insert(place, Box(x, top, width, foot - top, BOX, tip=tip, view=stage.view))
        if stage.share:
            drawing.parts.append(Box(x, foot - _TIME * line, width * stage.share, _TIME * line, TIME))
        drawing.height, left, square = foot + pad, x + _ROWS * line, _SQUARE * line
        for flow in stage.flows:
            y, number = drawing.height, f"{flow.number:,}"
            if flow.color is not None:
                inset = 0.5 * (line - square)
                drawing.parts.append(Box(left, y + inset, square, square, flow.color, flow.hollow))
            drawing.write(right - self._shares(stage), number, STRONG, right=True)
            if flow.share:
                drawing.write(right, flow.share, QUIET, right=True)
            drawing.write(x + _NAMES * line, flow.name, TEXT, step)
            tip = f"{flow.name}: {number}{f' ({flow.share})' if flow.share else ''}\n{flow.tip}"
            drawing.parts.append(Box(left, y, right - left, step, tip=tip, view=flow.view))
        drawing.height = max(drawing.height, foot + pad + 0.4 * line) + pad
        return foot


def _split(heights: Sequence[float], columns: int) -> list[range]:
    """Return consecutive spans, one for each column, whose highest is as low as can be."""

    def highest(cuts: tuple[int, ...]) -> float:
        return max(sum(heights[a:b]) for a, b in pairwise((0, *cuts, len(heights))))

    best = min(combinations(range(1, len(heights)), columns - 1), key=highest)
    return [range(a, b) for a, b in pairwise((0, *best, len(heights)))]


# --- as SVG, in which text stays text, and what is said of a part is its tooltip ---------------------

_WIDTH, _HEIGHT, _MARGIN = 1280.0, 720.0, 24.0
_LETTER, _LINE = 15, 18.0  # how high letters and lines are
_FONTS = "'DejaVu Sans', Verdana, Arial, Helvetica, sans-serif"  # the widest first, as texts are measured by it
_INKS = {BOX: "#f4f5f7", TIME: "#1f6fbf", TEXT: "#1c2026", STRONG: "#1c2026", QUIET: "#5a6270"}
_EDGES = {BOX: 'stroke="#aab1bc" rx="4"', TIME: ""}


def write_svg(path: Path, frame: Frame, scene: Scene) -> None:
    """Write the figure of a frame; raises OSError in one line."""
    write_text(path, svg(figure_of(frame, f"{scene.path.stem}, frame {Session(scene).frame_at(frame.time)}")))


def svg(figure: Figure) -> str:
    """Return the text of the SVG."""
    room = _WIDTH - 2 * _MARGIN, _HEIGHT - 2 * _MARGIN
    drawing = lay_out(figure, font(_LETTER).getlength, _LINE, *room)
    height = drawing.scale * drawing.height + 2 * _MARGIN
    size = f'width="{_WIDTH:g}" height="{height:.0f}" viewBox="0 0 {_WIDTH:g} {height:.0f}"'
    lines = (
        f'<svg xmlns="http://www.w3.org/2000/svg" {size} font-family="{_FONTS}" font-size="{_LETTER}">',
        f"<title>{escape(figure.title)}</title>",
        '<rect width="100%" height="100%" fill="#ffffff"/>',
        f'<g transform="translate({_MARGIN:g} {_MARGIN:g}) scale({drawing.scale:.4g})">',
        *map(_element, drawing.parts),
        "</g>",
        "</svg>\n",
    )
    return "\n".join(lines)


def _element(part: Box | Words | Arrow) -> str:
    if isinstance(part, Words):
        place = f'x="{part.x:.1f}" y="{part.y + 0.8 * _LINE:.1f}" fill="{_INKS[part.ink]}"'
        weight, anchor = ' font-weight="600"' * (part.ink == STRONG), ' text-anchor="end"' * part.right
        return f"<text {place}{weight}{anchor}>{escape(part.text)}</text>"
    if isinstance(part, Arrow):
        shape = f'<polyline points="{_points(part.points)}" fill="none" stroke="{_INKS[QUIET]}" stroke-width="1.5"/>'
        return shape + f'<polygon points="{_points(part.corners)}" fill="{_INKS[QUIET]}"/>' * (part.head > 0.0)
    color = _INKS.get(part.ink, "none") if isinstance(part.ink, str) else _hex(part.ink)
    look = f'fill="{color}" {_EDGES.get(str(part.ink), _EDGE)}'
    if part.hollow or not part.ink:
        look = f'fill="none" stroke="{color}" stroke-width="2" pointer-events="all"'
    place = f'x="{part.x:.1f}" y="{part.y:.1f}" width="{part.width:.1f}" height="{part.height:.1f}"'
    return f"<rect {place} {look}><title>{escape(part.tip)}</title></rect>" if part.tip else f"<rect {place} {look}/>"


_EDGE = 'stroke="#5a6270" stroke-width="0.5"'  # of what has a colour


def _points(points: Sequence[Point]) -> str:
    return " ".join(f"{x:.1f},{y:.1f}" for x, y in points)


def _hex(color: Color) -> str:
    return "#" + "".join(f"{round(255.0 * channel):02x}" for channel in color)
