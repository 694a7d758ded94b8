"""Experiments and zoom tests that end: stopped, failed, or with the scene they are of."""

from __future__ import annotations

import gc
import threading
import time
import weakref
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from tests.viewer.desk import ELSEWHERE, SIZE, Desk, is_the_same_picture
from tests.viewer.fakes import FakeRenderer, make_scene
from tracer.experiments import experiment
from tracer.frame import Frame
from tracer.renderer import Renderer
from tracer.scene.load import load_scene, scene_info
from tracer.scene.model import Camera, Cancelled
from viewer.services.controller import Controller
from viewer.services.render_request import Traced
from viewer.state.preferences import Preferences
from viewer.util.resources import embedded_scenes
from viewer.window.app import advance


def test_another_scene_ends_a_run_and_its_results_stay(desk: Desk) -> None:
    desk.runs.experiment_plan.frames = 5000
    desk.runs.start_experiment()
    run = desk.runs.experiment
    desk.until(lambda: run.results is not None)
    desk.open(embedded_scenes()["figure4"])
    assert run.done and desk.runs.current is None and run.results.frames
    assert desk.c.frame.camera.position == (0.0, 0.0, 20.0), "the picture is not the new scene's"
    desk.runs.experiment_plan.frames = 2
    desk.runs.start_experiment()
    desk.run_to_its_end()
    assert desk.runs.experiment.whole and "figure4" in desk.runs.experiment.results.scene


def test_a_run_that_is_overtaken_by_another_scene_does_not_trace_it(desk: Desk) -> None:
    """Whatever the thread was at: the run has not begun when the scene changes."""
    begun, hold, renderer = threading.Event(), threading.Event(), desk.c.renderer._renderer

    class Holding:
        def work(self, renderer: object, cancelled: object) -> None:
            begun.set()
            hold.wait(20.0)

    desk.c.renderer.perform(Holding())
    assert begun.wait(20.0)
    desk.runs.start_experiment()
    scene = load_scene(embedded_scenes()["figure4"])
    desk.c.show(scene, Renderer(scene), scene_info(scene))
    hold.set()
    desk.run_to_its_end()
    assert renderer is not desk.c.renderer._renderer
    assert desk.runs.experiment.results is None and not desk.runs.experiment.traced
    assert desk.said == "experiment stopped after 0 of 5 frames"


def test_restoring_a_place_ends_a_run(desk: Desk) -> None:
    snapshot = desk.c.session.state
    desk.runs.experiment_plan.frames = 5000
    desk.runs.start_experiment()
    desk.until(lambda: desk.runs.experiment.traced > 2)
    desk.c.restore(replace(snapshot, camera=ELSEWHERE))
    desk.run_to_its_end()
    assert desk.c.frame.camera == ELSEWHERE


def test_closing_ends_a_run(tiny_scene_file: Path, tmp_path: Path) -> None:
    desk = Desk(tiny_scene_file, tmp_path)
    desk.runs.experiment_plan.frames = 100_000
    desk.runs.start_experiment()
    desk.until(lambda: desk.runs.experiment.traced > 2)
    began = time.monotonic()
    assert desk.c.close()
    assert time.monotonic() - began < 5.0
    assert desk.runs.experiment.done


def test_a_run_that_fails_is_one_line_and_the_thread_lives_on(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*arguments: object, **options: object) -> None:
        raise AttributeError("no world")

    monkeypatch.setattr(experiment, "run", fail)
    controller = Controller(Preferences(state={"pace": {"progressive": False}, "settings": {"samples": 1}}))
    controller.show(make_scene(), FakeRenderer(), {})
    controller.runs.experiment_plan.frames = 2
    controller.runs.start_experiment()
    end = time.monotonic() + 20.0
    while controller.runs.current is not None or controller.frame is None:
        assert time.monotonic() < end
        advance(controller, SIZE)
    assert controller.notices.newest_fault.text == "the experiment failed: AttributeError: no world"
    assert "no world" in controller.notices.newest_fault.details
    assert controller.close()


def test_stopping_keeps_the_whole_frames(desk: Desk) -> None:
    own = desk.c.frame
    desk.runs.experiment_plan.frames = 5000
    desk.runs.start_experiment()
    run = desk.runs.experiment
    desk.until(lambda: run.results is not None and len(run.results.frames) > 3)
    growing = run.results
    before = len(growing.frames)
    desk.runs.stop()
    desk.run_to_its_end()
    assert not run.whole and desk.runs.current is None
    assert len(growing.frames) == before, "results that were handed out have changed"
    done = len(run.results.frames)
    assert before <= done < 5000
    assert all(len(values) == done for figures in run.results.methods.values() for values in figures.values())
    assert f"experiment stopped after {done} of 5000 frames; what was done is kept" == desk.said
    assert is_the_same_picture(desk.c.frame, own)


def test_stopped_before_its_first_frame_a_run_leaves_nothing_and_what_it_cut_short_is_traced(desk: Desk) -> None:
    renderer, begun = desk.c.renderer._renderer, threading.Event()

    def never(_time: float, _camera: Camera, cancel: Callable[[], bool], *_how: object) -> Iterator[Frame]:
        begun.set()
        while not cancel():
            time.sleep(0.001)
        yield from ()
        raise Cancelled()

    renderer.refine = never
    desk.c.scheduler.trace_again()
    desk.tick()
    assert begun.wait(20.0)
    desk.came.clear()
    desk.runs.start_experiment()
    desk.runs.stop()
    del renderer.refine
    desk.run_to_its_end()
    assert desk.runs.experiment.results is None
    assert desk.said == "experiment stopped after 0 of 5 frames"
    assert {(frame.width, frame.height) for frame in desk.came} == {SIZE}


def test_a_run_that_is_over_keeps_neither_its_scene_nor_a_frame(desk: Desk) -> None:
    scene, frames = weakref.ref(desk.c.session.scene), []
    show = desk.c.scheduler.show

    def showing(traced: Traced) -> None:
        frames.append(weakref.ref(traced.frame))
        show(traced)

    desk.c.scheduler.show = showing
    desk.runs.start_experiment()
    desk.run_to_its_end()
    desk.came.clear()
    assert desk.runs.experiment.whole and frames
    desk.open(embedded_scenes()["figure4"])
    desk.came.clear()
    gc.collect()
    assert scene() is None and not any(frame() for frame in frames)
    assert desk.runs.experiment.scene_path.name == "tiny.aff"
