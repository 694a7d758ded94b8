"""Looking closely at the picture: zoom, exact pixels, and how their values lie."""

from __future__ import annotations

import numpy as np
from imgui_bundle import imgui

from tests.viewer.drawn import picture
from tests.viewer.driver import Driver
from viewer.state.pixels import around, pixels_shown
from viewer.state.views import View

KEY = imgui.Key
CTRL, SHIFT = int(KEY.mod_ctrl), int(KEY.mod_shift)
SMALL = 1024, 620  # a window that is quickly drawn, and just does not fold its panels


def closeup(d: Driver) -> None:
    """Ctrl and the wheel zoom around the pointer, and what is clicked then is the pixel that is seen there."""
    d.resize(*SMALL)
    p = d.c.preferences
    d.fix_resolution(320, 240)
    p.pixel_values = False
    d.c.session.set_draw(legend=False)
    d.settle()
    camera, traced, speed = d.c.session.camera, d.c.history.frames, d.c.preferences.speed
    shown = picture(d.c.frame)
    for number, (u, v) in enumerate(((0.3, 0.4), (0.003, 0.5), (0.71, 0.998))):
        x, y = _point_at(d, u, v)
        _wheel(d, 12 if number % 2 == 0 else 7)
        assert abs(d.c.session.draw.zoom.scale - (64.0 if number % 2 == 0 else 2.0**3.5)) < 1e-6
        assert d.c.selection.hovered is not None and _pixel(d) == (x, y), "the pixel has moved away from the pointer"
        d.context.mouse_click(0)
        d.frames(3)
        picked = d.c.selection.picked
        assert picked is None or (picked.x, picked.y) == (x, y)
        d.c.selection.clear()
        d.c.selection.select(d.c.selection.hovered)
        found, d.c.selection.picked = d.c.selection.picked, None
        assert (found is None) == (d.c.frame.primitive[y, x] < 0)
        d.frames(3)
        if number == 0:
            _crisp(d, shown, x, y)
            _panned(d, x, y)
        d.press(int(KEY.f) | SHIFT)
        assert d.c.session.draw.zoom.fits
    assert d.c.session.camera == camera and d.c.history.frames == traced and d.c.preferences.speed == speed
    d.press(KEY.equal, 3)
    assert abs(d.c.session.draw.zoom.scale - 2.0**1.5) < 1e-9
    d.press(KEY.minus, 3)
    assert d.c.session.draw.zoom.fits
    _numbers(d)
    _range(d)
    _exposed(d)
    d.settle()


def _point_at(d: Driver, u: float, v: float) -> tuple[int, int]:
    """Rest the pointer on a point of the picture; the pixel there."""
    left, top, right, bottom = d.picture_edges()
    d.context.mouse_move_to_pos((left + u * (right - left), top + v * (bottom - top)))
    d.frames(2)
    return _pixel(d)


def _pixel(d: Driver) -> tuple[int, int]:
    """Under the pointer."""
    u, v = d.c.selection.hovered
    return int(u * d.c.frame.width), int(v * d.c.frame.height)


def _wheel(d: Driver, notches: int) -> None:
    d.context.key_down(KEY.mod_ctrl)
    d.context.mouse_wheel_y(notches)
    d.frames(1)
    d.context.key_up(KEY.mod_ctrl)
    d.frames(3)


def _crisp(d: Driver, shown: np.ndarray, x: int, y: int) -> None:
    """A pixel is a rectangle of its colour, and its neighbours begin where it ends."""
    window, (left, top, right, bottom) = d.window(), d.picture_edges()
    size = np.array([right - left, bottom - top]) * 64.0 / (d.c.frame.width, d.c.frame.height)
    zoom = d.c.session.draw.zoom
    for dx, dy in ((0, 0), (1, 0), (0, 2), (3, 1)):
        middle = (
            (np.array([x + dx + 0.5, y + dy + 0.5]) / (d.c.frame.width, d.c.frame.height)) - (zoom.left, zoom.top)
        ) * 64.0
        at = np.array([left, top]) + middle * (right - left, bottom - top)
        if not (left < at[0] - size[0] / 2 and at[0] + size[0] / 2 < right - 1 and top + 40 < at[1] < bottom - size[1]):
            continue
        reach = np.floor(size / 2 - 2).astype(int)
        block = window[int(at[1]) - reach[1] : int(at[1]) + reach[1], int(at[0]) - reach[0] : int(at[0]) + reach[0]]
        near = np.abs(block.astype(int) - shown[y + dy, x + dx]).max(axis=-1) <= 1
        assert near.mean() > (0.9 if (dx, dy) == (0, 0) else 0.999), "not one colour, or another one"  # the pointer


