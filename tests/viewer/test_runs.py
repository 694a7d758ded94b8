"""Experiments and zoom tests at the controller: what they find, what they keep, and that nothing disturbs them."""

from __future__ import annotations

import csv
import gc
import json
import threading
import time
import weakref
from collections.abc import Callable, Iterator
from dataclasses import replace
from datetime import datetime
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from tests.viewer.conftest import FakeRenderer, make_scene
from tracer import experiment, zoom
from tracer.frame import Frame
from tracer.renderer import Renderer
from tracer.scene.load import load_scene, scene_info
from tracer.scene.model import Camera, Cancelled
from viewer import exports
from viewer.controller import Controller
from viewer.preferences import Preferences
from viewer.render_thread import Traced
from viewer.resources import embedded_scenes
from viewer.runs import ExperimentPlan, duration
from viewer.views import View

SIZE = (64, 48)
ELSEWHERE = Camera((0.0, 2.0, 8.0), (0.0, -0.2, -1.0))


class Desk:
    """A controller at work on a scene in a file, without a window."""

    def __init__(self, path: Path, folder: Path) -> None:
        preferences = Preferences(dynamic_resolution=False, samples=1, threads=1, screenshot_folder=str(folder))
        self.c = Controller(preferences)
        self.runner = self.c.runner
        self.came: list[Frame] = []
        self.open(path)
        self.runner.experiment_plan = ExperimentPlan({"paper"}, frames=5, size=(32, 24), depth=1)
        self.runner.zoom_plan = replace(self.runner.zoom_plan, steps=4, size=(32, 24))

    def open(self, path: Path) -> None:
        scene = load_scene(path)
        self.c.show(scene, Renderer(scene, self.c.session.settings), scene_info(scene))
        self.rest()

    def tick(self) -> None:
        frame = self.c.tick(SIZE)
        if frame is not None:
            self.came.append(frame)
        time.sleep(0.001)

    def until(self, happens: Callable[[], object]) -> None:
        end = time.monotonic() + 60.0
        while not happens():
            assert time.monotonic() < end, f"waited in vain; the status says {self.c.message}"
            self.tick()

    def rest(self) -> None:
        quiet = 0

        def rested() -> bool:
            nonlocal quiet
            quiet = 0 if self.c.active else quiet + 1
            return quiet > 10

        self.until(rested)

    def run_to_its_end(self) -> None:
        self.until(lambda: self.runner.current is None)
        self.rest()

    @property
    def said(self) -> str:
        assert self.c.message is not None
        return self.c.message.text


@pytest.fixture
def desk(tiny_scene_file: Path, tmp_path: Path) -> Iterator[Desk]:
    desk = Desk(tiny_scene_file, tmp_path / "pictures")
    yield desk
    assert desk.c.close()


@pytest.fixture
def figure4(tmp_path: Path) -> Iterator[Desk]:
    desk = Desk(embedded_scenes()["figure4"], tmp_path / "pictures")
    yield desk
    assert desk.c.close()


def same_figures(one: experiment.Results, other: experiment.Results) -> bool:
    """Everything but the times."""
    left, right = (
        {m: {name: v for name, v in figures.items() if name != "frame_seconds"} for m, figures in r.methods.items()}
        for r in (one, other)
    )
    return one.frames == other.frames and left == right


def is_the_same_picture(one: Frame, other: Frame) -> bool:
    """Of the same place, traced alike."""
    same = (one.time, one.camera, one.settings) == (other.time, other.camera, other.settings)
    return same and np.array_equal(one.primitive, other.primitive)


def test_an_experiment_is_that_of_the_command_and_its_frames_are_the_picture(desk: Desk) -> None:
    desk.runner.experiment_plan.verify = True
    own = desk.c.frame
    desk.came.clear()
    desk.runner.start_experiment()
    run = desk.runner.experiment
    desk.run_to_its_end()
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
    desk.runner.experiment_plan = replace(desk.runner.experiment_plan, frames=5000, verify=verify)
    desk.c.set_view(View.WIPE)
    desk.rest()
    desk.came.clear()
    desk.runner.start_experiment()
    desk.until(lambda: desk.came)
    assert desk.runner.current.verifies is verify
    assert ("this run does not verify" in desk.c.tracing.title) is not verify
    assert desk.c.tracing.drawn_view is (View.WIPE if verify else View.COLOR)


