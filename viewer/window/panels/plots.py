"""The last frames' numbers: what became of shadow rays as stacked areas, work and milliseconds as curves, and, once it
was recorded, what lights send to what the camera sees."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from imgui_bundle import ImVec2, ImVec4, imgui, implot
from numpy.typing import NDArray

from tracer.culling.fate import Fate
from tracer.experiments.experiment import REFERENCE, Results
from tracer.method import title_of
from viewer.services.runs import Experiment
from viewer.state import terms
from viewer.state.palette import FATES, LIT, PARTLY_LIT
from viewer.util.numbers import whole_percent
from viewer.window.style import CONTRAST, GREY, LIME, ROSE, TAN, TEAL, VIOLET
from viewer.window.ui import Ui
from viewer.window.widgets import QUIET, checkbox, clipped, count, em, paragraph, tooltip, tooltip_at, width_of


@dataclass(frozen=True)
class _Plot:
    """A plot of curves: their labels, series and colours; `stacked` areas are together all rays that were due."""

    title: str
    curves: tuple[tuple[str, str, ImVec4], ...]
    stacked: bool = False
    logarithmic: bool = False
    per_pixel: bool = True
    only_if: str = ""  # the plot is shown once this series has a value


_PLOTS = (
    _Plot("What became of shadow rays",
          tuple((FATES[fate].name, series, ImVec4(*FATES[fate].color, 1.0)) for fate, series in (
              (Fate.CULLED, "culled"), (Fate.DYNAMIC_ONLY, "dynamic_only"), (Fate.CANDIDATES, "candidates_only"),
              (Fate.CACHED, "cache_hits"), (Fate.TRACED, "traced"))), stacked=True),
    _Plot("Samples of lights",
          (("due", "samples_due", GREY), ("reaching", "samples_reached", ImVec4(*LIT, 1.0)),
           ("penumbra", "penumbra", ImVec4(*PARTLY_LIT, 1.0))), only_if="samples_due"),
    _Plot("Steps and tests",
          (("steps", "steps", CONTRAST), ("for shadows", "shadow_steps", TAN), ("tests", "tests", VIOLET))),
    _Plot("Milliseconds", (("tracing", "traced_ms", TEAL), ("drawing", "drawn_ms", LIME)), logarithmic=True,
          per_pixel=False),
    _Plot("Tree built, %", ((terms.BUILT, "built", TEAL),), per_pixel=False, only_if="built"),
)  # fmt: skip
RECENT = 10.0
"""Seconds before the newest frame that can be shown alone."""
_LEAST_WIDTH = 15.0
"""Ems of a plot; what finds no room beside is below, and the panel scrolls."""
_LOW, _LEGEND_SQUARE = 9.0, 1.6  # ems of height of a low plot, and of width beside a label of the legend
FLAGS = int(implot.Flags_.no_menus | implot.Flags_.no_box_select | implot.Flags_.no_mouse_text)
AXIS = int(implot.AxisFlags_.no_highlight)
LEGEND = int(implot.LegendFlags_.outside | implot.LegendFlags_.no_menus)
COLORS = (TEAL, VIOLET, CONTRAST, TAN, ROSE, LIME)
_PER_PIXEL = (
    "Counts are divided by pixels, as pictures differ in size, and in motion only some pixels are shaded: those of "
    "primary rays and certificates by all pixels, others by the shaded ones."
)


@dataclass
class PlotsState:
    """The frame that the pointer was on last; `recent`, only the last seconds are shown."""

    pointed: int | None = None
    recent: bool = False


def whole_numbers(first: float, last: float, width: float) -> None:
    """Put ticks along the x axis of a plot of `first` to `last`, so many pixels wide: at whole numbers, and none so
    near to an edge that its label would be cut off."""
    label = imgui.calc_text_size(f"{last:.0f}").x
    pixel = (last - first) / max(width - em(5.0), em(2.0))  # beside the labels of the other axes, at least
    steps = (step * 10**power for power in range(12) for step in (1, 2, 5))
    step = next(step for step in steps if step >= 2.5 * label * pixel)
    ticks = range(math.ceil(first / step) * step, math.floor(last - 0.6 * label * pixel) + 1, step)
    implot.setup_axis_ticks(implot.ImAxis_.x1, [float(tick) for tick in ticks], [str(tick) for tick in ticks])


def setup_legend(labels: Sequence[str], size: ImVec2) -> None:
    """Put the legend of these labels where a plot of that size has room for all: below it, or beside a low one."""
    row = sum(width_of(label) + em(_LEGEND_SQUARE) for label in labels)
    if size.y < em(_LOW) and size.x > em(_LEAST_WIDTH):
        implot.setup_legend(implot.Location_.east, LEGEND)
    else:
        across = int(implot.LegendFlags_.horizontal) if row <= size.x else 0
        implot.setup_legend(implot.Location_.south, LEGEND | across)


def wrong_axis(most: int, condition: int, height: float) -> None:
    """Set up a right-hand axis y2 for bars of `most` at most, which stay in the lowest third of a plot so high, with as
    many whole numbers as that has room for."""
    implot.setup_axis(implot.ImAxis_.y2, "wrong", AXIS | int(implot.AxisFlags_.aux_default))
    implot.setup_axis_limits(implot.ImAxis_.y2, 0.0, 3.0 * max(most, 1), condition)
    lines = (height - em(5.0)) / 3.0 / imgui.get_text_line_height()
    ticks = sorted({max(1, most), *((0,) if lines >= 1.0 else ()), *((max(1, most // 2),) if lines >= 2.0 else ())})
    implot.setup_axis_ticks(implot.ImAxis_.y2, [float(tick) for tick in ticks], [count(tick) for tick in ticks])


def show(ui: Ui) -> None:
    """Draw the panel: plots side by side, over the number of the frame."""
    history = ui.controller.history
    if len(history) == 0:
        paragraph("Curves appear with the first frames.", QUIET)
        return
    if imgui.small_button("Clear"):
        history.clear_plots()
        return
    imgui.same_line()
    state = ui.state(PlotsState)
    tip = f"Show only the pictures of the {RECENT:.0f} seconds before the newest."
    checkbox(f"last {RECENT:.0f} s", state.recent, lambda on: setattr(state, "recent", on), tip)
    imgui.same_line()
    start = _start(ui) if state.recent else 0
    shown = len(history) - start
    clipped(f"the last {shown} pictures" if shown > 1 else "one picture", QUIET)
    tooltip(_PER_PIXEL)
    plots = [plot for plot in _PLOTS if not plot.only_if or history.values(plot.only_if).any()]
    room, spacing = imgui.get_content_region_avail(), imgui.get_style().item_spacing.x
    bar = imgui.get_style().scrollbar_size if imgui.get_scroll_max_y() > 0.0 else 0.0  # fewer rows may need none
    columns = min(max(int((room.x + bar + spacing) / (em(_LEAST_WIDTH) + spacing)), 1), len(plots))
    columns = math.ceil(len(plots) / math.ceil(len(plots) / columns))  # as many in each row
    size = ImVec2((room.x + spacing) / columns - spacing, max(room.y, em(8.0)))
    for number, plot in enumerate(plots):
        if number % columns:
            imgui.same_line()
        _draw(ui, plot, size, start)


def _start(ui: Ui) -> int:
    """Return the place of the first of the last seconds' frames among all that could be shown."""
    came = ui.controller.history.values("came")
    return int(np.searchsorted(came, came[-1] - RECENT))


