"""The legend in the picture: dragged, switched off, and saved with it."""

from __future__ import annotations

import numpy as np
from imgui_bundle import imgui
from PIL import Image

from tests.viewer.driver import Driver, Rect
from viewer.output import capture
from viewer.state.preferences import load_preferences
from viewer.state.views import View, can_draw
from viewer.window.panels.legend import LegendState

KEY = imgui.Key


def legends(d: Driver) -> None:
    """Every view has its legend in the picture; it can be dragged, stays inside, and can be off."""
    d.change(method="paper")
    for view in View:
        d.see(view)
        there = view is not View.COLOR and can_draw(d.c.frame, view, d.c.session.draw.light)
        assert d.ui.state(LegendState).shown == there, view
        if there:
            _legend(d)
    _dragged(d)
    d.resize(1024, 700)
    right, bottom = d.picture_edges()[2:]
    area = _legend(d)
    assert right - area[2] < 20.0 and bottom - area[3] < 20.0, "it has left its corner"
    _off_and_on(d)
    _in_saved_pictures(d)
    d.c.settings.finish()
    kept = load_preferences()[0]
    draw = kept.state["draw"]
    assert (draw["legend"], kept.legend_in_pictures, draw["legend_at"]) == (True, False, [1.0, 1.0])


def _legend(d: Driver) -> Rect:
    """Left, top, right and bottom of the legend, which lies inside the picture."""
    d.frames(2)
    area, picture = d.place("//Picture/legend"), d.picture_edges()
    assert picture[0] <= area[0] and area[2] <= picture[2] and picture[1] <= area[1] and area[3] <= picture[3]
    return area


def _dragged(d: Driver) -> None:
    """About the picture, and into two corners; nothing but the legend moves, and a click on it selects nothing."""
    d.see(View.OCCLUSION)
    camera, frame = d.c.session.camera, d.c.frame
    left, top, right, bottom = d.picture_edges()

    def drag_to(x: float, y: float) -> Rect:
        area = _legend(d)
        hold = (area[0] + area[2]) / 2.0, area[3] - 6.0
        d.drag(hold, (x - (area[0] + area[2]) / 2.0, y - (area[1] + area[3]) / 2.0))
        return _legend(d)

    area = drag_to((left + right) / 2.0, (top + bottom) / 2.0)
    assert abs(area[0] + area[2] - left - right) < 6.0 and abs(area[1] + area[3] - top - bottom) < 6.0
    d.context.mouse_click(0)
    for corner, place in (((left, top), (0.0, 0.0)), ((right, bottom), (1.0, 1.0))):
        drag_to(*corner)
        assert d.c.session.draw.legend_at == place
    assert d.c.session.camera == camera and d.c.frame is frame and d.c.selection.picked is None


def _off_and_on(d: Driver) -> None:
    """Where the picture has no legend, the panel has it."""

    def panel() -> float:
        d.show_panel("View")
        return imgui.internal.find_window_by_name("View").content_size.y

    with_legend = panel()
    d.press(KEY.n)
    assert not d.c.session.draw.legend and not d.ui.state(LegendState).shown
    assert panel() > with_legend + 60.0
    d.press(KEY.n)
    assert d.ui.state(LegendState).shown and panel() == with_legend


def _in_saved_pictures(d: Driver) -> None:
    """Only where that is wanted; then the rest of the picture is what it was, and it still brings everything back."""
    p, folder = d.c.preferences, d.folder / "pictures"

    def saved(name: str) -> np.ndarray:
        p.screenshot_template = f"{name}.png"
        d.press(KEY.f12)
        d.wait(lambda: not d.c.captures.busy, "the picture to be written")
        assert capture.read(folder / f"{name}.png").draw.view is d.c.session.draw.view
        with Image.open(folder / f"{name}.png") as image:
            return np.asarray(image)

    assert np.array_equal(saved("without"), d.shown())
    d.show_panel("Saving")
    d.click("//Saving/Legend in saved pictures")
    assert p.legend_in_pictures
    other = (saved("with") != d.shown()).any(axis=-1)
    rows, columns = np.nonzero(other)
    assert other.any() and rows.min() > d.c.frame.height // 4 and columns.min() > d.c.frame.width // 4
    d.click("//Saving/Legend in saved pictures")
    assert not p.legend_in_pictures
