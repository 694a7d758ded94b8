"""The recorded pictures of a zoom test."""

from __future__ import annotations

import numpy as np
from imgui_bundle import imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons
from PIL import Image

from tests.viewer.driver import Driver
from tracer.experiments import zoom
from viewer.services.runs import RecordedZoomTest
from viewer.util.resources import embedded_scenes


def filmstrip(d: Driver) -> None:
    """A zoom test of Figure 4 leaves a strip of pictures under each plot."""
    d.settle()
    d.drop(embedded_scenes()["figure4"])
    d.wait(lambda: d.c.session.scene.path.name == "figure4.aff", "the scene of Figure 4")
    d.settle()
    runs, plan = d.c.runs, d.c.runs.zoom_plan
    plan.factors, plan.steps, plan.size, plan.ratio = "4, 64", 40, (128, 128), 0.94
    d.c.selection.clear()
    d.c.selection.select((0.5, 0.5))
    d.show_panel("Zoom test")
    d.click(f"//Zoom test/**/{icons.ICON_FA_PLAY}  Start")
    d.wait(lambda: runs.current is None, "the zoom test")
    d.settle()
    test = runs.zoom_test
    assert test.whole and [len(test.filmstrip.of(factor)) for factor in (4.0, 64.0)] == [43, 43]
    for _ in d.sizes():
        for approach in test.results.approaches:
            _point_and_click(d, test, approach)
    d.scroll_down("Zoom test")
    d.click(f"//Zoom test/**/{icons.ICON_FA_FLOPPY_DISK} Film")
    d.wait(lambda: any((d.folder / "pictures").glob("*-film*.png")), "the film to be written")
    (path,) = (d.folder / "pictures").glob("*-film*.png")
    with Image.open(path) as image:
        assert image.width == 1920 and image.height > 700


def _point_and_click(d: Driver, test: RecordedZoomTest, approach: zoom.Approach) -> None:
    """A thumbnail shows its step as it was recorded, rings included, while it is pointed at; a click flies there."""
    step, traced = approach.steps[-1], d.c.history.frames
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
    d.click(small)
    d.settle()
    assert np.allclose(d.c.session.camera.position, step.camera.position)
