"""What is drawn over the picture and beside it, at the sizes of window that people have; run as other scenarios are."""

from __future__ import annotations

from collections.abc import Iterator

import glfw
import numpy as np
from imgui_bundle import glfw_utils, imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons
from PIL import Image

from tests.viewer.window import Driver
from tracer import zoom
from viewer import capture
from viewer.preferences import load_preferences
from viewer.resources import embedded_scenes
from viewer.views import View

KEY = imgui.Key
SIZES = ((1280, 800), (1600, 1000))


def sizes(d: Driver) -> Iterator[tuple[int, int]]:
    """Set the window to each of SIZES, one after another."""
    for size in SIZES:
        resize(d, *size)
        yield size


def resize(d: Driver, width: int, height: int) -> None:
    glfw.set_window_size(glfw_utils.glfw_window_hello_imgui(), width, height)
    d.frames(4)
    d.settle()


def _legend(d: Driver) -> tuple[float, float, float, float]:
    """Left, top, right and bottom of the legend, which lies inside the picture."""
    d.frames(2)
    area = d.context.item_info("//Picture/legend").rect_full
    left, top, right, bottom = d.picture_edges()
    assert left <= area.min.x and area.max.x <= right and top <= area.min.y and area.max.y <= bottom
    return area.min.x, area.min.y, area.max.x, area.max.y


def legends(d: Driver) -> None:
    """Every view has its legend in the picture; it can be dragged, catches in corners, stays inside, and can be off."""
    d.c.change(method="paper")
    d.settle()
    for _ in sizes(d):
        for view in View:
            d.c.set_view(view)
            d.settle()
            assert d.ui.legend_shown == (view is not View.COLOR and view.can_draw(d.c.frame)), view
            if d.ui.legend_shown:
                _legend(d)
        _dragged(d)
    resize(d, 900, 600)
    right, bottom = d.picture_edges()[2:]
    area = _legend(d)
    assert right - area[2] < 20.0 and bottom - area[3] < 20.0, "it has left its corner"
    _off_and_on(d)
    _in_saved_pictures(d)
    d.c.save_preferences()
    kept = load_preferences()[0]
    assert (kept.legend, kept.legend_in_pictures, kept.legend_x, kept.legend_y) == (True, False, 1.0, 1.0)


def _dragged(d: Driver) -> None:
    """About the picture, and into two corners; nothing but the legend moves, and a click on it selects nothing."""
    d.c.set_view(View.OCCLUSION)
    d.settle()
    p, camera, frame = d.c.preferences, d.c.session.camera, d.c.frame
    left, top, right, bottom = d.picture_edges()

    def drag_to(x: float, y: float) -> tuple[float, float, float, float]:
        area = _legend(d)
        hold = (area[0] + area[2]) / 2.0, area[3] - 6.0
        d.drag(hold, (x - (area[0] + area[2]) / 2.0, y - (area[1] + area[3]) / 2.0))
        return _legend(d)

    area = drag_to((left + right) / 2.0, (top + bottom) / 2.0)
    assert abs(area[0] + area[2] - left - right) < 6.0 and abs(area[1] + area[3] - top - bottom) < 6.0
    d.context.mouse_click(0)
    d.frames(2)
    assert d.c.selected is None and d.c.session.camera == camera and d.c.frame is frame
    area = drag_to(left, top)
    assert (p.legend_x, p.legend_y) == (0.0, 0.0) and area[0] - left < 20.0
    area = drag_to(right - (area[2] - area[0]) / 2.0 - 20.0, bottom - (area[3] - area[1]) / 2.0 - 20.0)
    assert (p.legend_x, p.legend_y) == (1.0, 1.0) and right - area[2] < 20.0 and bottom - area[3] < 20.0
    assert d.c.session.camera == camera and d.c.frame is frame and d.c.selected is None


def _off_and_on(d: Driver) -> None:
    """Where the picture has no legend, the panel has it."""

    def panel() -> float:
        d.ui.show_panel("View")
        d.frames(4)
        return imgui.internal.find_window_by_name("View").content_size.y

    with_legend = panel()
    d.press(KEY.n)
    assert not d.c.preferences.legend and not d.ui.legend_shown
    assert panel() > with_legend + 60.0
    d.press(KEY.n)
    assert d.ui.legend_shown and panel() == with_legend


