"""The results of a sweep as a figure: for each scene what each method saves, and how fast it is, over the sizes."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.ticker import FuncFormatter, NullLocator, PercentFormatter

from tracer.experiments.experiment import REFERENCE
from tracer.experiments.sweep_summary import Line
from viewer.output.figures import COLORS, DASHES, MARKS, SIZE, styled

MOST_PANELS = 6
_ROWS: tuple[tuple[str, Callable[[Line], float]], ...] = (
    ("Traversal steps\nsaved", lambda line: line.steps),
    ("Intersection tests\nsaved", lambda line: line.tests),
    ("Speed-up over none\n(processor time)", lambda line: line.speed_up),
)


@styled
def sweep_figure(title: str, lines: Sequence[Line]) -> Figure:
    """Columns of panels, one for each scene and combination of settings; in each a curve for each method, over sizes.

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
    figure = Figure(figsize=(max(SIZE[0], 3.6 * len(columns) + 2.4), 9.0), layout=ConstrainedLayoutEngine(w_pad=0.1))
    panels = figure.subplots(len(_ROWS), len(columns), squeeze=False, sharex="col", sharey="row")
    for column, (scene, settings) in enumerate(columns):
        mine = [line for line in drawn if (line.scene, line.settings) == (scene, settings)]
        panels[0][column].set_title("\n".join(filter(None, (scene, settings))), fontsize=15.0)
        for row, (_, value) in enumerate(_ROWS):
            _draw(panels[row][column], mine, methods, value)
        _name_sizes(panels[-1][column], mine)
    for row, (label, _) in enumerate(_ROWS):
        panels[row][0].set_ylabel(label)
        if row < 2:
            panels[row][0].yaxis.set_major_formatter(PercentFormatter(1.0, decimals=0))
    for panel in panels[-1]:
        panel.axhline(1.0, color="black", linewidth=1.0)
    handles, names = panels[0][0].get_legend_handles_labels()
    figure.legend(handles, names, loc="outside right upper")
    frames = sum(line.frames for line in lines)
    figure.suptitle(f"{title}\n{frames:,} frames", x=0.01, ha="left", fontsize=18.0)
    figure.align_ylabels()
    return figure


def _draw(panel: Axes, lines: Sequence[Line], methods: Sequence[str], value: Callable[[Line], float]) -> None:
    for number, method in enumerate(methods):
        of_method = sorted((line for line in lines if line.method == method), key=_pixels)
        panel.plot(
            [_pixels(line) for line in of_method],
            [value(line) for line in of_method],
            label=method,
            color=COLORS[number % len(COLORS)],
            linestyle=DASHES[number % len(DASHES)],
            marker=MARKS[number % len(MARKS)],
            markersize=8,
        )


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
