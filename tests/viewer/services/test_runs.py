"""Experiments and zoom tests at the controller: what they show, and how they end; nothing disturbs them."""

from __future__ import annotations

import gc
import json
import time
import weakref
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.viewer.desk import ELSEWHERE, SIZE, Desk, is_the_same_picture
from tracer.experiments import experiment
from tracer.experiments.experiment import Experiment
from viewer.services.runs import duration, shown_of
from viewer.state.views import View
from viewer.util.resources import embedded_scenes


def same_figures(one: experiment.Results, other: experiment.Results) -> bool:
    """Everything but the times."""
    left, right = (
        {m: {name: v for name, v in figures.items() if name != "frame_seconds"} for m, figures in r.methods.items()}
        for r in (one, other)
    )
    return one.frames == other.frames and left == right


def test_an_experiment_is_that_of_the_command_and_its_frames_are_the_picture(desk: Desk) -> None:
    desk.runs.experiment_plan.verify = True
    own = desk.c.frame
    desk.came.clear()
    desk.runs.start_experiment()
    run = desk.runs.experiment
    assert shown_of(run) == "experiment: starting"
    desk.run_to_its_end()
    assert shown_of(run).startswith("showing frame ")
    assert run.whole and run.results is not None and desk.said.startswith("experiment done: 5 frames in ")

    scene = desk.c.session.scene
    times = experiment.path_times(scene, 5)
    *_, expected = experiment.run(scene, run.settings, ["paper"], times)
    assert same_figures(run.results, expected)
    assert len(experiment.table(run.results)) == 2
    desk.runs.export(run, ".json")
    desk.rest()
    (file,) = desk.c.preferences.picture_folder.glob("*.json")
    kept = json.loads(file.read_text())
    assert kept.pop("version") and kept == json.loads(json.dumps(run.results.to_dict())), "not what is shown"

    shown = [frame for frame in desk.came if frame.settings == replace(run.settings, method="paper")]
    assert shown and shown == desk.came[: len(shown)], "they are not the picture while it is under way"
    assert {frame.time for frame in shown} <= set(times)
    assert is_the_same_picture(desk.c.frame, own)
    desk.c.navigator.go_to_experiment(run, 3)
    desk.rest()
    session = desk.c.session
    assert (session.time, session.settings.method, session.settings.depth) == (times[3], "paper", 1)


def start_long(desk: Desk) -> Experiment:
    """An experiment under way, far from its end."""
    desk.runs.experiment_plan.frames = 5000
    desk.runs.start_experiment()
    run = desk.runs.experiment
    desk.until(lambda: run.results is not None and len(run.results.frames) > 2)
    return run


@pytest.mark.parametrize("verify", [False, True])
def test_a_view_of_what_is_wrong_says_whether_the_run_verifies(desk: Desk, verify: bool) -> None:
    desk.runs.experiment_plan = replace(desk.runs.experiment_plan, frames=5000, verify=verify)
    desk.c.session.set_draw(view=View.WIPE)
    desk.rest()
    desk.came.clear()
    desk.runs.start_experiment()
    desk.until(lambda: desk.came)
    assert desk.runs.current.verifies is verify
    assert ("this run does not verify" in desk.c.scheduler.title) is not verify
    assert desk.c.scheduler.drawn_view is (View.WIPE if verify else View.COLOR)


def test_the_last_frame_of_a_run_is_shown_though_the_window_was_late(desk: Desk) -> None:
    desk.came.clear()
    desk.runs.start_experiment()
    run = desk.runs.experiment
    end = time.monotonic() + 60.0
    while not run.done:
        assert time.monotonic() < end
        time.sleep(0.01)
    desk.tick()
    assert [(f.width, f.height, f.settings.method) for f in desk.came] == [(32, 24, "paper")]
    assert desk.runs.current is None and desk.said.startswith("experiment done")
    desk.rest()
    assert (desk.c.frame.width, desk.c.frame.height) == SIZE


