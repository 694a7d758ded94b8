"""What is said of the results of experiments and zoom tests."""

from __future__ import annotations

import pytest

from tracer.experiments import zoom
from tracer.experiments.experiment import Results, Row
from tracer.experiments.titles import happenings, title
from tracer.experiments.zoom import Approach, Change, Step
from tracer.scene.model import Camera
from viewer.output.reports import SPEED_UP, WRONG, caveats, changes_in_words, table_1, verdicts


def row(method: str, steps: float = 0.0, tests: float = 0.0, speed_up: float = 1.0, spread: float = 0.01) -> Row:
    spread = spread if method != "none" else 0.0
    return Row(
        method, steps, steps, 3, tests, tests, 3, 0.0, 0, 0.0, 0.1, 1.0 / speed_up, 0.0, 0, speed_up, spread, 0.3
    )


def test_table_1_of_a_verified_run_tells_what_is_wrong_and_no_speed_up() -> None:
    verified, timed = (table_1(Results("s", (8, 8), settings={"verify": verify})) for verify in (True, False))
    assert WRONG in verified and SPEED_UP not in verified and SPEED_UP in timed and WRONG not in timed
    cells = {column.meaning: column.cell(row("certified", -1193.6, 0.25, 1.5)) for column in timed}
    assert cells["traversal steps saved, average"] == "1,195 × as many"
    assert cells["intersection tests saved, average"] == "25.0%"
    assert cells["speed-up over none, all frames"] == "1.50 ± 0.01"
    assert cells["shadow rays saved (of rays due)"] == "30.0%"
    none = {column.meaning: column.cell(row("none")) for column in timed}
    assert none["speed-up over none, all frames"] == none["traversal steps saved, average"] == ""


def test_a_verdict_says_what_is_saved_and_whether_it_is_faster_or_right() -> None:
    rows = [
        row("none"),
        row("paper", 0.1, speed_up=1.5),
        row("certified", 0.7, speed_up=1.0),
        row("lie", -11.6, speed_up=0.5),
    ]
    part = "of the traversal steps of shadow rays saved"
    assert verdicts(rows, verified=False) == [
        f"Paper: 10.0% {part}, faster than tracing all: 1.50 times as fast.",
        f"Certified: 70.0% {part}, 7.0 times as many as by Paper, as fast as tracing all within 3%.",
        "Local illumination environments: 12.6 × as many traversal steps of shadow rays, slower than tracing all: 0.50 "
        "times as fast.",
    ]
    assert verdicts(rows[:2], verified=True) == [f"Paper: 10.0% {part}, no wrong answer."]
    assert "too few frames" in verdicts([rows[0], row("paper", 0.1, spread=float("inf"))], verified=False)[0]


def test_what_times_depend_on_is_said_alike_in_the_window_and_by_bench() -> None:
    seconds = {"none": {"frame_seconds": [1.0, 1.0]}, "certified": {"frame_seconds": [2.0, 2.0]}}
    found = Results("s", (8, 8), [0, 1], methods=seconds, settings={"accelerator": "bvh8", "verify": False})
    found.build_seconds = {"none": [0.0, 0.0], "certified": [1.5, 0.5]}
    said = caveats(found)
    assert "bvh8" in said[0] and "50% of the time of Certified is preparing" in said
    beside = caveats(found, in_window=True)
    assert beside[1:] == said and "window" in beside[0] and not any("window" in one for one in said)
    found.settings["verify"] = True
    for one in (caveats(found), caveats(found, in_window=True)):
        assert one[0] == "no speed-up is given, as verifying takes time: it traces the culled rays as well"
    assert caveats(found)[1:] == ["2 frames teach few modes, longer runs save more"]
    found.frames = list(range(100))
    assert len(caveats(found)) == 1


@pytest.mark.parametrize(
    ("frames", "stopped", "said"),
    [([0, 1, 2], True, "frames 0 to 2 of 200, stopped"), ([7, 8], False, "frames 7 to 8 of 200"),
     ([7], False, "frame 7 of 200")],
)  # fmt: skip
def test_frames_are_told_by_their_path(frames: list[int], stopped: bool, said: str) -> None:
    made = Results("scenes/hall.aff", (8, 6), frames, path_times=range(200), planned=200, stopped=stopped)
    assert title(made) == f"hall.aff, 8 × 6, {said}"


def test_steps_where_something_happens_are_told_and_lights_that_change_alike_together() -> None:
    changes = [
        Change(None, "INIT", "FULLY_RENDERED"),
        Change(0, "INIT", "NON_SHADOW"),
        Change(1, "INIT", "FULL_SHADOW"),
        Change(3, "INIT", "NON_SHADOW"),
    ]
    assert changes_in_words(changes) == [
        "init → fully rendered",
        "lights 0, 3: init → non-shadow",
        "light 1: init → full shadow",
    ]
    camera = Camera((0, 0, 5), (0, 0, -1))
    steps = [
        Step(n, 5.0, camera, 10, 10, "INIT", ["INIT"], changes if n == 6 else [], wrong, wrong, 10, 0, 0)
        for n, wrong in enumerate([0, 2, 2, 3, 0, 0, 0])
    ]
    results = zoom.Results("room.aff", (64, 48), 0, 0.0, (0.0, 0.0, 0.0), 0.9, approaches=[Approach(4.0, steps)])
    assert [(factor, step.number) for factor, step in happenings(results)] == [(4.0, n) for n in (1, 3, 4, 6)]