def test_the_frames_of_the_chosen_method_are_shown(desk: Desk) -> None:
    desk.came.clear()
    desk.runner.start_experiment()
    desk.runner.experiment.shown = "none"
    desk.run_to_its_end()
    small = [frame.settings.method for frame in desk.came if (frame.width, frame.height) == (32, 24)]
    assert small and set(small) == {"none"}


def test_stopping_keeps_the_whole_frames(desk: Desk) -> None:
    own = desk.c.frame
    desk.runner.experiment_plan.frames = 5000
    desk.runner.start_experiment()
    run = desk.runner.experiment
    desk.until(lambda: run.results is not None and len(run.results.frames) > 3)
    growing = run.results
    before = len(growing.frames)
    desk.runner.stop()
    desk.run_to_its_end()
    assert not run.whole and desk.runner.current is None
    assert len(growing.frames) == before, "results that were handed out have changed"
    done = len(run.results.frames)
    assert before <= done < 5000
    assert all(len(values) == done for figures in run.results.methods.values() for values in figures.values())
    assert f"experiment stopped after {done} of 5000 frames; what was done is kept" == desk.said
    assert is_the_same_picture(desk.c.frame, own)


def test_stopped_before_its_first_frame_a_run_leaves_nothing_and_what_it_cut_short_is_traced(desk: Desk) -> None:
    renderer, begun = desk.c.render._renderer, threading.Event()

    def never(_time: float, _camera: Camera, cancel: Callable[[], bool], *_how: object) -> Iterator[Frame]:
        begun.set()
        while not cancel():
            time.sleep(0.001)
        yield from ()
        raise Cancelled()

    renderer.refine = never
    desk.c.trace_again()
    desk.tick()
    assert begun.wait(20.0)
    desk.came.clear()
    desk.runner.start_experiment()
    desk.runner.stop()
    del renderer.refine
    desk.run_to_its_end()
    assert desk.runner.experiment.results is None
    assert desk.said == "experiment stopped after 0 of 5 frames"
    assert {(frame.width, frame.height) for frame in desk.came} == {SIZE}


def test_the_last_frame_of_a_run_is_shown_though_the_window_was_late(desk: Desk) -> None:
    desk.came.clear()
    desk.runner.start_experiment()
    run = desk.runner.experiment
    assert run._done.wait(60.0)
    desk.tick()
    assert [(f.width, f.height, f.settings.method) for f in desk.came] == [(32, 24, "paper")]
    assert desk.runner.current is None and desk.said.startswith("experiment done")
    desk.rest()
    assert (desk.c.frame.width, desk.c.frame.height) == SIZE


def test_a_run_that_is_over_keeps_neither_its_scene_nor_a_frame(desk: Desk) -> None:
    scene, frames = weakref.ref(desk.c.session.scene), []
    show = desk.c.tracing.show

    def showing(traced: Traced) -> None:
        frames.append(weakref.ref(traced.frame))
        show(traced)

    desk.c.tracing.show = showing
    desk.runner.start_experiment()
    desk.run_to_its_end()
    desk.came.clear()
    assert desk.runner.experiment.whole and frames
    desk.open(embedded_scenes()["figure4"])
    desk.came.clear()
    gc.collect()
    assert scene() is None and not any(frame() for frame in frames)
    assert desk.runner.experiment.scene_path.name == "tiny.aff"


def test_nothing_is_changed_nor_traced_beside_a_run(desk: Desk) -> None:
    session = desk.c.session
    renderer = desk.c.render._renderer
    memories = {size: memory.words.copy() for size, memory in renderer._memories.items()}
    desk.runner.experiment_plan.frames = 5000
    desk.runner.start_experiment()
    desk.until(lambda: desk.runner.experiment.traced > 2)
    before = (session.camera, session.time, session.settings, session.playing, session.follow)
    asked: list[object] = []
    renderer.refine = lambda *arguments: asked.append(arguments)
    for disturb in (
        lambda: desk.c.move(ELSEWHERE),
        lambda: desk.c.glide(ELSEWHERE),
        lambda: desk.c.follow_path(False),
        lambda: desk.c.toggle_play(),
        lambda: desk.c.step(3),
        lambda: desk.c.change(depth=2),
        lambda: desk.c.toggle_culling(),
        lambda: desk.c.reset_modes(),
    ):
        desk.c.message = None
        disturb()
        assert desk.said == "the experiment is still under way; stop it first (Escape)"
        desk.tick()
        assert (session.camera, session.time, session.settings, session.playing, session.follow) == before
    desk.runner.start_experiment()
    assert desk.said == "the experiment is still under way"
    desk.runner.start_zoom_test()
    assert desk.said == "the experiment is still under way" and desk.runner.zoom_test is None
    desk.c.trace_again()
    many = desk.runner.experiment.traced + 10
    desk.until(lambda: desk.runner.experiment.traced > many)
    assert not asked, "a frame was traced beside the run"
    del renderer.refine
    assert all(np.array_equal(memory.words, memories[size]) for size, memory in renderer._memories.items())
    desk.runner.stop()
    desk.run_to_its_end()
    desk.c.move(ELSEWHERE)
    desk.rest()
    assert desk.c.frame.camera == ELSEWHERE


