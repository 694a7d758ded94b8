"""Experiments and zoom tests: started, stopped, and asked about."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
from imgui_bundle import glfw_utils, imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from tests.viewer.driver import Driver
from tests.viewer.scenarios.steps import saved_results
from viewer.state.views import View
from viewer.util.resources import embedded_scenes
from viewer.window.ui import Dialog

KEY = imgui.Key


def experimenting(d: Driver) -> None:
    """An experiment starts from its panel, plays, can be stopped, and leaves a table, a plot and files."""
    d.settle()
    runs, home, method = d.c.runs, d.c.session.camera, d.c.session.settings.method
    d.show_panel("Experiment")
    runs.experiment_plan.frames, runs.experiment_plan.size = 3000, (64, 48)
    d.click("//Experiment/**/##verify")
    assert runs.experiment_plan.verify
    d.click(f"//Experiment/**/{icons.ICON_FA_PLAY}  Start")
    run = runs.experiment
    for _ in range(3):
        before = run.traced
        d.wait(lambda: run.is_shown and run.traced > before + 3, "frames of the experiment")  # noqa: B023
        assert (d.c.frame.width, d.c.frame.height) == (64, 48) == d.ui.graphics.display.picture.size, (
            "they are not the picture"
        )
    d.hold(KEY.w, 0.1)
    assert d.c.session.camera == home and "stop it first" in d.said
    d.press(KEY.c)
    assert d.c.session.settings.method == method
    d.press(KEY._2)
    assert d.c.session.draw.view is View.OCCLUSION, "a view can be chosen any time"
    d.click(f"//Experiment/**/{icons.ICON_FA_STOP}  Stop")
    d.wait(lambda: runs.current is None, "the experiment to stop", 20.0)
    assert 3 <= len(run.results.frames) < 3000 and "what was done is kept" in d.said
    d.settle()
    assert (d.c.frame.width, d.c.frame.height) == d.c.scheduler.inputs.size and d.c.frame.camera == home

    runs.experiment_plan.frames = 6
    d.choose("Run/Experiment")
    d.wait(lambda: runs.current is None, "the experiment to end")
    d.settle()
    assert runs.experiment is not run and runs.experiment.whole
    files = saved_results(d, "Experiment")
    assert len(json.loads(files[".json"].read_text())["frames"]) == 6
    assert files[".csv"].read_text().splitlines()[1].startswith("none,")

    # What methods are compared by is seen at once, however many there are; the plot is behind a tab.
    runs.experiment_plan.frames, runs.experiment_plan.accelerator = 2, "kdtree-lazy"
    runs.experiment_plan.methods |= {"auto", "certified+cache"}
    runs.start_experiment()
    d.wait(lambda: runs.current is None, "the experiment to end")
    d.settle()
    assert runs.experiment.results.settings["accelerator"] == "kdtree-lazy"
    for name in ("Table", "Plot", "Table"):
        d.click(f"//Experiment/**/{name}")
    (table,) = (w for w in imgui.get_current_context().windows if w.was_active and "table 1" in w.name)
    assert table.size.x > 25.0 * imgui.get_font_size(), "columns that are compared are out of sight"


def zooming(d: Driver) -> None:
    """A zoom test starts from its panel, plays, and leaves plots, steps to go to, and files; Escape stops another."""
    d.settle()
    runs = d.c.runs
    d.show_panel("Zoom test")
    start = f"//Zoom test/**/{icons.ICON_FA_PLAY}  Start"
    d.click(start)
    assert runs.zoom_test is None and "click a primitive" in d.said
    d.context.mouse_move_to_pos(d.picture_centre())
    d.context.mouse_click(0)
    d.frames(2)
    assert d.c.selection.picked is not None
    runs.zoom_plan.steps, runs.zoom_plan.size = 5, (64, 64)
    d.click(start)
    d.wait(lambda: runs.current is None, "the zoom test")
    d.settle()
    test = runs.zoom_test
    assert test.whole and [a.factor for a in test.results.approaches] == [4.0, 16.0]
    step = test.results.approaches[0].steps[4]
    d.click("//Zoom test/**/4 step 4##shot")
    d.settle()
    assert np.allclose(d.c.frame.camera.position, step.camera.position)
    files = saved_results(d, "Zoom test")
    assert json.loads(files[".json"].read_text())["primitive"] == test.start.primitive
    assert len(files[".csv"].read_text().splitlines()) == 1 + test.frames

    runs.zoom_plan.steps, runs.zoom_plan.ratio = 1000, 0.999
    d.click(start)
    d.wait(lambda: runs.zoom_test.traced > 5, "steps")
    d.press(KEY.escape)
    d.wait(lambda: runs.current is None, "the zoom test to stop", 20.0)
    assert len(runs.zoom_test.results.approaches[0].steps) >= 5
    d.settle()


def asking(d: Driver) -> None:
    """While an experiment runs, opening and quitting ask first; the answer that stops it keeps what is done."""
    d.settle()
    runs, scene = d.c.runs, d.c.session.scene
    first, other = Path(scene.path), embedded_scenes()["figure4"]
    runs.experiment_plan.frames, runs.experiment_plan.size = 3000, (64, 48)

    def under_way() -> None:
        if runs.current is None:
            runs.start_experiment()
            d.slow_down(runs.experiment)
        d.wait(lambda: runs.experiment.done_of[0] > 1, "frames of the experiment")

    def answer(name: str) -> None:
        d.frames(3)
        assert d.c.questions.question is not None and runs.current is not None, "nobody has asked"
        d.click(f"//{d.c.questions.question.title}###question/{name}")
        assert d.c.questions.question is None

    under_way()
    for ask in (lambda: d.drop(other), lambda: d.press(KEY.f5), lambda: d.press("Ctrl+Q"),
                lambda: d.c.loader.open(other)):  # fmt: skip
        ask()
        answer("Keep running")
        assert runs.current is not None and not runs.current.stopping and d.c.loader.load_job is None
    d.drop(other)
    d.frames(3)
    d.press(KEY.escape)
    assert d.c.questions.question is None and not runs.current.stopping, "Escape has stopped it beside the question"
    d.drop(d.folder / "gone.aff")
    assert d.c.questions.question is None and "no such file" in d.said
    run = runs.experiment
    d.drop(other)
    answer("Stop and open")
    d.wait(lambda: d.c.session.scene.path == other and runs.current is None, "the other scene")
    d.settle()
    assert run is runs.experiment and run.results is not None and not run.whole
    d.show_panel("Experiment")
    d.expect(f"Made in {first.name}; open that scene again", f"{first.name}, 64 × 48", "begun at")
    saved_results(d, "Experiment")
    d.drop(first)
    d.wait(lambda: d.c.session.scene.path == first, "the first scene again")
    d.settle()

    # Escape closes what lies over the panels, one by one, and stops the run only when nothing does.
    under_way()
    d.press(KEY.f1)
    d.choose("Edit/Presets/Presets...")
    assert d.ui.dialogs == [Dialog.KEYS, Dialog.PRESETS]
    popups = lambda: len(imgui.get_current_context().open_popup_stack)  # noqa: E731
    for there in ("//##MainMenuBar/##MenuBar/File", f"//Scene/{icons.ICON_FA_CLOCK_ROTATE_LEFT}  Recent"):
        d.click(there)
        assert popups() == 1
        d.press(KEY.escape)
        assert popups() == 0 and d.ui.dialogs == [Dialog.KEYS, Dialog.PRESETS]
    d.press(KEY.escape)
    assert d.ui.dialogs == [Dialog.KEYS]
    d.press(KEY.escape)
    assert not d.ui.dialogs and not runs.current.stopping
    d.press(KEY.escape)
    d.wait(lambda: runs.current is None, "the experiment to stop", 20.0)
    d.settle()

    under_way()
    before = set((d.folder / "pictures").glob("*"))
    d.app._close_wanted(glfw_utils.glfw_window_hello_imgui())
    closed_with: list[set[Path]] = []
    leave = d.app._exit
    d.app._exit = lambda: closed_with.append(set((d.folder / "pictures").glob("*")) - before)  # type: ignore
    answer("Save and quit")
    d.wait(lambda: bool(closed_with), "the files to be written, and the end", 30.0)
    assert {path.suffix for path in closed_with[0]} == {".json", ".csv", ".png"}
    leave()
