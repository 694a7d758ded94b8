"""What all figures for slides and papers have in common: style, title, curves and labels, and files.

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

from viewer.util.files import write_whole

ENDINGS = (".png", ".svg", ".pdf")
# Okabe and Ito's colours, those that read well as letters first; in greys, dashes and marks distinguish methods.
COLORS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00")
DASHES: tuple[Any, ...] = ("-", (0, (4, 1.5)), (0, (1, 1.2)), (0, (5, 1.5, 1, 1.5)), (0, (8, 2)), (0, (2, 2)))
MARKS = ("o", "s", "^", "D", "v", "P")

SIZE = (12.8, 7.2)  # inches: a slide of 16:9, 1920 x 1080 pixels
_DPI = 150
_MARGIN = 0.12  # inches that keep the labels beside panels off the edge
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


def page(title: str, size: tuple[float, float] = SIZE) -> Figure:
    """Begin a figure, so many inches wide and high, with its title at the left."""
    figure = Figure(figsize=size, layout=ConstrainedLayoutEngine(w_pad=_MARGIN))
    figure.suptitle(title, x=0.01, ha="left", fontsize=18.0)
    return figure


def bare(panel: Axes) -> None:
    """Take a panel's ticks and borders away, for a picture."""
    panel.set_xticks([])
    panel.set_yticks([])
    panel.grid(False)
    for side in panel.spines.values():
        side.set_visible(False)


def look(number: int, mark: bool = True) -> dict[str, Any]:
    """Return how the curve with this number is drawn: its colour, its dashes, and its mark."""
    found = {"color": COLORS[number % len(COLORS)], "linestyle": DASHES[number % len(DASHES)]}
    return found | ({"marker": MARKS[number % len(MARKS)]} if mark else {})


def label_right(panel: Axes, labels: Sequence[tuple[float, str, str]], room: float) -> None:
    """Write labels (height, text, colour) beside a panel, at their heights where that leaves each other room.

    `room` is the part of the panel's height that a label takes."""
    low, high = panel.get_ylim()
    heights = spread([height for height, _, _ in labels], room * (high - low), low, high)
    beside = panel.get_yaxis_transform()
    for (_, text, color), height in zip(labels, heights):
        panel.annotate(text, (1.0, height), (8, 0), beside, "offset points", va="center", color=color)


def spread(heights: Sequence[float], gap: float, low: float, high: float) -> list[float]:
    """Move heights as little as need be to lie `gap` apart, in their order, and half a gap inside the range.

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
