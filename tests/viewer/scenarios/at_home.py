"""What makes the window a place to work in: the command palette, undo, presets, the log, scenes that change."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
from imgui_bundle import imgui

from tests.viewer.driver import Driver
from viewer.state.views import View
from viewer.window.menus import ANY_POPUP
from viewer.window.panels.command_palette import Finder
from viewer.window.panels.named_states import NameFields

PEN = "\uf304"


def at_home(d: Driver) -> None:
    """One thing after another, as somebody would who settles in."""
    _palette(d)
    _undo(d)
    _presets(d)
    _log(d)
    _reloading(d)


def _palette(d: Driver) -> None:
    find(d, "occlusion m")
    assert imgui.is_popup_open("", ANY_POPUP)
    before = d.c.session.camera
    d.press("Enter")
    assert d.c.session.draw.view is View.OCCLUSION and not imgui.is_popup_open("", ANY_POPUP)
    assert d.c.session.camera == before, "letters that were typed flew"
    find(d, "bounces").press("Enter")
    for typed, depth in (("500", 10), ("7", 7)):
        d.type(typed).press("Enter")
        assert d.c.session.settings.depth == depth
        assert imgui.is_popup_open("", ANY_POPUP) == (typed == "500")
    find(d, "redo").press("Enter")
    assert imgui.is_popup_open("", ANY_POPUP) and "nothing to redo" in d.ui.state(Finder).problem
    d.press("Escape")
    assert not imgui.is_popup_open("", ANY_POPUP)
    d.press("Ctrl+Shift+P")
    assert [item.name for item in d.ui.state(Finder).found[:2]] == ["setting Bounces", "Occlusion mode"]
    d.press("DownArrow", "UpArrow", "DownArrow")
    assert d.ui.state(Finder).aimed.name == "Occlusion mode"
    d.press("Escape")


def find(d: Driver, typed: str) -> Driver:
    """Open the palette and type."""
    return d.press("Ctrl+Shift+P").type(typed)


def _undo(d: Driver) -> None:
    home = d.c.session.camera
    d.hold("D", 0.1)
    d.drag(d.on_picture(0.7, 0.4), (60.0, 10.0)).settle()  # beside the legend, which can be dragged as well
    shading = d.c.session.draw.shading
    d.drag(d.middle("//View/**/##shading"), (40.0, 0.0))
    assert d.c.session.draw.shading != shading and d.c.undo.undoes.startswith("shading")
    d.choose("Edit/###Undo")
    assert d.c.session.draw.shading == shading, "a drag is one step"
    assert d.said.startswith("undone: shading") and d.c.undo.undoes == "camera"
    while d.c.undo.undoes == "camera":  # several where the machine is slow: the camera rests between them
        d.press("Ctrl+Z")
    d.settle()
    assert d.c.session.camera == home
    d.press("Ctrl+Y")
    assert d.c.undo.undoes == "camera"
    d.press("Ctrl+Z", "Ctrl+Z", "Ctrl+Z").settle()
    assert d.c.session.settings.depth == 10 and d.c.session.draw.view is View.COLOR and not d.c.undo.undoes
    d.press("Ctrl+Shift+Z")
    assert d.c.session.draw.view is View.OCCLUSION
    d.settle()


def _presets(d: Driver) -> None:
    d.choose("Edit/Presets/Presets...")
    d.click("//Presets/##new preset").type("mine").press("Enter")
    assert [preset.name for preset in d.c.presets.all] == ["mine"]
    kept = d.c.session.settings
    d.click("//Presets/As in the paper").settle()
    assert d.c.session.settings.method == "paper" and (d.c.frame.width, d.c.frame.height) == (512, 512)
    d.c.history.clear()
    d.c.session.playing = True
    d.wait(lambda: d.c.history.frames > 4, "some frames of the animation")
    d.c.session.playing = False
    d.settle()
    assert (d.c.history.values("pixels") == 512 * 512).all(), "each is traced in full, and learns from the one before"
    assert (d.c.history.values("culled") + d.c.history.values("dynamic_only") > 0)[1:].all()
    d.click(f"//Presets/**/{PEN}").type("ours").press("Enter")
    assert d.c.presets.all[0].name == "ours" and d.ui.state(NameFields).place is None
    d.press("Escape")
    assert not d.ui.dialogs
    d.choose("Edit/Presets/###preset ours").settle()
    assert d.c.session.settings == kept and d.c.undo.undoes == "preset ours"


def _log(d: Driver) -> None:
    d.show_panel("Plots")
    d.c.notices.mark_read()
    d.c.notices.say("this could not be done", error=True)
    d.frames(2)
    assert len(d.c.notices.unread) == 1
    d.show_panel("Log")
    assert not d.c.notices.unread, "seen"


def _reloading(d: Driver) -> None:
    scene, path = d.c.session.scene, Path(d.c.session.scene.path)
    d.hold("D", 0.1).settle()
    here, picture = d.c.session.state, d.shown()
    good = path.read_text()
    _write(path, good.replace("l 3 5 4", "l -6 5 4"))
    d.wait(lambda: d.c.session.scene is not scene, "the scene that has changed", 30.0)
    assert d.ui.graphics.display.texture_id is not None
    d.settle()
    assert d.c.session.state == here and d.said.endswith("tiny.aff changed")
    assert np.abs(d.shown().astype(int) - picture).max() > 20, "another picture"
    scene = d.c.session.scene
    _write(path, good + "\np 3\n0 0\n")
    d.wait(lambda: "tiny.aff:" in d.said, "the broken scene to be told of", 30.0)
    d.frames(2)
    assert d.c.session.scene is scene


def _write(path: Path, text: str) -> None:
    """Another time as well, however coarse the disk's clock is."""
    before = path.stat().st_mtime_ns
    path.write_text(text)
    os.utime(path, ns=(before + 10**9, before + 10**9))
