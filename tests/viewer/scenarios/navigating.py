"""Ways to get about: bookmarks, a camera copied and pasted, drags, keys of one's own."""

from __future__ import annotations

import json
import math
from unittest import mock

import numpy as np
from imgui_bundle import imgui

from tests.viewer.driver import Driver


def navigating(d: Driver) -> None:
    """All of them in turn."""
    _bookmarks(d)
    _texts(d)
    _drags(d)
    _keys(d)


def _bookmarks(d: Driver) -> None:
    places = []
    for key in ("D", "W"):
        d.hold(key, 0.1).settle().press("Ctrl+B").settle()
        places.append(d.c.session.camera)
    marks = d.c.bookmarks.all
    d.press("Alt+1")
    assert d.c.motion.under_way
    d.settle()
    assert d.c.session.camera == places[0]
    d.press("Alt+2").settle()
    assert d.c.session.camera == places[1]
    d.show_panel("Camera").click(f"//Camera/**/{id(marks[1])}/\uf304").type("near the sphere").press("Enter")
    assert marks[1].name == "near the sphere"
    (x, first), (_, second) = (d.middle(f"//Camera/**/{id(mark)}/###go") for mark in marks)
    d.drag((x, second), (0.0, first - second))
    assert [mark.name for mark in d.c.bookmarks.all] == ["near the sphere", "frame 0"]
    d.click(f"//Camera/**/{id(marks[1])}/\uf00d")
    assert [mark.name for mark in d.c.bookmarks.all] == ["near the sphere"]


def _texts(d: Driver) -> None:
    """The clipboard is one of the test's own: that of the screen is shared by all windows that are tested."""
    clipboard = [""]
    copy, paste = lambda text: clipboard.__setitem__(0, text), lambda: clipboard[0]
    with mock.patch.multiple(imgui, set_clipboard_text=copy, get_clipboard_text=paste):
        d.settle().press("Ctrl+Shift+C")
        camera = d.c.session.camera
        assert json.loads(clipboard[0]) == camera.to_json()
        d.press("R", "Ctrl+Shift+V").settle()
        now = d.c.session.camera
        assert math.dist(now.position, camera.position) < 1e-6 and abs(now.angle - camera.angle) < 1e-6
        assert np.allclose(now.basis(), camera.basis(), atol=1e-6)
        clipboard[0] = "no camera"
        d.press("Ctrl+Shift+V")
        assert d.c.notices.message.error and d.c.session.camera == now


def _drags(d: Driver) -> None:
    d.press("O")
    before = d.c.session.camera
    d.drag(d.on_picture(0.5, 0.5), (80.0, 0.0))
    pivot, after = d.ui.picture.pivot, d.c.session.camera
    assert math.isclose(math.dist(after.position, pivot), math.dist(before.position, pivot), rel_tol=1e-6)
    assert math.dist(after.position, before.position) > 0.1, "the left button orbits"
    d.drag(d.on_picture(0.5, 0.5), (40.0, 0.0), 2)
    assert np.allclose(d.c.session.camera.direction, after.direction) and d.c.session.camera != after, "pans"
    before = d.c.session.camera
    d.context.mouse_wheel_y(2.0)
    d.wait(lambda: d.c.session.camera != before, "the wheel")
    after, pivot = d.c.session.camera, d.ui.picture.pivot  # that under the pointer, in the frame that was there then
    assert math.dist(after.position, pivot) < math.dist(before.position, pivot), "the wheel goes nearer"
    d.settle().press("F").settle()
    to_pivot = np.subtract(d.ui.picture.pivot, d.c.session.camera.position)
    assert d.c.session.camera.basis()[2] @ to_pivot / np.linalg.norm(to_pivot) > 0.9999
    d.press("G").settle()


def _keys(d: Driver) -> None:
    d.press("F1").click("//Keyboard and mouse/**/Fly forward/W##key")
    assert d.ui.keyboard.wanted_for == "Fly forward"
    before = d.c.session.camera
    d.press("X")
    assert d.ui.keymap.of("Fly forward") == ("X",) and d.c.session.camera == before
    d.click("//Keyboard and mouse/**/Fly back/S##key").press("O")
    assert d.ui.keymap.conflicts()["Fly back"] == ["Orbit"] and "also Orbit" in d.said
    assert d.c.preferences.navigation == "fly", "a key that was chosen did what it does"
    del d.c.preferences.keys["Fly back"]
    d.press("F1").hold("W", 0.1)
    assert d.c.session.camera == before
    d.hold("X", 0.1)
    assert (np.subtract(d.c.session.camera.position, before.position) @ before.basis()[2]) > 0.0
