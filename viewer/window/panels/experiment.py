"""The paper's Table 1 in the window: a path of frames by several methods, played as it is traced."""

from __future__ import annotations

import numpy as np
from imgui_bundle import ImVec2, imgui, implot

from tracer.experiments import experiment
from tracer.experiments.experiment import REFERENCE, Experiment, Results, Row
from tracer.method import Kind, additions, bases, in_order, title_of
from viewer.output.reports import TITLED, caveats, published, table_1, verdicts
from viewer.state.methods import BY_MODES, CERTIFIED, groups
from viewer.state.plans import ExperimentPlan
from viewer.util.numbers import saved_in_words
from viewer.window.panels.culling import kinds_of_methods
from viewer.window.panels.plots import AXIS, COLORS, FLAGS, go_to_run_frame, pointed_frame, setup_legend, wrong_axis
from viewer.window.panels.runs import Part, results_table, show_run
from viewer.window.setting_rows import plan_rows
from viewer.window.ui import Ui
from viewer.window.widgets import ERROR, QUIET, dropdown, in_window_style, outlined, paragraph, properties, row, tooltip

_USUAL = (REFERENCE, BY_MODES, CERTIFIED, "lightbuffer", "voxels")
_PLOT, _TABLE = 16.0, 44.0  # ems of width; the table's first columns are what methods are compared by
_FEWEST_FRAMES, _LEAST_TOP = 10, 2.0  # frames and percents that the plot's axes span at least


def show(ui: Ui) -> None:
    """The panel: what to measure, the savings frame by frame, and the table."""
    run, parts, doing = ui.controller.runs.experiment, list[Part](), ""
    if run is not None:
        s = run.settings
        doing = f"{s.width} x {s.height}, {s.depth} bounces, showing {title_of(run.shown)}"
    if run is not None and (results := run.results) is not None:
        parts.append(("Table", _TABLE, lambda: _table(ui, run, results)))
        parts.append(("Plot", _PLOT, lambda: _plot(ui, run, results)))
    show_run(
        ui, run, lambda: _plan(ui), ui.controller.runs.start_experiment,
        tip="Trace the path by each method, and compare them",
        doing=doing,
        parts=parts,
        why="What culling saves of the work of shadow rays, frame by frame, and the paper's Table 1.",
    )  # fmt: skip


def _plan(ui: Ui) -> None:
    plan = ui.controller.runs.experiment_plan
    imgui.push_style_var(imgui.StyleVar_.cell_padding, ImVec2(imgui.get_style().cell_padding.x, 1.0))
    with properties("plan", 4.6) as shown:
        if shown:
            row("Methods", "Methods to compare with tracing every shadow ray.")
            _methods(ui, plan)
            plan_rows(ui, plan, "frames", "size", "depth", "accelerator", "verify")
    imgui.pop_style_var()


def _methods(ui: Ui, plan: ExperimentPlan) -> None:
    """A list to be opened: a tick for each base, and for each way to add to those; the reference is always among
    them."""
    titles = ", ".join(map(title_of, in_order(plan.methods)))
    opened = dropdown("##methods", titles, int(imgui.ComboFlags_.height_largest))
    tooltip(f"{titles}\nOn the command line: {','.join(in_order(plan.methods))}")
    if not opened:
        return

    def add_or_remove(label: str, methods: set[str]) -> None:
        there = bool(methods) and methods <= {REFERENCE, *plan.methods}
        with outlined():
            if imgui.checkbox(label, there)[0]:
                plan.methods = plan.methods - methods if there else plan.methods | methods

    def base(kind: Kind) -> None:
        imgui.begin_disabled(kind.name == REFERENCE)
        add_or_remove(kind.title, {kind.name})
        imgui.end_disabled()

    def addition(kind: Kind) -> None:
        bases = [method for method in plan.methods if "+" not in method and method != kind.name]
        add_or_remove(kind.plus, {f"{base}+{kind.name}" for base in bases})

    kinds_of_methods(ui, [("Usual", [kind for kind in bases() if kind.name in _USUAL])], base)
    if imgui.tree_node("More"):
        kinds_of_methods(
            ui, [(name, [one for one in kinds if one.name not in _USUAL]) for name, kinds in groups()], base
        )
        kinds_of_methods(ui, [("And each of these with", additions())], addition)
        imgui.tree_pop()
    imgui.end_combo()


