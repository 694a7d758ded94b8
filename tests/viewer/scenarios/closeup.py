"""Looking closely at the picture: zoom, exact pixels, and how their values lie."""

from __future__ import annotations

import numpy as np
from imgui_bundle import imgui

from tests.viewer.drawn import picture
from tests.viewer.driver import Driver
from viewer.state.pixels import Zoom, around, pixel_at, pixels_shown
from viewer.state.views import View


def closeup(d: Driver) -> None:
    """Ctrl and the wheel zoom around the pointer, and what is clicked then is the pixel that is seen there."""
    d.fix_resolution(320, 240)
    d.c.preferences.pixel_values = False
    d.see(View.COLOR, legend=False)
    camera, traced, speed = d.c.session.camera, d.c.history.frames, d.c.preferences.speed
    for (u, v), notches in (((0.3, 0.4), 12), ((0.003, 0.5), 7), ((0.71, 0.998), 12)):
        d.point(u, v)
        x, y = _pixel(d)
        _wheel(d, notches)
        assert np.isclose(_zoom(d).scale, min(2.0 ** (notches / 2), 64.0))
        assert _pixel(d) == (x, y), "the pixel has moved away from the pointer"
        d.click_here()
        assert d.c.selection.pixel == ((x, y) if d.c.frame.primitive[y, x] >= 0 else None)
        d.c.selection.clear()
        d.click_here(2)
        assert d.c.selection.picked is None, "the middle button pans, and selects nothing"
        if u == 0.3:
            _crisp(d, x, y)
            _panned(d)
        d.press("Shift+F")
        assert _zoom(d).fits
    assert d.c.session.camera == camera and d.c.history.frames == traced and d.c.preferences.speed == speed
    d.press("Equal", "Equal", "Equal")
    assert np.isclose(_zoom(d).scale, 2.0**1.5)
    d.press("Minus", "Minus", "Minus")
    assert _zoom(d).fits
    _numbers(d)
    _range(d)
    _exposed(d)


def _zoom(d: Driver) -> Zoom:
    return d.c.session.draw.zoom


def _pixel(d: Driver) -> tuple[int, int]:
    """The one under the pointer."""
    return pixel_at(d.c.frame, *d.c.selection.hovered)


def _wheel(d: Driver, notches: int) -> None:
    with d.held("Ctrl"):
        d.context.mouse_wheel_y(notches)


def _crisp(d: Driver, x: int, y: int) -> None:
    """A pixel is a rectangle of its colour, and its neighbours begin where it ends."""
    window, shown, (left, top, right, bottom) = d.window(), picture(d.c.frame), d.picture_edges()
    corner, room, pixels = np.array([left, top]), np.array([right - left, bottom - top]), (320, 240)
    reach = np.floor(room * 64.0 / pixels / 2 - 2).astype(int)
    for dx, dy in ((0, 0), (1, 0), (0, 2), (3, 1)):
        middle = (np.array([x + dx + 0.5, y + dy + 0.5]) / pixels - (_zoom(d).left, _zoom(d).top)) * 64.0
        (x0, y0), (x1, y1) = (corner + middle * room + side * reach for side in (-1, 1))
        if left <= x0 and x1 < right - 1 and top + 40 < y0 and y1 < bottom:
            off = np.abs(window[int(y0) : int(y1), int(x0) : int(x1)].astype(int) - shown[y + dy, x + dx])
            near = off.max(axis=-1) <= 1
            assert near.mean() > (0.9 if (dx, dy) == (0, 0) else 0.999), "not one colour, or another one"  # the pointer


def _panned(d: Driver) -> None:
    """A drag with Ctrl moves the picture along with the pointer, and no camera."""
    before, mouse = d.c.selection.hovered, imgui.get_io().mouse_pos
    with d.held("Ctrl"):
        d.drag((mouse.x, mouse.y), (60.0, 40.0))
    assert np.allclose(d.c.selection.hovered, before, atol=1e-3), "what was under the pointer has not come along"
    assert _zoom(d).scale == 64.0 and d.c.selection.picked is None


def _numbers(d: Driver) -> None:
    """Values are written into pixels that are large enough, in every view that has any."""
    d.point(0.45, 0.55)
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
    d.press("1", "Shift+F").settle()


def _range(d: Driver) -> None:
    """The panel has a histogram of the pixels that are seen, which give the colours their range."""
    d.see(View.DEPTH, zoom=around(0.5, 0.6, 3.0))
    d.show_panel("Pixels")
    columns, rows = pixels_shown(d.c.session.draw.zoom, d.c.frame.width, d.c.frame.height)
    depth = d.c.frame.depth[rows.start : rows.stop, columns.start : columns.stop]
    depth = depth[np.isfinite(depth)]
    d.click("//Pixels/**/Use as the range of colours").press("Shift+F")
    assert np.allclose(d.c.session.draw.span, (depth.min(), depth.max()))
    d.expect_picture()
    d.see(View.COLOR, spans=())


def _exposed(d: Driver) -> None:
    """Exposure by keys, and stripes over what is clipped; neither traces, nor outlives what resets it."""
    traced = d.c.history.frames
    d.press("RightBracket", "RightBracket", "Shift+M")
    assert d.c.session.draw.tone.exposure == 1.0 and d.c.session.draw.clipping
    d.expect_picture(1)
    d.press("LeftBracket", "Shift+M")
    assert d.c.session.draw.tone.exposure == 0.5
    d.choose("Picture/Colours as traced")
    assert d.c.session.draw.tone.neutral and np.array_equal(d.shown(), picture(d.c.frame)), "bit for bit as it was"
    d.press("Ctrl+Z")
    assert d.c.session.draw.tone.exposure == 0.5, "colours as traced can be undone"
    d.press("Ctrl+Shift+Z")
    assert d.c.session.draw.tone.neutral
    assert d.c.history.frames == traced
