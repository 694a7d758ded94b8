"""The tables of `bench`, in terminals of all widths: columns may go, figures are never cut."""

from __future__ import annotations

import io
from functools import partial

import pytest
from rich.console import Console
from rich.table import Table

from tracer.experiments.experiment import FIGURES, Results
from tracer.experiments.lamp_experiment import LampResults
from tracer.method import line_up
from viewer.cli import bench, console
from viewer.cli.bench import COLUMNS, bench_table

LARGE = 123_456_789.0


def results(methods: list[str]) -> Results:
    """Of two frames; all but the reference do 4.832 times its work, and one does a thousand times."""
    found = Results("room.aff", (512, 512), frames=[0, 1], path_times=(0.0, 1.0), planned=2)
    found.settings = {"lamp_radius": 0.25, "lamp_samples": 64}
    for name in methods:
        work = {"none": 1.0, "voxels": 1194.0}.get(name, 4.832)
        found.methods[name] = {figure: [LARGE * work] * 2 for figure in FIGURES}
        found.methods[name] |= {"certificate_steps": [0.0] * 2, "certificate_tests": [0.0] * 2}
        found.methods[name] |= {"frame_seconds": [12.3456 * work] * 2, "wrong": [54_321.0] * 2}
        found.build_seconds[name], found.memory_bytes[name] = [3.5, 3.5], [987_654_321] * 2
    return found


def printed(table: Table, width: int | None) -> str:
    out, title = io.StringIO(), table.title
    table.title = None
    Console(file=out, width=width or 1000).print(table)
    table.title = title
    return out.getvalue()


@pytest.mark.parametrize("verified", [False, True])
@pytest.mark.parametrize("width", [72, 80, 100, 200, None])
def test_methods_have_a_line_each_and_no_figure_is_cut(width: int | None, verified: bool):
    methods = line_up(6)
    text = printed(bench_table(results(methods), verified, width), width)
    assert len(methods) > 10 and "…" not in text
    assert max(map(len, text.splitlines())) <= (width or 1000)
    lines = {line.split("│")[1].strip(): line for line in text.splitlines() if line.startswith("│")}
    for name in methods[1:]:
        assert ("1,194 × as many" if name == "voxels" else "-383.2%") in lines[name], "in one line"
    caption = " ".join(text[text.rindex("┘") + 1 :].split())
    assert "--csv FILE has all figures" in caption
    headings = " ".join(text[: text.index("┡")].split())
    for heading in COLUMNS.values():
        name = " ".join(heading.split())
        shown = heading.split("\n")[0] in headings
        meant = name != ("speed- up" if verified else "wrong")
        assert (name in caption.partition("a wider terminal shows")[2]) == (not shown and meant)
    assert (" ms " in lines["paper"]) == ("a frame" in headings)
    assert ("a wider terminal" in caption) == (width in (72, 80, 100))


def test_few_methods_have_columns_where_these_fit():
    few = results(["none", "paper", "cells", "certified", "auto"])
    wide, narrow = (printed(bench_table(few, True, width), width) for width in (None, 80))
    assert "traversal steps saved, average" in wide and "traversal steps saved, average" not in narrow
    assert "-383.2%" in narrow and "…" not in narrow and max(map(len, narrow.splitlines())) <= 80
    two = printed(bench_table(results(["none", "paper"]), True, 80), 80)
    assert "traversal steps saved, average" in two and "--csv" not in two


@pytest.mark.parametrize("width", [80, 100, None])
def test_lamps_fit_too(width: int | None):
    text = printed(bench.lamp_table(LampResults([results([*line_up(6)])]), width), width)
    assert "…" not in text and max(map(len, text.splitlines())) <= (width or 1000)
    assert "59,653.9 ms" in text
    caption = " ".join(text[text.rindex("┘") :].split())
    assert ("123,456,789" in text) == ("a wider terminal shows shadow rays" not in caption) == (width is None)


def test_where_nothing_helps_a_line_is_longer_than_the_terminal(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    monkeypatch.setattr(console, "Console", partial(Console, force_terminal=True, width=30, color_system=None))
    console.print_table(bench_table(results(line_up(6)), True, 30))
    out = capsys.readouterr().out
    assert "-383.2%" in out and "certified+lightbuffer" in out and "…" not in out
