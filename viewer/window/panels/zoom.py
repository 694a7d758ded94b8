"""The zoom test in the window: towards what was clicked, and whether its shadows come in time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from imgui_bundle import ImVec2, imgui, implot
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from tracer.experiments.zoom import Approach, Results
from viewer.output.reports import happenings, modes_in_words
from viewer.services.runs import RecordedZoomTest
from viewer.window.panels import filmstrip
from viewer.window.panels.plots import AXIS, COLORS, FLAGS, LEGEND, whole_numbers, wrong_axis
from viewer.window.panels.runs import (
    choice,
    either,
    export_buttons,
    results_table,
    side_by_side,
    start_or_progress,
    whose,
)
from viewer.window.setting_rows import plan_rows
from viewer.window.style import MARK
from viewer.window.ui import Ui
from viewer.window.widgets import (
    ERROR,
    QUIET,
    WARNING,
    checkbox,
    clipped,
    count,
    em,
    paragraph,
    properties,
    row,
    tooltip,
    tooltip_above,
)

_TABLE = 20.0  # ems of the table
_COLUMNS = {"factor": 2.9, "step": 2.0, "pixels": 3.0, "wrong": 2.6, "modes": 0.0}  # ems
_NARROWEST = 15.0  # ems of a plot that stands beside another
_LOW = 9.0  # ems of height below which a plot has no legend
_FILM, _LEAST_FILM, _MOST_FILM = 0.4, 3.6, 9.0  # the pictures' part of the height, and its limits in ems


@dataclass
class ZoomState:
    """Whether the table has a row for each step."""

    all_steps: bool = False


def show(ui: Ui) -> None:
    """The panel: how to go, the counts on the way, and what happened at which step."""
    test = ui.controller.runs.zoom_test
    results = test.results if test is not None else None
    side_by_side(
        lambda: _controls(ui, test),
        lambda size: _plots(ui, test, results, size),
        lambda: _table(ui, test, results),
        em(_TABLE),
        lambda: whose(ui, test) if test is not None and results is not None else None,
    )


def _controls(ui: Ui, test: RecordedZoomTest | None) -> None:
    c = ui.controller
    under_way = c.runs.current is test
    if test is not None and under_way:
        paragraph(f"towards primitive {test.start.primitive}", QUIET)
    else:
        _plan(ui)

    tip = "Move towards the primitive, once with each factor"
    start_or_progress(ui, test, c.runs.start_zoom_test, tip)
    export_buttons(ui, test)
    if test is not None and test.results is not None:
        if imgui.button(f"{icons.ICON_FA_FLOPPY_DISK} Film"):
            c.runs.export_filmstrip(test)
        tooltip_above("Save the filmstrip as a picture: the paper's Figure 4")


def _plan(ui: Ui) -> None:
    c = ui.controller
    plan = c.runs.zoom_plan
    with properties("plan", 4.6) as shown:
        if not shown:
            return
        row("Towards", "The primitive that you clicked in the picture.")
        start = c.runs.last_start
        if c.selection.picked is not None:
            clipped(f"{c.selection.picked.primitive}  ({c.selection.picked.kind}, {c.selection.picked.object_name})")
        elif start is not None and plan.same_start:
            clipped(f"{start.primitive}")
        else:
            imgui.text_colored(WARNING, "Click a primitive")
        if start is not None:
            row("From", "Start where the camera is, or where the last test towards this primitive began.")
            plan.same_start = either("here", "start", plan.same_start)
        plan_rows(ui, plan, "factors", "steps", "ratio")
        tooltip(f"The last step is at {100.0 * plan.ratio**plan.steps:.2g} % of the distance.")
        plan_rows(ui, plan, "size")


def _plots(ui: Ui, test: RecordedZoomTest | None, results: Results | None, size: ImVec2) -> None:
    """A plot for each factor, side by side."""
    approaches = [a for a in results.approaches if a.steps] if results is not None else []
    if test is None or not approaches:
        if imgui.begin_child("nothing", size):
            paragraph(
                "Does a shadow that can only be seen from close up appear in time? Click a primitive, and start.", QUIET
            )
        imgui.end_child()
        return
    spacing = imgui.get_style().item_spacing.x
    width = (size.x - (len(approaches) - 1) * spacing) / len(approaches)
    if width < _NARROWEST * em(1.0) and len(approaches) > 1:
        _tabs(ui, test, approaches, size)
        return
    imgui.begin_group()
    for number, approach in enumerate(approaches):
        if number:
            imgui.same_line()
        name = f"zoom factor {approach.factor:g}##{number}"
        _plot_and_film(ui, test, approaches, approach, name, ImVec2(width, size.y))
    imgui.end_group()


def _tabs(ui: Ui, test: RecordedZoomTest, approaches: list[Approach], size: ImVec2) -> None:
    """One plot at a time, where there is no room for all; of a test that is under way, the one that grows."""
    grows = len(approaches) - 1 if ui.controller.runs.current is test else -1
    if imgui.begin_child("plots", size) and imgui.begin_tab_bar("factors"):
        for number, approach in enumerate(approaches):
            flags = int(imgui.TabItemFlags_.set_selected) if number == grows else 0
            if imgui.begin_tab_item(f"factor {approach.factor:g}##{number}", None, flags)[0]:
                room = imgui.get_content_region_avail()
                _plot_and_film(ui, test, approaches, approach, f"##{number}", room)
                imgui.end_tab_item()
        imgui.end_tab_bar()
    imgui.end_child()


def _plot_and_film(
    ui: Ui, test: RecordedZoomTest, approaches: list[Approach], approach: Approach, name: str, size: ImVec2
) -> None:
    """A plot, and under it the pictures of its steps."""
    gap = imgui.get_style().item_spacing.y
    pictures = min(max(_FILM * size.y, em(_LEAST_FILM)), em(_MOST_FILM))
    imgui.begin_group()
    _plot(ui, test, approaches, approach, name, ImVec2(size.x, max(size.y - pictures - gap, em(4.0))))
    filmstrip.strip(ui, test, approach, f"film {approach.factor:g}", ImVec2(size.x, pictures))
    imgui.end_group()


def _plot(
    ui: Ui, test: RecordedZoomTest, approaches: list[Approach], approach: Approach, name: str, size: ImVec2
) -> None:
    """Pixels, and the count past which the primitive is examined again, on a logarithmic scale; wrong ones as bars."""
    low = size.y < em(_LOW)
    if not implot.begin_plot(name, size, FLAGS | int(implot.Flags_.no_legend) if low else FLAGS):
        return
    steps = approach.steps
    numbers = np.arange(len(steps), dtype=np.float64)
    pixels = np.array([max(step.pixels, 0.5) for step in steps], np.float64)
    limits = np.array([approach.factor * step.highest or np.nan for step in steps], np.float64)
    seen = [max(step.pixels, step.highest, 1) for a in approaches for step in a.steps]
    most_wrong = max(1, *(a.most_wrong for a in approaches))
    implot.setup_axes("", "" if low else "pixels", AXIS, AXIS)
    implot.setup_axis_scale(implot.ImAxis_.y1, int(implot.Scale_.log10))
    last = test.frames / len(test.factors) - 0.3
    whole_numbers(-0.7, last, size.x)
    implot.setup_axis_format(implot.ImAxis_.y1, "%.0f")
    least, high = 0.3 * min(pixels.min(), *(s.pixels or 0.5 for a in approaches for s in a.steps)), 6.0 * max(seen)
    always = int(imgui.Cond_.always)
    implot.setup_axes_limits(-0.7, last, least, high, always)
    wrong_axis(most_wrong, always)
    implot.setup_legend(implot.Location_.south, LEGEND)
    implot.set_axes(implot.ImAxis_.x1, implot.ImAxis_.y2)
    wrong = np.array([step.wrong_of_primitive for step in steps], np.float64)
    implot.plot_bars("wrong", numbers, wrong, 0.8, implot.Spec(line_color=ERROR, fill_color=ERROR, fill_alpha=0.7))
    implot.set_axes(implot.ImAxis_.x1, implot.ImAxis_.y1)
    implot.plot_stairs("limit", numbers, limits, implot.Spec(line_color=COLORS[2], line_weight=1.4))
    implot.plot_line("pixels", numbers, pixels, implot.Spec(line_color=COLORS[0], line_weight=1.8))
    changed = np.array([step.number for step in steps if step.changes], np.float64)
    mark = implot.Spec(marker=int(implot.Marker_.diamond), marker_size=em(0.24), marker_fill_color=MARK,
                       marker_line_color=MARK)  # fmt: skip
    implot.plot_scatter("modes", changed, pixels[changed.astype(int)], mark)
    if implot.is_plot_hovered():
        step = steps[min(max(round(implot.get_plot_mouse_pos().x), 0), len(steps) - 1)]
        filmstrip.show_step(ui, test, approach.factor, step)
        if imgui.is_mouse_clicked(imgui.MouseButton_.left):
            ui.controller.go_to_step(step)
    implot.end_plot()


def _table(ui: Ui, test: RecordedZoomTest | None, results: Results | None) -> None:
    """The steps, those where something happens or all; a click shows what was recorded there."""
    state = ui.state(ZoomState)
    if test is None or results is None:
        return
    tip = "else only those where modes or wrong pixels change"
    checkbox("all steps", state.all_steps, lambda on: setattr(state, "all_steps", on), tip)
    columns = [(heading, em(width), "") for heading, width in _COLUMNS.items()]
    with results_table("steps", columns) as shown:
        for approach in results.approaches if shown else ():
            for step in approach.steps if state.all_steps else happenings(approach):
                if choice(f"{approach.factor:g}##{step.number}"):
                    ui.controller.go_to_step(step)
                if imgui.is_item_hovered():
                    filmstrip.show_step(ui, test, approach.factor, step)
                wrong = ERROR if step.wrong_of_primitive else None
                for text, color in (
                    (str(step.number), None),
                    (count(step.pixels), None),
                    (count(step.wrong_of_primitive), wrong),
                    (modes_in_words(step.changes), None),
                ):
                    imgui.table_next_column()
                    clipped(text, color)
