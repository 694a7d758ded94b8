"""Hunts at the controller: what they find is flown to, as it was found, and saved."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.viewer.desk import Desk
from tests.viewer.marbles import LAST, STEP, write_marbles
from viewer.output import capture


@pytest.fixture
def study(tmp_path: Path) -> Iterator[Desk]:
    desk = Desk(write_marbles(tmp_path), tmp_path / "pictures")
    plan = desk.c.hunts.plan
    plan.size, plan.last, plan.step, plan.around, plan.keep = (96, 96), LAST, STEP, 3, 4
    desk.c.settings.change(depth=2)
    desk.rest()
    yield desk
    assert desk.c.close()


def test_a_find_is_flown_to_as_it_was_found(study: Desk) -> None:
    c = study.c
    here = c.session.state
    c.hunts.start()
    run = c.hunts.hunt
    assert run is not None and c.runs.current is run
    study.run_to_its_end()
    found = c.hunts.found
    assert run.whole and found is not None and found.finds and (found.frames, run.frames) == (12, 12)
    assert "hunt done: 12 frames" in study.said
    for number in (0, len(found.finds) - 1):
        find = found.finds[number]
        c.hunts.go(number)
        assert c.hunts.chosen == number
        study.run_to_its_end()
        frame, picked = c.frame, c.selection.picked
        assert (frame.width, frame.height) == (96, 96) and (frame.time, frame.camera) == (find.time, find.camera)
        assert tuple(frame.color[find.y, find.x].tolist()) == find.color
        assert tuple(frame.reference[find.y, find.x].tolist()) == find.reference
        assert picked is not None and (picked.x, picked.y) == (find.x, find.y) and picked.wrong > 0
        assert c.session.on_path == find.own_camera and c.session.draw.light == find.light
        assert c.session.settings.method == "paper" and c.session.settings.verify
        if find.bounces == 0:
            taught = c.history.origins_of(picked)
            assert taught is not None
            lesson = taught.lights[find.light]
            assert (lesson.lit if find.lit else lesson.blocked) >= 0, "nobody has taught what is wrong"
    for _ in range(2):
        c.undo.undo()
        study.rest()
    assert c.session.state == here and not c.session.pace.fixed_size


def test_the_figure_of_a_find_is_saved(study: Desk) -> None:
    c, folder = study.c, study.c.preferences.picture_folder
    c.hunts.plan.around, c.hunts.plan.keep = 0, 1
    c.hunts.start()
    study.run_to_its_end()
    c.hunts.save_figure(0)
    study.run_to_its_end()
    (picture,), (told,) = folder.glob("*.png"), folder.glob("*.json")
    find, data = c.hunts.found.finds[0], capture.read_data(picture)
    assert data["figure"]["marks"] == [[find.x, find.y]] and data["figure"]["methods"] == ["none", "paper"]
    assert json.loads(told.read_text())["before"] == data["state"]["warmup"]["frames"]
    assert str(picture) in study.said


def test_a_hunt_that_is_stopped_keeps_its_finds_and_needs_its_scene(study: Desk, tiny_scene_file: Path) -> None:
    c = study.c
    c.hunts.plan.last, c.hunts.plan.step = None, 1
    c.hunts.start()
    study.until(lambda: c.hunts.found is not None and c.hunts.found.finds)
    c.hunts.go(0)
    assert "the hunt is still under way" in study.said
    c.runs.stop()
    study.run_to_its_end()
    assert c.hunts.found.finds and not c.hunts.hunt.whole
    study.open(tiny_scene_file)
    camera = c.session.camera
    c.hunts.go(0)
    assert "open that scene again" in study.said and c.session.camera == camera
    c.hunts.plan.size = (9999, 16)
    c.hunts.start()
    assert "too large for a run" in study.said


def test_a_frame_of_an_experiment_can_be_gone_to(desk: Desk) -> None:
    c = desk.c
    desk.runs.start_experiment()
    run = desk.runs.experiment
    desk.run_to_its_end()
    c.navigator.go_to_experiment(run, 3)
    desk.rest()
    assert c.session.time == run.times[3] and c.session.settings.method == "paper"
    assert c.session.settings.depth == 1
