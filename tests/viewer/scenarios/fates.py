"""What becomes of shadow rays is seen in the picture, also while a train goes by."""

from __future__ import annotations

from tests.viewer.driver import Driver
from tracer.culling.fate import Fate
from viewer.state.views import View
from viewer.util.resources import embedded_scenes

SOME = 6  # pictures in motion that are looked at


def fates(d: Driver) -> None:
    """The keys of the views of fates; another light asks for no frame; no other view flashes up in motion."""
    d.settle()
    d.fix_resolution(240, 135)
    d.c.settings.change(method="paper", samples=1)
    d.open(embedded_scenes()["default"])
    d.press(View.FATE.key)
    d.settle()
    frame, traced, drawn = d.c.frame, d.c.history.frames, []
    assert d.c.scheduler.drawn_view is View.FATE and frame.fates is not None
    for light in range(3):
        assert d.c.session.draw.light == light
        d.expect_picture()
        drawn.append(d.shown())
        d.press("L")
    assert d.c.history.frames == traced and (drawn[0] != drawn[1]).any()
    assert (frame.fate(0) == Fate.CULLED).any()

    d.press("Space")
    d.wait(lambda: d.c.frame.shaded is not None, "a picture of which a part is shaded")
    for view in (View.FATE, View.OCCLUSION, View.MOVING_SHADOW):
        d.press(view.key)
        d.wait(lambda view=view: d.c.scheduler.drawn_view is view, f"the view {view.label}")
        for _ in range(SOME):
            frame = d.c.frame
            d.wait(lambda frame=frame: d.c.frame is not frame, "another picture")
            assert d.c.scheduler.drawn_view is view, "no other view flashes up"
    d.press("Space")
    d.settle()
    d.expect_picture()
