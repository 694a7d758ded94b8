"""The table of a sweep: one where there is room for it, else one for each scene, size and combination of settings."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import groupby
from typing import TYPE_CHECKING

from rich.table import Table

from tracer.experiment import REFERENCE
from viewer.cli.console import width_of
from viewer.cli.narrow_tables import left_out, named
from viewer.state import terms
from viewer.state.study import Study
from viewer.util.messages import printable

if TYPE_CHECKING:  # this needs pyarrow
    from viewer.output.sweep_summary import Line

LEAST_WANTED = ("frames", "saved", "tests\nsaved", "wrong")
"""Columns that are left out, one after another, where there is no room for all."""


def tables(study: Study, lines: list[Line], width: int | None) -> Iterator[Table]:
    """What to print in so many columns; None for as many as it takes."""
    whole = _table(study.title, lines, lines)
    if width is None or width_of(whole) <= width:
        yield whole
        return
    parts = [
        list(part) for _, part in groupby(lines, lambda line: (line.scene, line.width, line.height, line.settings))
    ]
    left = left_out(LEAST_WANTED, lambda left: [_of_part(part, lines, left) for part in parts], width)
    for number, part in enumerate(parts):
        table = _of_part(part, lines, left)
        first, last = number == 0, number == len(parts) - 1
        table.title = f"{printable(study.title) if first else ''}\n{_where(part[0])}"
        if not last:
            table.caption = None
        elif left:
            table.caption = f"{table.caption}; a wider terminal shows {named(left)}, too"
        yield table


def _where(line: Line) -> str:
    return ", ".join(filter(None, (printable(line.scene), f"{line.width}×{line.height}", line.settings)))


def _of_part(part: list[Line], lines: list[Line], left: Sequence[str]) -> Table:
    """The methods of one scene, size and combination of settings, without the columns that are left out."""
    return _table("", [replace(line, settings="") for line in part], lines, left, where=False)


def _table(title: str, shown: list[Line], lines: list[Line], left: Sequence[str] = (), where: bool = True) -> Table:
    """A section for each scene, size and combination of settings, a row for each method."""
    from viewer.output.sweep_summary import COLUMNS

    verified = all(line.verified for line in lines)
    saved = f"\n{terms.SAVED} are shadow rays {terms.MEANINGS[terms.SAVED]}" * (terms.SAVED not in left)
    table = Table(title=printable(title), title_justify="left", title_style="bold", caption_justify="left")
    table.caption = (
        f"saved against {REFERENCE}, certificates included; times are processor time of one thread"
        + (", with verifying" if verified else "; verify = true counts wrong answers")
        + saved
    )
    settings = where and any(line.settings for line in lines)
    for heading in (*(("scene", "size") if where else ()), *(["settings"] if settings else []), "method"):
        table.add_column(heading, no_wrap=heading != "settings")
    columns = [(heading, cell) for heading, cell in COLUMNS if heading not in left and (verified or heading != "wrong")]
    for heading, _ in columns:
        table.add_column(heading, justify="right", no_wrap=True)
    before: tuple[str, ...] = ("", "", "")
    for number, line in enumerate(shown):
        place = (printable(line.scene), f"{line.width}×{line.height}", line.settings)
        names = 3 if settings else 2 if where else 0
        cells = ["" if place[: i + 1] == before[: i + 1] else place[i] for i in range(names)]
        next_ = shown[number + 1] if number + 1 < len(shown) else None
        ends = next_ is not None and (next_.scene, next_.width, next_.height, next_.settings) != (
            line.scene, line.width, line.height, line.settings,
        )  # fmt: skip
        table.add_row(*cells, line.method, *(cell(line) for _, cell in columns), end_section=ends)
        before = place
    return table
