"""What if: a light off and elsewhere, an object hidden; it is compared with what was, and undo brings all back."""

from __future__ import annotations

import numpy as np
from imgui_bundle import imgui

from tests.viewer.driver import Driver
from viewer.state.comparison import CompareMode
from viewer.window.panels.what_if import marks_of

UNDO = int(imgui.Key.z) | int(imgui.Key.mod_ctrl)


def what_if(d: Driver) -> None:
    """Edits by the panel and by the hand on a light; each is a step of undo."""
    d.settle()
    c = d.c
    c.settings.change(method="paper")
    d.settle()
    d.show_panel("What if")
    before, traced = c.frame, c.frame.color.copy()

    # A light off, by its tick.
    d.click("//What if/**/$$1/##on")
    d.wait(lambda: not c.editing.under_way, "the light off", 20.0)
    d.settle()
    assert len(c.session.scene.lights) == len(c.session.original.lights) - 1
    d.click("//What if/**/Compare with the picture before")
    seen = c.comparing.seen
    assert (seen.a.frame, seen.b.frame) == (before, c.frame) and c.comparing.state.mode is CompareMode.DIFFERENCE
    d.scroll_down("What if")
    d.click("//What if/**/End the comparison")
    assert c.comparing.seen is None

    # What was clicked, hidden.
    left, top, right, bottom = d.picture_edges()
    y, x = np.argwhere(c.frame.primitive >= 0)[int((c.frame.primitive >= 0).sum()) * 2 // 3]
    at = left + (x + 0.5) / c.frame.width * (right - left), top + (y + 0.5) / c.frame.height * (bottom - top)
    d.context.mouse_move_to_pos(at)
    d.context.mouse_click(0)
    d.settle()
    d.frames(5)
    shown = c.session.scene.primitive_count
    d.click("//What if/**/Hide primitive")
    d.wait(lambda: not c.editing.under_way, "the primitive hidden", 20.0)
    d.settle()
    assert c.session.edits.hidden_primitives and c.session.scene.primitive_count < shown
    assert c.selection.picked is None

    # A light dragged in the picture, into which it is brought.
    camera = c.session.camera
    c.editing.change(c.editing.now.with_light_at(0, tuple(camera.position + 3.0 * camera.basis()[2])))
    d.wait(lambda: not c.editing.under_way, "the light in the picture", 20.0)
    d.settle()
    (mark,) = marks_of(d.ui, c.frame)
    before = c.session.edits.light_place(0)
    left, top, right, bottom = d.picture_edges()
    place = left + mark.at[0] * (right - left), top + mark.at[1] * (bottom - top)
    d.drag(place, (60.0, 25.0))
    d.wait(lambda: not c.editing.under_way, "the light elsewhere", 20.0)
    d.settle()
    assert mark.number == 0 and c.session.edits.light_place(0) != before and c.undo.undoes == "light 0 moved"

    # All comes back.
    while c.session.edits:
        d.press(UNDO)
        d.wait(lambda: not c.editing.under_way, "the step taken back", 20.0)
    d.settle()
    assert c.session.scene is c.session.original and np.array_equal(c.frame.color, traced)
