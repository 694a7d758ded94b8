"""What if: a light off and elsewhere, an object hidden; it is compared with what was, and undo brings all back."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
from imgui_bundle import imgui
from PIL import Image

from tests.viewer.driver import Driver
from viewer.state.comparison import CompareMode
from viewer.window.panels.what_if import marks_of

KEY = imgui.Key
UNDO = int(imgui.Key.z) | int(imgui.Key.mod_ctrl)


def look(d: Driver, name: str) -> None:
    """Keep a picture of the window where somebody wants to see it."""
    folder = os.environ.get("SHADOWCULL_LOOK")
    if folder:
        Image.fromarray(d.window()).save(Path(folder) / f"{name}.png")


def what_if(d: Driver) -> None:
    """Edits by the panel and by the hand on a light; each is a step of undo."""
    d.settle()
    c = d.c
    c.settings.change(method="paper")
    d.settle()
    d.ui.show_panel("What if")
    d.frames(5)
    before, traced = c.frame, c.frame.color.copy()
    look(d, "1-none")

    # A light off, by its tick.
    d.context.item_click("//What if/**/$$1/##on")
    d.wait(lambda: not c.editing.under_way, "the light off", 20.0)
    d.settle()
    assert len(c.session.scene.lights) == len(c.session.original.lights) - 1
    d.context.item_click("//What if/**/Compare with the picture before")
    d.frames(5)
    look(d, "2-light-off")
    seen = c.comparing.seen
    assert (seen.a.frame, seen.b.frame) == (before, c.frame) and c.comparing.state.mode is CompareMode.DIFFERENCE
    d.scroll_down("What if")
    look(d, "2-scrolled")
    d.context.item_click("//What if/**/End the comparison")
    d.frames(2)
    assert c.comparing.seen is None

    # What was clicked, hidden.
    left, top, right, bottom = d.picture_edges()
    y, x = np.argwhere(c.frame.primitive >= 0)[int((c.frame.primitive >= 0).sum()) * 2 // 3]
    at = left + (x + 0.5) / c.frame.width * (right - left), top + (y + 0.5) / c.frame.height * (bottom - top)
    d.context.mouse_move_to_pos(at)
    d.context.mouse_click(0)
    d.settle()
    d.frames(5)
    look(d, "3-clicked")
    shown = c.session.scene.primitive_count
    d.context.item_click("//What if/**/Hide primitive")
    d.wait(lambda: not c.editing.under_way, "the primitive hidden", 20.0)
    d.settle()
    assert c.session.edits.hidden_primitives and c.session.scene.primitive_count < shown
    assert c.selection.picked is None
    look(d, "4-hidden")

    # A light dragged in the picture.
    marks = [mark for mark in marks_of(d.ui, c.frame) if mark.on]
    if marks:  # else they are all beside the picture
        mark = marks[0]
        left, top, right, bottom = d.picture_edges()
        place = left + mark.at[0] * (right - left), top + mark.at[1] * (bottom - top)
        d.drag(place, (60.0, 25.0))
        d.wait(lambda: not c.editing.under_way, "the light elsewhere", 20.0)
        d.settle()
        assert c.session.edits.light_place(mark.number) is not None
        look(d, "5-dragged")
        d.scroll_down("What if")
        look(d, "5-scrolled")
        assert c.undo.undoes == f"light {mark.number} moved"
        d.press(UNDO)
        d.settle()
        assert c.session.edits.light_place(mark.number) is None

    # All comes back.
    while c.session.edits:
        d.press(UNDO)
        d.wait(lambda: not c.editing.under_way, "the step taken back", 20.0)
    d.settle()
    assert not c.session.edits and c.session.scene is c.session.original
    assert np.array_equal(c.frame.color, traced)
    look(d, "6-back")
