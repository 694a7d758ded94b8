"""The table of a sweep: one where there is room for it, else one for each scene, size and combination of settings."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from itertools import groupby
from typing import TYPE_CHECKING

from rich.table import Table

from tracer.experiments.experiment import REFERENCE
from tracer.experiments.study import Study
from viewer.cli.console import width_of
from viewer.cli.narrow_tables import left_out, named
from viewer.state import terms
from viewer.util import numbers
from viewer.util.messages import printable

if TYPE_CHECKING:  # this needs pyarrow
    from tracer.experiments.sweep_summary import Line

LEAST_WANTED = ("frames", "saved", "tests\nsaved", "wrong")
"""Columns that are left out, one after another, where there is no room for all."""


def _saved(value: float, spread: float = float("nan")) -> str:
    return "" if value != value else numbers.saved(value, spread if spread == spread else None)


COLUMNS: tuple[tuple[str, Callable[[Line], str]], ...] = (
    ("frames", lambda line: f"{line.frames:,}"),
    ("steps\nsaved", lambda line: "" if line.method == REFERENCE else _saved(line.steps, line.spread)),
    ("tests\nsaved", lambda line: "" if line.method == REFERENCE else _saved(line.tests)),
    (terms.SAVED, lambda line: "" if line.method == REFERENCE else f"{line.known:.1%}"),
    ("wrong", lambda line: f"{line.wrong:,}" if line.verified else ""),
    ("frame,\nmedian\nms", lambda line: "" if line.seconds != line.seconds else f"{1000 * line.seconds:,.1f}"),
    ("speed-\nup, all\nframes", lambda line: "" if line.speed_up != line.speed_up else f"{line.speed_up:.2f}"),
)
"""What a table says of a line: headings, and the cells below them."""


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
