"""Ways to get about: bookmarks, a camera copied and pasted, drags, keys of one's own."""

from __future__ import annotations

import json
import math

import numpy as np
from imgui_bundle import imgui

from tests.viewer.driver import Driver

KEY = imgui.Key
SMALL = (1000, 640)  # still with docked panels, and soon drawn


def navigating(d: Driver) -> None:
    """All of them in turn."""
    d.resize(*SMALL)
    d.settle()
    _bookmarks(d)
    _texts(d)
    _drags(d)
    _keys(d)


def _bookmarks(d: Driver) -> None:
    places = []
    for key in (KEY.d, KEY.w):
        d.hold(key, 0.1)
        d.settle()
        d.press("Ctrl+B")
        d.settle()
        places.append(d.c.session.camera)
    marks = d.c.bookmarks.all
    d.press("Alt+1")
    assert d.c.motion.under_way
    d.wait(lambda: d.c.session.camera == places[0], "the flight to the first bookmark", 30.0)
    d.press("Alt+2")
    d.wait(lambda: d.c.session.camera == places[1], "the flight to the next one", 30.0)
    d.show_panel("Camera")
    d.click(f"//Camera/**/{id(marks[1])}/\uf304")
    d.type("near the sphere")
    d.press(KEY.enter)
    assert marks[1].name == "near the sphere"
    rows = [d.context.item_info(f"//Camera/**/{id(mark)}/###go").rect_full for mark in marks]
    d.drag((rows[1].min.x + 9.0, rows[1].min.y + 5.0), (0.0, rows[0].min.y - rows[1].min.y))
    d.frames(3)
    assert [mark.name for mark in d.c.bookmarks.all] == ["near the sphere", "frame 0"]
    d.click(f"//Camera/**/{id(marks[1])}/\uf00d")
    assert [mark.name for mark in d.c.bookmarks.all] == ["near the sphere"]
    d.settle()


def _texts(d: Driver) -> None:
    camera = d.c.session.camera
    d.press("Ctrl+Shift+C")
    assert json.loads(imgui.get_clipboard_text()) == camera.to_json()
    d.press(KEY.r)
    d.press("Ctrl+Shift+V")
    d.wait(lambda: not d.c.motion.under_way, "the flight to what was pasted", 30.0)
    now = d.c.session.camera
    assert math.dist(now.position, camera.position) < 1e-6 and abs(now.angle - camera.angle) < 1e-6
    assert np.allclose(now.basis(), camera.basis(), atol=1e-6)
    imgui.set_clipboard_text("no camera")
    d.press("Ctrl+Shift+V")
    assert d.c.notices.message.error and d.c.session.camera == now
    d.settle()


def _drags(d: Driver) -> None:
    d.press(KEY.o)
    before = d.c.session.camera
    d.drag(d.picture_centre(), (80.0, 0.0))
    pivot, after = d.ui.picture.pivot, d.c.session.camera
    assert math.isclose(math.dist(after.position, pivot), math.dist(before.position, pivot), rel_tol=1e-6)
    assert math.dist(after.position, before.position) > 0.1, "the left button orbits"
    d.drag(d.picture_centre(), (40.0, 0.0), 2)
    assert np.allclose(d.c.session.camera.direction, after.direction) and d.c.session.camera != after, "pans"
    before = d.c.session.camera
    d.context.mouse_wheel_y(2.0)
    d.wait(lambda: d.c.session.camera != before, "the wheel")
    after, pivot = d.c.session.camera, d.ui.picture.pivot  # that under the pointer, in the frame that was there then
    assert math.dist(after.position, pivot) < math.dist(before.position, pivot), "the wheel goes nearer"
    d.settle()
    d.press(KEY.f)
    d.wait(lambda: not d.c.motion.under_way, "the way of the focus", 30.0)
    to_pivot = np.subtract(d.ui.picture.pivot, d.c.session.camera.position)
    assert d.c.session.camera.basis()[2] @ to_pivot / np.linalg.norm(to_pivot) > 0.9999
    d.press(KEY.g)
    d.settle()


def _keys(d: Driver) -> None:
    d.press(KEY.f1)
    d.frames(3)
    d.click("//Keyboard and mouse/**/Fly forward/W##key")
    assert d.ui.keyboard.wanted_for == "Fly forward"
    before = d.c.session.camera
    d.press(KEY.x)
    d.frames(2)
    assert d.ui.keymap.of("Fly forward") == ("X",) and d.c.session.camera == before
    d.click("//Keyboard and mouse/**/Fly back/S##key")
    d.press(KEY.o)
    d.frames(2)
    assert d.ui.keymap.conflicts()["Fly back"] == ["Orbit"] and "also Orbit" in d.said
    assert d.c.preferences.navigation == "fly", "a key that was chosen did what it does"
    del d.c.preferences.keys["Fly back"]
    d.press(KEY.f1)
    d.hold(KEY.w, 0.1)
    assert d.c.session.camera == before
    d.hold(KEY.x, 0.1)
    assert (np.subtract(d.c.session.camera.position, before.position) @ before.basis()[2]) > 0.0
    d.c.preferences.keys.clear()
    d.settle()
