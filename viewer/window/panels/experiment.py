"""The paper's Table 1 in the window: a path of frames by several methods, played as it is traced."""

from __future__ import annotations

from itertools import combinations

import numpy as np
from imgui_bundle import ImVec2, imgui, implot

from tracer.experiments.experiment import REFERENCE, Results
from tracer.method import Kind, additions, in_order
from viewer.services.runs import Experiment
from viewer.state.methods import groups
from viewer.state.plans import ExperimentPlan
from viewer.util.numbers import saved_in_words
from viewer.window.panels import experiment_table
from viewer.window.panels.culling import lights_to_fit, pale, said_of
from viewer.window.panels.plots import AXIS, COLORS, FLAGS, LEGEND, go_to_experiment_frame, pointed_frame, wrong_axis
from viewer.window.panels.runs import export_buttons, in_tabs, side_by_side, start_or_progress, whose
from viewer.window.setting_rows import plan_rows
from viewer.window.ui import Ui
from viewer.window.widgets import (
    ERROR,
    QUIET,
    in_window_style,
    outlined,
    paragraph,
    properties,
    row,
    tooltip,
)

_WORKS = (("steps", "steps"), ("tests", "tests"))
_FEWEST_FRAMES, _LEAST_TOP = 10, 2.0  # frames and percents that the plot's axes span at least


def show(ui: Ui) -> None:
    """The panel: what to measure, the savings frame by frame, and the table."""
    run = ui.controller.runs.experiment
    results = run.results if run is not None else None
    controls, plot = (lambda: _controls(ui, run)), (lambda size: _plot(ui, run, results, size))
    if run is None or results is None:
        side_by_side(controls, plot, None, 0.0)
        return
    width = experiment_table.width_of(ui, run, results)
    in_tabs(controls, plot, lambda: experiment_table.show(ui, run, results), width, lambda: whose(ui, run))


def _controls(ui: Ui, run: Experiment | None) -> None:
    runner = ui.controller.runs
    under_way = run is not None and runner.current is run
    if run is not None and under_way:
        _shown_method(run)
    else:
        _plan(ui)
    tip = "Trace the path by each method, and compare them"
    start_or_progress(ui, run, runner.start_experiment, tip)
    export_buttons(ui, run)


def _plan(ui: Ui) -> None:
    plan = ui.controller.runs.experiment_plan
    imgui.push_style_var(imgui.StyleVar_.cell_padding, ImVec2(imgui.get_style().cell_padding.x, 1.0))
    with properties("plan", 4.6) as shown:
        if shown:
            row("Methods", f"Methods to compare with {REFERENCE}, which traces every shadow ray.")
            _methods(plan, lights_to_fit(ui))
            plan_rows(ui, plan, "frames", "size", "depth", "accelerator", "verify")
    imgui.pop_style_var()


def _methods(plan: ExperimentPlan, lights: tuple[int, int]) -> None:
    """A list to be opened: a line for each base, a tick for each way to add to it; the reference is always among
    them, and what has nothing to say of so many lights is pale."""
    opened = imgui.begin_combo("##methods", ", ".join(in_order(plan.methods)), int(imgui.ComboFlags_.height_largest))
    tooltip(", ".join(in_order({REFERENCE, *plan.methods})))
    if opened:
        _method_ticks(plan, lights)
        imgui.end_combo()


def _method_ticks(plan: ExperimentPlan, lights: tuple[int, int]) -> None:
    small, whole = ([kind for kind in additions() if kind.alone is alone] for alone in (False, True))
    sets: list[tuple[Kind, ...]] = [added for n in range(len(small) + 1) for added in combinations(small, n)]
    sets += [(kind,) for kind in whole]  # methods in their own right: one of them at a time
    if not imgui.begin_table("methods", 1 + len(sets), int(imgui.TableFlags_.sizing_fixed_fit)):
        return
    imgui.table_next_column()
    for added in sets:
        imgui.table_next_column()
        fits = all(kind.fits(*lights) for kind in added)
        imgui.text_colored(QUIET if fits else pale(), "".join(f"+{kind.name}" for kind in added) or "alone")
        if added:
            tooltip("\n".join(f"+{kind.name}: {said_of(kind, lights)}" for kind in added))
    for heading, kinds in groups():
        imgui.table_next_row()
        imgui.table_next_column()
        imgui.text_colored(QUIET, heading.partition(":")[0])
        for base in kinds:
            _ticks_of(plan, base, sets, lights)
    imgui.end_table()


