"""Every view of the picture: its keys, what is wrong by difference and wipe, and legends."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from imgui_bundle import imgui

from tests.viewer.drawn import picture
from tests.viewer.driver import Driver
from tests.viewer.scenarios.steps import figure4
from viewer.state.palette import WRONG
from viewer.state.views import View
from viewer.views.wipe import wipe_column

KEY = imgui.Key


def views(d: Driver) -> None:
    """Every view by its key, each the same as what the command line would draw; only what must be verified, or
    counted, is traced for, once, and as little for the views after it."""
    d.c.settings.change(method="paper")
    d.fix_resolution(320, 220)
    d.settle()
    d.certify()
    d.press(KEY.t)
    d.settle()
    traced = d.c.history.frames
    d.c.session.set_draw(shading=0.35)
    for view in View:
        if view in (View.CUTS, View.VOXELS, View.CELL_LIGHTS, View.TREE):  # of some frames (`culling`)
            continue
        before = d.c.history.frames
        d.press(view.key)
        assert d.c.session.draw.view is view
        assert view.records or d.c.history.frames == before, "changing the view has traced"
        d.settle()
        d.expect_picture()
    d.press(KEY._3)
    d.press(KEY.l)
    assert d.c.session.draw.light == 1
    d.press("Shift+L")
    assert d.c.session.draw.light == 0
    d.press(KEY.h)
    d.press(KEY.u)
    d.settle()
    for view in (View.SAVED, View.COST):
        d.c.session.set_draw(view=view)
        d.frames(2)
        expected = picture(d.c.frame, view, shares=True).astype(int)
        assert np.abs(d.shown().astype(int) - expected).max() <= 2
        assert np.abs(expected - picture(d.c.frame, view)).max() > 20
    d.settle()
    assert d.c.history.frames == traced + 5, "only what a view needs more is traced for"
    assert not d.c.session.settings.verify


def difference(d: Driver) -> None:
    """The dimmed picture where all is right; where culling misses a shadow, one colour, counted, and ringed where that
    is wanted."""
    of_wrong = np.round(np.multiply(255.0, WRONG))

    def dimmed() -> np.ndarray:
        return d.c.session.draw.beneath * picture(d.c.frame).astype(float)

    d.settle()
    d.press(KEY._8)
    d.settle()
    assert d.c.frame.wrong is not None and not d.c.frame.wrong.any()
    assert np.abs(d.shown() - dimmed()).max() <= 1, "nothing is wrong, yet something shines"
    d.press(KEY._1)
    figure4(d, 20)
    assert d.c.frame.wrong is None, "verified, though no view asks for it"
    d.press(KEY._8)
    d.settle()
    wrong = d.c.frame.wrong > 0
    assert d.c.frame.statistics.shadow.wrong == d.c.frame.wrong.sum() > 0
    marked = d.shown()
    assert np.array_equal((marked == of_wrong).all(axis=-1), wrong)
    assert np.count_nonzero(np.abs(marked - dimmed()).max(axis=-1) > 1) > np.count_nonzero(wrong), "no rings"
    d.press(KEY.m)
    assert not d.c.session.draw.mark_wrong
    assert np.abs(d.shown() - dimmed())[~wrong].max() <= 1, "the picture, dimmed, where every answer is right"
    d.press(KEY.m)
    d.press(KEY.c)
    d.settle()
    assert d.c.frame.settings.method == "none" and not d.c.frame.wrong.any()
    assert np.abs(d.shown() - dimmed()).max() <= 1 and not d.c.session.settings.verify


def wiping(d: Driver) -> None:
    """The line of the wipe is dragged by the pointer and nothing else moves; elsewhere a drag turns the camera."""
    d.settle()
    figure4(d, 20)
    d.c.session.set_draw(mark_wrong=False)
    d.press(KEY._9)
    d.settle()
    frame = d.c.frame
    assert (frame.color != frame.reference).any()
    left, top, right, bottom = d.picture_edges()
    camera, pivot, middle = d.c.session.camera, d.ui.picture.pivot, (top + bottom) / 2.0

    def drag_line(start: float, end: float, height: float) -> None:
        x = left + start * (right - left)
        d.drag((x, height), ((end - start) * (right - left), 7.0))
        assert abs(d.c.session.draw.wipe - end) < 0.02
        assert d.c.session.camera == camera and d.ui.picture.pivot is pivot and d.c.selection.picked is None

    drag_line(0.5, 0.3, middle)
    assert (
        np.abs(d.shown().astype(int) - picture(frame, View.WIPE, mark_wrong=False, wipe=d.c.session.draw.wipe)).max()
        <= 1
    )
    drag_line(0.3, 0.9, top + 0.2 * (bottom - top))
    pixels, column = d.shown(), wipe_column(128, d.c.session.draw.wipe)
    assert np.array_equal(pixels[:, :column], picture(frame)[:, :column]), "left of the line is the traced picture"
    right_one = picture(replace(frame, color=frame.reference))
    assert np.array_equal(pixels[:, column + 1 :], right_one[:, column + 1 :]), "right of the line is the reference"
    d.drag((left + 0.9 * (right - left), middle), (2.0 * (right - left), 0.0))
    assert d.c.session.draw.wipe == 1.0, "past the edge it stays on it"
    assert d.c.frame is frame and d.c.session.camera == camera, "dragging the line has traced"
    traced = d.c.history.frames
    d.drag((left + 0.7 * (right - left), middle), (60.0, 0.0))
    assert d.c.session.draw.wipe == 1.0 and d.c.session.camera != camera, "elsewhere a drag turns the camera"
    d.settle()
    assert d.c.history.frames > traced and d.c.frame.settings.verify
