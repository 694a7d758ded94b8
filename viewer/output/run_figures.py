"""Figures of experiments, zoom tests and sweeps, as `figures` draws them."""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogFormatter, MaxNLocator, NullLocator, PercentFormatter

from tracer.experiments import zoom
from tracer.experiments.experiment import REFERENCE, Results, Row, table
from viewer.output.figures import COLORS, DASHES, MARKS, SIZE, bare, label_right, look, page, styled
from viewer.output.filmstrip import Filmstrip, Shot
from viewer.output.reports import (
    NEVER_WHOLE,
    WRONG_PIXELS,
    frames_in_words,
    happenings,
    modes_in_words,
    never_whole,
    zoom_title,
)
from viewer.state.plans import MOST_FACTORS
from viewer.util.numbers import saved

if TYPE_CHECKING:  # this needs pyarrow
    from tracer.experiments.sweep_summary import Line

# --- experiments -----------------------------------------------------------------------------------

_PANELS = (("steps", "Traversal steps\nsaved"), ("tests", "Intersection tests\nsaved"))
_FEW = 40  # frames up to which each has a dot


@styled
def savings_figure(results: Results, verified: bool) -> Figure:
    """Draw the part of the shadow rays' work that each method saves against the reference, frame by frame.

    One curve per method for traversal steps and one for intersection tests, each with its average
    and its maximum; where `verified`, the wrong answers of each frame below them, or that there are
    none.  Raises ValueError where there is no frame, or no method beside the reference.
    """
    rows = [row for row in table(results) if row.method != REFERENCE]
    if not rows:
        raise ValueError("there is nothing to plot: no frame, or no method to compare with the reference")
    wrong = verified and any(row.wrong for row in rows)
    figure = page(_title(results, rows, verified))
    heights = [3, 3, 1.6] if wrong else [1, 1]
    panels: Sequence[Axes] = figure.subplots(len(heights), sharex=True, gridspec_kw={"height_ratios": heights})
    for panel, (work, label) in zip(panels, _PANELS):
        _draw_savings(panel, results, rows, work)
        panel.set_ylabel(label)
    if wrong:
        _draw_wrong(panels[-1], results, rows)
    panels[-1].set_xlabel("Frame")
    panels[-1].xaxis.set_major_locator(MaxNLocator(steps=[1, 2, 5, 10], integer=True, min_n_ticks=1))
    first, last = results.frames[0], results.frames[-1]
    margin = max(0.5, 0.03 * (last - first))
    panels[-1].set_xlim(first - margin, last + margin)
    figure.align_ylabels(panels)
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
    label_right(panel, labels, 0.135 if len(rows) == 1 else 0.27)


_COLUMNS = ("average_{}", "most_{}", "most_{}_frame")  # of a Row


def _draw_curve(panel: Axes, results: Results, values: Sequence[float] | np.ndarray, number: int) -> str:
    """One value per frame, in the look of the method of this number; returns its colour."""
    dot = "." if len(results.frames) <= _FEW else ""
    (drawn,) = panel.plot(results.frames, values, marker=dot, markersize=9, **look(number, mark=False))
    return str(drawn.get_color())


def _label_above(panel: Axes, results: Results, frame: int, value: float, text: str, color: str) -> None:
    """A label above a point of a curve, inside the panel at either end too."""
    first, last = results.frames[0], results.frames[-1]
    place = (frame - first) / max(last - first, 1)
    side = "left" if place < 0.15 else "right" if place > 0.85 else "center"
    panel.annotate(text, (frame, value), (0, 11), textcoords="offset points", ha=side, va="bottom", color=color)


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
    label_right(panel, labels, 0.25)


# --- zoom tests ------------------------------------------------------------------------------------

_LETTERS = 132  # of a line as wide as the figure
_LINES = 9  # about changed modes under a panel, at most
_LINES_OF_STEP = 3
_INCHES_OF_LINE = 0.21
_INCHES = 5.2  # of height for the panels
_WIDE = 4  # columns that have room for long titles


