"""Experiments and zoom tests at the controller: what they show, and that nothing disturbs them."""

from __future__ import annotations

import time
from dataclasses import replace
from datetime import datetime

import numpy as np
import pytest

from tests.viewer.desk import ELSEWHERE, SIZE, Desk, is_the_same_picture
from tests.viewer.fakes import make_frame, make_scene
from tracer.experiments import experiment, zoom
from tracer.experiments.experiment import Experiment
from tracer.experiments.zoom import ZoomTest
from tracer.frame import Settings
from viewer.services.runs import described, duration, shown_of
from viewer.state.views import View


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
    assert shown_of(run) == "the experiment is starting"
    desk.run_to_its_end()
    assert shown_of(run).startswith("showing frame ")
    assert run.whole and run.results is not None and desk.said.startswith("experiment done: 5 frames in ")

    scene = desk.c.session.scene
    times = experiment.path_times(scene, 5)
    *_, expected = experiment.run(scene, run.settings, ["paper"], times)
    assert same_figures(run.results, expected)
    assert len(experiment.table(run.results)) == 2

    shown = [frame for frame in desk.came if frame.settings == replace(run.settings, method="paper")]
    assert shown and shown == desk.came[: len(shown)], "they are not the picture while it is under way"
    assert {frame.time for frame in shown} <= set(times)
    assert is_the_same_picture(desk.c.frame, own)


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


def test_the_frames_of_the_chosen_method_are_shown(desk: Desk) -> None:
    desk.came.clear()
    desk.runs.start_experiment()
    desk.runs.experiment.shown = "none"
    desk.run_to_its_end()
    small = [frame.settings.method for frame in desk.came if (frame.width, frame.height) == (32, 24)]
    assert small and set(small) == {"none"}


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
    session = desk.c.session
    renderer = desk.c.renderer._renderer
    histories = {size: history.words.copy() for size, history in renderer.state.histories.items()}
    desk.runs.experiment_plan.frames = 5000
    desk.runs.start_experiment()
    desk.until(lambda: desk.runs.experiment.traced > 2)
    before = (session.camera, session.time, session.settings, session.playing, session.on_path)
    asked: list[object] = []
    renderer.refine = lambda *arguments: asked.append(arguments)
    for disturb in (
        lambda: desk.c.motion.move(ELSEWHERE),
        lambda: desk.c.motion.glide(ELSEWHERE),
        lambda: desk.c.motion.follow_path(False),
        lambda: desk.c.motion.toggle_play(),
        lambda: desk.c.motion.step(3),
        lambda: desk.c.settings.change(depth=2),
        lambda: desk.c.settings.toggle_culling(),
        lambda: desk.c.reset_modes(),
    ):
        desk.c.notices.message = None
        disturb()
        assert desk.said == "the experiment is still under way; stop it first"
        desk.tick()
        assert (session.camera, session.time, session.settings, session.playing, session.on_path) == before
    desk.runs.start_experiment()
    assert desk.said == "the experiment is still under way"
    desk.runs.start_zoom_test()
    assert desk.said == "the experiment is still under way" and desk.runs.zoom_test is None
    desk.c.scheduler.trace_again()
    many = desk.runs.experiment.traced + 10
    desk.until(lambda: desk.runs.experiment.traced > many)
    assert not asked, "a frame was traced beside the run"
    del renderer.refine
    assert all(np.array_equal(history.words, histories[size]) for size, history in renderer.state.histories.items())
    desk.runs.stop()
    desk.run_to_its_end()
    desk.c.motion.move(ELSEWHERE)
    desk.rest()
    assert desk.c.frame.camera == ELSEWHERE


def test_a_plan_that_is_no_good_is_one_line(desk: Desk) -> None:
    desk.runs.experiment_plan.size = (0, 10)
    desk.runs.start_experiment()
    assert desk.c.notices.message.error and "width is a whole number" in desk.said
    desk.c.selection.select((0.5, 0.5))
    desk.runs.experiment_plan.size = desk.runs.zoom_plan.size = (64, 4097)
    for start in (desk.runs.start_experiment, desk.runs.start_zoom_test):
        desk.c.notices.message = None
        start()
        assert desk.c.notices.message.error and "64 x 4097 is too large for a run" in desk.said
    desk.runs.zoom_plan.size = (32, 24)
    desk.runs.zoom_plan.factors = "four"
    desk.runs.start_zoom_test()
    assert desk.c.notices.message.error and "'four' are not zoom factors" in desk.said
    desk.runs.zoom_plan = replace(desk.runs.zoom_plan, factors="4", ratio=0.5, steps=500)
    desk.runs.start_zoom_test()
    assert desk.c.notices.message.error and desk.said.startswith("500 steps of 0.5 end nearer than")
    assert desk.runs.experiment is None and desk.runs.current is None


@pytest.mark.parametrize(
    ("seconds", "said"),
    [(0.2, "0 s"), (59.4, "59 s"), (59.6, "1:00 min"), (125, "2:05 min"), (3599.6, "1:00 h"), (4200, "1:10 h")],
)
def test_durations_as_people_say_them(seconds: float, said: str) -> None:
    assert duration(seconds) == said


def test_results_name_their_scene_and_that_it_is_not_the_one_that_is_open():
    kitchen, office = (make_scene(path=f"scenes/{name}.aff") for name in ("kitchen", "office"))
    run = Experiment(kitchen, Settings(width=64, height=48, accelerator="kdtree"), ["paper"], [0.0] * 5)
    run.began = datetime(2026, 1, 2, 14, 3)
    rest = ", 64 x 48, 0 of 5 frames, kdtree, begun 2026-01-02 14:03"
    assert described(run, kitchen) == (f"kitchen.aff{rest}", False)
    assert described(run, office) == (f"kitchen.aff (not office.aff, which is open){rest}", True)
    again = make_scene(path="scenes/kitchen.aff")
    assert described(run, again) == (f"kitchen.aff before it was edited or reloaded{rest}", True)
    assert described(run, None) == (f"kitchen.aff{rest}", True)


def test_a_zoom_test_names_its_primitive_and_the_time_of_today():
    scene = make_scene()
    test = ZoomTest(scene, Settings(width=64, height=64), zoom.aim(make_frame(), 3))
    said, elsewhere = described(test, scene)
    assert not elsewhere
    assert said == f"scene.aff, 64 x 64, towards primitive 3, begun {test.began:%H:%M}"