def _in_saved_pictures(d: Driver) -> None:
    """Only where that is wanted; then the rest of the picture is what it was, and it still brings everything back."""
    p, folder = d.c.preferences, d.folder / "pictures"

    def saved(name: str) -> np.ndarray:
        p.screenshot_template = f"{name}.png"
        d.press(KEY.f12)
        d.wait(lambda: not d.c.keeper.busy, "the picture to be written")
        assert capture.read(folder / f"{name}.png").view is d.c.session.view
        with Image.open(folder / f"{name}.png") as image:
            return np.asarray(image)

    assert np.array_equal(saved("without"), d.shown())
    d.ui.show_panel("Saving")
    d.frames(3)
    d.context.item_click("//Saving/With legend")
    assert p.legend_in_pictures
    other = (saved("with") != d.shown()).any(axis=-1)
    rows, columns = np.nonzero(other)
    assert other.any() and rows.min() > d.c.frame.height // 4 and columns.min() > d.c.frame.width // 4
    d.context.item_click("//Saving/With legend")
    assert not p.legend_in_pictures


def filmstrip(d: Driver) -> None:
    """A zoom test of Figure 4 leaves a strip of pictures under each plot; a click shows one large, without tracing."""
    d.settle()
    d.drop(embedded_scenes()["figure4"])
    d.wait(lambda: d.c.session.scene.path.name == "figure4.aff", "the scene of Figure 4")
    d.settle()
    runner, plan = d.c.runner, d.c.runner.zoom_plan
    plan.factors, plan.steps, plan.size, plan.ratio = "4, 64", 40, (128, 128), 0.94
    d.c.selected = None
    d.c.select((0.5, 0.5))
    d.ui.show_panel("Zoom test")
    d.frames(3)
    d.context.item_click(f"//Zoom test/**/{icons.ICON_FA_PLAY}  Start")
    d.wait(lambda: runner.current is None, "the zoom test")
    d.settle()
    test = runner.zoom_test
    assert test.whole and [len(test.film.of(factor)) for factor in (4.0, 64.0)] == [43, 43]
    camera = d.c.session.camera
    for _ in sizes(d):
        for factor in (4.0, 64.0):
            _screened(d, test.results, factor)
        assert d.c.session.camera == camera
    _ways_back(d)
    d.context.item_click(f"//Zoom test/**/{icons.ICON_FA_FLOPPY_DISK} Film")
    d.wait(lambda: not d.c.keeper.busy, "the film to be written")
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
    shown = d.ui.screening
    assert shown is not None and shown.step() == step
    pixels = shown.shot.pixels()
    magenta = (pixels == (255, 0, 255)).all(axis=-1)
    assert pixels.shape == (128, 128, 3) and magenta.any() == (step.wrong > 0) == (factor == 64.0)
    assert d.ui.shots.texture_id(shown.shot, small=False) is not None, "it is not drawn"
    assert d.c.history.frames == traced, "showing it has traced"


def _to_the_end(d: Driver, strip: str) -> None:
    """Scroll a filmstrip to its last picture."""
    (window,) = (w for w in imgui.get_current_context().windows if f"/{strip}_" in w.name and w.active)
    imgui.internal.set_scroll_x(window, window.scroll_max.x)
    d.frames(3)


def _ways_back(d: Driver) -> None:
    """Escape, the button, and whatever is done with the traced picture."""
    test = d.c.runner.zoom_test
    _screened(d, test.results, 4.0)

    def show(number: int) -> None:
        d.context.item_click(f"//Zoom test/**/4 step {number}##shot")
        d.frames(4)
        assert d.ui.screening.shot.number == number

    show(41)
    d.context.item_click(f"//Picture/**/{icons.ICON_FA_CHEVRON_RIGHT}##1")
    d.frames(2)
    assert d.ui.screening.shot.number == 42
    d.press(KEY.escape)
    assert d.ui.screening is None and d.c.selected is not None
    show(42)
    d.context.item_click("//Picture/**/Back (Escape)##recorded")
    d.frames(2)
    assert d.ui.screening is None
    show(42)
    d.press(KEY._2)
    assert d.ui.screening is None and d.c.session.view is View.OCCLUSION
    show(42)
    d.hold(KEY.d, 0.1)
    assert d.ui.screening is None
    d.settle()
    assert d.c.runner.zoom_test is test
