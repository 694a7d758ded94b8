"""Where the parts of Figure 1 lie, for whatever draws them: a column of boxes, or several side by side.

All lengths are those of the unit in which `measure` gives the width of a text; y goes down.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from enum import Enum
from functools import cache
from itertools import combinations, pairwise

from viewer.output.figure1 import Figure, Flow, Part, Stage
from viewer.state.palette import Color
from viewer.state.views import View
from viewer.views.legend import wrapped

# --- what a drawing consists of ------------------------------------------------------------------

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


# --- where its parts lie ----------------------------------------------------------------------------

Measure = Callable[[str], float]

# All in lines' heights.
_ARROW, _ROWS = 0.7, 1.35  # from a box's left edge to the arrow that leaves it, and to the rows beside this
_LOOP, _GUTTER = 1.1, 1.6  # the way back to the first stage, at the left edge, and the room between columns
_BAR, _TIME = 0.4, 0.14  # how high a bar of parts is, and one of time
_SQUARE = 0.7  # a row's square of colour
_BETWEEN = 0.7  # between the columns of a row
_WIDEST = 28.0  # a column, where there is room for several: else numbers stand far from their names
_TALLEST, _FOOT = 32.0, 2.5  # all of the paper's stages below each other, as low as can be, and what is below columns


class Detail(Enum):
    """How much is written out: rules too, or all but these, or as little as there can be; the rest are tips.

    Its value, in lines' heights: the room inside a box, and between boxes and what is beside the arrows; and from line
    to line."""

    RULES = 0.45, 1.15
    FIGURES = 0.4, 1.15
    LEAST = 0.17, 1.05


def lay_out(figure: Figure, measure: Measure, line: float, width: float, height: float, strong: float = 1.0) -> Drawing:
    """The figure in so much room, in lines of text so high; `strong` letters are so many times as wide as others.

    As much is written out as finds room, in as few columns, but in as many as the paper's stages need, so that in the
    same room other methods' fewer stages stand where these did.  Where nothing finds room, the figure is as low as can
    be, and higher than that."""
    known = cache(measure)
    needed = math.ceil(_TALLEST / max(height / line - _FOOT, 1.0))
    fewest = max(int(width / (_WIDEST * line)), needed)
    lowest: _Sheet | None = None
    written = [_Texts(known, line, detail, strong) for detail in Detail]
    most = [texts.most_columns(figure, width) for texts in written]
    for texts, possible in zip(written, most, strict=True):
        for columns in range(min(max(most), fewest), possible + 1):
            sheet = _Sheet(figure, texts, width, columns)
            if sheet.height <= height:
                return sheet.drawn()
            if lowest is None or sheet.height < lowest.height:
                lowest = sheet
    assert lowest is not None
    return lowest.drawn()


@dataclass(frozen=True)
class _Texts:
    """What is written of stages and flows, and how wide that is."""

    measure: Measure
    line: float
    detail: Detail
    strong: float

    @property
    def pad(self) -> float:
        return self.detail.value[0] * self.line

    @property
    def step(self) -> float:
        return self.detail.value[1] * self.line

    def wide(self, text: str) -> float:
        """The width of strong letters."""
        return self.strong * self.measure(text)

    def heading(self, stage: Stage) -> str:
        return stage.name if self.detail is Detail.LEAST else stage.heading

    def time(self, stage: Stage) -> str:
        return stage.part if self.detail is Detail.LEAST else stage.duration

    def number(self, flow: Flow) -> str:
        return _short(flow.number) if self.detail is Detail.LEAST else f"{flow.number:,}"

    def shares(self, flows: Sequence[Flow]) -> float:
        """The room of the shares of flows, with what is before them; 0 where they have none, or all are tips."""
        widest = max((self.measure(flow.share) for flow in flows), default=0.0)
        return widest + _BETWEEN * self.line if widest and self.detail is not Detail.LEAST else 0.0

    def before_names(self, flows: Sequence[Flow]) -> float:
        """From a column's left edge to the names of what leaves a stage."""
        return (_ROWS + (_SQUARE + 0.35 if any(flow.color for flow in flows) else 0.0)) * self.line

    def numbers(self, flows: Sequence[Flow]) -> float:
        """The room of the numbers of flows, with what is before them."""
        return max((self.wide(self.number(flow)) for flow in flows), default=0.0) + _BETWEEN * self.line

    def fits_one_line(self, stage: Stage, column: float) -> bool:
        """Whether the name of a stage and its time find room beside each other."""
        return self.wide(self.heading(stage)) + self.measure(self.time(stage)) <= (
            column - 2 * self.pad - _BETWEEN * self.line
        )

    def most_columns(self, figure: Figure, width: float) -> int:
        """How many columns there is room for, one at least."""
        most = int((width + (_GUTTER - _LOOP) * self.line) / (self._least_column(figure) + _GUTTER * self.line))
        return max(1, min(len(figure.stages), most))

    def _least_column(self, figure: Figure) -> float:
        """The width that a column must have for nothing in it to be cut."""
        boxes = (
            self.wide(self.heading(stage)) + self.measure(self.time(stage)) + 2 * self.pad + _BETWEEN * self.line
            for stage in figure.stages
        )
        rows = (
            self.before_names(stage.flows)
            + self.measure(flow.name)
            + self.numbers(stage.flows)
            + self.shares(stage.flows)
            for stage in figure.stages
            for flow in stage.flows
        )
        return max(*boxes, *rows)