def test_nothing_is_changed_nor_traced_beside_a_run(desk: Desk) -> None:
    c, session, renderer = desk.c, desk.c.session, desk.c.renderer._renderer
    histories = {size: history.words.copy() for size, history in renderer.state.histories.items()}
    run = start_long(desk)
    before, asked = session.state, []
    renderer.refine = lambda *arguments: asked.append(arguments)
    for disturb in (
        lambda: c.motion.move(ELSEWHERE),
        lambda: c.motion.glide(ELSEWHERE),
        lambda: c.motion.follow_path(False),
        lambda: c.motion.toggle_play(),
        lambda: c.motion.step(3),
        lambda: c.settings.change(depth=2),
        lambda: c.settings.toggle_culling(),
        lambda: c.settings.reset(()),
        lambda: c.presets.apply("Quick and exact"),
        lambda: c.undo.undo(),
        lambda: c.reset_modes(),
    ):
        c.notices.message = None
        disturb()
        assert desk.said == "the experiment is still under way; stop it first"
        desk.tick()
        assert session.state == before and not session.playing
    for start in (desk.runs.start_experiment, desk.runs.start_zoom_test):
        start()
        assert desk.said == "the experiment is still under way"
    c.scheduler.trace_again()
    many = run.traced + 10
    desk.until(lambda: run.traced > many)
    assert not asked and desk.runs.zoom_test is None, "a frame was traced beside the run"
    del renderer.refine
    assert all(np.array_equal(history.words, histories[size]) for size, history in renderer.state.histories.items())
    desk.runs.stop()
    desk.run_to_its_end()
    c.motion.move(ELSEWHERE)
    desk.rest()
    assert c.frame.camera == ELSEWHERE


def test_a_plan_that_is_no_good_is_one_line(desk: Desk) -> None:
    runs = desk.runs
    desk.c.selection.select((0.5, 0.5))
    for start, plan, wrong, said in (
        (runs.start_experiment, runs.experiment_plan, {"size": (0, 10)}, "width is a whole number"),
        (runs.start_zoom_test, runs.zoom_plan, {"factors": "four"}, "'four' are not zoom factors"),
        (runs.start_zoom_test, runs.zoom_plan, {"factors": "4", "ratio": 0.5, "steps": 500}, "500 steps of 0.5 end"),
    ):
        vars(plan).update(wrong)
        start()
        assert desk.c.notices.message.error and said in desk.said
    assert runs.experiment is None and runs.current is None


def test_durations_as_people_say_them() -> None:
    said = {0.2: "0 s", 59.4: "59 s", 59.6: "1:00 min", 125: "2:05 min", 3599.6: "1:00 h", 4200: "1:10 h"}
    assert {seconds: duration(seconds) for seconds in said} == said


def test_restoring_a_place_ends_a_run(desk: Desk) -> None:
    run = start_long(desk)
    desk.c.restore(replace(desk.c.session.state, camera=ELSEWHERE))
    desk.run_to_its_end()
    assert desk.c.frame.camera == ELSEWHERE and run.done


def test_a_run_that_fails_is_one_line_and_the_thread_lives_on(desk: Desk, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*arguments: object, **options: object) -> None:
        raise AttributeError("no world")

    monkeypatch.setattr(experiment, "run", fail)
    desk.runs.start_experiment()
    desk.run_to_its_end()
    fault = desk.c.notices.newest_fault
    assert fault.text == "the experiment failed: AttributeError: no world" and "no world" in fault.details
    desk.c.motion.move(ELSEWHERE)
    desk.rest()
    assert desk.c.frame.camera == ELSEWHERE


def test_stopped_before_its_first_frame_a_run_leaves_nothing(desk: Desk) -> None:
    desk.runs.start_experiment()
    desk.runs.stop()
    desk.run_to_its_end()
    assert desk.runs.experiment.results is None and desk.said == "experiment stopped after 0 of 5 frames"


def test_a_run_that_is_over_keeps_neither_its_scene_nor_a_frame(desk: Desk) -> None:
    scene = weakref.ref(desk.c.session.scene)
    desk.runs.start_experiment()
    desk.run_to_its_end()
    frames = [weakref.ref(frame) for frame in desk.came]
    desk.came.clear()
    assert desk.runs.experiment.whole and frames
    desk.open(embedded_scenes()["figure4"])
    desk.came.clear()
    gc.collect()
    assert scene() is None and not any(frame() for frame in frames)
    desk.c.navigator.go_to_experiment(desk.runs.experiment, 3)
    assert "the experiment was made in tiny.aff; open that scene again" in desk.said


def test_what_cannot_be_written_is_one_line(desk: Desk, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    desk.c.preferences.screenshot_folder = str(tmp_path / "file")
    desk.runs.experiment_plan.methods = set()
    desk.runs.start_experiment()
    desk.run_to_its_end()
    desk.runs.export(desk.runs.experiment, ".json")
    desk.rest()
    assert desk.c.notices.message.error and "nothing saved: cannot write to" in desk.said
    desk.c.preferences.screenshot_folder = str(tmp_path / "pictures")
    desk.runs.export(desk.runs.experiment, ".png")  # the reference alone
    desk.rest()
    assert desk.c.notices.message.error and "nothing to plot" in desk.said
    assert not list((tmp_path / "pictures").iterdir())
