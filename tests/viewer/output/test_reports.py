"""What is said of the results of experiments."""

from __future__ import annotations

from dataclasses import replace

from tracer.experiment import Row
from viewer.output.reports import LINES, leaders


def row(method: str, steps: float = 0.0, tests: float = 0.0, speed_up: float = 1.0) -> Row:
    return Row(method, steps, steps, 3, tests, tests, 3, 0.0, 0, 0.0, 0.1, 1.0 / speed_up, 0.0, 0, speed_up)


def test_the_best_is_worth_naming():
    rows = [row("none"), row("certified", 0.9, 0.2, 1.5), row("auto", 0.1, 0.1, 1.2), row("paper", 0.95, 0.9, 3.0)]
    assert leaders(rows) == [
        "fewest steps, of exact methods: certified (90.0% saved)",
        "fewest tests, of exact methods: certified (20.0% saved)",
        "least time, of exact methods: certified (1.50 times as fast as none)",
    ]


def test_none_is_best_where_the_others_cost_more():
    rows = [row("none"), row("certified", -1193.6, -0.2, 0.4), row("auto", 0.0, 0.0, 1.1), row("voxels", 0.0003, 0.0)]
    assert leaders(rows) == [
        "fewest steps, of exact methods: none; no other saves any",
        "fewest tests, of exact methods: none; no other saves any",
        "least time, of exact methods: none; no other is quicker",
    ], "auto has culled nothing: that it was quicker is chance"
    close = [row("none"), row("certified", 0.5, 0.5, 1.02), row("auto", 0.4, 0.4, 1.01)]
    assert leaders(close)[2] == "least time, of exact methods: none; no other is quicker"


def test_nothing_is_said_where_there_is_nothing_to_choose_from():
    assert leaders([row("none"), row("certified", 0.5)]) == []
    assert leaders([row("none"), row("certified", 0.5), row("paper", 0.5)]) == []


def test_savings_and_speed_up_are_in_the_table():
    cells = {heading.strip(): cell(row("certified", -1193.6, 0.25, 1.5)) for heading, cell in LINES}
    assert cells["traversal steps saved, average"] == "1,195 × as many"
    assert cells["intersection tests saved, average"] == "25.0%"
    assert cells["speed-up over none, all frames"] == "1.50"
    none = {heading.strip(): cell(replace(row("none"))) for heading, cell in LINES}
    assert none["speed-up over none, all frames"] == none["traversal steps saved, average"] == ""


def test_nothing_is_said_of_time_where_frames_were_verified() -> None:
    rows = [row("none"), row("certified", 0.5), row("paper", 0.5), row("certified+cache", 0.6)]
    assert leaders(rows, timed=False) == leaders(rows)[:2]