def _draw(ui: Ui, plot: _Plot, size: ImVec2, start: int) -> None:
    history = ui.controller.history
    values_of = history.per_pixel if plot.per_pixel else history.values  # contiguous float64, as ImPlot wants them
    implot.push_style_var(implot.StyleVar_.legend_inner_padding, ImVec2(em(0.15), em(0.3)))
    implot.push_style_var(implot.StyleVar_.legend_spacing, ImVec2(em(0.2), 0.0))
    of = " per pixel" if plot.per_pixel and width_of(f"{plot.title} per pixel") <= size.x else ""
    shown = implot.begin_plot(f"{plot.title}{of}##{plot.title}", size, FLAGS)
    implot.pop_style_var(2)
    if not shown:
        return
    curves = [(label, values_of(name)[start:], color) for label, name, color in plot.curves]
    if plot.stacked:  # without a fate that no ray had
        curves = [one for one in curves if one[1].any()] or curves[-1:]
    number, many = history.first + start, len(history) - start
    first, last = number - 0.5, number + max(many - 1, 10) + 0.5
    top = float(values_of("due")[start:].max()) if plot.stacked else max(float(y.max()) for _, y, _ in curves)
    limits = (0.0, 1.12 * top or 1.0)
    implot.setup_axes("", "", AXIS, AXIS)
    whole_numbers(first, last, size.x)
    implot.setup_axis_format(implot.ImAxis_.y1, "%.4g")
    if plot.logarithmic:  # full frames and those in motion differ a hundredfold
        implot.setup_axis_scale(implot.ImAxis_.y1, int(implot.Scale_.log10))
        limits = (1.0, 10.0 * max(top, 1.0))
    implot.setup_axes_limits(first, last, *limits, int(imgui.Cond_.always))
    setup_legend([label for label, _, _ in curves], size)
    if plot.stacked:
        _stack(curves, first)
    else:
        for label, values, color in curves:
            x, y = as_steps(values, first)
            implot.plot_line(label, x, y, implot.Spec(line_color=color, line_weight=1.6))
    pointed = pointed_frame(number, number + many - 1)
    implot.end_plot()
    if pointed is not None:
        _go_to_frame(ui, pointed, [f"{label}: {values[pointed - number]:.3g}" for label, values, _ in curves])


