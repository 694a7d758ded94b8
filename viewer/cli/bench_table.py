"""The table of `bench`: a column for each method where there is room for that, else a line for each."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from rich.table import Table

from tracer.experiments import experiment
from tracer.experiments.experiment import Results, Row
from viewer.cli.console import width_of
from viewer.cli.narrow_tables import left_out, named
from viewer.output.reports import SPEED_UP, WRONG, caveats, frames_in_words, lines
from viewer.util.messages import printable

MOST_COLUMNS = 5
"""Methods that have columns, at most."""
# What columns are called where methods have lines; the other figures are left to the files.
_COLUMNS = {
    "traversal steps saved, average": "steps\nsaved",
    "intersection tests saved, average": "tests\nsaved",
    WRONG: "wrong",
    "time of a frame, median": "a frame",
    "time of all frames": "all\nframes",
    "  of it preparing": "preparing",
    SPEED_UP: "speed-\nup",
    "memory of the method": "memory",
}
LEAST_WANTED = ("preparing", "all\nframes", "memory", "a frame", "tests\nsaved", "wrong")
"""Columns that are left out, one after another, where there is no room for all."""


def bench_table(results: Results, verified: bool, width: int | None) -> Table:
    """The table for so many columns; None for as many as it takes."""
    rows = experiment.table(results)
    if len(rows) <= MOST_COLUMNS:
        table = _by_columns(results, rows, verified)
        if width is None or width_of(table) <= width:
            return table
    left = left_out(LEAST_WANTED, lambda left: [_by_lines(results, rows, verified, left)], width)
    return _by_lines(results, rows, verified, left)


def _by_columns(results: Results, rows: Sequence[Row], verified: bool) -> Table:
    table = _begun(results, verified)
    table.add_column("")
    for row in rows:
        table.add_column(row.method.replace("+", "\n+"), justify="right")
    for heading, cell in lines(verified):
        table.add_row(heading, *(cell(row) for row in rows))
    return table


def _by_lines(results: Results, rows: Sequence[Row], verified: bool, left: Sequence[str]) -> Table:
    table = _begun(results, verified)
    table.add_column("method", no_wrap=True)
    shown = [
        (_COLUMNS[heading], cell)
        for heading, cell in lines(verified)
        if heading in _COLUMNS and _COLUMNS[heading] not in left
    ]
    for heading, _ in shown:
        table.add_column(heading, justify="right", no_wrap=True)
    for row in rows:
        table.add_row(row.method, *(cell(row) for _, cell in shown))
    missing = named([heading for heading in left if verified or heading != "wrong"])
    wider = f"a wider terminal shows {missing}, too; " if missing else ""
    table.caption = f"{table.caption}; {wider}--csv FILE has all figures"
    return table


def _begun(results: Results, verified: bool) -> Table:
    width, height = results.size
    title = (
        f"Work of shadow rays\n{printable(Path(results.scene).name)}, {width} × {height}, {frames_in_words(results)}"
    )
    table = Table(title=title, title_justify="left", title_style="bold", caption_justify="left")
    table.caption = "; ".join([*caveats(results), *([] if verified else ["--verify counts wrong answers"])])
    return table
