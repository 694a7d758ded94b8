"""A model that comes alone, in its studio: dropped, turned, saved and brought back."""

from __future__ import annotations

import trimesh
from imgui_bundle import imgui

from tests.viewer.driver import Driver
from tracer.scene.studio import up_in_studio

KEY = imgui.Key


def standing(d: Driver) -> None:
    """The window shows it upright, a key turns it, a saved picture remembers how it stood, and the studio goes away."""
    d.c.settings.change(lamp_samples=1)  # many rays show nothing more here
    path = d.folder / "rod.ply"
    trimesh.creation.cylinder(0.5, 2.0, sections=16).export(path)
    d.drop(path)
    d.wait(lambda: up_in_studio(d.c.session.scene) is not None, "the model in its studio")
    d.settle()
    assert up_in_studio(d.c.session.scene) == "z" and "with z up" in d.said
    assert d.c.info["bounds"][1][2] - d.c.info["bounds"][0][2] < 2.1  # the model's, not the floor's
    d.press("Ctrl+U")
    d.wait(lambda: up_in_studio(d.c.session.scene) == "x", "the model to lie")
    d.settle()
    assert d.c.session.camera.up == (1.0, 0.0, 0.0)
    d.c.preferences.screenshot_template = "lying.png"
    d.press(KEY.f12)
    d.wait(lambda: not d.c.captures.busy, "the picture to be written")
    studio = next(c for c in d.ui.commands if c.name == "Studio")
    assert studio.checked()
    studio.run()
    d.wait(lambda: up_in_studio(d.c.session.scene) is None, "the model without its studio")
    d.settle()
    assert not studio.checked() and len(d.c.session.scene.lights) == 2
    turn = next(c for c in d.ui.commands if c.name == "Turn the model")
    assert "no model is in a studio" in turn.why_not
    d.drop(d.folder / "pictures" / "lying.png")
    d.wait(lambda: up_in_studio(d.c.session.scene) == "x", "the picture's scene, as it stood")
    d.settle()
    assert studio.checked() and d.c.loader.meshes.studio is False
    d.press("Ctrl+U")
    d.wait(lambda: up_in_studio(d.c.session.scene) == "-y", "the model to lie otherwise")
    d.settle()
    assert d.c.session.camera.up == (0.0, -1.0, 0.0) and not d.c.undo.undoes
