"""The tree of a pixel's rays: unfolded, filtered, and picked out in the picture."""

from __future__ import annotations

import numpy as np
from imgui_bundle import imgui

from tests.viewer.driver import Driver
from viewer.output.ray_rows import RaySubset
from viewer.window.panels import rays as panel
from viewer.window.panels.rays import RaysState


def rays(d: Driver) -> None:
    """A click on a pixel lists its rays."""
    d.settle()
    c, state = d.c, d.ui.state(RaysState)
    assert not panel.are_listed(d.ui), "they are folded at first"
    c.settings.change(method="paper")
    d.settle()
    d.press("X")
    d.frames(2)
    assert c.inspector.tree is None, "nothing is clicked"
    traced = c.history.frames
    d.pick(*_inside(d))
    d.wait(lambda: c.inspector.tree is not None, "the rays of the clicked pixel", 20.0)
    tree = c.inspector.tree
    assert c.history.frames == traced, "asking has traced a frame"
    assert (tree.x, tree.y) == c.selection.pixel and tree.due > 0
    d.frames(3)
    drawn, everything = lines_drawn(), len(panel.rows(d.ui))

    # Filters hide rows and lines.
    d.click("//Inspector/wrong")
    assert state.shown.shown is RaySubset.WRONG and len(panel.rows(d.ui)) < everything and lines_drawn() < drawn
    d.click("//Inspector/all")
    assert len(panel.rows(d.ui)) == everything

    # A row that the pointer is on is picked out; a click selects it.
    row = next(row for _, row in panel.rows(d.ui) if len(row.places) == 1 and "traced" in row.text)
    d.hover(f"//Inspector/**/{row.key}/##row")
    assert state.pointed is not None and state.pointed.key == row.key
    d.click(f"//Inspector/**/{row.key}/##row")
    assert state.selected == row.key

    # The path ray folds; the tree goes with the selection.
    top = panel.rows(d.ui)[0][1].key
    for count in (1, everything):
        state.toggled ^= {top}
        d.frames(2)
        assert len(panel.rows(d.ui)) == count
    d.press("Escape")
    assert c.inspector.tree is None and not panel.are_listed(d.ui)


def _inside(d: Driver) -> tuple[float, float]:
    """A pixel whose neighbours show the same."""
    primitive = d.c.frame.primitive
    here = primitive >= 0
    for shift in (-3, 3):
        here &= (np.roll(primitive, shift, 0) == primitive) & (np.roll(primitive, shift, 1) == primitive)
    y, x = np.argwhere(here)[here.sum() // 2]
    return (x + 0.5) / d.c.frame.width, (y + 0.5) / d.c.frame.height


def lines_drawn() -> int:
    """How much is drawn over the picture, in corners of triangles."""
    return imgui.internal.find_window_by_name("Picture").draw_list.vtx_buffer.size()