def _short(number: int) -> str:
    """A large number in few characters."""
    if number < 100_000:
        return f"{number:,}"
    return f"{number / 1e3:.0f} k" if number < 1_000_000 else f"{number / 1e6:.3g} M"


def shortened(text: str, measure: Measure, room: float) -> str:
    """The text, or as much of it as there is room for, with an ellipsis."""
    if measure(text) <= room:
        return text
    while text and measure(f"{text}…") > room:
        text = text[:-1]
    return f"{text}…"


class _Sheet:
    """A figure being laid out, in so many columns: how high it is, and, once that is known, all of it."""

    def __init__(self, figure: Figure, texts: _Texts, width: float, columns: int) -> None:
        self._figure, self._texts, self._line = figure, texts, texts.line
        self._column = (width - (_LOOP + (columns - 1) * _GUTTER) * texts.line) / columns
        self._title = wrapped(figure.title, texts.wide, width) if figure.title else []
        self._top = len(self._title) * texts.step + 0.3 * texts.line if self._title else 1.0
        heights = [self._height(stage) for stage in figure.stages]
        self._spans = _split(heights, columns)
        self._bottom = self._top + max(sum(heights[first:last]) for first, last in self._spans) + 0.15 * texts.line
        said = " ".join((figure.next_frame, *figure.notes))
        self._last = wrapped(said, texts.measure, width - _LOOP * texts.line)
        self.height = self._bottom + 0.2 * texts.line + len(self._last) * texts.step
        self.drawing = Drawing(width, self.height)

    def drawn(self) -> Drawing:
        """All of it."""
        for number, text in enumerate(self._title):
            self.drawing.words.append(Words(0.0, number * self._texts.step, text, Tone.STRONG))
        self._columns()
        return self.drawing

    def _rule(self, stage: Stage) -> list[str]:
        if self._texts.detail is not Detail.RULES:
            return []
        return wrapped(stage.rule, self._texts.measure, self._column - 2 * self._texts.pad)

    def _box_height(self, stage: Stage) -> float:
        lines = 1 + len(self._rule(stage)) + (not self._texts.fits_one_line(stage, self._column))
        bar = _BAR + 0.3 if stage.bar else 0.0
        return 2 * self._texts.pad + (lines - 1) * self._texts.step + (1.0 + bar) * self._line

    def _height(self, stage: Stage) -> float:
        """Of a box, and of the arrow that leaves it."""
        rows = max(len(stage.flows) * self._texts.step, 0.4 * self._line)
        return self._box_height(stage) + 2 * self._texts.pad + rows

    def _columns(self) -> None:
        """All stages, from column to column, and the way from the last back to the first."""
        line, stages, end = self._line, self._figure.stages, (0.0, 0.0)
        entrance = self._top + self._texts.pad + 0.5 * line
        for number, (first, last) in enumerate(self._spans):
            x, y = _LOOP * line + number * (self._column + _GUTTER * line), self._top
            for at, stage in enumerate(stages[first:last], first):
                self._stage(stage, x, y)
                leaves = x + _ARROW * line, y + self._box_height(stage)
                y += self._height(stage)
                end = leaves[0], y
                self.drawing.arrows.append(Arrow((leaves, end), head=at + 1 < last))
            if last < len(stages):
                right = x + self._column + _GUTTER * line
                turn = right - 0.5 * _GUTTER * line
                self.drawing.arrows.append(Arrow((end, (turn, y), (turn, entrance), (right, entrance))))
        self._next(end, entrance)

    def _next(self, end: Point, entrance: float) -> None:
        """The way back to the first stage, with what the next frame begins with, and notes."""
        left, x, y = 0.35 * self._line, _LOOP * self._line, self._bottom
        self.drawing.arrows.append(Arrow((end, (end[0], y), (left, y), (left, entrance), (x, entrance))))
        for number, text in enumerate(self._last):
            place = y + 0.2 * self._line + number * self._texts.step
            self.drawing.words.append(Words(x, place, text, Tone.QUIET))

    def _stage(self, stage: Stage, x: float, y: float) -> None:
        """A box, and the rows beside the arrow that leaves it."""
        drawing, line, texts, height = self.drawing, self._line, self._texts, self._box_height(stage)
        left, inner = x + texts.pad, self._column - 2 * texts.pad
        drawing.boxes.append(Box(x, y, self._column, height))
        tip = f"{stage.heading}\n{stage.rule}\n{stage.duration}"
        drawing.areas.append(Area(x, y, self._column, height, tip, stage.view))
        at, beside = y + texts.pad, texts.fits_one_line(stage, self._column)
        drawing.words.append(Words(left, at, shortened(texts.heading(stage), texts.wide, inner), Tone.STRONG))
        at += 0.0 if beside else texts.step
        time = shortened(texts.time(stage), texts.measure, inner)
        drawing.words.append(Words(left + (inner if beside else 0.0), at, time, Tone.QUIET, beside))
        for text in self._rule(stage):
            at += texts.step
            drawing.words.append(Words(left, at, text))
        if stage.bar:
            at += 1.3 * line
            drawing.bars += _bar(stage.bar, left, at, inner, _BAR * line)
            drawing.areas.append(Area(left, at, inner, _BAR * line, stage.bar_tip, stage.view))
        if stage.share:
            drawing.times.append(Box(x, y + height - _TIME * line, self._column * stage.share, _TIME * line))
        self._rows(stage.flows, x, y + height + texts.pad)

    def _rows(self, flows: Sequence[Flow], x: float, y: float) -> None:
        """What leaves a stage: square, name, number and share, below each other."""
        drawing, line, texts = self.drawing, self._line, self._texts
        left, right = x + texts.before_names(flows), x + self._column
        room, shares = right - left - texts.numbers(flows), texts.shares(flows)
        if room - shares < max((texts.measure(flow.name) for flow in flows), default=0.0):
            shares = 0.0  # they are tips, then
        room -= shares
        for flow in flows:
            at = x + _ROWS * line
            if flow.color is not None:
                square = _SQUARE * line
                drawing.bars.append(Box(at, y + 0.5 * (line - square), square, square, flow.color, flow.hollow))
            drawing.words.append(Words(left, y, shortened(flow.name, texts.measure, room)))
            drawing.words.append(Words(right - shares, y, texts.number(flow), Tone.STRONG, True))
            if shares and flow.share:
                drawing.words.append(Words(right, y, flow.share, Tone.QUIET, True))
            tip = f"{flow.name}: {flow.number:,}" + (f" ({flow.share})" if flow.share else "") + f"\n{flow.tip}"
            drawing.areas.append(Area(at, y, right - at, texts.step, tip, flow.view))
            y += texts.step


def _bar(parts: Sequence[Part], x: float, y: float, width: float, height: float) -> Iterator[Box]:
    for part in parts:
        if part.share > 0.0:
            yield Box(x, y, width * part.share, height, part.color, part.hollow)
        x += width * part.share


def _split(heights: Sequence[float], columns: int) -> list[tuple[int, int]]:
    """Consecutive spans, one for each column, whose highest is as low as can be."""

    def highest(cuts: tuple[int, ...]) -> float:
        return max(sum(heights[a:b]) for a, b in pairwise((0, *cuts, len(heights))))

    best = min(combinations(range(1, len(heights)), columns - 1), key=highest)
    return list(pairwise((0, *best, len(heights))))
