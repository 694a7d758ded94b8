"""What is opened and saved: by dropping, from saved pictures, and by the dialog; and a model that comes alone."""

from __future__ import annotations

import json
from pathlib import Path

import glfw
import numpy as np
import trimesh
from imgui_bundle import glfw_utils
from PIL import Image

from tests.viewer.driver import Driver
from tracer.scene.studio import up_in_studio
from viewer.state.methods import missing
from viewer.state.views import View
from viewer.util.resources import embedded_scenes
from viewer.window.panels.dialogs import OPEN, OpenFileState


def capturing(d: Driver) -> None:
    """Pictures with and without panels; dropping one brings everything back."""
    d.press("2").hold("D", 0.2).press("C").settle()
    d.c.preferences.screenshot_template = "{scene}-{view}-{frame:04d}.png"
    for key in ("F12", "Shift+F12"):  # the picture, and the window
        d.press(key).settle()
    files = sorted(p.name for p in d.pictures.iterdir())
    assert files == ["tiny-occlusion-0000-2.png", "tiny-occlusion-0000.png"]
    with Image.open(d.pictures / files[1]) as alone, Image.open(d.pictures / files[0]) as window:
        assert alone.size == (d.c.frame.width, d.c.frame.height)
        assert window.size == tuple(glfw.get_framebuffer_size(glfw_utils.glfw_window_hello_imgui()))
        assert np.array_equal(np.asarray(alone), d.shown())
        data = json.loads(alone.text["shadowcull"])
    assert data["statistics"]["shadow"]["due"] == d.c.frame.statistics.shadow.due
    camera = d.c.session.camera
    d.press("C", "1", "R").settle()
    assert d.c.session.camera != camera
    d.drop(d.pictures / files[1])
    assert d.c.session.camera == camera
    assert d.c.session.draw.view is View.OCCLUSION and d.c.session.settings.method == "none"
    (d.folder / "file").write_text("")
    d.c.preferences.screenshot_folder, d.c.preferences.screenshot_template = str(d.folder / "file"), "a.png"
    d.press("F12").settle()
    assert d.c.notices.message.error and "cannot write" in d.said


def dropping(d: Driver) -> None:
    """Scenes open; whatever is none is one line, and the open scene stays, as it does when a load is cancelled."""
    scene, frame = d.c.session.scene, d.c.frame
    d.drop(d.folder / "big.aff")
    assert d.c.loader.load_job is not None
    d.press("Escape").settle()
    assert d.c.session.scene is scene and d.c.frame is frame and "cancelled" in d.said
    bad, text, fake = (d.folder / name for name in ("bad.aff", "notes.txt", "fake.png"))
    for path, content in ((bad, "l 1 2\nf 1 1\np 3\n0 0 zero\n"), (text, "hello"), (fake, "no picture")):
        path.write_text(content)
    for path in (bad, text, fake, d.folder / "gone.aff", d.folder):
        d.c.notices.message = None
        d.drop(path).settle()
        assert d.c.notices.message is not None and d.c.notices.message.error, f"{path} was not refused"
        assert path.name in d.said and "\n" not in d.said
        assert d.c.session.scene is scene
    lights = "\n".join(f"l {i} 5 3 0.1 0.1 0.1" for i in range(12))
    many = d.folder / "many.aff"
    many.write_text(Path(scene.path).read_text() + lights)
    d.drop(many, text).settle()
    assert len(d.c.session.scene.lights) == 14
    dark = d.folder / "dark.nff"
    dark.write_text(
        "v\nfrom 0 0 5\nat 0 0 0\nup 0 1 0\nangle 40\nhither 0.1\nresolution 8 8\nf 1 0 0 1 0 1 0 1\ns 0 0 0 1\n"
    )
    d.c.session.set_draw(view=View.SHADOW)
    d.c.settings.set_light(13)
    d.open(dark)
    assert missing(View.SHADOW, d.c.frame).text == "The scene has no lights."
    d.press("3")
    assert d.c.frame.primitive.max() >= 0
    d.press("1")
    _model(d)


