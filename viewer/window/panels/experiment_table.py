"""The paper's Table 1 beside the plot of an experiment."""

from __future__ import annotations

from collections.abc import Callable

from imgui_bundle import ImVec4, imgui

from tracer import experiment
from tracer.experiment import REFERENCE, Results, Row
from viewer.output.reports import LINES, WRONG
from viewer.services.runs import Experiment
from viewer.window.ui import Ui
from viewer.window.widgets import ERROR, QUIET, clipped, em, in_window_style, right, tooltip

_SHORT = (
    "steps saved", "  most (frame)", "tests saved", "  most (frame)", "extra / pixel", "wrong", "time in window",
    "  all frames", "  preparing", "memory",
)  # fmt: skip
_TIMES = _SHORT[6:9]
_TIME_TIP = "measured while the window draws as well: do not compare it with times of shadowcull bench"
_HEADING, _REFERENCE, _METHOD = 6.8, 5.4, 7.4  # widths of the table's columns in ems
_MOST_COLUMNS, _LONGEST = 3, 11.0  # methods that have columns; ems of the longest name where they have lines

Figure = tuple[str, str, Callable[[Row], str]]
"""What is told of a method: in words, in few, and how."""


def width_for(columns: int) -> float:
    """Of the paper's table with so many methods, in ems."""
    return _HEADING + _REFERENCE + _METHOD * (columns - 1) + 1.2


def show(ui: Ui, run: Experiment | None, results: Results | None) -> None:
    """The paper's Table 1: a column for each of a few methods, or else a line for each."""
    if run is None or results is None:
        return
    rows: list[Row] = ui.cached("table 1", results, 0, lambda: experiment.table(results))
    whole = len(results.frames) == len(run.times)
    plural = "s" * (len(run.times) != 1)
    done = f"{len(results.frames)} frame{plural}" if whole else f"{len(results.frames)} of {len(run.times)} frames"
    clipped(f"{done}, {run.settings.width} x {run.settings.height}, {run.settings.accelerator}", QUIET)
    figures = [
        (heading, short, cell)
        for (heading, cell), short in zip(LINES, _SHORT, strict=True)
        if heading != WRONG or run.settings.verify
    ]
    if len(rows) <= _MOST_COLUMNS:
        _method_columns(rows, figures)
    else:
        _method_lines(rows, figures)


def _method_columns(rows: list[Row], figures: list[Figure]) -> None:
    """A line for each figure."""
    flags = imgui.TableFlags_.sizing_stretch_prop | imgui.TableFlags_.row_bg
    widths = [max(em(_REFERENCE if r.method == REFERENCE else _METHOD), _text_width(r.method)) for r in rows]
    scrolls = em(_HEADING) + sum(widths) > imgui.get_content_region_avail().x
    if scrolls:
        flags |= imgui.TableFlags_.scroll_x | imgui.TableFlags_.scroll_y
    if not imgui.begin_table("table 1", 1 + len(rows), int(flags)):
        return
    imgui.table_setup_scroll_freeze(1, 1)
    stretch, fixed = imgui.TableColumnFlags_.width_stretch, imgui.TableColumnFlags_.width_fixed
    imgui.table_setup_column("", int(fixed if scrolls else stretch), em(_HEADING) if scrolls else 0.0)
    for line, width in zip(rows, widths, strict=True):
        imgui.table_setup_column(line.method, int(fixed), width)
    imgui.table_next_column()
    for line in rows:
        imgui.table_next_column()
        clipped(line.method, QUIET)
    for figure in figures:
        imgui.table_next_column()
        _figure_name(figure)
        for line in rows:
            imgui.table_next_column()
            clipped(*_figure_cell(figure, line))
    imgui.end_table()


def _method_lines(rows: list[Row], figures: list[Figure]) -> None:
    """A line for each method: all of them are seen at once, by the first figures."""
    flags = imgui.TableFlags_.row_bg | imgui.TableFlags_.scroll_x | imgui.TableFlags_.scroll_y
    if not imgui.begin_table("table 1, lines", 1 + len(figures), int(flags | imgui.TableFlags_.sizing_fixed_fit)):
        return
    imgui.table_setup_scroll_freeze(1, 1)
    imgui.table_setup_column("method", 0, min(max(_text_width(r.method) for r in rows), em(_LONGEST)))
    for figure in figures:
        cells = [_text_width(_figure_cell(figure, line)[0]) for line in rows]
        imgui.table_setup_column(figure[0], 0, max(_text_width(figure[1].strip()), *cells))
    imgui.table_next_column()
    for figure in figures:
        imgui.table_next_column()
        _figure_name(figure)
    for line in rows:
        imgui.table_next_column()
        clipped(line.method, QUIET)
        for figure in figures:
            imgui.table_next_column()
            right(*_figure_cell(figure, line))
    imgui.end_table()


def _figure_name(figure: Figure) -> None:
    heading, short, _ = figure
    clipped(short, QUIET)
    tooltip(f"{heading.strip()}, {_TIME_TIP}" if short in _TIMES else heading.strip())


def _figure_cell(figure: Figure, line: Row) -> tuple[str, ImVec4 | None]:
    heading, _, cell = figure
    return in_window_style(cell(line)), ERROR if heading == WRONG and line.wrong else None


def _text_width(text: str) -> float:
    return float(imgui.calc_text_size(text).x) + 1.0
