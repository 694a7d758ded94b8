"""Every view of the picture and its legend, and what is wrong by difference and wipe."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from tests.viewer.drawn import picture
from tests.viewer.driver import Driver, Rect
from tracer.culling.fate import Fate
from viewer.output import capture
from viewer.state.palette import WRONG
from viewer.state.preferences import load_preferences
from viewer.state.views import View, can_draw
from viewer.util.resources import embedded_scenes
from viewer.views.wipe import wipe_column

LEGEND = "//Picture/legend"
OF_SOME_FRAMES = (View.CUTS, View.VOXELS, View.CELL_LIGHTS, View.SLACK, View.REGRET)  # of other methods


def views(d: Driver) -> None:
    """Every view by its key, each the same as what the command line would draw, and with its legend in the picture;
    only what must be verified, or counted, is traced for, once, and as little for the views after it."""
    d.change(method="paper")
    d.see(View.OCCLUSION)
    assert not d.has(LEGEND), "the panel View has it, and nothing lies over the picture"
    d.app.params.docking_params.dockable_window_of_name("View").is_visible = False
    d.see(View.COLOR).certify()
    d.press("T").settle()
    traced = d.c.history.frames
    d.c.session.set_draw(shading=0.35)
    for view in View:
        before = d.c.history.frames
        d.press(view.key)
        assert d.c.session.draw.view is view
        assert view.records or d.c.history.frames == before, "changing the view has traced"
        d.settle()
        there = can_draw(d.c.frame, view, d.c.session.draw.light)
        assert there == (view not in OF_SOME_FRAMES) and d.has(LEGEND) == (there and view != View.COLOR), view
        if there:
            d.expect_picture()
        if d.has(LEGEND):
            _legend(d)
    d.press("3", "L")
    assert d.c.session.draw.light == 1
    d.press("Shift+L")
    assert d.c.session.draw.light == 0
    d.press("H", "U").settle()
    for view in (View.SAVED, View.COST):
        d.see(view)
        d.expect_picture(shares=True)
        assert np.abs(d.shown().astype(int) - picture(d.c.frame, view)).max() > 20
    assert d.c.history.frames == traced + 5, "only what a view needs more is traced for"
    assert not d.c.session.settings.verify
    d.c.session.set_pace(fixed_size=False)
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
    area, picture = d.place(LEGEND), d.picture_edges()
    assert picture[0] <= area[0] and area[2] <= picture[2] and picture[1] <= area[1] and area[3] <= picture[3]
    return area


def _dragged(d: Driver) -> None:
    """About the picture, and into two corners; nothing but the legend moves, and a click on it selects nothing."""
    d.see(View.OCCLUSION)
    camera, frame = d.c.session.camera, d.c.frame
    for across in (0.5, 0.0, 1.0):  # the last is where it stays
        (x, y), (_, _, _, bottom) = d.middle(LEGEND), _legend(d)
        to_x, to_y = d.on_picture(across, across)
        d.drag((x, bottom - 6.0), (to_x - x, to_y - y))
        _legend(d)
        if across == 0.5:
            assert np.allclose(d.middle(LEGEND), (to_x, to_y), atol=3.0)
            d.click_here()
        else:
            assert d.c.session.draw.legend_at == (across, across)
    assert d.c.session.camera == camera and d.c.frame is frame and d.c.selection.picked is None


def _off_and_on(d: Driver) -> None:
    """The legend is in the panel View or, where that is not in sight, in the picture if it is wanted there."""
    for there in (True, False, True):
        assert d.has(LEGEND) == there == d.c.session.draw.legend
        d.press("N").frames(2)
    d.press("N").show_panel("View").frames(2)
    assert not d.has(LEGEND) and d.c.session.draw.legend
    d.show_panel("Culling").frames(2)
    assert d.has(LEGEND), "the panel is behind another"


def _in_saved_pictures(d: Driver) -> None:
    """Only where that is wanted; then the rest of the picture is what it was, and it still brings everything back."""
    p = d.c.preferences
    assert np.array_equal(d.settle().saved("without.png"), d.shown())
    d.show_panel("Saving").click("//Saving/Legend in saved pictures")
    assert p.legend_in_pictures
    other = (d.saved("with.png") != d.shown()).any(axis=-1)
    assert all(capture.read(path).draw.view is View.OCCLUSION for path in d.pictures.iterdir())
    rows, columns = np.nonzero(other)
    assert other.any() and rows.min() > d.c.frame.height // 4 and columns.min() > d.c.frame.width // 4
    d.click("//Saving/Legend in saved pictures")
    assert not p.legend_in_pictures


def fates(d: Driver) -> None:
    """The keys of the views of fates; another light asks for no frame; no other view flashes up in motion."""
    d.fix_resolution(240, 135)
    d.c.session.set_pace(target_fps=120.0)  # so that no machine is fast enough for whole pictures in motion
    d.c.settings.change(method="paper")
    d.open(embedded_scenes()["default"])
    d.press(View.FATE.key).settle()
    traced, first = d.c.history.frames, d.shown()
    d.press("L")
    assert d.c.history.frames == traced and (d.shown() != first).any()
    assert (d.c.frame.fate(0) == Fate.CULLED).any()

    d.press("Space")
    d.wait(lambda: d.c.frame.shaded is not None, "a picture of which a part is shaded")
    for view in (View.FATE, View.OCCLUSION, View.MOVING_SHADOW):
        d.press(view.key)
        d.wait(lambda view=view: d.c.scheduler.drawn_view is view, f"the view {view.label}")
        for _ in range(6):
            frame = d.c.frame
            d.wait(lambda frame=frame: d.c.frame is not frame, "another picture")
            assert d.c.scheduler.drawn_view is view, "no other view flashes up"
    d.press("Space").settle()
    d.expect_picture()


def difference(d: Driver) -> None:
    """The dimmed picture where all is right; where culling misses a shadow, one colour, counted, and ringed where that
    is wanted; and beside the picture as it should be."""
    of_wrong = np.round(np.multiply(255.0, WRONG))

    def dimmed() -> np.ndarray:
        return d.c.session.draw.beneath * picture(d.c.frame).astype(float)

    d.press("8").settle()
    assert d.c.frame.wrong is not None and not d.c.frame.wrong.any()
    assert np.abs(d.shown() - dimmed()).max() <= 1, "nothing is wrong, yet something shines"
    d.press("1")
    _figure4(d, 20)
    assert d.c.frame.wrong is None, "verified, though no view asks for it"
    d.press("8").settle()
    wrong = d.c.frame.wrong > 0
    assert d.c.frame.statistics.shadow.wrong == d.c.frame.wrong.sum() > 0
    marked = d.shown()
    assert np.array_equal((marked == of_wrong).all(axis=-1), wrong)
    assert np.count_nonzero(np.abs(marked - dimmed()).max(axis=-1) > 1) > np.count_nonzero(wrong), "no rings"
    d.press("M")
    assert not d.c.session.draw.mark_wrong
    assert np.abs(d.shown() - dimmed())[~wrong].max() <= 1, "the picture, dimmed, where every answer is right"
    _wiped(d)
    d.press("8", "M", "C").settle()
    assert d.c.frame.settings.method == "none" and not d.c.frame.wrong.any()
    assert np.abs(d.shown() - dimmed()).max() <= 1 and not d.c.session.settings.verify


def _wiped(d: Driver) -> None:
    """The line of the wipe is dragged by the pointer and nothing else moves; elsewhere a drag turns the camera."""
    d.press("9").settle()
    frame = d.c.frame
    assert (frame.color != frame.reference).any()
    left, _, right, _ = d.picture_edges()
    camera, pivot = d.c.session.camera, d.ui.picture.pivot
    for start, end, height in ((0.5, 0.3, 0.5), (0.3, 0.9, 0.2)):
        d.drag(d.on_picture(start, height), ((end - start) * (right - left), 7.0))
        assert abs(d.c.session.draw.wipe - end) < 0.02
        assert d.c.session.camera == camera and d.ui.picture.pivot is pivot and d.c.selection.picked is None
        d.expect_picture(1)
    pixels, column = d.shown(), wipe_column(128, d.c.session.draw.wipe)
    assert np.array_equal(pixels[:, :column], picture(frame)[:, :column]), "left of the line is the traced picture"
    right_one = picture(replace(frame, color=frame.reference))
    assert np.array_equal(pixels[:, column + 1 :], right_one[:, column + 1 :]), "right of the line is the reference"
    d.drag(d.on_picture(0.9, 0.5), (2.0 * (right - left), 0.0))
    assert d.c.session.draw.wipe == 1.0, "past the edge it stays on it"
    assert d.c.frame is frame and d.c.session.camera == camera, "dragging the line has traced"
    traced = d.c.history.frames
    d.drag(d.on_picture(0.7, 0.5), (60.0, 0.0))
    assert d.c.session.draw.wipe == 1.0 and d.c.session.camera != camera, "elsewhere a drag turns the camera"
    d.settle()
    assert d.c.history.frames > traced and d.c.frame.settings.verify


def _figure4(d: Driver, frame: int) -> None:
    """The paper's Figure 4 up to a frame, as it is described there: 128 x 128 pixels, frame by frame."""
    d.c.session.set_pace(progressive=False, fixed_size=True, width=128, height=128, every_frame=False)
    d.c.preferences.loop = False
    d.c.settings.change(method="paper")
    d.open(embedded_scenes()["figure4"])
    for number in range(1, frame + 1):
        d.press("RightArrow").settle()
        assert d.c.session.frame == number