def test_another_scene_ends_a_run_and_its_results_stay(desk: Desk) -> None:
    desk.runner.experiment_plan.frames = 5000
    desk.runner.start_experiment()
    run = desk.runner.experiment
    desk.until(lambda: run.results is not None)
    desk.open(embedded_scenes()["figure4"])
    assert run.done and desk.runner.current is None and run.results.frames
    assert desk.c.frame.camera.position == (0.0, 0.0, 20.0), "the picture is not the new scene's"
    desk.runner.experiment_plan.frames = 2
    desk.runner.start_experiment()
    desk.run_to_its_end()
    assert desk.runner.experiment.whole and "figure4" in desk.runner.experiment.results.scene


def test_a_run_that_is_overtaken_by_another_scene_does_not_trace_it(desk: Desk) -> None:
    """Whatever the thread was at: the run has not begun when the scene changes."""
    begun, hold, renderer = threading.Event(), threading.Event(), desk.c.render._renderer

    class Holding:
        def work(self, renderer: object, cancelled: object) -> None:
            begun.set()
            hold.wait(20.0)

    desk.c.render.perform(Holding())
    assert begun.wait(20.0)
    desk.runner.start_experiment()
    scene = load_scene(embedded_scenes()["figure4"])
    desk.c.show(scene, Renderer(scene), scene_info(scene))
    hold.set()
    desk.run_to_its_end()
    assert renderer is not desk.c.render._renderer
    assert desk.runner.experiment.results is None and not desk.runner.experiment.traced
    assert desk.said == "experiment stopped after 0 of 5 frames"


def test_restoring_a_place_ends_a_run(desk: Desk) -> None:
    snapshot = desk.c.session.snapshot()
    desk.runner.experiment_plan.frames = 5000
    desk.runner.start_experiment()
    desk.until(lambda: desk.runner.experiment.traced > 2)
    desk.c.restore(replace(snapshot, camera=ELSEWHERE, follow=False))
    desk.run_to_its_end()
    assert desk.c.frame.camera == ELSEWHERE


def test_closing_ends_a_run(tiny_scene_file: Path, tmp_path: Path) -> None:
    desk = Desk(tiny_scene_file, tmp_path)
    desk.runner.experiment_plan.frames = 100_000
    desk.runner.start_experiment()
    desk.until(lambda: desk.runner.experiment.traced > 2)
    began = time.monotonic()
    assert desk.c.close()
    assert time.monotonic() - began < 5.0
    assert desk.runner.experiment.done


def test_a_run_that_fails_is_one_line_and_the_thread_lives_on(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*arguments: object, **options: object) -> None:
        raise AttributeError("no world")

    monkeypatch.setattr(experiment, "run", fail)
    controller = Controller(Preferences(dynamic_resolution=False, samples=1))
    controller.show(make_scene(), FakeRenderer(), {})
    controller.runner.experiment_plan.frames = 2
    controller.runner.start_experiment()
    end = time.monotonic() + 20.0
    while controller.runner.current is not None or controller.frame is None:
        assert time.monotonic() < end
        controller.tick(SIZE)
    assert controller.faults.notice.text == "the experiment failed: AttributeError: no world"
    assert "no world" in controller.faults.notice.details
    assert controller.close()