def _ticks_of(plan: ExperimentPlan, base: Kind, sets: list[tuple[Kind, ...]], lights: tuple[int, int]) -> None:
    """A line of the list."""
    imgui.table_next_row()
    imgui.table_next_column()
    imgui.align_text_to_frame_padding()
    if base.fits(*lights):
        imgui.text_unformatted(base.name)
    else:
        imgui.text_colored(pale(), base.name)
    tooltip(said_of(base, lights))
    for added in sets:
        imgui.table_next_column()
        if base in added:
            continue
        method = "+".join(kind.name for kind in (base, *added))
        imgui.begin_disabled(method == REFERENCE)
        with outlined():
            changed, _ = imgui.checkbox(f"##{method}", method == REFERENCE or method in plan.methods)
        imgui.end_disabled()
        if changed:
            plan.methods ^= {method}


def _shown_method(run: Experiment) -> None:
    """Whose frames are the picture."""
    imgui.align_text_to_frame_padding()
    imgui.text_colored(QUIET, "show")
    imgui.same_line()
    imgui.set_next_item_width(-1.0)
    if imgui.begin_combo("##shown", run.shown):
        for method in run.methods:
            if imgui.selectable(method, run.shown == method)[0]:
                run.shown = method
        imgui.end_combo()
    width, height = run.settings.width, run.settings.height
    imgui.text_colored(QUIET, f"{width} x {height}, {run.settings.depth} bounces")


def _plot(ui: Ui, run: Experiment | None, results: Results | None, size: ImVec2) -> None:
    """Savings of each method but the reference, and its wrong answers, over the frames of the path."""
    if run is None or results is None:
        if imgui.begin_child("nothing", size):
            paragraph("What culling saves of the work of shadow rays, frame by frame, and the paper's Table 1.", QUIET)
        imgui.end_child()
        return
    wrong = run.settings.verify and any(any(figures["wrong"]) for figures in results.methods.values())
    savings = ui.cached("savings", results, 0, lambda: _savings(results))
    thin = " (thin: tests)" if len(savings) > len(_WORKS) else ""
    if not implot.begin_plot(f"saved{thin}##{id(run)}", size, FLAGS):
        return
    frames = np.array(results.frames, np.float64)
    top = max([float(values.max()) for _, values in savings] or [0.0])
    bottom = min([float(values.min()) for _, values in savings] or [0.0])
    implot.setup_axes("", "", AXIS, AXIS)
    implot.setup_axis_format(implot.ImAxis_.x1, "%.0f")
    implot.setup_axis_format(implot.ImAxis_.y1, "%.4g %%")
    once = int(imgui.Cond_.always if ui.controller.runs.current is run else imgui.Cond_.once)
    last = max(len(run.times), _FEWEST_FRAMES) - 0.5
    implot.setup_axes_limits(-0.5, last, min(1.1 * bottom, 0.0), max(1.12 * top, _LEAST_TOP), once)
    if wrong:
        wrong_axis(max(int(max(figures["wrong"])) for figures in results.methods.values()), once)
    implot.setup_legend(implot.Location_.south, LEGEND)
    if wrong:
        _plot_wrong(results, frames)
    for (name, values), spec in zip(savings, _looks(len(savings)), strict=True):
        if len(frames) == 1:  # is no line
            spec.marker = int(implot.Marker_.circle)
        implot.plot_line(name, frames, values, spec)
    place = pointed_frame(0, len(results.frames) - 1, results.frames)
    implot.end_plot()
    said = []
    if place is not None:
        said = [f"{name}: {in_window_style(saved_in_words(values[place] / 100.0))}" for name, values in savings]
    go_to_experiment_frame(ui, run, results, place, said)


def _looks(curves: int) -> list[implot.Spec]:
    """How to draw so many curves, steps and tests of each method in turn: of several methods each has one colour and
    one entry in the legend, and its tests are thin."""
    if curves <= len(_WORKS):
        return [implot.Spec(line_color=color, line_weight=1.6) for color in COLORS[:curves]]
    pairs = [(COLORS[n // len(_WORKS) % len(COLORS)], n % len(_WORKS) == 0) for n in range(curves)]
    return [implot.Spec(line_color=color, line_weight=2.2 if steps else 0.9) for color, steps in pairs]


def _savings(results: Results) -> list[tuple[str, np.ndarray]]:
    methods = [method for method in results.methods if method != REFERENCE]
    many = len(methods) > 1
    return [
        (method if many else label, 100.0 * results.reductions(method, work))
        for method in methods
        for work, label in _WORKS
    ]


def _plot_wrong(results: Results, frames: np.ndarray) -> None:
    implot.set_axes(implot.ImAxis_.x1, implot.ImAxis_.y2)
    first = next((method for method in results.methods if method != REFERENCE), "")
    for method, figures in results.methods.items():
        if method != REFERENCE:
            values = np.array(figures["wrong"], np.float64)
            spec = implot.Spec(line_color=ERROR, fill_color=ERROR, fill_alpha=0.55)
            implot.plot_bars("wrong" if method == first else f"##wrong {method}", frames, values, 0.8, spec)
    implot.set_axes(implot.ImAxis_.x1, implot.ImAxis_.y1)
