"""The recorded pictures of a zoom test."""

from __future__ import annotations

from imgui_bundle import imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons
from PIL import Image

from tests.viewer.driver import Driver
from tracer.experiments import zoom
from viewer.state.views import View
from viewer.util.resources import embedded_scenes

KEY = imgui.Key


def filmstrip(d: Driver) -> None:
    """A zoom test of Figure 4 leaves a strip of pictures under each plot; a click shows one large, without tracing."""
    d.settle()
    d.drop(embedded_scenes()["figure4"])
    d.wait(lambda: d.c.session.scene.path.name == "figure4.aff", "the scene of Figure 4")
    d.settle()
    runs, plan = d.c.runs, d.c.runs.zoom_plan
    plan.factors, plan.steps, plan.size, plan.ratio = "4, 64", 40, (128, 128), 0.94
    d.c.selection.picked = None
    d.c.selection.select((0.5, 0.5))
    d.ui.show_panel("Zoom test")
    d.frames(3)
    d.context.item_click(f"//Zoom test/**/{icons.ICON_FA_PLAY}  Start")
    d.wait(lambda: runs.current is None, "the zoom test")
    d.settle()
    test = runs.zoom_test
    assert test.whole and [len(test.filmstrip.of(factor)) for factor in (4.0, 64.0)] == [43, 43]
    camera = d.c.session.camera
    for _ in d.sizes():
        for factor in (4.0, 64.0):
            _screened(d, test.results, factor)
        assert d.c.session.camera == camera
    _ways_back(d)
    d.scroll_down("Zoom test")
    d.context.item_click(f"//Zoom test/**/{icons.ICON_FA_FLOPPY_DISK} Film")
    d.wait(lambda: not d.c.captures.busy, "the film to be written")
    d.frames(2)
    (path,) = (d.folder / "pictures").glob("*-film-*.png")
    with Image.open(path) as image:
        assert image.width == 1920 and image.height > 700


def _screened(d: Driver, results: zoom.Results, factor: float) -> None:
    """A thumbnail, clicked, shows its step: the picture as it was recorded, rings included."""
    approach = next(a for a in results.approaches if a.factor == factor)
    step = approach.steps[-1]
    traced = d.c.history.frames
    tab = f"//Zoom test/**/factor {factor:g}##{results.approaches.index(approach)}"
    if d.context.item_exists(tab):  # where there is no room for both
        d.context.item_click(tab)
        d.frames(2)
    _to_the_end(d, f"film {factor:g}")
    d.context.item_click(f"//Zoom test/**/{factor:g} step {step.number}##shot")
    d.frames(6)
    shown = d.ui.frame_preview
    assert shown is not None and shown.step() == step
    pixels = shown.shot.pixels()
    magenta = (pixels == (255, 0, 255)).all(axis=-1)
    assert pixels.shape == (128, 128, 3) and magenta.any() == (step.wrong > 0) == (factor == 64.0)
    assert d.ui.graphics.textures.texture_id(shown.shot, small=False) is not None, "it is not drawn"
    assert d.c.history.frames == traced, "showing it has traced"


def _to_the_end(d: Driver, strip: str) -> None:
    """Scroll a filmstrip to its last picture."""
    (window,) = (w for w in imgui.get_current_context().windows if f"/{strip}_" in w.name and w.active)
    imgui.internal.set_scroll_x(window, window.scroll_max.x)
    d.frames(3)


def _ways_back(d: Driver) -> None:
    """Escape, the button, and whatever is done with the traced picture."""
    test = d.c.runs.zoom_test
    _screened(d, test.results, 4.0)

    def show(number: int) -> None:
        d.context.item_click(f"//Zoom test/**/4 step {number}##shot")
        d.frames(4)
        assert d.ui.frame_preview.shot.number == number

    show(41)
    d.context.item_click(f"//Picture/**/{icons.ICON_FA_CHEVRON_RIGHT}##1")
    d.frames(2)
    assert d.ui.frame_preview.shot.number == 42
    d.press(KEY.escape)
    assert d.ui.frame_preview is None and d.c.selection.picked is not None
    show(42)
    d.context.item_click("//Picture/**/Back (Escape)##recorded")
    d.frames(2)
    assert d.ui.frame_preview is None
    show(42)
    d.press(KEY._2)
    assert d.ui.frame_preview is None and d.c.session.draw.view is View.OCCLUSION
    show(42)
    d.hold(KEY.d, 0.1)
    assert d.ui.frame_preview is None
    d.settle()
    assert d.c.runs.zoom_test is test
