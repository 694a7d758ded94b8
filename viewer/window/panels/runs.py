"""What the panels of runs share: rows of a plan, three parts side by side, progress, and the files to save."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager

from imgui_bundle import ImVec2, imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from tracer.experiments.experiment import Experiment
from tracer.experiments.runner import Run
from tracer.experiments.zoom import ZoomTest
from viewer.services.runs import described, duration
from viewer.state.plans import FilmPlan, HuntPlan
from viewer.window.ui import Ui
from viewer.window.widgets import QUIET, WARNING, clipped, em, row, same_line_for, tooltip, tooltip_above, wide_button

_SAVED_AS = {".json": ("JSON", "Save every figure"), ".csv": ("CSV", "Save the table"),
             ".png": ("Plot", "Save the plot as a picture")}  # fmt: skip

_LEFT, _LEAST_PLOT = 14.0, 12.0  # ems of the controls, and of a plot beside them


def frames_row(plan: FilmPlan | HuntPlan, frames: tuple[int, int], tip: str) -> None:
    """The row of the first and the last frame."""
    row("Frames", tip)
    changed, span = imgui.input_int2("##frames", list(frames))
    if changed:
        plan.first, plan.last = max(0, span[0]), max(0, span[1])


def either(no: str, yes: str, now: bool) -> bool:
    """Show two buttons of which one is set, beside each other where there is room; returns whether it is the second."""
    first = imgui.radio_button(no, not now)
    same_line_for(yes.partition("##")[0])
    second = imgui.radio_button(yes, now)
    return second or (now and not first)


@contextmanager
def results_table(name: str, columns: Sequence[tuple[str, float, str]]) -> Iterator[bool]:
    """A table whose headings stay; yields whether it is visible.

    Columns are headings, pixels, and what they mean; one of no pixels takes what the others leave.  Where there is none
    of these, the first column stays as the others are scrolled."""
    wide = all(width for _, width, _ in columns)
    flags = imgui.TableFlags_.row_bg | imgui.TableFlags_.scroll_y
    flags |= imgui.TableFlags_.scroll_x if wide else imgui.TableFlags_.none
    shown = imgui.begin_table(name, len(columns), int(flags))
    if shown:
        imgui.table_setup_scroll_freeze(int(wide), 1)
        for heading, width, _ in columns:
            kind = imgui.TableColumnFlags_.width_fixed if width else imgui.TableColumnFlags_.width_stretch
            imgui.table_setup_column(heading, int(kind), width)
        for heading, _, tip in columns:
            imgui.table_next_column()
            clipped(heading, QUIET)
            if tip:
                tooltip(tip)
    yield shown
    if shown:
        imgui.end_table()


def choice(label: str, chosen: bool = False) -> bool:
    """Begin a row of such a table that can be clicked anywhere, by its first cell; returns whether it is."""
    imgui.table_next_row()
    imgui.table_next_column()
    flags = imgui.SelectableFlags_.span_all_columns | imgui.SelectableFlags_.allow_overlap
    return imgui.selectable(label, chosen, int(flags))[0]


def side_by_side(
    controls: Callable[[], None],
    plot: Callable[[ImVec2], None],
    table: Callable[[], None] | None,
    table_width: float,
    heading: Callable[[], None] = lambda: None,
) -> None:
    """Controls, plot and table in a row; one below the other where the panel is too narrow for that.  A heading of one
    line stands above plot and table.

    Without a table, the plot has its room."""
    room, spacing = imgui.get_content_region_avail(), imgui.get_style().item_spacing.x
    beside = table_width + spacing if table is not None else 0.0
    middle = room.x - em(_LEFT) - spacing - beside
    if table is not None and middle < em(16.0):  # before they go one below the other, the table gives what it can
        table_width = max(em(11.0), table_width - (em(16.0) - middle))
        middle = room.x - em(_LEFT) - table_width - 2.0 * spacing
    if middle < em(_LEAST_PLOT):
        controls()
        heading()
        plot(ImVec2(room.x, em(14.0)))
        if table is not None:
            _in_child("table", ImVec2(0.0, em(14.0)), table)
        return
    _in_child("controls", ImVec2(em(_LEFT), 0.0), controls)
    imgui.same_line()
    imgui.begin_group()
    heading()
    plot(ImVec2(middle, max(imgui.get_content_region_avail().y, em(8.0))))
    if table is not None:
        imgui.same_line()
        _in_child("table", ImVec2(table_width, 0.0), table)
    imgui.end_group()


def _in_child(name: str, size: ImVec2, show: Callable[[], None]) -> None:
    if imgui.begin_child(name, size):
        show()
    imgui.end_child()


def in_tabs(
    controls: Callable[[], None],
    plot: Callable[[ImVec2], None],
    table: Callable[[], None],
    table_width: float,
    heading: Callable[[], None] = lambda: None,
) -> None:
    """Controls, plot and table in a row, and a heading above the last two.  Where a table of so many pixels leaves too
    little for a plot, both are tabs beside the controls; in a panel that is too narrow for that, they lie below one
    another."""
    room, spacing = imgui.get_content_region_avail(), imgui.get_style().item_spacing.x
    middle = room.x - em(_LEFT) - spacing
    if middle - table_width - spacing >= em(16.0) or middle < em(_LEAST_PLOT):
        side_by_side(controls, plot, table, max(table_width, 0.45 * middle), heading)
        return
    _in_child("controls", ImVec2(em(_LEFT), 0.0), controls)
    imgui.same_line()
    if imgui.begin_child("results", ImVec2(middle, 0.0)):
        heading()
        if imgui.begin_tab_bar("results"):
            if imgui.begin_tab_item_simple("Table"):
                table()
                imgui.end_tab_item()
            if imgui.begin_tab_item_simple("Plot"):
                area = imgui.get_content_region_avail()
                plot(ImVec2(area.x, max(area.y, em(8.0))))
                imgui.end_tab_item()
            imgui.end_tab_bar()
    imgui.end_child()


def whose(ui: Ui, run: Experiment | ZoomTest) -> None:
    """A line that says of which scene the results are, and stands out where that is not the one that is open."""
    text, elsewhere = described(run, ui.controller.session.scene)
    clipped(f"{icons.ICON_FA_TRIANGLE_EXCLAMATION}  {text}" if elsewhere else text, WARNING if elsewhere else QUIET)


def start_or_progress(ui: Ui, run: Run | None, start: Callable[[], None], tip: str) -> None:
    """The button that starts, or, while the run is under way, how far it is and the button that stops it."""
    runner = ui.controller.runs
    if run is None or runner.current is not run:
        imgui.begin_disabled(runner.current is not None)
        if wide_button(f"{icons.ICON_FA_PLAY}  Start", tip, explain=tooltip_above):
            start()
        imgui.end_disabled()
        return
    left = run.seconds_left
    imgui.progress_bar(run.fraction, ImVec2(-1.0, 0.0), "" if left is None else f"{duration(left)} left")
    clipped(run.label if run.traced else "Starting ...", QUIET)
    if run.stopping:
        imgui.text_colored(QUIET, "Stopping ...")
    elif wide_button(
        f"{icons.ICON_FA_STOP}  Stop",
        f"Keep what is done{ui.key('Stop, or clear the selection')}",
        explain=tooltip_above,
    ):
        runner.stop()


def export_buttons(ui: Ui, run: Run | None) -> None:
    """One small button for each kind of file; none before there are results."""
    kinds = ui.controller.runs.exports_of(run) if run is not None else {}
    for ending in kinds:
        name, tip = _SAVED_AS[ending]
        if run is not None and imgui.button(f"{icons.ICON_FA_FLOPPY_DISK} {name}"):
            ui.controller.runs.export(run, ending)
        tooltip_above(tip)
        imgui.same_line(0.0, em(0.25))
    if kinds:
        imgui.new_line()
