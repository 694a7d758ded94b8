"""The tables of `bench` and `sweep`, in terminals of all widths: columns may go, figures are never cut."""

from __future__ import annotations

import io
from collections.abc import Sequence
from functools import partial
from types import SimpleNamespace

import pytest
from rich.console import Console
from rich.table import Table

from tracer.experiments.experiment import FIGURES, Results
from tracer.experiments.sweep_summary import Line
from tracer.method import line_up
from viewer.cli import console, sweep
from viewer.cli.bench import bench_table

LARGE = 123_456_789.0
STUDY = SimpleNamespace(title="Two rooms")


def results(methods: Sequence[str]) -> Results:
    """Of two frames; all but the reference do 4.832 times its work, and one does a thousand times."""
    found = Results("room.aff", (512, 512), frames=[0, 1], path_times=(0.0, 1.0), planned=2)
    found.settings = {"verify": True}
    for name in methods:
        work = {"none": 1.0, "voxels": 1194.0}.get(name, 4.832)
        found.methods[name] = {figure: [LARGE * work] * 2 for figure in FIGURES}
        found.methods[name] |= {"certificate_steps": [0.0] * 2, "certificate_tests": [0.0] * 2}
        found.methods[name] |= {"frame_seconds": [12.3456 * work] * 2, "wrong": [54_321.0] * 2}
        found.build_seconds[name], found.memory_bytes[name] = [3.5, 3.5], [987_654_321] * 2
    return found


def lines() -> list[Line]:
    return [
        Line(scene, 512, 512, settings, method, 1200, 0.4123, 0.012, -17.413, 0.71, 123456, 0.01, True, 12.3456, 1.03)
        for scene in ("default", "kitchen")
        for settings in ("lightcuts_error 0.01, light_buffer_side 64", "lightcuts_error 0.1, light_buffer_side 256")
        for method in ("none", "paper", "lightcuts-stochastic", "certified+lightbuffer")
    ]


def printed(tables: Sequence[Table], width: int | None) -> str:
    out = io.StringIO()
    for table in tables:
        title, table.title = table.title, None
        print(title, file=out)
        Console(file=out, width=width or 1000).print(table)
    return out.getvalue()


@pytest.mark.parametrize("width", [80, 100, 200, None])
@pytest.mark.parametrize(
    ("made", "never_cut"),
    [
        (lambda width: [bench_table(results(line_up(6)), width)], ("certified+lightbuffer", "-383.2%")),
        (lambda width: sweep.tables(STUDY, lines(), width),
         ("default", "kitchen", "lightcuts_error 0.01", "certified+lightbuffer", "41.2% ± 1.2", "12,345.6")),
    ],
    ids=["bench", "sweep"],
)  # fmt: skip
def test_nothing_is_cut_off_and_what_is_left_out_is_named(width: int | None, made, never_cut: tuple[str, ...]):
    text = printed(made(width), width)
    assert "…" not in text and all(word in text for word in never_cut)
    rows = [line for line in text.splitlines() if line[:1] in "│┃"]
    assert max(map(len, rows)) <= (width or 1000)
    whole = printed(made(None), None)
    headings = len(next(line for line in rows if line[0] == "┃").split("┃")) - 2
    every = len(next(line for line in whole.splitlines() if line[:1] == "┃").split("┃")) - 2
    told = " ".join(text.split()).rpartition("a wider terminal shows ")[2]
    assert (told.count(",") if headings < every else 0) == every - headings, "as many as the commas of a, b, too"


def test_where_nothing_helps_a_line_is_longer_than_the_terminal(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    monkeypatch.setattr(console, "Console", partial(Console, force_terminal=True, width=30, color_system=None))
    console.print_table(bench_table(results(line_up(6)), 30))
    out = capsys.readouterr().out
    assert "-383.2%" in out and "certified+lightbuffer" in out and "…" not in out
