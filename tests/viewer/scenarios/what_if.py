"""What if: a light off and elsewhere, an object hidden; it is compared with what was, and undo brings all back."""

from __future__ import annotations

import numpy as np

from tests.viewer.driver import Driver
from viewer.state.comparison import CompareMode
from viewer.window.panels.what_if import marks_of


def what_if(d: Driver) -> None:
    """Edits by the panel and by the hand on a light; each is a step of undo."""
    c = d.c
    d.change(method="paper")
    d.show_panel("What if")
    before, traced = c.frame, c.frame.color.copy()

    # A light off, by its tick.
    d.click("//What if/**/$$1/##on").settle()
    assert len(c.session.scene.lights) == len(c.session.original.lights) - 1
    d.click("//What if/**/Compare with the picture before")
    seen = c.comparing.seen
    assert (seen.a.frame, seen.b.frame) == (before, c.frame) and c.comparing.state.mode is CompareMode.DIFFERENCE
    d.scroll_down("What if").click("//What if/**/End the comparison")
    assert c.comparing.seen is None

    # What was clicked, hidden.
    shown = c.session.scene.primitive_count
    d.pick(*d.places(c.frame.primitive >= 0)[0]).settle()
    d.click("//What if/**/Hide primitive").settle()
    assert c.session.edits.hidden_primitives and c.session.scene.primitive_count < shown
    assert c.selection.picked is None

    # A light dragged in the picture, into which it is brought.
    camera = c.session.camera
    c.editing.change(c.editing.now.with_light_at(0, tuple(camera.position + 3.0 * camera.basis()[2])))
    d.settle()
    (mark,) = marks_of(d.ui, c.frame)
    before = c.session.edits.light_place(0)
    d.drag(d.on_picture(*mark.at), (60.0, 25.0)).settle()
    assert mark.number == 0 and c.session.edits.light_place(0) != before and c.undo.undoes == "light 0 moved"

    # All comes back.
    while c.session.edits:
        d.press("Ctrl+Z").settle()
    assert c.session.scene is c.session.original and np.array_equal(c.frame.color, traced)