def test_a_plan_that_is_no_good_is_one_line(desk: Desk) -> None:
    desk.runner.experiment_plan.size = (0, 10)
    desk.runner.start_experiment()
    assert desk.c.message.error and "width and height" in desk.said
    desk.c.select((0.5, 0.5))
    desk.runner.experiment_plan.size = desk.runner.zoom_plan.size = (64, 4097)
    for start in (desk.runner.start_experiment, desk.runner.start_zoom_test):
        desk.c.message = None
        start()
        assert desk.c.message.error and "64 x 4097 is too large for a run" in desk.said
    desk.runner.zoom_plan.size = (32, 24)
    desk.runner.zoom_plan.factors = "four"
    desk.runner.start_zoom_test()
    assert desk.c.message.error and "'four' are not zoom factors" in desk.said
    desk.runner.zoom_plan = replace(desk.runner.zoom_plan, factors="4", ratio=0.5, steps=500)
    desk.runner.start_zoom_test()
    desk.rest()
    assert desk.c.message.error and desk.said.startswith("the zoom test failed: 500 steps")
    assert desk.runner.experiment is None and desk.runner.current is None


def test_a_zoom_test_shows_every_frame_and_finds_what_the_command_finds(figure4: Desk) -> None:
    desk = figure4
    desk.runner.zoom_plan = replace(desk.runner.zoom_plan, factors="4, 64", steps=20, size=(128, 128))
    desk.c.select((0.5, 0.5))
    assert desk.c.selected.primitive == 0
    own = desk.c.frame
    start = zoom.aim(desk.c.frame, 0)
    desk.came.clear()
    desk.runner.start_zoom_test()
    test = desk.runner.zoom_test
    desk.until(lambda: desk.runner.current is None)
    of_test = [frame for frame in desk.came if frame.settings.verify]
    assert len(of_test) == test.frames == 2 * (20 + zoom.STILL_FRAMES)
    assert [frame.settings.zoom_factor for frame in of_test] == [4.0] * 23 + [64.0] * 23
    *_, expected = zoom.run(desk.c.session.scene, test.settings, start, [4.0, 64.0], 20, test.plan.ratio)
    assert test.results == expected
    four, sixty_four = test.results.approaches
    assert four.steps[-1].wrong == 0 < sixty_four.steps[-1].wrong
    desk.rest()
    assert is_the_same_picture(desk.c.frame, own)


def test_a_zoom_test_needs_something_to_go_to(desk: Desk) -> None:
    desk.runner.start_zoom_test()
    assert desk.c.message.error and "click a primitive" in desk.said
    desk.c.select((0.5, 0.5))
    picked = desk.c.selected
    desk.c.selected = replace(picked, dynamic=True)
    desk.runner.start_zoom_test()
    assert desk.c.message.error and "moves" in desk.said
    desk.c.selected = picked
    desk.c.move(replace(ELSEWHERE, direction=(0.0, 1.0, 0.0)))
    desk.rest()
    desk.runner.start_zoom_test()
    assert desk.c.message.error and "is not to be seen from here" in desk.said
    assert desk.runner.zoom_test is None


def test_a_step_can_be_gone_to(figure4: Desk) -> None:
    desk = figure4
    desk.c.select((0.5, 0.5))
    desk.runner.start_zoom_test()
    desk.run_to_its_end()
    step = desk.runner.zoom_test.results.approaches[0].steps[-1]
    desk.c.session.go_to_frame(30)
    desk.runner.go_to(step)
    desk.rest()
    assert desk.c.frame.camera.position == pytest.approx(step.camera.position)
    assert desk.c.frame.time == 0.0
    camera = desk.c.session.camera
    desk.runner.experiment_plan.frames = 5000
    desk.runner.start_experiment()
    desk.runner.go_to(desk.runner.zoom_test.results.approaches[0].steps[0])
    assert desk.said.startswith("the experiment is still under way") and desk.c.session.camera == camera
    desk.runner.stop()
    desk.run_to_its_end()
    desk.open(embedded_scenes()["figure3"])
    camera = desk.c.session.camera
    desk.runner.go_to(step)
    desk.rest()
    assert desk.c.session.camera == camera and "figure4.aff" in desk.said


def test_a_zoom_test_can_be_repeated_from_its_start(figure4: Desk) -> None:
    desk = figure4
    desk.c.select((0.5, 0.5))
    desk.runner.start_zoom_test()
    desk.run_to_its_end()
    first = desk.runner.zoom_test
    desk.runner.go_to(first.results.approaches[0].steps[-1])
    desk.rest()
    assert desk.runner.zoom_plan.same_start
    for selected in (desk.c.selected, None):
        desk.c.selected = selected
        desk.runner.start_zoom_test()
        desk.run_to_its_end()
        assert desk.runner.zoom_test is not first and desk.runner.zoom_test.results == first.results
    desk.runner.zoom_plan.same_start = False
    desk.c.select((0.5, 0.5))
    desk.runner.start_zoom_test()
    desk.run_to_its_end()
    assert desk.runner.zoom_test.start.distance < first.start.distance
    desk.c.selected = replace(desk.c.selected, primitive=first.start.primitive + 1)
    assert desk.runner.last_start is None, "of another primitive it is no start"


