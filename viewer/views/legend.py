"""What a legend consists of: the colours of a view, what each stands for, and how much of the frame has it.

The window draws it into the picture, or beside it, and a saved picture may carry it; `lay_out` says where its
parts lie: boxes of colour and lines of text, in the unit in which `measure` gives the width of a text."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from enum import Enum

from tracer.util.text import wrapped
from viewer.state.palette import LIGHT, Color, color_map, signed_map


class NoteKind(Enum):
    """How a note is meant."""

    PLAIN = "a fact"
    GOOD = "all is well"
    WARNING = "take care"


@dataclass(frozen=True)
class Entry:
    """A line: a colour, or none, what it stands for, a value for each of the legend's columns, and more in words.

    Where it is `quiet`, its values name what is below them; the colour may have `stripes` of another."""

    name: str
    color: Color | None = None
    values: tuple[str, ...] = ()
    meaning: str = ""
    quiet: bool = False
    stripes: Color | None = None


@dataclass(frozen=True)
class Scale:
    """The colour map as a bar, and what its ends and its middle stand for; `reverse` begins with its last colour, and
    `signed` is that of a signed difference."""

    low: str
    high: str
    middle: str = ""
    reverse: bool = False
    signed: bool = False


@dataclass(frozen=True)
class Note:
    """A sentence below the rest."""

    text: str
    kind: NoteKind = NoteKind.PLAIN


@dataclass(frozen=True)
class Legend:
    """A title, names of the columns of values, and the rest as far as there is any; `facts` come after the colours."""

    title: str
    columns: tuple[str, ...] = ()
    entries: tuple[Entry, ...] = ()
    scale: Scale | None = None
    facts: tuple[Entry, ...] = ()
    notes: tuple[Note, ...] = ()


def fact(name: str, value: str, meaning: str = "") -> Entry:
    """Return a line without a colour."""
    return Entry(name, None, (value,), meaning)


def lights_in_words(lights: int) -> str:
    """Return what numbers the lights of a scene have."""
    if lights == 0:
        return "the scene has no lights"
    return "the scene has one light, number 0" if lights == 1 else f"the scene's lights are 0 to {lights - 1}"


Measure = Callable[[str], float]

NOTE_WIDTH = 15.0
"""Lines' heights: how wide notes are, where nothing else is wider."""

BACKDROP_OPACITY = 0.82
QUIET: Color = (0.68, 0.71, 0.76)
NOTES: dict[NoteKind, Color] = {
    NoteKind.PLAIN: QUIET,
    NoteKind.GOOD: (0.36, 0.80, 0.64),
    NoteKind.WARNING: (0.96, 0.74, 0.31),
}


@dataclass(frozen=True)
class PlacedText:
    """A line of text; its upper left corner."""

    x: float
    y: float
    text: str
    color: Color = LIGHT


@dataclass(frozen=True)
class Box:
    """A rectangle of one colour."""

    x: float
    y: float
    width: float
    height: float
    color: Color


@dataclass(frozen=True)
class Layout:
    """The size of all, margins included, its parts, and, for lines that have a tip, (top, bottom, tip)."""

    width: float
    height: float
    words: tuple[PlacedText, ...]
    boxes: tuple[Box, ...]
    tips: tuple[tuple[float, float, str], ...]


STEPS = 64
"""Boxes that a bar of the colour map consists of."""


def fitting(
    legend: Legend, measure: Measure, line: float, width: float, height: float, most: float = 1e9
) -> Layout | None:
    """The layout of as much of a legend as there is room for: notes go first, then facts, then the last column.

    None where even the colours and their names are too large, or cover an area of more than `most`."""
    plain = replace(legend, notes=(), facts=())
    narrower = (
        replace(plain, columns=plain.columns[:n], entries=tuple(replace(e, values=e.values[:n]) for e in plain.entries))
        for n in (1, 0)
    )
    for one in (legend, replace(legend, notes=()), plain, *narrower):
        layout = lay_out(one, measure, line)
        if layout.width <= width and layout.height <= height and layout.width * layout.height <= most:
            return layout
    return None


def lay_out(legend: Legend, measure: Measure, line: float) -> Layout:
    """All of a legend, in lines of text so high."""
    pad, gap, step = 0.5 * line, 0.8 * line, 1.2 * line
    indent = 1.1 * line if any(entry.color for entry in legend.entries) else 0.0
    rows = (*legend.entries, *legend.facts)
    columns = max([len(legend.columns), *(len(row.values) for row in rows)])
    table = [legend.columns, *(row.values for row in rows)]
    widths = [max((measure(row[i]) for row in table if i < len(row)), default=0.0) for i in range(columns)]
    names = max(((indent if row.color else 0.0) + measure(row.name) for row in rows), default=0.0)
    inner = max(
        names + sum(width + gap for width in widths),
        measure(legend.title),
        _scale_width(legend, measure, line),
        NOTE_WIDTH * line if legend.notes else 0.0,
    )
    words, boxes, tips = [PlacedText(pad, pad, legend.title)], [], []
    y = pad + step

    def values(texts: tuple[str, ...], color: Color) -> Iterator[PlacedText]:
        right = pad + inner
        for width, text in zip(reversed(widths), reversed((*texts, *[""] * (columns - len(texts))))):
            if text:
                yield PlacedText(right - measure(text), y, text, color)
            right -= width + gap

    if legend.scale is not None:
        scale = legend.scale
        colors = (signed_map if scale.signed else color_map)(STEPS).tolist()
        for k, (red, green, blue) in enumerate(reversed(colors) if scale.reverse else colors):
            left = inner * k / STEPS  # each as far as the bar's end: there are no seams where the next one begins
            boxes.append(Box(pad + left, y + 0.1 * line, inner - left, 0.7 * line, (red, green, blue)))
        y += line
        words.append(PlacedText(pad, y, scale.low))
        words.append(PlacedText(pad + (inner - measure(scale.middle)) / 2.0, y, scale.middle, QUIET))
        words.append(PlacedText(pad + inner - measure(scale.high), y, scale.high))
        y += step
    if legend.columns:
        words += values(legend.columns, QUIET)
        y += step
    for row in rows:
        if row.color is not None:
            side = 0.76 * line
            boxes.append(Box(pad, y + 0.12 * line, side, side, row.color))
            if row.stripes is not None:
                boxes += [Box(pad + k * side, y + 0.12 * line, side / 4.0, side, row.stripes) for k in (0.25, 0.75)]
            words.append(PlacedText(pad + indent, y, row.name))
        else:
            words.append(PlacedText(pad, y, row.name, QUIET))
        words += values(row.values, QUIET if row.quiet else LIGHT)
        if row.meaning:
            tips.append((y, y + step, row.meaning))
        y += step
    for note in legend.notes:
        for text in wrapped(note.text, measure, inner):
            words.append(PlacedText(pad, y, text, NOTES[note.kind]))
            y += step
    height = y - (step - line) + pad
    return Layout(inner + 2.0 * pad, height, tuple(words), tuple(boxes), tuple(tips))


def _scale_width(legend: Legend, measure: Measure, line: float) -> float:
    if legend.scale is None:
        return 0.0
    scale = legend.scale
    ends = 2.0 * max(measure(scale.low), measure(scale.high)) + measure(scale.middle)
    return max(ends + 2.0 * line, 11.0 * line)
