"""Figures for slides and papers, drawn from plain data, and the files they are written to.

Importing this loads matplotlib, which takes a second: import it where a figure is wanted.  Nothing
of a user's own matplotlib settings shows, and the same data give the same file.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from matplotlib import style
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.ticker import MaxNLocator, PercentFormatter

from tracer.experiments.experiment import REFERENCE, Results, Row, table
from viewer.output.reports import frames_in_words
from viewer.util.files import write_whole
from viewer.util.numbers import saved

ENDINGS = (".png", ".svg", ".pdf")
# Okabe and Ito's colours, those that read well as letters first; in greys, dashes and marks distinguish methods.
COLORS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00")
DASHES: tuple[Any, ...] = ("-", (0, (4, 1.5)), (0, (1, 1.2)), (0, (5, 1.5, 1, 1.5)), (0, (8, 2)), (0, (2, 2)))
MARKS = ("o", "s", "^", "D", "v", "P")

SIZE = (12.8, 7.2)  # inches: a slide of 16:9, 1920 x 1080 pixels
_DPI = 150
_STYLE: dict[str, Any] = {
    "font.size": 15.0,
    "axes.labelsize": 16.0,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "#DDDDDD",
    "lines.linewidth": 2.5,
    "legend.frameon": False,
    "pdf.fonttype": 42,  # letters stay letters
    "svg.hashsalt": "shadowcull",
}
_PANELS = (("steps", "Traversal steps saved"), ("tests", "Intersection tests saved"))
_MARGIN = 0.12  # inches that keep the labels beside panels off the edge
_FEW = 40  # frames up to which each has a dot

styled = style.context(["default", _STYLE])
"""Decorates a function that draws or writes, to do it in this module's style."""


def check_ending(path: Path) -> None:
    """Raise ValueError, in one line, for a file that is none of ENDINGS."""
    if path.suffix.lower() not in ENDINGS:
        raise ValueError(f"{path}: unknown kind of plot; give one of {' '.join(ENDINGS)}")


@styled
def save(figure: Figure, path: Path, kept: Mapping[str, str] | None = None) -> None:
    """Write a figure as its ending says, one of ENDINGS, whole or not at all, with texts to be kept in it; raises
    OSError in one line."""
    kind = path.suffix.lower()[1:]
    no_date: dict[str, dict[str, Any]] = {"svg": {"Date": None}, "pdf": {"CreationDate": None}}

    def write(file: BinaryIO) -> None:
        figure.savefig(file, format=kind, dpi=_DPI, metadata={**no_date.get(kind, {}), **(kept or {})})

    write_whole(path, write)


@styled
def savings_figure(results: Results, verified: bool) -> Figure:
    """Part of the shadow rays' work that each method saves against the reference, frame by frame.

    One curve per method for traversal steps and one for intersection tests, each with its average
    and its maximum; where `verified`, the wrong answers of each frame below them, or that there are
    none.  Raises ValueError where there is no frame, or no method beside the reference.
    """
    rows = [row for row in table(results) if row.method != REFERENCE]
    if not rows:
        raise ValueError("there is nothing to plot: no frame, or no method to compare with the reference")
    wrong = verified and any(row.wrong for row in rows)
    figure = Figure(figsize=SIZE, layout=ConstrainedLayoutEngine(w_pad=_MARGIN))
    heights = [3, 3, 1.6] if wrong else [1, 1]
    panels: Sequence[Axes] = figure.subplots(len(heights), sharex=True, gridspec_kw={"height_ratios": heights})
    for panel, (work, label) in zip(panels, _PANELS):
        _draw_savings(panel, results, rows, work)
        panel.set_ylabel(label.replace(" ", "\n", 1))
    if wrong:
        _draw_wrong(panels[-1], results, rows)
    panels[-1].set_xlabel("Frame")
    panels[-1].xaxis.set_major_locator(MaxNLocator(steps=[1, 2, 5, 10], integer=True, min_n_ticks=1))
    first, last = results.frames[0], results.frames[-1]
    margin = max(0.5, 0.03 * (last - first))
    panels[-1].set_xlim(first - margin, last + margin)
    figure.align_ylabels(panels)
    figure.suptitle(_title(results, rows, verified), x=0.01, ha="left", fontsize=18.0)
    return figure


def _title(results: Results, rows: list[Row], verified: bool) -> str:
    width, height = results.size
    text = f"{Path(results.scene).name}, {width} × {height} pixels, {frames_in_words(results)}"
    if not verified:
        text += ", answers not verified"
    elif not any(row.wrong for row in rows):
        text += ", no wrong answer"
    return f"Work of shadow rays saved by culling\n{text}"