def test_results_are_written_beside_the_pictures(figure4: Desk, tmp_path: Path) -> None:
    desk, folder = figure4, tmp_path / "pictures"
    desk.runner.export(FakeRun(), ".json")
    assert desk.said == "there is nothing to save yet"
    desk.runner.start_experiment()
    desk.run_to_its_end()
    desk.c.select((0.5, 0.5))
    desk.runner.start_zoom_test()
    desk.run_to_its_end()
    for run in (desk.runner.experiment, desk.runner.zoom_test):
        for ending in exports.ENDINGS:
            desk.runner.export(run, ending)
    desk.rest()
    files = sorted(path.name for path in folder.iterdir())
    kinds = [name.rsplit("-", 6)[0] + Path(name).suffix for name in files]
    assert kinds == [f"figure4-{kind}{ending}" for kind in ("experiment", "zoom-test") for ending in
                     (".csv", ".json", ".png")]  # fmt: skip
    experiment_csv, experiment_json, _, zoom_csv, zoom_json, _ = (folder / name for name in files)
    assert [row["method"] for row in csv.DictReader(experiment_csv.open())] == ["none", "paper"]
    written = json.loads(experiment_json.read_text())
    assert written.pop("version")
    assert written == desk.runner.experiment.results.to_dict()
    assert len(list(csv.DictReader(zoom_csv.open()))) == desk.runner.zoom_test.frames
    assert len(json.loads(zoom_json.read_text())["approaches"]) == 2
    for name in (files[2], files[5]):
        with Image.open(folder / name) as plot:
            assert plot.size == (1920, 1080)


def test_what_is_there_can_be_saved_while_a_run_goes_on(desk: Desk, tmp_path: Path) -> None:
    desk.runner.experiment_plan.frames = 5000
    desk.runner.start_experiment()
    run = desk.runner.experiment
    desk.until(lambda: run.results is not None and len(run.results.frames) > 3)
    there = run.results.to_dict()
    desk.runner.export(run, ".json")
    desk.until(lambda: not desk.c.keeper.busy)
    (file,) = (tmp_path / "pictures").iterdir()
    kept = json.loads(file.read_text())
    assert len(there["frames"]) <= len(kept["frames"]) < 5000
    assert all(
        len(values) == len(kept["frames"]) for figures in kept["methods"].values() for values in figures.values()
    )
    assert desk.runner.current is run and not run.stopping, "saving has disturbed it"
    desk.runner.stop()
    desk.run_to_its_end()


class FakeRun:
    results = None


def test_what_cannot_be_written_is_one_line(desk: Desk, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    desk.c.preferences.screenshot_folder = str(tmp_path / "file")
    desk.runner.experiment_plan.methods = set()
    desk.runner.start_experiment()
    desk.run_to_its_end()
    desk.runner.export(desk.runner.experiment, ".json")
    desk.rest()
    assert desk.c.message.error and "nothing saved: cannot write to" in desk.said
    desk.c.preferences.screenshot_folder = str(tmp_path / "pictures")
    desk.runner.export(desk.runner.experiment, ".png")  # the reference alone
    desk.rest()
    assert desk.c.message.error and "nothing to plot" in desk.said
    assert not list((tmp_path / "pictures").iterdir())


def test_a_name_that_is_taken_gets_a_number(tmp_path: Path) -> None:
    now = datetime(2024, 5, 31, 14, 5, 9)

    def save() -> str:
        return exports.save(tmp_path, "room-experiment", ".csv", lambda path: path.write_text("saved"), now).name

    stem = "room-experiment-2024-05-31-14-05-09"
    assert [save(), save(), save()] == [f"{stem}.csv", f"{stem}-2.csv", f"{stem}-3.csv"]


@pytest.mark.parametrize(
    ("seconds", "said"),
    [(0.2, "0 s"), (59.4, "59 s"), (59.6, "1:00 min"), (125, "2:05 min"), (3599.6, "1:00 h"), (4200, "1:10 h")],
)
def test_durations_as_people_say_them(seconds: float, said: str) -> None:
    assert duration(seconds) == said