def _table(ui: Ui, run: Experiment, results: Results) -> None:
    """The paper's Table 1: a line for each method."""
    rows: list[Row] = ui.cached("table 1", results, len(results.frames), lambda: experiment.table(results))
    results_table("table 1", [TITLED, *table_1(results)], rows, fits=True)
    for sentence in ui.cached("verdicts", results, len(results.frames), lambda: verdicts(rows, run.settings.verify)):
        paragraph(in_window_style(sentence))
    said = in_window_style("; ".join(caveats(results, in_window=True)))
    for quiet in (f"{said[:1].upper()}{said[1:]}.", *map(in_window_style, published(results))):
        paragraph(quiet, QUIET)


def _plot(ui: Ui, run: Experiment, results: Results) -> None:
    """Savings of each method but the reference, steps thick and tests thin, and its wrong answers, over the frames."""
    savings = ui.cached("savings", results, 0, lambda: _savings(results))
    size = imgui.get_content_region_avail()
    if not implot.begin_plot(f"saved (thick: steps, thin: tests)##{id(run)}", size, FLAGS):
        return
    frames = np.array(results.frames, np.float64)
    values = [curve for curves in savings.values() for curve in curves]
    top = max([float(curve.max()) for curve in values], default=0.0)
    # So that one method that does many times the work does not flatten all others.
    bottom = max(min([float(curve.min()) for curve in values], default=0.0), -max(top, _LEAST_TOP))
    implot.setup_axes("", "", AXIS, AXIS)
    implot.setup_axis_format(implot.ImAxis_.x1, "%.0f")
    implot.setup_axis_format(implot.ImAxis_.y1, "%.4g %%")
    once = int(imgui.Cond_.always if ui.controller.runs.current is run else imgui.Cond_.once)
    last = max(len(run.times), _FEWEST_FRAMES) - 0.5
    implot.setup_axes_limits(-0.5, last, min(1.1 * bottom, 0.0), max(1.12 * top, _LEAST_TOP), once)
    most_wrong = max(int(max(figures["wrong"])) for figures in results.methods.values())
    if run.settings.verify and most_wrong:
        wrong_axis(most_wrong, once, size.y)
    setup_legend(list(savings), size)
    for number, (method, curves) in enumerate(savings.items()):
        if run.settings.verify and most_wrong:
            _plot_wrong(np.array(results.methods[method]["wrong"], np.float64), frames, method if number else "")
        for curve, weight in zip(curves, (2.2, 0.9), strict=True):
            spec = implot.Spec(line_color=COLORS[number % len(COLORS)], line_weight=weight)
            if len(frames) == 1:  # is no line
                spec.marker = int(implot.Marker_.circle)
            implot.plot_line(title_of(method), frames, curve, spec)
    place = pointed_frame(0, len(results.frames) - 1, results.frames)
    implot.end_plot()
    said = []
    if place is not None:
        for method, curves in savings.items():
            steps, tests = (in_window_style(saved_in_words(curve[place] / 100.0)) for curve in curves)
            said.append(f"{title_of(method)}: steps {steps}, tests {tests}")
    go_to_run_frame(ui, run, results, place, said)


def _savings(results: Results) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Per cents of steps and of tests that each method saves, frame by frame."""
    methods = [method for method in results.methods if method != REFERENCE]
    return {m: (100.0 * results.reductions(m, "steps"), 100.0 * results.reductions(m, "tests")) for m in methods}


def _plot_wrong(wrong: np.ndarray, frames: np.ndarray, method: str) -> None:
    implot.set_axes(implot.ImAxis_.x1, implot.ImAxis_.y2)
    spec = implot.Spec(line_color=ERROR, fill_color=ERROR, fill_alpha=0.55)
    implot.plot_bars(f"##wrong {method}" if method else "wrong", frames, wrong, 0.8, spec)
    implot.set_axes(implot.ImAxis_.x1, implot.ImAxis_.y1)