@styled
def zoom_figure(results: zoom.Results) -> Figure:
    """A column for each factor of a zoom test, over its steps.

    The primitive's pixels on a logarithmic scale, the count past which it is examined again, and marks
    where its modes change; below, its pixels with wrong shadows, and what the modes are from each mark
    on.  Raises ValueError where there is no step, or more than MOST_FACTORS factors.
    """
    approaches = [approach for approach in results.approaches if approach.steps]
    if not approaches:
        raise ValueError("there is nothing to plot: no step")
    if len(approaches) > MOST_FACTORS:
        raise ValueError(f"{len(approaches)} zoom factors cannot be drawn side by side, only {MOST_FACTORS}")
    names = [_names_of_changes(approach, _LETTERS // len(approaches)) for approach in approaches]
    below = _INCHES_OF_LINE * max(1, *(len(lines) for lines in names))
    told_above = f"A primitive approached step by step, and its shadows\n{zoom_title(results)}"
    if never_whole(results):
        told_above += f"\n{NEVER_WHOLE.capitalize()}"
    figure = page(told_above)
    heights = [0.72 * (_INCHES - below), 0.28 * (_INCHES - below), below]
    panels: np.ndarray = figure.subplots(
        3, len(approaches), sharex="row", sharey="row", squeeze=False, gridspec_kw={"height_ratios": heights}
    )
    most = max(approach.most_wrong for approach in approaches)
    last = max(approach.steps[-1].number for approach in approaches)
    for panel in panels[:2].flat:
        panel.set_xlim(-0.04 * last - 0.5, 1.04 * last + 0.5)
        panel.xaxis.set_major_locator(MaxNLocator(min(9, 24 // len(approaches)), integer=True))
    for (counts, wrong, told_below), approach, lines in zip(panels.T, approaches, names):
        _draw_counts(counts, approach)
        counts.set_title(f"{'Zoom factor' if len(approaches) <= _WIDE else 'Factor'} {approach.factor:g}")
        _draw_wrong_pixels(wrong, approach, most)
        told_below.axis("off")
        told_below.text(0.0, 1.0, "\n".join(lines), transform=told_below.transAxes, va="top", fontsize=12.0)
    panels[0, 0].set_ylabel("Pixels")
    panels[1, 0].set_ylabel("\n".join(textwrap.wrap(WRONG_PIXELS.capitalize(), 15)), fontsize=12.0)
    figure.align_ylabels(panels[:2, 0])
    figure.legend(*panels[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return figure


def _names_of_changes(approach: zoom.Approach, width: int) -> list[str]:
    """_LINES of so many letters at most about which modes change, and when."""
    changed = [step for step in approach.steps if step.changes]
    # Where they are too many, those of the occlusion mode say more.
    by_weight = sorted(changed, key=lambda step: all(change.light is not None for change in step.changes))
    shown: dict[int, list[str]] = {}
    for step in by_weight:
        text = f"step {step.number}: {modes_in_words(step.changes)}"
        indent = min(6, width // 4) * " "
        lines = textwrap.wrap(text, width, subsequent_indent=indent, max_lines=_LINES_OF_STEP, placeholder=" …")
        if sum(map(len, shown.values())) + len(lines) > _LINES - 1:
            break
        shown[step.number] = lines
    lines = [line for number in sorted(shown) for line in shown[number]]
    return lines if len(shown) == len(changed) else [*lines, f"and {len(changed) - len(shown)} more"]


class _PlainNumbers(LogFormatter):
    """100,000 and not a power, for those ticks of a logarithmic scale that have room for a label."""

    def __call__(self, x: float, pos: int | None = None) -> str:
        return f"{x:,.12g}" if super().__call__(x, pos) else ""


def _draw_counts(panel: Axes, approach: zoom.Approach) -> None:
    numbers = [step.number for step in approach.steps]
    pixels = [max(step.pixels, 0.5) for step in approach.steps]  # none is a half: a logarithmic scale has no 0
    limits = [approach.factor * step.highest or np.nan for step in approach.steps]
    changed = [step.number for step in approach.steps if step.changes]
    panel.set_yscale("log")
    panel.yaxis.set_major_formatter(_PlainNumbers())
    panel.yaxis.set_minor_formatter(_PlainNumbers())
    panel.step(numbers, limits, where="post", color=COLORS[2], linestyle=DASHES[1], label="zoom factor × highest count")
    panel.plot(numbers, pixels, ".-", color=COLORS[0], markersize=9, label="the primitive's pixels")
    marks = [pixels[number] for number in changed]
    panel.plot(changed, marks, "D", color="black", markersize=9, mec="white", label="its modes change")
    panel.tick_params(labelbottom=False)


def _draw_wrong_pixels(panel: Axes, approach: zoom.Approach, most: int) -> None:
    panel.bar([step.number for step in approach.steps], [s.wrong_of_primitive for s in approach.steps], color=COLORS[1])
    panel.set_xlabel("Step")
    panel.set_ylim(0.0, 1.08 * max(most, 1))
    panel.yaxis.set_major_locator(MaxNLocator(3, integer=True))
    if not approach.most_wrong:
        panel.text(0.5, 0.5, "none", transform=panel.transAxes, ha="center", va="center")


COLUMNS = 8


@styled
def film_figure(film: Filmstrip, results: zoom.Results) -> Figure:
    """Draw up to COLUMNS recorded pictures of each factor's way, as the paper's Figure 4.

    The steps are the same for all: those where something happens first.

    Raises ValueError where no picture was kept."""
    approaches = [approach for approach in results.approaches if film.of(approach.factor)]
    numbers = chosen_steps(results, sorted({shot.number for a in approaches for shot in film.of(a.factor)}))
    if not numbers:
        raise ValueError("there is nothing to draw: no step")
    figure = page(zoom_title(results), (SIZE[0], 1.1 + 2.25 * len(approaches)))
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
    happened = sorted({step.number for approach in results.approaches for step in happenings(approach)} & set(kept))
    wanted = [kept[0], kept[-1], *happened]
    even = [kept[round(i * (len(kept) - 1) / (COLUMNS - 1))] for i in range(COLUMNS)]
    return sorted(list(dict.fromkeys([*wanted, *even]))[:COLUMNS])


# --- sweeps ----------------------------------------------------------------------------------------

MOST_PANELS = 6
_ROWS: tuple[tuple[str, Callable[[Line], float]], ...] = (
    (_PANELS[0][1], lambda line: line.steps),
    (_PANELS[1][1], lambda line: line.tests),
    ("Speed-up over none\n(processor time)", lambda line: line.speed_up),
)


@styled
def sweep_figure(title: str, lines: Sequence[Line]) -> Figure:
    """Draw a column of panels for each scene and combination of settings, with a curve for each method over sizes.

    Raises ValueError where there is nothing to compare, or too much for one figure."""
    drawn = [line for line in lines if line.method != REFERENCE and line.steps == line.steps]
    if not drawn:
        raise ValueError(f"there is nothing to plot: no frame by {REFERENCE} and by another method")
    columns = list(dict.fromkeys((line.scene, line.settings) for line in drawn))
    if len(columns) > MOST_PANELS:
        raise ValueError(
            f"{len(columns)} scenes and combinations of settings, more than the {MOST_PANELS} of one plot; "
            "plot studies of fewer, or draw results.parquet by other means"
        )
    methods = list(dict.fromkeys(line.method for line in drawn))
    frames = sum(line.frames for line in lines)
    figure = page(f"{title}\n{frames:,} frames", (max(SIZE[0], 3.6 * len(columns) + 2.4), 9.0))
    panels = figure.subplots(len(_ROWS), len(columns), squeeze=False, sharex="col", sharey="row")
    for column, (scene, settings) in enumerate(columns):
        mine = [line for line in drawn if (line.scene, line.settings) == (scene, settings)]
        panels[0][column].set_title("\n".join(filter(None, (scene, settings))), fontsize=15.0)
        for row, (_, value) in enumerate(_ROWS):
            _draw_sizes(panels[row][column], mine, methods, value)
        _name_sizes(panels[-1][column], mine)
    for row, (label, _) in enumerate(_ROWS):
        panels[row][0].set_ylabel(label)
        if row < 2:
            panels[row][0].yaxis.set_major_formatter(PercentFormatter(1.0, decimals=0))
    for panel in panels[-1]:
        panel.axhline(1.0, color="black", linewidth=1.0)
    handles, names = panels[0][0].get_legend_handles_labels()
    figure.legend(handles, names, loc="outside right upper")
    figure.align_ylabels()
    return figure


def _draw_sizes(panel: Axes, lines: Sequence[Line], methods: Sequence[str], value: Callable[[Line], float]) -> None:
    for number, method in enumerate(methods):
        of_method = sorted((line for line in lines if line.method == method), key=_pixels)
        sizes, values = [_pixels(line) for line in of_method], [value(line) for line in of_method]
        panel.plot(sizes, values, label=method, markersize=8, **look(number))


def _name_sizes(panel: Axes, lines: Sequence[Line]) -> None:
    """Sizes on a scale of pixels, on which each step of a pyramid is as wide as the others."""
    sizes = {_pixels(line): f"{line.width}×{line.height}" for line in lines}
    panel.set_xscale("log", base=2)
    panel.xaxis.set_minor_locator(NullLocator())
    panel.set_xticks(list(sizes))
    panel.xaxis.set_major_formatter(FuncFormatter(lambda x, _: sizes.get(round(x), "")))
    panel.tick_params(axis="x", labelsize=12.0, labelrotation=30.0 if len(sizes) > 2 else 0.0)


def _pixels(line: Line) -> int:
    return line.width * line.height
