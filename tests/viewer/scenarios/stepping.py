"""The paper's text, stepped through by keys."""

from __future__ import annotations

from tests.viewer.desk import place_of
from tests.viewer.driver import Driver


def stepping(d: Driver) -> None:
    """A key opens the panel, a click runs the text; others go on, back, into the next frame, and to changes of modes;
    what a line speaks of is drawn over the picture as long as the panel is seen."""
    s = d.c.stepping
    d.fix_resolution(160, 120)
    d.change(method="paper").press("F6", "F8")
    d.expect("Step to the next line: click a pixel")
    d.expect("Click a pixel: the paper's text then runs")
    d.pick(*place_of(d.c, lit=False))
    d.wait(lambda: s.now is not None, "the steps", 20.0)
    d.expect("§2.3 occlusion testing, pixel", "step 1 of").settle()
    first, drawn = s.now, d.lines_drawn()
    d.press("F8").expect(f"current = {d.c.selection.picked.primitive}")
    assert s.place == 1 and d.lines_drawn() > drawn, "the primitive is outlined"
    assert d.press("F7").frames(2).lines_drawn() == drawn and s.place == 0
    s.place = len(first.steps) - 1
    d.press("F8")
    d.wait(lambda: s.now is not first, "the next frame", 20.0)
    assert d.press("F7").c.stepping.now is first
    d.press("Backspace").settle()
    d.wait(lambda: s.place == 0 and s.now is not first, "the frame in which nothing is known", 20.0)
    d.press("F9")
    assert s.now.steps[s.place].changes
    drawn = d.lines_drawn()
    d.context.window_close("//Paper")
    assert d.frames(3).lines_drawn() < drawn and not s.shown
