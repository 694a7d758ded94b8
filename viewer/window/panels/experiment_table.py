"""The paper's Table 1 beside the plot of an experiment."""

from __future__ import annotations

from collections.abc import Callable

from imgui_bundle import ImVec4, imgui

from tracer.experiments import experiment
from tracer.experiments.experiment import Results, Row
from viewer.output.reports import LINES, WRONG, caveats, lines
from viewer.services.runs import Experiment
from viewer.window.panels.runs import results_table
from viewer.window.ui import Ui
from viewer.window.widgets import ERROR, QUIET, clipped, em, in_window_style, paragraph, right, tooltip

_SHORT = (
    "rays saved", "steps saved", "most steps (frame)", "tests saved", "most tests (frame)", "extra / pixel", "wrong",
    "median frame", "all frames", "preparing", "speed-up", "memory",
)  # fmt: skip
COMPARED = ("speed-up", "rays saved", "steps saved", "tests saved", "wrong")
"""What methods are compared by, which comes first."""
_MOST_COLUMNS = 3  # methods that have columns
_HEADING, _LONGEST = 8.4, 11.0  # ems of what figures are called there, and of the longest name where methods have lines

Figure = tuple[str, str, Callable[[Row], str]]
"""What is told of a method: in words, in few, and how."""


def width_of(ui: Ui, run: Experiment | None, results: Results | None) -> float:
    """Pixels that what methods are compared by takes, with a line for each of them."""
    if run is None or results is None:
        return em(11.0)
    rows, figures = _rows(ui, results), _figures(run)
    compared = [figure for figure in figures if figure[1] in COMPARED]
    gaps = (len(compared) + 1) * 2.0 * imgui.get_style().cell_padding.x + imgui.get_style().scrollbar_size
    return _name_width(rows) + sum(_figure_width(figure, rows) for figure in compared) + gaps


def show(ui: Ui, run: Experiment | None, results: Results | None) -> None:
    """The paper's Table 1: a column for each of a few methods, where these fit, or else a line for each."""
    if run is None or results is None:
        return
    rows, figures = _rows(ui, results), _figures(run)
    said = in_window_style("; ".join(caveats(results, in_window=True)))
    paragraph(f"{said[:1].upper()}{said[1:]}.", QUIET)
    widths = [max(_text_width(r.method), *(_text_width(_figure_cell(f, r)[0]) for f in figures)) for r in rows]
    gaps = (len(rows) + 1) * 2.0 * imgui.get_style().cell_padding.x + imgui.get_style().scrollbar_size
    if len(rows) <= _MOST_COLUMNS and em(_HEADING) + sum(widths) + gaps <= imgui.get_content_region_avail().x:
        _method_columns(rows, figures, widths)
    else:
        _method_lines(rows, figures)


def _rows(ui: Ui, results: Results) -> list[Row]:
    rows: list[Row] = ui.cached("table 1", results, 0, lambda: experiment.table(results))
    return rows


def _figures(run: Experiment) -> list[Figure]:
    """What is told of each method, in the order in which it is read."""
    meant = lines(run.settings.verify)
    figures = [(line[0], short, line[1]) for line, short in zip(LINES, _SHORT, strict=True) if line in meant]
    return sorted(figures, key=lambda figure: COMPARED.index(figure[1]) if figure[1] in COMPARED else len(COMPARED))


def _method_columns(rows: list[Row], figures: list[Figure], widths: list[float]) -> None:
    """A line for each figure."""
    columns = [("", 0.0, ""), *((line.method, width, "") for line, width in zip(rows, widths, strict=True))]
    with results_table("table 1", columns) as shown:
        for figure in figures if shown else ():
            imgui.table_next_column()
            clipped(figure[1], QUIET)
            tooltip(figure[0].strip())
            for line in rows:
                imgui.table_next_column()
                clipped(*_figure_cell(figure, line))


def _method_lines(rows: list[Row], figures: list[Figure]) -> None:
    """A line for each method: all of them are seen at once, by the first figures."""
    columns = [(figure[1], _figure_width(figure, rows), figure[0].strip()) for figure in figures]
    with results_table("table 1, lines", [("", _name_width(rows), ""), *columns]) as shown:
        for line in rows if shown else ():
            imgui.table_next_column()
            clipped(line.method, QUIET)
            for figure in figures:
                imgui.table_next_column()
                right(*_figure_cell(figure, line))


def _figure_cell(figure: Figure, line: Row) -> tuple[str, ImVec4 | None]:
    heading, _, cell = figure
    return in_window_style(cell(line)), ERROR if heading == WRONG and line.wrong else None


def _name_width(rows: list[Row]) -> float:
    return min(max(_text_width(row.method) for row in rows), em(_LONGEST))


def _figure_width(figure: Figure, rows: list[Row]) -> float:
    return max(_text_width(figure[1]), *(_text_width(_figure_cell(figure, line)[0]) for line in rows))


def _text_width(text: str) -> float:
    return float(imgui.calc_text_size(text).x) + 1.0
