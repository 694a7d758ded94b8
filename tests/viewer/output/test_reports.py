"""What is said of the results of experiments."""

from __future__ import annotations

from dataclasses import replace

from tracer.experiments.experiment import Results, Row
from viewer.output.reports import LINES, SPEED_UP, WRONG, caveats, leaders, lines


def row(method: str, steps: float = 0.0, tests: float = 0.0, speed_up: float = 1.0, spread: float = 0.01) -> Row:
    return Row(
        method, steps, steps, 3, tests, tests, 3, 0.0, 0, 0.0, 0.1, 1.0 / speed_up, 0.0, 0, speed_up, spread, 0.3
    )


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
    noisy = [row("none"), row("certified", 0.5, 0.5, 1.2, spread=0.3), row("auto", 0.4, 0.4, 1.1, spread=0.2)]
    assert leaders(noisy)[2] == "least time, of exact methods: none; no other is quicker"
    close = [row("none"), row("certified", 0.5, 0.5, 1.02), row("auto", 0.4, 0.4, 1.01)]
    assert leaders(close)[2] == "least time, of exact methods: none; no other is quicker"


def test_nothing_is_said_where_there_is_nothing_to_choose_from():
    assert leaders([row("none"), row("certified", 0.5)]) == []
    assert leaders([row("none"), row("certified", 0.5), row("paper", 0.5)]) == []


def test_savings_and_speed_up_are_in_the_table():
    cells = {heading.strip(): cell(row("certified", -1193.6, 0.25, 1.5)) for heading, cell in LINES}
    assert cells["traversal steps saved, average"] == "1,195 × as many"
    assert cells["intersection tests saved, average"] == "25.0%"
    assert (
        cells["speed-up over none, all frames"] == "1.50 ± 0.01" and cells["shadow rays saved (of rays due)"] == "30.0%"
    )
    none = {heading.strip(): cell(replace(row("none"))) for heading, cell in LINES}
    assert none["speed-up over none, all frames"] == none["traversal steps saved, average"] == ""


def test_nothing_is_said_of_time_where_frames_were_verified() -> None:
    rows = [row("none"), row("certified", 0.5), row("paper", 0.5), row("certified+cache", 0.6)]
    assert leaders(rows, timed=False) == leaders(rows)[:2]


def test_what_times_depend_on_is_said_alike_in_the_window_and_by_bench() -> None:
    seconds = {"none": {"frame_seconds": [1.0, 1.0]}, "certified": {"frame_seconds": [2.0, 2.0]}}
    found = Results("s", (8, 8), [0, 1], methods=seconds, settings={"accelerator": "bvh8", "verify": False})
    found.build_seconds = {"none": [0.0, 0.0], "certified": [1.5, 0.5]}
    said = caveats(found)
    assert "bvh8" in said[0] and "50% of the time of certified is preparing" in said
    assert not any("window" in one for one in said)
    beside = caveats(found, in_window=True)
    assert beside[1:] == said and "window" in beside[0]
    found.settings["verify"] = True
    for one in (caveats(found), caveats(found, in_window=True)):
        assert one == ["times include verifying, which traces culled rays, too: no speed-up is told"]


def test_a_verified_run_tells_what_is_wrong_and_no_speed_up() -> None:
    verified, timed = ([heading for heading, _ in lines(one)] for one in (True, False))
    assert WRONG in verified and SPEED_UP not in verified
    assert SPEED_UP in timed and WRONG not in timed
