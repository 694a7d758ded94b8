"""Figures for slides and papers: of experiments and zoom tests, and what all figures have in common.

Importing this loads matplotlib, which takes a second: import it where a figure is wanted.  Nothing of a user's own
matplotlib settings shows, and the same data give the same file.
"""

from __future__ import annotations

import io
import threading
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib import style
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.ticker import LogLocator, MaxNLocator, NullFormatter, PercentFormatter

from tracer.experiments import zoom
from tracer.experiments.experiment import REFERENCE, Results, Row, table
from tracer.experiments.filmstrip import Filmstrip, Shot
from tracer.experiments.titles import NEVER_WHOLE, WRONG_PIXELS, happenings, never_whole, title
from tracer.method import title_of
from tracer.util.text import saved

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

_drawing = threading.RLock()


@contextmanager
def styled() -> Iterator[None]:
    """Draw or write in this module's style, on one thread at a time: matplotlib's settings are global."""
    with _drawing, style.context(["default", _STYLE]):
        yield


def check_ending(path: Path) -> None:
    """Raise ValueError, in one line, for a file that is none of ENDINGS."""
    if path.suffix.lower() not in ENDINGS:
        raise ValueError(f"{path}: unknown kind of plot; give one of {' '.join(ENDINGS)}")


@styled()
def file_of(figure: Figure, ending: str, kept: Mapping[str, str] | None = None) -> bytes:
    """Return a figure as a file with this ending, one of ENDINGS, with texts to be kept in it."""
    no_date: dict[str, dict[str, Any]] = {".svg": {"Date": None}, ".pdf": {"CreationDate": None}}
    file, metadata = io.BytesIO(), {**no_date.get(ending.lower(), {}), **(kept or {})}
    figure.savefig(file, format=ending.lower()[1:], dpi=_DPI, metadata=metadata)
    return file.getvalue()


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


def look(number: int) -> dict[str, Any]:
    """Return how the curve with this number is drawn: its colour and its dashes."""
    return {"color": COLORS[number % len(COLORS)], "linestyle": DASHES[number % len(DASHES)]}


def _over(figure: Figure, panels: Sequence[Axes], what: str) -> Figure:
    """Finish panels below each other over the same whole numbers: their curves are named at their right."""
    for panel in panels:
        panel.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), borderaxespad=0.0, labelspacing=0.8)
    panels[-1].set_xlabel(what)
    panels[-1].xaxis.set_major_locator(MaxNLocator(steps=[1, 2, 5, 10], integer=True, min_n_ticks=1))
    figure.align_ylabels(panels)
    return figure


# --- experiments -----------------------------------------------------------------------------------

_WORKS = (("steps", "Traversal steps\nsaved"), ("tests", "Intersection tests\nsaved"))
_FEW = 40  # frames up to which each has a dot


@styled()
def savings_figure(results: Results) -> Figure:
    """Draw the part of the shadow rays' work that each method saves against the reference, frame by frame.

    One curve per method for traversal steps and one for intersection tests, each with its average and its maximum; of
    verified frames the wrong answers below them, or that there are none.  Raises ValueError where there is no frame, or
    no method beside the reference."""
    verified = bool(results.settings.get("verify"))
    rows = [row for row in table(results) if row.method != REFERENCE]
    if not rows:
        raise ValueError("there is nothing to plot: no frame, or no method to compare with the reference")
    any_wrong = any(row.wrong for row in rows)
    checked = ("" if any_wrong else ", no wrong answer") if verified else ", answers not verified"
    figure = page(f"Work of shadow rays saved by culling\n{title(results)}{checked}")
    heights = [3.0, 3.0, 1.6] if verified and any_wrong else [1.0, 1.0]
    panels: Sequence[Axes] = figure.subplots(len(heights), sharex=True, gridspec_kw={"height_ratios": heights})
    for panel, (work, label) in zip(panels, _WORKS):
        for number, row in enumerate(rows):
            _draw_savings(panel, results, row, work, number)
        panel.set_ylim(min(0.0, panel.get_ylim()[0]), max(0.05, panel.get_ylim()[1]))
        panel.yaxis.set_major_formatter(PercentFormatter(1.0, decimals=0))
        panel.set_ylabel(label)
    for panel in panels[2:]:
        for number, row in enumerate(rows):
            _draw_curve(panel, results, results.methods[row.method]["wrong"], number,
                        f"{title_of(row.method)}, {row.wrong:,} ({row.wrong_part:.3%})")  # fmt: skip
        panel.set_ylim(bottom=0.0)
        panel.yaxis.set_major_locator(MaxNLocator(3, integer=True))
        panel.yaxis.set_major_formatter("{x:,.0f}")
        panel.set_ylabel("Wrong\nanswers")
    return _over(figure, panels, "Frame")


def _draw_savings(panel: Axes, results: Results, row: Row, work: str, number: int) -> None:
    """A curve, with its average and its maximum, which are those of the table."""
    average, most, frame = (getattr(row, name.format(work)) for name in ("average_{}", "most_{}", "most_{}_frame"))
    label = f"{title_of(row.method)}, average {saved(average)}\nmost {saved(most)}, frame {frame}"
    color = _draw_curve(panel, results, results.reductions(row.method, work), number, label)
    panel.axhline(average, linewidth=1.0, color=color, linestyle=DASHES[number % len(DASHES)])
    panel.plot([frame], [most], MARKS[number % len(MARKS)], color=color, markersize=11, mec="white", zorder=4)


