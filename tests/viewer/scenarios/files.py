"""What is opened and saved: by dropping, from saved pictures, and by the dialog."""

from __future__ import annotations

import json
from pathlib import Path

import glfw
import numpy as np
from imgui_bundle import glfw_utils, imgui
from PIL import Image

from tests.viewer.driver import Driver
from tests.viewer.scenarios.studios import standing
from viewer.state.methods import missing
from viewer.state.views import View
from viewer.util.resources import embedded_scenes
from viewer.window.panels.dialogs import OPEN, OpenFileState

KEY = imgui.Key


def capturing(d: Driver) -> None:
    """Pictures with and without panels; dropping one brings everything back."""
    pictures = d.folder / "pictures"
    d.settle()
    d.press(KEY._2)
    d.hold(KEY.d, 0.2)
    d.press(KEY.c)
    d.settle()
    d.c.preferences.screenshot_template = "{scene}-{view}-{frame:04d}.png"
    for key in (KEY.f12, "Shift+F12"):  # the picture, and the window
        d.press(key)
        d.settle()
    files = sorted(p.name for p in pictures.iterdir())
    assert files == ["tiny-occlusion-0000-2.png", "tiny-occlusion-0000.png"]
    with Image.open(pictures / files[1]) as alone, Image.open(pictures / files[0]) as window:
        assert alone.size == (d.c.frame.width, d.c.frame.height)
        assert window.size == tuple(glfw.get_framebuffer_size(glfw_utils.glfw_window_hello_imgui()))
        assert np.array_equal(np.asarray(alone), d.shown())
        data = json.loads(alone.text["shadowcull"])
    assert data["statistics"]["shadow"]["due"] == d.c.frame.statistics.shadow.due
    camera = d.c.session.camera
    for key in (KEY.c, KEY._1, KEY.r):
        d.press(key)
    d.settle()
    assert d.c.session.camera != camera
    d.drop(pictures / files[1])
    assert d.c.session.camera == camera
    assert d.c.session.draw.view is View.OCCLUSION and d.c.session.settings.method == "none"
    (d.folder / "file").write_text("")
    d.c.preferences.screenshot_folder, d.c.preferences.screenshot_template = str(d.folder / "file"), "a.png"
    d.press(KEY.f12)
    d.settle()
    assert d.c.notices.message.error and "cannot write" in d.said
    d.settle()


def dropping(d: Driver) -> None:
    """Scenes open; whatever is none is one line, and the open scene stays."""
    d.settle()
    scene = d.c.session.scene
    bad, text, fake = (d.folder / name for name in ("bad.aff", "notes.txt", "fake.png"))
    for path, content in ((bad, "l 1 2\nf 1 1\np 3\n0 0 zero\n"), (text, "hello"), (fake, "no picture")):
        path.write_text(content)
    for path in (bad, text, fake, d.folder / "gone.aff", d.folder):
        d.c.notices.message = None
        d.drop(path)
        d.settle()
        assert d.c.notices.message is not None and d.c.notices.message.error, f"{path} was not refused"
        assert path.name in d.said and "\n" not in d.said
        assert d.c.session.scene is scene
    lights = "\n".join(f"l {i} 5 3 0.1 0.1 0.1" for i in range(40))
    many = d.folder / "many.aff"
    many.write_text(Path(scene.path).read_text() + lights)
    d.drop(many, text)
    d.settle()
    assert len(d.c.session.scene.lights) == 42
    dark = d.folder / "dark.nff"
    dark.write_text(
        "v\nfrom 0 0 5\nat 0 0 0\nup 0 1 0\nangle 40\nhither 0.1\nresolution 8 8\nf 1 0 0 1 0 1 0 1\ns 0 0 0 1\n"
    )
    d.c.session.set_draw(view=View.SHADOW)
    d.c.settings.set_light(35)
    d.open(dark)
    assert missing(View.SHADOW, d.c.frame).text == "The scene has no lights."
    d.press(KEY._3)
    assert d.c.frame.primitive.max() >= 0
    d.press(KEY._1)
    standing(d)


def reopening(d: Driver) -> None:
    """A picture saved in a view that needs more of a frame opens over another scene; so do the keys of such views."""
    d.c.preferences.screenshot_template = "{view}.png"
    d.settle()
    first = Path(d.c.session.scene.path)
    for key in ("H", "Shift+H", "8", "9"):
        d.press(key)
        d.settle()
        d.press(KEY.f12)
        d.settle()
    d.press(KEY._1)
    take = d.c.renderer.take
    for view in (View.SAVED, View.COST, View.DIFFERENCE, View.WIPE):
        d.open(embedded_scenes()["figure4"])
        d.see(View.COLOR)
        d.c.renderer.take = lambda: None  # the first frame of the scene is long in coming
        d.drop(d.folder / "pictures" / f"{view}.png")
        d.wait(lambda: d.c.session.scene.path == first, "the picture's scene")
        assert d.c.session.draw.view is view and d.c.frame is None
        for key in ("8", "9", "H", "Shift+H", "0", "3", view.key):
            d.press(key)
        d.press(KEY.f12)
        d.c.notices.say("what could not be saved has been told")
        d.c.renderer.take = take
        d.settle()
        assert d.c.scheduler.drawn_view is view
        d.expect_picture()


def cancelling(d: Driver) -> None:
    """A load that is cancelled leaves the open scene as it is."""
    d.settle()
    scene, frame = d.c.session.scene, d.c.frame
    d.drop(d.folder / "big.aff")
    assert d.c.loader.load_job is not None
    d.press(KEY.escape)
    d.wait(lambda: d.c.loader.load_job is None, "the load to stop", 20.0)
    d.frames(3)
    assert d.c.session.scene is scene and d.c.frame is frame
    assert "cancelled" in d.said


def browsing(d: Driver) -> None:
    """The dialog that opens a file, with the keyboard alone and then with the pointer."""
    d.settle()
    box = d.folder / "box"
    (box / "inner").mkdir(parents=True)
    scene = Path(d.c.session.scene.path).read_text()
    for name in ("whole.aff", "inner/deep.aff"):
        (box / name).write_text(scene)
    (box / "wheel.aff").write_text("f 1 0 0 1 0 1 0 1\ns 0 0 0 1\n")
    Image.new("RGB", (8, 8)).save(box / "plot.png")
    state = d.ui.state(OpenFileState)
    state.folder = d.folder

    d.press("Ctrl+O")
    d.frames(2)
    d.type("bo")
    d.press(KEY.tab)
    names = ("inner/", "plot.png", "wheel.aff", "whole.aff")
    assert state.typed == "box/" and state.found == [f"box/{name}" for name in names]
    d.type("who")
    assert state.found == ["box/whole.aff"]
    d.press(KEY.tab)
    d.press(KEY.enter)
    assert not d.ui.dialogs and state.folder == box
    d.settle()
    assert d.c.session.scene.path.name == "whole.aff"

    # What cannot be opened is refused where it was asked for.
    d.press("Ctrl+O")
    d.frames(2)
    d.type("gone.aff")
    d.press(KEY.enter)
    assert d.ui.dialogs and "no such file" in state.problem
    d.frames(2)
    d.press("Ctrl+A")
    d.type("inner")
    assert not state.problem
    d.press(KEY.enter)
    assert d.ui.dialogs and state.folder == box / "inner" and state.typed == ""
    d.frames(2)

    d.type("deep.aff")
    d.click(f"//{OPEN}/Open")
    assert not d.ui.dialogs
    d.settle()
    assert d.c.session.scene.path.name == "deep.aff"
