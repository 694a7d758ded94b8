"""Experiments, zoom tests and films: started, stopped, and asked about."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
from imgui_bundle import glfw_utils, imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons
from PIL import Image

from tests.viewer.driver import SMALL, Driver
from tracer.culling.modes import OcclusionMode, occlusion_mode
from tracer.experiments import zoom
from viewer.services.runs import RecordedZoomTest
from viewer.state.views import View
from viewer.util.resources import default_scene, embedded_scenes
from viewer.window.ui import Dialog


def experimenting(d: Driver) -> None:
    """An experiment starts from its panel, plays, can be stopped, and leaves a table, a plot and files."""
    runs, home, method = d.c.runs, d.c.session.camera, d.c.session.settings.method
    d.show_panel("Experiment")
    runs.experiment_plan.frames, runs.experiment_plan.size = 3000, (64, 48)
    d.click("//Experiment/**/##verify")
    assert runs.experiment_plan.verify
    d.start("Experiment")
    run = runs.experiment
    for _ in range(3):
        before = run.traced
        d.wait(lambda: run.is_shown and run.traced > before + 3, "frames of the experiment")  # noqa: B023
        assert (d.c.frame.width, d.c.frame.height) == (64, 48) == d.ui.graphics.display.picture.size, (
            "they are not the picture"
        )
    d.hold("W", 0.1)
    assert d.c.session.camera == home and "stop it first" in d.said
    d.press("C")
    assert d.c.session.settings.method == method
    d.press("2")
    assert d.c.session.draw.view is View.OCCLUSION, "a view can be chosen any time"
    d.click(f"//Experiment/**/{icons.ICON_FA_STOP}  Stop").settle()
    assert 3 <= len(run.results.frames) < 3000 and "what was done is kept" in d.said
    assert (d.c.frame.width, d.c.frame.height) == d.c.scheduler.inputs.size and d.c.frame.camera == home

    runs.experiment_plan.frames = 6
    d.choose("Run/Start experiment").settle()
    assert runs.experiment is not run and runs.experiment.whole
    files = _saved_results(d, "Experiment")
    assert len(json.loads(files[".json"].read_text())["frames"]) == 6
    assert files[".csv"].read_text().splitlines()[1].startswith("none,")

    # What methods are compared by is seen at once, however many there are; the plot is behind a tab.
    runs.experiment_plan.frames, runs.experiment_plan.accelerator = 2, "kdtree-lazy"
    runs.experiment_plan.methods |= {"auto", "certified+cache"}
    runs.start_experiment()
    d.settle()
    assert runs.experiment.results.settings["accelerator"] == "kdtree-lazy"
    d.resize(900, 620)
    for name in ("Table", "Plot", "Table"):
        d.click(f"//Experiment/**/{name}")
    (table,) = (w for w in imgui.get_current_context().windows if w.was_active and "table 1" in w.name)
    assert table.size.x > 25.0 * imgui.get_font_size(), "columns that are compared are out of sight"
    d.resize(*SMALL)


def zooming(d: Driver) -> None:
    """A zoom test of Figure 4 starts from its panel, plays, and leaves plots with a strip of pictures under each, steps
    to go to, and files."""
    d.open(embedded_scenes()["figure4"])
    runs, plan = d.c.runs, d.c.runs.zoom_plan
    d.show_panel("Zoom test").start("Zoom test")
    assert runs.zoom_test is None and "click a primitive" in d.said
    d.pick()
    assert d.c.selection.picked is not None
    plan.factors, plan.steps, plan.size, plan.ratio = "4, 64", 40, (128, 128), 0.94
    d.start("Zoom test").settle()
    test = runs.zoom_test
    assert test.whole and [len(test.filmstrip.of(factor)) for factor in (4.0, 64.0)] == [43, 43]
    for _ in d.sizes():
        for approach in test.results.approaches:
            _point_and_click(d, test, approach)
    files = _saved_results(d, "Zoom test")
    assert json.loads(files[".json"].read_text())["primitive"] == test.start.primitive
    assert len(files[".csv"].read_text().splitlines()) == 1 + test.frames
    d.click(f"//Zoom test/**/{icons.ICON_FA_FLOPPY_DISK} Film").settle()
    (path,) = d.pictures.glob("*-film*.png")
    with Image.open(path) as image:
        assert image.width == 1920 and image.height > 700


def _point_and_click(d: Driver, test: RecordedZoomTest, approach: zoom.Approach) -> None:
    """A thumbnail shows its step as it was recorded, rings included, while it is pointed at; a click flies there."""
    step, traced = approach.steps[-1], d.c.history.frames
    if d.has(tab := "//Zoom test/**/Pictures"):  # where there is no room for all parts side by side
        d.click(tab).frames(3)
    (window,) = (w for w in imgui.get_current_context().windows if "/films_" in w.name and w.active)
    imgui.internal.set_scroll_x(window, window.scroll_max.x)
    imgui.internal.set_scroll_y(window, window.scroll_max.y if approach is test.results.approaches[-1] else 0.0)
    d.frames(3)
    small = f"//Zoom test/**/{approach.factor:g} step {step.number}##shot"
    d.hover(small)
    shot = test.filmstrip.nearest(approach.factor, step.number)
    magenta = (shot.pixels() == (255, 0, 255)).all(axis=-1)
    assert magenta.shape == (128, 128) and magenta.any() == (step.wrong > 0) == (approach.factor == 64.0)
    assert d.ui.graphics.textures.texture_id(shot, small=False) is not None, "it is not drawn"
    assert d.c.history.frames == traced, "showing it has traced"
    d.click(small).settle()
    assert d.c.session.camera == step.camera and np.count_nonzero(d.c.frame.wrong) == step.wrong, "its modes are gone"


def filming(d: Driver) -> None:
    """A path, with its modes; a flight through bookmarks; and one that is stopped."""
    films, runs = d.c.films, d.c.runs
    d.see(View.OCCLUSION)
    d.choose("Run/Film...")
    films.plan.last, films.plan.size, films.plan.legend = 4, (160, 120), True
    assert films.count == 5
    d.start("Film").wait(lambda: runs.current is not None, "the film to begin")
    d.c.questions.before_opening("another scene", (waits := ["to be opened"]).clear)
    d.settle()
    assert d.c.questions.question is None and not waits, "it is opened once the film has ended"
    assert films.film.whole and "film done: 5 frames" in d.said
    folder = films.film.folder
    assert folder.parent == d.pictures and len(list(folder.iterdir())) == 5

    d.click("//Film/**/###bookmarks")
    assert films.plan.through_bookmarks and films.count == 0
    d.start("Film")
    assert d.c.notices.message.error and "two bookmarks" in d.said
    d.c.bookmarks.add()
    d.hold("D", 0.2).settle()
    d.c.bookmarks.add()
    films.plan.fps, films.plan.seconds = 50.0, 60.0
    assert films.count == 3000
    d.start("Film").wait(lambda: films.film.traced > 3, "frames of the flight")
    assert d.c.scheduler.drawn_view is View.OCCLUSION
    d.press("Escape").settle()
    assert 3 < len(list(films.film.folder.iterdir())) < 3000
    assert "is kept" in d.said and str(films.film.folder) in d.said


def asking(d: Driver) -> None:
    """While an experiment runs, opening and quitting ask first; the answer that stops it keeps what is done."""
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
    for ask in (lambda: d.drop(other), lambda: d.press("F5"), lambda: d.press("Ctrl+Q"),
                lambda: d.c.loader.open(other)):  # fmt: skip
        ask()
        answer("Keep running")
        assert runs.current is not None and not runs.current.stopping and d.c.loader.load_job is None
    d.drop(other)
    d.press("Escape")
    assert d.c.questions.question is None and not runs.current.stopping, "Escape has stopped it beside the question"
    d.drop(d.folder / "gone.aff")
    assert d.c.questions.question is None and "no such file" in d.said
    run = runs.experiment
    d.drop(other)
    answer("Stop and open")
    d.settle()
    assert d.c.session.scene.path == other and run is runs.experiment and run.results is not None and not run.whole
    d.show_panel("Experiment")
    d.expect(f"Made in {first.name}; open that scene again", f"{first.name}, 64 × 48", "begun at")
    d.open(first)

    # Escape closes what lies over the panels, one by one, and stops the run only when nothing does.
    under_way()
    d.press("F1")
    d.choose("Edit/Presets/Presets...").show_panel("Scene")
    assert d.ui.dialogs == [Dialog.KEYS, Dialog.PRESETS]
    popups = lambda: len(imgui.get_current_context().open_popup_stack)  # noqa: E731
    for there in ("//##MainMenuBar/##MenuBar/File", f"//Scene/{icons.ICON_FA_CUBES}  Scenes"):
        d.click(there)
        assert popups() == 1
        d.press("Escape")
        assert popups() == 0 and d.ui.dialogs == [Dialog.KEYS, Dialog.PRESETS]
    d.press("Escape")
    assert d.ui.dialogs == [Dialog.KEYS]
    d.press("Escape")
    assert not d.ui.dialogs and not runs.current.stopping
    d.press("Escape").settle()
    assert runs.current is None

    under_way()
    before = set(d.pictures.glob("*"))
    d.app._close_wanted(glfw_utils.glfw_window_hello_imgui())
    closed_with: list[set[Path]] = []
    leave = d.app._exit
    d.app._exit = lambda: closed_with.append(set(d.pictures.glob("*")) - before)  # type: ignore
    answer("Save and quit")
    d.wait(lambda: bool(closed_with), "the files to be written, and the end", 30.0)
    assert {path.suffix for path in closed_with[0]} == {".json", ".csv", ".png"}
    leave()


def _saved_results(d: Driver, panel: str) -> dict[str, Path]:
    """Save results by the panel's buttons; the files by their endings."""
    before = set(d.pictures.glob("*"))
    d.scroll_down(panel)
    for kind in ("JSON", "CSV", "Plot"):
        d.click(f"//{panel}/**/{icons.ICON_FA_FLOPPY_DISK} {kind}")
    d.settle()
    assert not d.c.notices.message.error, d.said
    files = {path.suffix: path for path in set(d.pictures.glob("*")) - before}
    assert set(files) == {".json", ".csv", ".png"}
    with Image.open(files[".png"]) as plot:
        assert plot.size == (1920, 1080)
    return files


def figures(d: Driver) -> None:
    """The paper's figures by one command each, in the scenes and sizes that show something."""
    runs = d.c.runs
    d.choose("Run/Figure 4").wait(lambda: runs.zoom_test is not None and runs.current is None, "Figure 4", 120.0)
    assert runs.zoom_test.whole and [bool(one.wrong_steps) for one in runs.zoom_test.results.approaches] == [True, True]
    d.expect("factor 4: examined anew after step 14", "factor 64: never examined anew")
    d.choose("Run/Figure 3").wait(lambda: d.c.session.draw.view is View.OCCLUSION, "Figure 3", 60.0).settle()
    hidden = OcclusionMode(int(occlusion_mode(d.c.frame.modes)[4]))
    assert hidden is OcclusionMode.FULLY_RENDERED, "the card that is hidden on its left is taken for whole"
    d.open(embedded_scenes()["figure4"])
    assert not d.c.session.state.pace.fixed_size, "another scene has the window's size"
    d.choose("Run/Table 1").wait(lambda: runs.experiment is not None and runs.experiment.traced > 0, "a frame", 60.0)
    assert d.c.session.scene.path == default_scene(), "a scene that shows something in it"