def _draw_curve(panel: Axes, results: Results, values: Sequence[float] | np.ndarray, number: int, label: str) -> str:
    """One value per frame, in the look of the method of this number; returns its colour."""
    dot = "." if len(results.frames) <= _FEW else ""
    (drawn,) = panel.plot(results.frames, values, marker=dot, markersize=9, label=label, **look(number))
    return str(drawn.get_color())


# --- zoom tests ------------------------------------------------------------------------------------


@styled()
def zoom_figure(results: zoom.Results) -> Figure:
    """Draw a zoom test over its steps: the primitive's pixels on a logarithmic scale, and for each factor the count
    past which it is examined again, marks where its modes change, and below its pixels with wrong shadows.

    Raises ValueError where there is no step."""
    approaches = [approach for approach in results.approaches if approach.steps]
    if not approaches:
        raise ValueError("there is nothing to plot: no step")
    never = f"\n{NEVER_WHOLE.capitalize()}" * never_whole(results)
    figure = page(f"A primitive approached step by step, and its shadows\n{title(results)}{never}")
    counts, wrong = figure.subplots(2, sharex=True, gridspec_kw={"height_ratios": [3.0, 1.6]})
    longest = max(approaches, key=lambda approach: len(approach.steps))
    pixels = [max(step.pixels, 0.5) for step in longest.steps]  # none is a half: a logarithmic scale has no 0
    counts.plot([step.number for step in longest.steps], pixels, ".-", color="black", label="the primitive's pixels")
    for place, approach in enumerate(approaches):
        numbers, factor = [step.number for step in approach.steps], f"{approach.factor:g}"
        limits = [approach.factor * step.highest or np.nan for step in approach.steps]
        looks = look(place)
        counts.step(numbers, limits, where="post", label=f"{factor} × last examination", **looks)
        changed = [step.number for step in approach.steps if step.changes]
        marks = [max(approach.steps[number].pixels, 0.5) for number in changed]
        mark = {"marker": MARKS[place % len(MARKS)], "color": looks["color"], "linestyle": "", "mec": "white"}
        counts.plot(changed, marks, markersize=11, label=f"modes change, factor {factor}", **mark)
        wrong.step(
            numbers, [s.wrong_of_primitive for s in approach.steps], where="mid", label=f"factor {factor}", **looks
        )
    counts.set_yscale("log")
    counts.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    counts.yaxis.set_major_formatter("{x:,.12g}")
    counts.yaxis.set_minor_formatter(NullFormatter())
    counts.set_ylabel("Pixels")
    wrong.set_ylabel(WRONG_PIXELS.replace(" of", "\nof").capitalize())
    wrong.set_ylim(bottom=0.0, top=1.08 * max(1, *(approach.most_wrong for approach in approaches)))
    wrong.yaxis.set_major_locator(MaxNLocator(3, integer=True))
    return _over(figure, (counts, wrong), "Step")


COLUMNS = 8


@styled()
def film_figure(film: Filmstrip, results: zoom.Results) -> Figure:
    """Draw up to COLUMNS recorded pictures of each factor's way, as the paper's Figure 4.

    The steps are the same for all: those where something happens first.

    Raises ValueError where no picture was kept."""
    approaches = [approach for approach in results.approaches if film.of(approach.factor)]
    numbers = chosen_steps(results, sorted({shot.number for a in approaches for shot in film.of(a.factor)}))
    if not numbers:
        raise ValueError("there is nothing to draw: no step")
    figure = page(title(results), (SIZE[0], 1.1 + 2.25 * len(approaches)))
    panels = figure.subplots(len(approaches), len(numbers), squeeze=False)
    for row, approach in zip(panels, approaches):
        shots: dict[int, Shot] = {shot.number: shot for shot in film.of(approach.factor)}
        steps = {step.number: step for step in approach.steps}
        for panel, number in zip(row, numbers):
            bare(panel)
            if number not in shots or number not in steps:
                panel.axis("off")
                continue
            panel.imshow(shots[number].pixels(), interpolation="nearest")
            step = steps[number]
            panel.set_title(f"step {number}", fontsize=12.0)
            wrong = f"{step.wrong_of_primitive:,} wrong"
            panel.set_xlabel(f"{step.pixels:,} px\n{wrong}", fontsize=11.0, color=COLORS[1] if step.wrong else "black")
        row[0].set_ylabel(f"zoom factor {approach.factor:g}", fontsize=13.0)
    return figure


def chosen_steps(results: zoom.Results, kept: list[int]) -> list[int]:
    """Return up to COLUMNS of the kept steps: first and last, where something happens, and between."""
    if len(kept) <= COLUMNS:
        return kept
    happened = sorted({step.number for _, step in happenings(results)} & set(kept))
    wanted = [kept[0], kept[-1], *happened]
    even = [kept[round(i * (len(kept) - 1) / (COLUMNS - 1))] for i in range(COLUMNS)]
    return sorted(list(dict.fromkeys([*wanted, *even]))[:COLUMNS])