def as_steps(values: NDArray[np.float64], first: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return x and y of a curve that is level over each frame, from the left edge of the first on: where a setting was
    switched it jumps."""
    edges = first + np.arange(len(values) + 1, dtype=np.float64)
    return np.repeat(edges, 2)[1:-1], np.repeat(values, 2)


def _stack(curves: list[tuple[str, NDArray[np.float64], ImVec4]], first: float) -> None:
    """Areas one above the other, which together are all rays that were due."""
    frames, below = as_steps(np.zeros(len(curves[0][1])), first)
    for label, values, color in curves:
        above = below + np.repeat(values, 2)
        implot.plot_shaded(label, frames, below, above, implot.Spec(fill_color=color, fill_alpha=0.85))
        below = above


def pointed_frame(first: int, last: int, frames: Sequence[int] | None = None) -> int | None:
    """Draw a line at the frame that the pointer is on, of those of the plot that is being drawn; returns its number, or
    its place among `frames`."""
    if last < first or not implot.is_plot_hovered():
        return None
    x = implot.get_plot_mouse_pos().x
    found = min(max(round(x), first), last) if frames is None else int(np.argmin(np.abs(np.asarray(frames) - x)))
    at = found if frames is None else frames[found]
    implot.plot_inf_lines("##pointed", np.array([float(at)]), implot.Spec(line_color=GREY, line_weight=1.0))
    return found


def _go_to_frame(ui: Ui, number: int, values: list[str]) -> None:
    """After a plot: say which frame the pointer is on, and go there where that is clicked."""
    c = ui.controller
    record = c.history.records.get(number)
    if record is None:
        return
    ui.state(PlotsState).pointed = number
    (width, height), part = record.state.size, record.counters["pixels"] / record.counters["all_pixels"]
    shaded = f", {whole_percent(part)} shaded" if part < 1.0 else ""
    said = f"{record.state.time:.3f} s, {title_of(record.state.settings.method)}, {width} x {height}{shaded}"
    if _clicked([c.navigator.name_of(number), said, *values]):
        c.navigator.go(number)


def go_to_run_frame(ui: Ui, run: Experiment, results: Results, place: int | None, values: list[str]) -> None:
    """Do the same for the frames of an experiment, by the method that it shows."""
    c = ui.controller
    if place is None:
        return
    number = results.frames[place]
    if run.settings.verify:
        wrong = {m: figures["wrong"][place] for m, figures in results.methods.items() if m != REFERENCE}
        values = [*values, *(f"{title_of(method)}: {many} wrong answers" for method, many in wrong.items())]
    if _clicked([f"frame {number} of the experiment, by {title_of(run.shown)}", *values]):
        c.navigator.go_to_experiment(run, number)


def _clicked(lines: list[str]) -> bool:
    """Show what the pointer is told of a frame; returns whether it was clicked."""
    if imgui.is_mouse_clicked(imgui.MouseButton_.left):
        return True
    tooltip_at("\n".join([*lines, "Click to go there."]))
    return False