def _model(d: Driver) -> None:
    """It stands upright in its studio, a key turns it, a saved picture remembers how it stood, and the studio goes."""
    d.c.settings.change(lamp_samples=1)  # many rays show nothing more here
    trimesh.creation.cylinder(0.5, 2.0, sections=16).export(d.folder / "rod.ply")
    studio = d.command("Studio")

    def standing() -> str | None:
        return up_in_studio(d.settle().c.session.scene)

    d.open(d.folder / "rod.ply")
    assert standing() == "z" and "with z up" in d.said
    assert d.c.info["bounds"][1][2] - d.c.info["bounds"][0][2] < 2.1  # the model's, not the floor's
    d.press("Ctrl+U")
    assert standing() == "x" and d.c.session.camera.up == (1.0, 0.0, 0.0)
    d.saved("lying.png")
    assert studio.checked()
    studio.run()
    assert standing() is None and not studio.checked() and len(d.c.session.scene.lights) == 2
    assert "no model is in a studio" in d.command("Turn the model").why_not
    d.drop(d.pictures / "lying.png")
    assert standing() == "x" and studio.checked() and d.c.loader.meshes.studio is False
    d.press("Ctrl+U")
    assert standing() == "-y" and d.c.session.camera.up == (0.0, -1.0, 0.0) and not d.c.undo.undoes


def reopening(d: Driver) -> None:
    """A picture saved in a view that needs more of a frame opens over another scene; so do the keys of such views."""
    d.c.preferences.screenshot_template = "{view}.png"
    first = Path(d.c.session.scene.path)
    for key in ("H", "Shift+H", "8", "9"):
        d.press(key).settle().press("F12").settle()
    d.press("1")
    take = d.c.renderer.take
    for view in (View.SAVED, View.COST, View.DIFFERENCE, View.WIPE):
        d.open(embedded_scenes()["figure4"])
        d.see(View.COLOR)
        d.c.renderer.take = lambda: None  # the first frame of the scene is long in coming
        d.drop(d.pictures / f"{view}.png").wait(lambda: d.c.session.scene.path == first, "the picture's scene")
        assert d.c.session.draw.view is view and d.c.frame is None
        d.press("8", "9", "H", "Shift+H", "0", "3", view.key, "F12")
        d.c.notices.say("what could not be saved has been told")
        d.c.renderer.take = take
        d.settle()
        assert d.c.scheduler.drawn_view is view
        d.expect_picture()


def browsing(d: Driver) -> None:
    """The dialog that opens a file, with the keyboard alone and then with the pointer."""
    box = d.folder / "box"
    (box / "inner").mkdir(parents=True)
    scene = Path(d.c.session.scene.path).read_text()
    for name in ("whole.aff", "inner/deep.aff"):
        (box / name).write_text(scene)
    state = d.ui.state(OpenFileState)
    state.folder = d.folder

    d.press("Ctrl+O").type("bo").press("Tab")
    assert state.typed == "box/" and state.found == ["box/inner/", "box/whole.aff"]
    d.type("who")
    assert state.found == ["box/whole.aff"]
    d.press("Tab", "Enter")
    assert not d.ui.dialogs and state.folder == box
    d.settle()
    assert d.c.session.scene.path.name == "whole.aff"

    # What cannot be opened is refused where it was asked for.
    d.press("Ctrl+O").type("gone.aff").press("Enter")
    assert d.ui.dialogs and "no such file" in state.problem
    d.press("Ctrl+A").type("inner")
    assert not state.problem
    d.press("Enter")
    assert d.ui.dialogs and state.folder == box / "inner" and state.typed == ""
    d.type("deep.aff").click(f"//{OPEN}/**/deep.aff")
    assert not d.ui.dialogs
    d.settle()
    assert d.c.session.scene.path.name == "deep.aff"
