"""The figure of a zoom test: a primitive's pixels, its wrong ones, and its modes, over the steps."""

from __future__ import annotations

import textwrap

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogFormatter, MaxNLocator

from tracer.experiments import zoom
from viewer.output.figures import COLORS, DASHES, SIZE, styled
from viewer.output.reports import NEVER_WHOLE, WRONG_PIXELS, modes_in_words, never_whole, zoom_title
from viewer.state.plans import MOST_FACTORS

_LETTERS = 138  # of a line as wide as the figure
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
    figure = Figure(figsize=SIZE, layout="constrained")
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
    told_above = f"A primitive approached step by step, and its shadows\n{zoom_title(results)}"
    if never_whole(results):
        told_above += f"\n{NEVER_WHOLE.capitalize()}"
    figure.suptitle(told_above, x=0.01, ha="left", fontsize=18.0)
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
