"""Zoom tests and hunts at the controller: what they find, and where one can go from there."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from tests.marbles import write_marbles
from tests.viewer.desk import ELSEWHERE, Desk, is_the_same_picture
from tracer.experiments import runner, zoom
from viewer.util.resources import embedded_scenes


def test_a_zoom_test_shows_every_frame_and_finds_what_the_command_finds(
    figure4: Desk, monkeypatch: pytest.MonkeyPatch
) -> None:
    desk = figure4
    monkeypatch.setattr(runner, "SEEN_WITHIN", 30.0)  # on a busy machine the window draws late
    desk.runs.zoom_plan = replace(desk.runs.zoom_plan, factors="4, 64", steps=20, size=(128, 128))
    desk.c.selection.select((0.5, 0.5))
    assert desk.c.selection.picked.primitive == 0
    own = desk.c.frame
    start = zoom.aim(desk.c.frame, 0)
    desk.came.clear()
    desk.runs.start_zoom_test()
    test = desk.runs.zoom_test
    desk.until(lambda: desk.runs.current is None)
    of_test = [frame for frame in desk.came if frame.settings.verify]
    assert len(of_test) == test.frames == 2 * (20 + zoom.STILL_FRAMES)
    assert [frame.settings.zoom_factor for frame in of_test] == [4.0] * 23 + [64.0] * 23
    *_, expected = zoom.run(desk.c.session.scene, test.settings, start, [4.0, 64.0], 20, test.ratio)
    assert test.results == expected
    four, sixty_four = test.results.approaches
    assert four.steps[-1].wrong == 0 < sixty_four.steps[-1].wrong
    desk.rest()
    assert is_the_same_picture(desk.c.frame, own)


def test_a_zoom_test_needs_something_to_go_to(desk: Desk) -> None:
    desk.c.selection.select((0.5, 0.5))
    picked = desk.c.selection.picked
    desk.c.selection.picked = replace(picked, dynamic=True)
    desk.runs.start_zoom_test()
    assert desk.c.notices.message.error and "moves" in desk.said
    desk.c.selection.picked = picked
    desk.c.motion.move(replace(ELSEWHERE, direction=(0.0, 1.0, 0.0)))
    desk.rest()
    desk.runs.start_zoom_test()
    assert desk.c.notices.message.error and "is not to be seen from here" in desk.said
    assert desk.runs.zoom_test is None


def test_a_step_can_be_gone_to_in_its_own_scene_while_nothing_runs(figure4: Desk) -> None:
    desk = figure4
    desk.c.selection.select((0.5, 0.5))
    desk.runs.start_zoom_test()
    desk.run_to_its_end()
    step, camera = desk.runs.zoom_test.results.approaches[0].steps[-1], desk.c.session.camera
    desk.runs.experiment_plan.frames = 5000
    desk.runs.start_experiment()
    desk.c.navigator.go_to_step(4.0, step)
    assert desk.said.startswith("the experiment is still under way") and desk.c.session.camera == camera
    desk.open(embedded_scenes()["figure3"])
    camera = desk.c.session.camera
    desk.c.navigator.go_to_step(4.0, step)
    desk.rest()
    assert desk.c.session.camera == camera and "figure4.aff" in desk.said


def test_a_hunt_that_is_stopped_keeps_its_finds_and_needs_its_scene(
    desk_at: Callable[[Path], Desk], tmp_path: Path, tiny_scene_file: Path
) -> None:
    desk = desk_at(write_marbles(tmp_path))
    c = desk.c
    c.runs.hunt_plan.size = (96, 96)
    c.settings.change(depth=2)
    c.runs.start_hunt()
    desk.until(lambda: c.runs.hunt.results is not None and c.runs.hunt.results.finds)
    c.navigator.go_to_find(0)
    assert "the hunt is still under way" in desk.said
    c.runs.stop()
    desk.run_to_its_end()
    assert c.runs.hunt.results.finds and not c.runs.hunt.whole
    find, before = c.runs.hunt.results.finds[-1], c.session.state
    c.navigator.go_to_find(len(c.runs.hunt.results.finds) - 1)
    desk.run_to_its_end()
    assert tuple(c.frame.color[find.y, find.x].tolist()) == find.color
    assert tuple(c.frame.reference[find.y, find.x].tolist()) == find.reference
    c.undo.undo()
    desk.rest()
    assert c.session.state == before
    desk.open(tiny_scene_file)
    c.navigator.go_to_find(0)
    assert "open that scene again" in desk.said and c.session.camera == c.session.scene.camera
