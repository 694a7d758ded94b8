"""Another tree: chosen from a list, and what of it is built is told."""

from __future__ import annotations

import numpy as np

from tests.viewer.driver import Driver
from tracer.geometry.accelerators import LAZY


def trees(d: Driver) -> None:
    """Pictures by a tree that is built where rays arrive are those of any; how much of it there is can be read."""
    d.fix_resolution(320, 220)
    d.settle()
    fast = d.c.frame
    assert fast.statistics.built is None and not d.c.history.values("built").any()
    d.show_panel("Rendering")
    d.click("//Rendering/Rendering/##accelerator")
    d.click(f"//##Combo_00/{LAZY}")
    d.wait(lambda: d.c.frame.settings.accelerator == LAZY, "a picture by the other tree")
    d.settle()
    built = d.c.frame.statistics.built
    assert 0 < built.primitives <= built.of and built.nodes > 0
    assert np.array_equal(d.c.frame.primitive, fast.primitive)
    assert d.c.history.values("built")[-1] == 100.0 * built.share
    d.show_panel("Statistics")
    d.scroll_down("Statistics")
    d.expect("Built", "nodes")
