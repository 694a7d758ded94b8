"""What moves: the camera by keys and pointer, time, and the window's size."""

from __future__ import annotations

import glfw
import numpy as np
from imgui_bundle import glfw_utils, imgui

from tests.viewer.driver import Driver
from viewer.window.panels.named_states import NameFields


def flying(d: Driver) -> None:
    """Keys and drags on the picture move the camera; typing and drags on panels do not."""
    home = d.c.session.camera
    d.hold("W", 0.3)
    ahead = d.c.session.camera
    assert np.dot(np.subtract(ahead.position, home.position), home.basis()[2]) > 0.0
    assert ahead.basis()[2] @ home.basis()[2] > 0.999
    d.settle()
    assert (d.c.frame.width, d.c.frame.height) == d.c.scheduler.inputs.size, "at idle the resolution is the window's"
    assert d.c.traced.request.divisor == 1 and d.c.traced.whole

    before = d.c.session.camera
    d.drag(d.on_picture(0.5, 0.5), (80.0, 0.0))
    assert d.c.session.camera.position == before.position
    assert d.c.session.camera.basis()[2] @ before.basis()[0] > 0.05, "dragging right looks right"
    d.drag(d.on_picture(0.5, 0.5), (-80.0, 0.0), 1)

    before = d.c.session.camera
    panel = d.panel("Inspector")
    d.drag((panel.pos.x + 60.0, panel.pos.y + panel.size.y - 20.0), (50.0, -30.0))
    assert d.c.session.camera == before, "a drag on a panel moved the camera"

    with d.held("Ctrl"):
        d.context.key_down(imgui.Key.w)
        d.frames(3)
    d.context.key_up(imgui.Key.w)
    assert d.c.session.camera == before, "a key of a chord, let go late, moved the camera"

    d.show_panel("Camera").click("//Camera/##new bookmark").type("wasd")
    assert d.ui.state(NameFields).new["bookmark"] == "wasd"
    assert d.c.session.camera == before, "typing moved the camera"
    d.press("Enter")
    assert d.c.bookmarks.all[0].name == "wasd"
    d.pick()
    assert d.c.selection.picked is not None and d.c.session.camera == before, "a click only inspects"

    d.press("R")
    assert d.c.session.on_path
    d.settle()
    assert d.c.session.camera == home, "the scene's own"


def playing(d: Driver) -> None:
    """Play, pause, step and scrub; every frame is traced in full where that was asked for."""
    d.press("Space")
    assert d.c.session.playing
    d.wait(lambda: d.c.session.time > 0.3, "time to pass")
    d.press("Space")
    assert not d.c.session.playing
    d.settle()
    assert d.c.frame.time == d.c.session.time
    frame = d.c.session.frame
    d.press("RightArrow")
    assert d.c.session.frame == frame + 1
    d.press("LeftArrow", "Home")
    assert d.c.session.frame == 0
    d.c.session.set_pace(every_frame=True)
    d.c.preferences.loop = False
    d.settle()
    d.c.history.clear()
    d.press("Space").settle()
    assert d.c.session.frame == d.c.session.scene.frames - 1
    assert d.c.history.frames >= d.c.session.scene.frames - 1
    assert len(set(d.c.history.values("pixels"))) == 1, "all in full resolution"


def resizing(d: Driver) -> None:
    """The picture follows the window, keeps a fixed resolution's aspect, and rests while minimised."""
    window = glfw_utils.glfw_window_hello_imgui()
    for size in ((1300, 900), (640, 400), (200, 120), (1000, 700)):
        glfw.set_window_size(window, *size)
        d.frames(4).settle()
        if min(d.c.scheduler.inputs.size) > 0:
            assert (d.c.frame.width, d.c.frame.height) == d.c.scheduler.inputs.size
    d.fix_resolution(120, 90)
    d.settle()
    assert (d.c.frame.width, d.c.frame.height) == (120, 90)
    d.app._room_for_picture = lambda: (0, 0)  # as while minimised; without a window manager nothing minimises
    d.frames(3)
    traced = d.c.history.frames
    d.press("T").frames(3)
    assert d.c.history.frames == traced, "a window that cannot be seen is traced for"
    del d.app._room_for_picture
    d.settle()
    assert d.c.history.frames == traced + 1