def _draw_savings(panel: Axes, results: Results, rows: list[Row], work: str) -> None:
    """The curves of one kind of work; average and maximum are those of the table.

    The maximum's figures stand above it where there is one curve, and beside the panel where there are several.
    """
    labels = []
    lowest, highest = 0.0, 0.05
    for number, row in enumerate(rows):
        savings = results.reductions(row.method, work)
        average, most, frame = (getattr(row, name.format(work)) for name in _COLUMNS)
        color = _draw_curve(panel, results, savings, number)
        panel.axhline(average, linewidth=1.0, color=color, linestyle=DASHES[number % len(DASHES)])
        panel.plot([frame], [most], MARKS[number % len(MARKS)], color=color, markersize=11, mec="white", zorder=4)
        label, greatest = f"{row.method}, average {saved(average)}", f"most {saved(most)}, frame {frame}"
        if len(rows) == 1:
            _label_above(panel, results, frame, most, greatest, color)
        else:
            label += f"\n{greatest}"
        labels.append((average, label, color))
        lowest, highest = min(lowest, float(savings.min())), max(highest, most)
    extent = highest - lowest
    panel.set_ylim(lowest - 0.03 * extent, highest + (0.22 if len(rows) == 1 else 0.08) * extent)
    panel.yaxis.set_major_locator(MaxNLocator(6, steps=[1, 2, 5, 10]))
    panel.yaxis.set_major_formatter(PercentFormatter(1.0, decimals=0))
    _label_right(panel, labels, 0.135 if len(rows) == 1 else 0.27)


_COLUMNS = ("average_{}", "most_{}", "most_{}_frame")  # of a Row


def _draw_curve(panel: Axes, results: Results, values: Sequence[float] | np.ndarray, number: int) -> str:
    """One value per frame, in the look of the method of this number; returns its colour."""
    color = COLORS[number % len(COLORS)]
    dot = "." if len(results.frames) <= _FEW else ""
    panel.plot(results.frames, values, color=color, linestyle=DASHES[number % len(DASHES)], marker=dot, markersize=9)
    return color


def _label_above(panel: Axes, results: Results, frame: int, value: float, text: str, color: str) -> None:
    """A label above a point of a curve, inside the panel at either end too."""
    first, last = results.frames[0], results.frames[-1]
    place = (frame - first) / max(last - first, 1)
    side = "left" if place < 0.15 else "right" if place > 0.85 else "center"
    panel.annotate(text, (frame, value), (0, 11), textcoords="offset points", ha=side, va="bottom", color=color)


def _label_right(panel: Axes, labels: list[tuple[float, str, str]], room: float) -> None:
    """Labels (height, text, colour) beside the panel, at their heights where that leaves each other room.

    `room` is the part of the panel's height that a label takes.
    """
    low, high = panel.get_ylim()
    heights = spread([height for height, _, _ in labels], room * (high - low), low, high)
    beside = panel.get_yaxis_transform()
    for (_, text, color), height in zip(labels, heights):
        panel.annotate(text, (1.0, height), (8, 0), beside, "offset points", va="center", color=color)


def spread(heights: Sequence[float], gap: float, low: float, high: float) -> list[float]:
    """The heights, moved as little as need be to lie `gap` apart, in their order, and half a gap inside the range.

    Where so many do not fit, they divide the range evenly.
    """
    order = np.argsort(heights, kind="stable")
    gap = min(gap, (high - low) / max(len(heights), 1))
    # From below each at least a gap above the last, then from above each at most a gap below the next.
    moved = np.maximum(np.array(heights, np.float64)[order], low + gap / 2)
    for i in range(1, len(moved)):
        moved[i] = max(moved[i], moved[i - 1] + gap)
    limit = high - gap / 2
    for i in reversed(range(len(moved))):
        moved[i] = limit = min(moved[i], limit)
        limit -= gap
    placed = np.empty(len(moved))
    placed[order] = moved
    return [float(height) for height in placed]


def _draw_wrong(panel: Axes, results: Results, rows: list[Row]) -> None:
    """Wrong answers of each frame, with their sum and their part of the shadow rays that were due."""
    labels = []
    for number, row in enumerate(rows):
        wrong = results.methods[row.method]["wrong"]
        color = _draw_curve(panel, results, wrong, number)
        labels.append((float(np.mean(wrong)), f"{row.method}, {row.wrong:,} ({row.wrong_part:.3%})", color))
    panel.set_ylabel("Wrong\nanswers")
    panel.set_ylim(bottom=0.0)
    panel.yaxis.set_major_locator(MaxNLocator(3, integer=True))
    panel.yaxis.set_major_formatter("{x:,.0f}")
    _label_right(panel, labels, 0.25)
