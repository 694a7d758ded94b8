"""What a command says while it works, and how it stops.

Results go to standard output; everything else goes to standard error, as a progress bar where
that is a terminal and as next to nothing where it is not.  Ctrl-C is a wish: it is noted, and the
work ends by `Cancelled` at the next report of progress; a second one ends it at once.
"""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import timedelta
from types import FrameType

from rich.console import Console
from rich.progress import BarColumn, Progress, ProgressColumn, Task, TaskID, TextColumn, TimeElapsedColumn
from rich.table import Table
from rich.text import Text

from tracer.experiments.time_left import TimeLeft
from tracer.scene.model import Cancelled
from tracer.settings import Settings
from tracer.statistics import FrameStatistics
from viewer.state import terms, verified
from viewer.util.messages import in_one_line, printable, say


class _TimeLeftColumn(ProgressColumn):
    def render(self, task: Task) -> Text:
        left = task.fields["left"].seconds() if "left" in task.fields else None
        return Text("" if left is None else f"{timedelta(seconds=round(left))} left", "progress.remaining")


class Work:
    """A long piece of work: `progress` is handed to the tracer, `cancelled` to its renderer."""

    def __init__(self) -> None:
        self.stopped = False
        self._left = TimeLeft()
        self._bar: Progress | None = None
        self._task: TaskID | None = None

    def progress(self, label: str, fraction: float) -> None:
        """A `Progress` of the tracer; raises Cancelled once Ctrl-C was pressed."""
        if self.stopped:
            raise Cancelled("cancelled")
        self._left = TimeLeft()
        self._show(label, fraction)

    def count(self, label: str, done: int, total: int) -> None:
        """So many of `total` like steps are done: shows the time left too, and leaves stopping to `cancelled`."""
        self._left.mark(done, total)
        self._show(label, done / total)

    def _show(self, label: str, fraction: float) -> None:
        if self._bar is not None:
            if self._task is None:
                self._task = self._bar.add_task(label, total=1.0)
            completed = min(max(fraction, 0.0), 1.0 - 1e-9)  # a task that was once finished keeps the time of it
            self._bar.update(self._task, description=in_one_line(label), completed=completed, left=self._left)

    def cancelled(self) -> bool:
        return self.stopped

    def note(self, line: str) -> None:
        """One line above the bar."""
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
    """Work under way, with a bar on a terminal, and with Ctrl-C turned into `Cancelled`."""
    work = Work()
    before = signal.signal(signal.SIGINT, work._interrupt)
    console = Console(stderr=True)
    try:
        if not console.is_terminal:
            yield work
            return
        columns = (
            TextColumn("{task.description}", markup=False),
            BarColumn(bar_width=24),
            TimeElapsedColumn(),
            _TimeLeftColumn(),
        )
        with Progress(*columns, console=console, transient=True) as work._bar:
            yield work
    finally:
        signal.signal(signal.SIGINT, before)


def print_table(table: Table) -> None:
    """A table on standard output; where that is no terminal as wide as it is, and 100 columns at least.

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
    """How many columns a table takes, with its cells in one line each."""
    return Console(width=1000).measure(table).maximum


def terminal_width() -> int | None:
    """The columns of the terminal; None where standard output is none."""
    console = Console()
    return console.width if console.is_terminal else None


def statistics_table(statistics: FrameStatistics, title: str, settings: Settings, remark: str = "") -> Table:
    """The counters of a frame by a method, primary, secondary and shadow rays apart; what is wrong where it was
    verified."""
    caption = "\n".join(filter(None, (statistics.decision, remark))) or None
    table = Table(title=title, title_justify="left", title_style="bold", caption=caption)
    table.caption_justify = "left"
    table.add_column("")
    for name in ("primary", "secondary", "shadow"):
        table.add_column(name, justify="right")
    kinds = (statistics.primary, statistics.secondary, statistics.shadow)
    traced = (statistics.primary.rays, statistics.secondary.rays, statistics.shadow.traced)
    table.add_row("rays traced", *(f"{rays:,}" for rays in traced))
    table.add_row("traversal steps", *(f"{kind.traversal_steps:,}" for kind in kinds))
    table.add_row("intersection tests", *(f"{kind.intersection_tests:,}" for kind in kinds), end_section=True)
    shadow = statistics.shadow
    due = max(shadow.due, 1)
    table.add_row(f"shadow rays {terms.DUE}", "", "", f"{shadow.due:,}")
    table.add_row(f"  {terms.SAVED}", f"{shadow.saved / due:.1%}", "", f"{shadow.saved:,}")
    table.add_row(f"    {terms.CULLED}", f"{shadow.culled / due:.1%}", "", f"{shadow.culled:,}")
    table.add_row(f"    {terms.DYNAMIC_ONLY}", f"{shadow.dynamic_only / due:.1%}", "", f"{shadow.dynamic_only:,}")
    if shadow.candidates_only:
        table.add_row(
            f"  {terms.CANDIDATES_ONLY}", f"{shadow.candidates_only / due:.1%}", "", f"{shadow.candidates_only:,}"
        )
    if shadow.cache_hits:
        table.add_row(f"  {terms.CACHE_HITS}", f"{shadow.cache_hits / due:.1%}", "", f"{shadow.cache_hits:,}")
    table.add_row(f"  {terms.TRACED}", f"{shadow.traced / due:.1%}", "", f"{shadow.traced:,}")
    wrong = statistics.wrong
    if wrong is not None:
        if statistics.cuts is None:
            name, share = verified.named(terms.WRONG, wrong), f"{wrong.answers / max(wrong.due, 1):.3%}"
            table.add_row(name, share, "", f"{wrong.answers:,}")
        name = verified.named(terms.WRONG_PIXELS if statistics.cuts is None else terms.BEYOND, wrong)
        table.add_row(name, f"{wrong.pixels / max(wrong.shaded, 1):.3%}", "", f"{wrong.pixels:,}")
    if shadow.passed_over:
        table.add_row(f"samples {terms.PASSED_OVER}", "", "", f"{shadow.passed_over:,}")
    if statistics.certificates and terms.made(settings.method)[0]:
        table.add_row(terms.made(settings.method)[0], "", "", f"{statistics.certificates:,}")
        table.add_row("  traversal steps", "", "", f"{statistics.certificate_steps:,}")
        table.add_row("  intersection tests", "", "", f"{statistics.certificate_tests:,}")
    table.add_row("occlusion tests", f"{statistics.occlusion_tests:,}", "", "", end_section=True)
    for name, seconds in statistics.phases.items():
        table.add_row(terms.phase(name, settings)[0], f"{1000.0 * seconds:,.1f} ms", "", "")
    table.add_row("frame", f"{1000.0 * statistics.seconds:,.1f} ms", "", "")
    return table
