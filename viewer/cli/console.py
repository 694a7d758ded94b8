"""What a command says while it works, and how it stops.

Results go to standard output; everything else goes to standard error, as a progress bar where that is a terminal and as
next to nothing where it is not.  Ctrl-C is a wish: it is noted, and the work ends by `Cancelled` at the next report of
progress; a second one ends it at once."""

from __future__ import annotations

import signal
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from types import FrameType
from typing import TYPE_CHECKING, Literal, TypeVar

from rich.console import Console
from rich.progress import BarColumn, Progress, TaskID, TextColumn, TimeElapsedColumn, TimeRemainingColumn
from rich.table import Table
from rich.text import Text

from tracer.experiments.runner import Results, Run
from tracer.geometry.world import World
from tracer.scene.model import Cancelled
from tracer.util.text import printable
from viewer.util.messages import in_one_line, say

if TYPE_CHECKING:
    from viewer.output.reports import Column

Row = TypeVar("Row")

_PACE_OVER = 600.0  # seconds: frames may take minutes, and the time left is told from those of the last ones


class Work:
    """A long piece of work: `progress` is handed to the tracer, `cancelled` to its renderer."""

    def __init__(self) -> None:
        self.stopped = False
        self._bar: Progress | None = None
        self._task: TaskID | None = None

    def progress(self, label: str, fraction: float) -> None:
        """Show a `Progress` of the tracer; raises Cancelled once Ctrl-C was pressed."""
        if self.stopped:
            raise Cancelled("cancelled")
        self._show(label, min(max(fraction, 0.0), 1.0 - 1e-9), 1.0)  # what was once finished keeps the time of it

    def count(self, label: str, done: int, total: int) -> None:
        """Show that so many of `total` like steps are done; leaves stopping to `cancelled`."""
        self._show(label, done, total)

    def _show(self, label: str, done: float, total: float) -> None:
        if self._bar is not None:
            if self._task is None:
                self._task = self._bar.add_task(label, total=total)
            self._bar.update(self._task, description=in_one_line(label), completed=done, total=total)

    def cancelled(self) -> bool:
        return self.stopped

    def perform(self, run: Run[Results], world: World | None = None) -> Results:
        """Do a run and show how far it is; return its results.

        Where it was cancelled, that is said, and what is done is returned.  Raises Cancelled where nothing is."""

        def show() -> None:
            self.count(run.label, run.traced, run.frames)

        show()
        for _ in run.each(world, self.cancelled, show):
            pass
        if run.results is None:
            raise Cancelled("cancelled")
        if not run.whole:
            self.note("cancelled after {} of {} {}s; these are kept".format(*run.done_of, run.unit))
        return run.results

    def note(self, line: str) -> None:
        """Print one line above the bar."""
        if self._bar is None:
            say(line)
        else:
            self._bar.console.print(f"shadowcull: {in_one_line(line)}", markup=False, highlight=False)

    def _interrupt(self, number: int, frame: FrameType | None) -> None:
        if self.stopped:
            raise KeyboardInterrupt
        self.stopped = True


@contextmanager
def working() -> Iterator[Work]:
    """Begin a piece of work, with a bar on a terminal, and with Ctrl-C turned into `Cancelled`."""
    work = Work()
    before = signal.signal(signal.SIGINT, work._interrupt)
    console = Console(stderr=True)
    columns = (
        TextColumn("{task.description}", markup=False),
        BarColumn(bar_width=24),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
        TextColumn("left"),
    )
    try:
        if not console.is_terminal:
            yield work
            return
        with Progress(*columns, console=console, transient=True, speed_estimate_period=_PACE_OVER) as work._bar:
            yield work
    finally:
        signal.signal(signal.SIGINT, before)


# --- tables ----------------------------------------------------------------------------------------


def titled(title: str, caption: str = "") -> Table:
    """Begin a table with its title and its caption at the left."""
    table = Table(title=title, title_justify="left", title_style="bold", caption=caption or None)
    table.caption_justify = "left"
    return table


def print_table(table: Table) -> None:
    """Print a table on standard output; where that is no terminal as wide as it is, and 100 columns at least.

    Its title may be wider than itself, such as a path, which must not be broken; nor must figures be cut: where a
    terminal is too narrow for these, its own lines are."""
    console = Console()
    title, table.title = table.title, None
    if not console.is_terminal:
        console = Console(width=max(100, width_of(table)))
    if title is not None:
        for line in str(title).split("\n"):
            console.print(Text(printable(line), str(table.title_style or "")), soft_wrap=True)
    for column in table.columns:
        if column.justify == "right" or column.no_wrap:
            heading = console.measure(column.header)
            needed = [console.measure(cell).maximum for cell in column.cells]
            column.min_width = max([heading.maximum if column.no_wrap else heading.minimum, *needed])
    console.print(table, crop=False)


def width_of(table: Table) -> int:
    """Return how many columns a table takes, with its cells in one line each."""
    return Console(width=1000).measure(table).maximum


def terminal_width() -> int | None:
    """Return the columns of the terminal; None where standard output is none."""
    console = Console()
    return console.width if console.is_terminal else None


def listed(
    columns: Sequence[Column[Row]], rows: Sequence[Row], title: str = "", caption: str = "",
    section: Callable[[Row], object] = lambda row: None,
) -> Table:  # fmt: skip
    """Make a table with a line for each row, and a rule wherever the section is another."""
    table = titled(title, caption)
    lines = [[column.cell(row) for column in columns] for row in rows]
    for number, column in enumerate(columns):
        in_one = not column.text or not any(" " in line[number] for line in lines)
        side: Literal["left", "right"] = "left" if column.text else "right"
        heading = column.heading if column.text else column.heading.replace(" ", "\n")
        table.add_column(heading, justify=side, no_wrap=in_one)
    for number, line in enumerate(lines):
        after = rows[number + 1] if number + 1 < len(rows) else rows[number]
        table.add_row(*line, end_section=section(after) != section(rows[number]))
    return table


def fitted(
    columns: Sequence[Column[Row]], made: Callable[[Sequence[Column[Row]]], Sequence[Table]], width: int | None,
    least: int = 3,
) -> Sequence[Table]:  # fmt: skip
    """Return the tables that are made of the columns, without the last of these where a terminal so wide has no room,
    but for the `least`; the last caption names what is left out.  None is any width."""
    count, tables = len(columns), made(columns)
    while width is not None and count > least and any(width_of(table) > width for table in tables):
        count -= 1
        tables = made(columns[:count])
    if left := ", ".join(column.heading for column in columns[count:]):
        tables[-1].caption = f"{tables[-1].caption or ''}\na wider terminal shows {left}, too".strip()
    return tables


def columns_help(columns: Sequence[Column[Row]]) -> str:
    """Say in a line for each column of a table what it means."""
    width = max(len(column.heading) for column in columns)
    return "columns:\n" + "".join(f"  {column.heading:{width}}  {column.meaning}\n" for column in columns)
