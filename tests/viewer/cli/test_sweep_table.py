"""The table of a sweep, in terminals of all widths."""

from __future__ import annotations

import io
from types import SimpleNamespace

import pytest
from rich.console import Console

from tracer.experiments.sweep_summary import Line
from viewer.cli import sweep

METHODS = ("none", "paper", "lightcuts-stochastic", "certified+lightbuffer")
STUDY = SimpleNamespace(title="Two rooms")


def lines() -> list[Line]:
    return [
        Line(scene, 512, 512, settings, method, 1200, 0.4123, 0.012, -17.413, 0.71, 123456, 0.01, True, 12.3456, 1.03)
        for scene in ("default", "kitchen")
        for settings in ("lightcuts_error 0.01, light_buffer_side 64", "lightcuts_error 0.1, light_buffer_side 256")
        for method in METHODS
    ]


def printed(width: int | None) -> tuple[str, int]:
    """What is printed, and how many tables it is."""
    tables, out = list(sweep.tables(STUDY, lines(), width)), io.StringIO()
    for table in tables:
        title, table.title = table.title, None
        print(title, file=out)
        Console(file=out, width=width or 1000).print(table)
    return out.getvalue(), len(tables)


@pytest.mark.parametrize(("width", "count"), [(80, 4), (100, 4), (200, 1), (None, 1)])
def test_nothing_is_cut_off(width: int | None, count: int):
    text, number = printed(width)
    assert number == count and "…" not in text
    assert max(map(len, text.splitlines())) <= (width or 1000)
    for word in (*METHODS, "default", "kitchen", "lightcuts_error 0.01", "41.2% ± 1.2", "12,345.6"):
        assert word in text, word
    words = " ".join(text.split())
    left_out = [
        heading for heading, _ in sweep.COLUMNS if " ".join(heading.split()) in words.partition("a wider terminal")[2]
    ]
    assert bool(left_out) == (width in (80, 100)), left_out
    assert ("18.4 × as many" in text) == ("tests\nsaved" not in left_out)
    assert ("saved are shadow rays culled or dynamic only" in words) == ("saved" not in left_out)