def _panned(d: Driver, x: int, y: int) -> None:
    """A drag with Ctrl moves the picture along with the pointer, and no camera."""
    u, v = d.c.selection.hovered
    mouse = imgui.get_io().mouse_pos
    d.context.key_down(KEY.mod_ctrl)
    d.drag((mouse.x, mouse.y), (60.0, 40.0))
    d.context.key_up(KEY.mod_ctrl)
    d.frames(2)
    assert d.c.selection.hovered == (abs_near(u), abs_near(v)), "what was under the pointer has not come along"
    assert d.c.session.draw.zoom.scale == 64.0 and d.c.selection.picked is None


class abs_near(float):
    """A number that equals any near it."""

    def __eq__(self, other: object) -> bool:
        return isinstance(other, float) and abs(self - other) < 1e-3

    __hash__ = float.__hash__


def _numbers(d: Driver) -> None:
    """Values are written into pixels that are large enough, in every view that has any."""
    _point_at(d, 0.45, 0.55)
    _wheel(d, 12)
    for view in (View.COLOR, View.OCCLUSION):
        d.see(view)
        d.c.preferences.pixel_values = False
        d.frames(3)
        without = d.window()
        d.c.preferences.pixel_values = True
        d.frames(3)
        left, top, right, bottom = (int(edge) for edge in d.picture_edges())
        changed = (d.window() != without).any(axis=-1)[top + 30 : bottom, left:right]
        assert 0.02 < changed.mean() < 0.8, f"{view}: {changed.mean():.1%} of the picture changed"
    d.c.session.set_draw(view=View.COLOR)
    d.press(int(KEY.f) | SHIFT)
    d.settle()


def _range(d: Driver) -> None:
    """The panel has a histogram of the pixels that are seen, which give the colours their range."""
    d.c.session.set_draw(view=View.DEPTH, zoom=around(0.5, 0.6, 3.0))
    d.settle()
    d.show_panel("Pixels")
    columns, rows = pixels_shown(d.c.session.draw.zoom, d.c.frame.width, d.c.frame.height)
    depth = d.c.frame.depth[rows.start : rows.stop, columns.start : columns.stop]
    depth = depth[np.isfinite(depth)]
    d.click("//Pixels/**/Use as the range of colours")
    d.press(int(KEY.f) | SHIFT)
    d.frames(3)
    assert np.allclose(d.c.session.draw.span, (depth.min(), depth.max()))
    d.expect_picture()
    d.c.session.set_draw(spans=())
    d.see(View.COLOR)


def _exposed(d: Driver) -> None:
    """Exposure by keys, and stripes over what is clipped; neither traces, nor outlives what resets it."""
    traced = d.c.history.frames
    d.press(KEY.right_bracket, 2)
    d.press(int(KEY.m) | SHIFT)
    assert d.c.session.draw.tone.exposure == 1.0 and d.c.session.draw.clipping
    d.expect_picture(1)
    d.press(KEY.left_bracket)
    d.press(int(KEY.m) | SHIFT)
    assert d.c.session.draw.tone.exposure == 0.5
    d.choose("Picture/Colours as traced")
    assert d.c.session.draw.tone.neutral and np.array_equal(d.shown(), picture(d.c.frame)), "bit for bit as it was"
    d.press(int(KEY.z) | CTRL)
    assert d.c.session.draw.tone.exposure == 0.5, "colours as traced can be undone"
    d.press(int(KEY.z) | CTRL | SHIFT)
    assert d.c.session.draw.tone.neutral
    assert d.c.history.frames == traced
