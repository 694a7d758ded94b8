"""What moves: the camera by keys and pointer, time, and the window's size."""

from __future__ import annotations

import math

import glfw
import numpy as np
from imgui_bundle import glfw_utils, imgui

from tests.viewer.driver import Driver
from viewer.window.panels.named_states import NameFields

KEY = imgui.Key


def flying(d: Driver) -> None:
    """Keys and drags on the picture move the camera; typing and drags on panels do not."""
    d.settle()
    home = d.c.session.camera
    d.hold(KEY.w, 0.3)
    ahead = d.c.session.camera
    assert np.dot(np.subtract(ahead.position, home.position), home.basis()[2]) > 0.0
    assert ahead.basis()[2] @ home.basis()[2] > 0.999
    d.settle()
    assert (d.c.frame.width, d.c.frame.height) == d.c.scheduler.inputs.size, "at idle the resolution is the window's"
    assert d.c.traced.request.divisor == 1 and d.c.traced.whole

    before = d.c.session.camera
    d.drag(d.picture_centre(), (80.0, 0.0))
    assert d.c.session.camera.position == before.position
    assert d.c.session.camera.basis()[2] @ before.basis()[0] > 0.05, "dragging right looks right"
    d.drag(d.picture_centre(), (-80.0, 0.0), 1)

    before = d.c.session.camera
    panel = imgui.internal.find_window_by_name("Statistics")
    d.drag((panel.pos.x + 60.0, panel.pos.y + panel.size.y - 20.0), (50.0, -30.0))
    assert d.c.session.camera == before, "a drag on a panel moved the camera"

    for change, key in (("down", KEY.mod_ctrl), ("down", KEY.w), ("up", KEY.mod_ctrl), ("up", KEY.w)):
        getattr(d.context, f"key_{change}")(key)
        d.frames(3)
    assert d.c.session.camera == before, "a key of a chord, let go late, moved the camera"

    d.show_panel("Camera")
    d.click("//Camera/##new bookmark")
    d.type("wasd")
    assert d.ui.state(NameFields).new["bookmark"] == "wasd"
    assert d.c.session.camera == before, "typing moved the camera"
    d.press(KEY.enter)
    assert d.c.bookmarks.all[0].name == "wasd"
    d.pick(0.5, 0.5)
    assert d.c.selection.picked is not None and d.c.session.camera == before, "a click only inspects"

    d.press(KEY.r)
    assert d.c.session.on_path
    d.wait(lambda: d.c.session.camera == home, "the scene's own camera")
    d.c.go_to_bookmark(0)
    d.wait(lambda: not d.c.motion.under_way, "the glide to the bookmark")
    assert math.dist(d.c.session.camera.position, before.position) < 1e-9
    d.settle()


def playing(d: Driver) -> None:
    """Play, pause, step and scrub; every frame is traced in full where that was asked for."""
    d.settle()
    d.press(KEY.space)
    assert d.c.session.playing
    d.wait(lambda: d.c.session.time > 0.3, "time to pass")
    d.press(KEY.space)
    assert not d.c.session.playing
    d.settle()
    assert d.c.frame.time == d.c.session.time
    frame = d.c.session.frame
    d.press(KEY.right_arrow)
    assert d.c.session.frame == frame + 1
    d.press(KEY.left_arrow)
    d.press(KEY.home)
    assert d.c.session.frame == 0
    d.c.session.set_pace(every_frame=True)
    d.c.preferences.loop = False
    d.settle()
    d.c.history.clear()
    d.press(KEY.space)
    d.wait(lambda: not d.c.session.playing, "the last frame")
    d.settle()
    assert d.c.session.frame == d.c.session.scene.frames - 1
    assert d.c.history.frames >= d.c.session.scene.frames - 1
    assert len(set(d.c.history.values("pixels"))) == 1, "all in full resolution"


def resizing(d: Driver) -> None:
    """The picture follows the window, keeps a fixed resolution's aspect, and rests while minimised."""
    d.settle()
    window = glfw_utils.glfw_window_hello_imgui()
    for size in ((1300, 900), (640, 400), (200, 120), (1000, 700)):
        glfw.set_window_size(window, *size)
        d.frames(4)
        d.settle()
        if min(d.c.scheduler.inputs.size) > 0:
            assert (d.c.frame.width, d.c.frame.height) == d.c.scheduler.inputs.size
    d.fix_resolution(120, 90)
    d.settle()
    assert (d.c.frame.width, d.c.frame.height) == (120, 90)
    d.app._room_for_picture = lambda: (0, 0)  # as while minimised; without a window manager nothing minimises
    d.frames(3)
    traced = d.c.history.frames
    d.press(KEY.t)
    d.frames(5)
    assert d.c.history.frames == traced, "a window that cannot be seen is traced for"
    del d.app._room_for_picture
    d.settle()
    assert d.c.history.frames == traced + 1
