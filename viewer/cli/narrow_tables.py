"""Tables in terminals that are too narrow for them: columns are left out, the least wanted first, and named below."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from rich.table import Table

from viewer.cli.console import width_of


def left_out(
    least_wanted: Sequence[str], made: Callable[[Sequence[str]], Sequence[Table]], width: int | None
) -> Sequence[str]:
    """The fewest columns to leave out so that all tables, as `made` without these, fit in so many columns; all that can
    be where even that does not help.  None is any width."""
    for count in range(len(least_wanted)):
        if width is None or all(width_of(table) <= width for table in made(least_wanted[:count])):
            return least_wanted[:count]
    return least_wanted


def named(headings: Sequence[str]) -> str:
    """Headings, which may stand in several lines, as a list in words; "" of none."""
    return ", ".join(" ".join(heading.split()) for heading in headings)
