"""The panels of runs: what to do, how far it is, and what was found; and what these are made of."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import accumulate
from typing import TypeVar

from imgui_bundle import ImVec2, imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from tracer.experiments.experiment import Experiment
from tracer.experiments.hunt import Hunt
from tracer.experiments.runner import Run
from tracer.experiments.titles import title
from tracer.experiments.zoom import ZoomTest
from viewer.output.reports import Column
from viewer.services.runs import duration
from viewer.state.plans import PathPlan
from viewer.window.ui import Ui
from viewer.window.widgets import (
    ERROR,
    QUIET,
    WARNING,
    clipped,
    em,
    in_window_style,
    paragraph,
    right,
    row,
    same_line_for,
    seen_rows,
    tooltip,
    wide_button,
)

_SAVED_AS = {".json": ("JSON", "Save every figure"), ".csv": ("CSV", "Save the table"),
             ".png": ("Plot", "Save the plot as a picture"),
             "-film.png": ("Film", "Save the filmstrip as a picture: the paper's Figure 4")}  # fmt: skip
_LEFT, _LEAST = 14.0, 12.0  # ems of the controls, and of results beside them
_MEASURED, _LONGEST = 100, 12.0  # rows whose texts are measured, and ems of a column of text, at most

_ROW = int(imgui.SelectableFlags_.span_all_columns | imgui.SelectableFlags_.allow_overlap)
Row = TypeVar("Row")


def frames_row(ui: Ui, plan: PathPlan, tip: str) -> None:
    """Show the row of the first and the last frame."""
    row("Frames", tip)
    changed, span = imgui.input_int2("##frames", list(plan.frames(ui.controller.session.scene)))
    if changed:
        plan.first, plan.last = max(0, span[0]), max(0, span[1])


Part = tuple[str, float, Callable[[], None]]
"""A part of the results: its name, its least width in ems, and what shows it."""


def show_run(
    ui: Ui, run: Experiment | ZoomTest | Hunt | None, plan: Callable[[], None], start: Callable[[], None], tip: str,
    doing: str, parts: Sequence[Part], why: str,
) -> None:  # fmt: skip
    """Show a panel: what starts a run or stops it, the plan or what it is doing, and beside these what it has found.

    Without results it says `why` one would start."""

    def controls() -> None:
        start_or_progress(ui, run, start, tip)
        if run is not None and ui.controller.runs.current is run:
            paragraph(doing, QUIET)
        else:
            plan()
        if run is not None:
            _export_buttons(ui, run)

    if run is None or run.results is None:
        arrange(controls, lambda: paragraph(why, QUIET), ())
    else:
        arrange(controls, lambda: _heading(ui, run), parts)


def arrange(controls: Callable[[], None], heading: Callable[[], None], parts: Sequence[Part]) -> None:
    """Show controls, and beside them parts below a heading: next to each other, or as tabs where there is no room for
    that.

    In a panel that is too narrow for results beside controls, all lie below one another."""
    room, spacing = imgui.get_content_region_avail(), imgui.get_style().item_spacing.x
    width = room.x - em(_LEFT) - spacing
    if width < em(_LEAST):
        controls()
        heading()
        for name, _, show in parts:
            _in_child(name, ImVec2(0.0, em(14.0)), show)
        return
    _in_child("controls", ImVec2(em(_LEFT), 0.0), controls)
    imgui.same_line()
    if imgui.begin_child("results", ImVec2(width, 0.0)):
        heading()
        needed = sum(em(least) for _, least, _ in parts) + (len(parts) - 1) * spacing
        if needed <= width:
            for number, (name, least, show) in enumerate(parts):
                if number:
                    imgui.same_line()
                _in_child(name, ImVec2(em(least) + (width - needed) / len(parts), 0.0), show)
        elif imgui.begin_tab_bar("parts"):
            for name, _, show in parts:
                if imgui.begin_tab_item_simple(name):
                    show()
                    imgui.end_tab_item()
            imgui.end_tab_bar()
    imgui.end_child()


def _in_child(name: str, size: ImVec2, show: Callable[[], None]) -> None:
    if imgui.begin_child(name, size):
        show()
    imgui.end_child()


def results_table(
    name: str, columns: Sequence[Column[Row]], rows: Sequence[Row], click: Callable[[int], None] | None = None,
    chosen: int | None = None, tip: Callable[[Row], str] | None = None, fits: bool = False,
) -> None:  # fmt: skip
    """Show a table whose headings and first column stay, as wide as its columns need; a click on a row, of which `tip`
    says more, tells which it is.  It takes all room or, where it `fits`, what its rows need."""
    flags = imgui.TableFlags_.row_bg | imgui.TableFlags_.scroll_y | imgui.TableFlags_.scroll_x
    lines = (len(rows) + 1) * (imgui.get_text_line_height() + 2.0 * imgui.get_style().cell_padding.y)
    size = ImVec2(0.0, lines + imgui.get_style().scrollbar_size if fits else 0.0)
    room = imgui.get_content_region_avail()
    scrolls = not fits and lines + imgui.get_style().scrollbar_size > room.y
    if not imgui.begin_table(name, len(columns), int(flags), size):
        return
    imgui.table_setup_scroll_freeze(1, 1)
    some = [*rows[:_MEASURED], *rows[_MEASURED:][-_MEASURED:]]
    widths = []
    for column in columns:
        texts = [column.heading, *(in_window_style(column.cell(one)) for one in some)]
        width = max(imgui.calc_text_size(text).x for text in texts) + 1.0
        widths.append(min(width, em(_LONGEST)) if column.text else width)
    for column, width in zip(columns, _whole_columns(widths, room.x - scrolls * imgui.get_style().scrollbar_size)):
        imgui.table_setup_column(column.heading, int(imgui.TableColumnFlags_.width_fixed), width)
    for column in columns:
        imgui.table_next_column()
        clipped(column.heading, QUIET)
        tooltip(column.meaning)
    for number in seen_rows(len(rows)):
        imgui.table_next_row()
        for place, column in enumerate(columns):
            imgui.table_next_column()
            text, color = in_window_style(column.cell(rows[number])), ERROR if column.wrong(rows[number]) else None
            if place or click is None:
                (clipped if column.text else right)(text, color)
                continue
            if imgui.selectable(f"{text}##{number}", chosen == number, _ROW)[0]:
                click(number)
            if tip is not None:
                tooltip(tip(rows[number]))
    imgui.end_table()


def _whole_columns(widths: list[float], room: float) -> list[float]:
    """Return widths with those columns wider that are inside the room, so that its edge cuts none."""
    gap = 2.0 * imgui.get_style().cell_padding.x
    inside = sum(end <= room + gap for end in accumulate(width + gap for width in widths))
    left = room + gap - sum(widths[:inside]) - inside * gap if inside < len(widths) else 0.0
    return [width + (left / inside if place < inside else 0.0) for place, width in enumerate(widths)]


def _heading(ui: Ui, run: Experiment | ZoomTest | Hunt) -> None:
    """Say what the results are of, in a line that stands out where that is not the scene that is open."""
    scene = ui.controller.session.scene
    if scene is not None and not run.is_of(scene):
        paragraph(f"{icons.ICON_FA_TRIANGLE_EXCLAMATION}  Made {run.made_in(scene)}.", WARNING)
    if run.results is not None:
        clipped(f"{title(run.results)}, begun at {run.began:%H:%M}", QUIET)


def start_or_progress(ui: Ui, run: Run | None, start: Callable[[], None], tip: str) -> None:
    """Show the button that starts, or, while the run is under way, how far it is and the button that stops it."""
    runner = ui.controller.runs
    if run is None or runner.current is not run:
        imgui.begin_disabled(runner.current is not None)
        if wide_button(f"{icons.ICON_FA_PLAY}  Start", tip):
            start()
        imgui.end_disabled()
        return
    left = run.seconds_left
    imgui.progress_bar(run.fraction, ImVec2(-1.0, 0.0), "" if left is None else f"{duration(left)} left")
    clipped(run.label, QUIET)
    tip = f"Keep what is done{ui.key('Stop, or clear the selection')}"
    if run.stopping:
        imgui.text_colored(QUIET, "Stopping ...")
    elif wide_button(f"{icons.ICON_FA_STOP}  Stop", tip):
        runner.stop()


def _export_buttons(ui: Ui, run: Run) -> None:
    """Show one small button for each kind of file; none before there are results."""
    for number, ending in enumerate(ui.controller.runs.exports_of(run)):
        name, tip = _SAVED_AS[ending]
        label = f"{icons.ICON_FA_FLOPPY_DISK} {name}"
        if number:
            same_line_for(label)
        if imgui.button(label):
            ui.controller.runs.export(run, ending)
        tooltip(tip)
