"""A picture that was kept, or a second method, beside the live one."""

from __future__ import annotations

import numpy as np

from tests.viewer.drawn import picture
from tests.viewer.driver import Driver
from tests.viewer.scenarios.fitting import check_fit
from viewer.state.comparison import CompareMode
from viewer.state.draw_options import Curve, Tone
from viewer.state.frame_rows import beside
from viewer.state.views import View
from viewer.views.compare import GAP, composed, signed_picture
from viewer.views.wipe import wipe_column
from viewer.window.panels.sides import filling


def comparing(d: Driver) -> None:
    """What was kept stays as it was, and is seen in each way beside what is changed since; saved as it is seen."""
    d.fix_resolution(160, 120)
    d.change(method="none")
    comparing = d.c.comparing
    d.press("Shift+Z")
    assert "choose Keep as A" in d.said and comparing.seen is None, "nothing is kept yet"
    d.press("Ctrl+Shift+A", "Ctrl+A")
    kept = d.c.frame
    assert comparing.kept.frame is kept and comparing.kept.frame.settings.method == "none" and not comparing.state.on
    d.hold("D", 0.2).settle()
    assert d.c.frame is not kept and d.c.session.camera != kept.camera, "Ctrl+A has flown, or D has not"
    a, b = picture(kept), picture(d.c.frame)
    for mode in (CompareMode.WIPE, CompareMode.SIDE, CompareMode.DIFFERENCE, CompareMode.FLIP):
        d.press("Shift+Z") if mode is not CompareMode.WIPE else comparing.start(mode)
        d.settle()
        assert comparing.state.on and comparing.seen.mode is comparing.state.mode is mode
        assert d.c.frame.primitive.shape == kept.primitive.shape, "both can be compared pixel by pixel"
        saved = d.saved(f"{mode.value}.png")
        if mode is CompareMode.DIFFERENCE:
            found = comparing.seen.difference
            assert found.stats.pixels > 100
            assert np.array_equal(found.pixels != 0.0, (kept.color != d.c.frame.color).any(-1))
            assert np.array_equal(saved, signed_picture(found, found.stats.limit, ringed=True))
        else:
            assert np.array_equal(saved, composed(a, b, mode, 0.5, shows_a=False))
        if mode is CompareMode.SIDE:
            assert saved.shape[1] == 2 * b.shape[1] + GAP
            _inspects_from_a(d)
            for panel in ("Pixels", "Compare"):
                d.show_panel(panel)
                check_fit(d, f"{panel}, comparing")
    with d.held("Z"):
        assert comparing.seen.shows_a and filling(d.ui) is d.ui.graphics.a
        assert np.array_equal(d.saved("held.png"), a)
    assert not comparing.seen.shows_a and filling(d.ui) is d.ui.graphics.display
    _line(d, a, b)
    d.c.session.set_draw(tone=Tone(-1.0, 1.0, Curve.SRGB))
    toned = (picture(frame, tone=d.c.session.draw.tone) for frame in (kept, d.c.frame))
    expected = composed(*toned, CompareMode.WIPE, d.c.session.draw.wipe, False)
    assert np.abs(d.saved("toned.png").astype(int) - expected).max() <= 1, "both have the tone"
    d.c.session.set_draw(tone=Tone())
    d.press("9").settle()
    assert not comparing.state.on and d.ui.graphics.a.texture_id is None, "one line at a time"
    d.press("1")
    d.fix_resolution(80, 60)
    d.settle()
    comparing.start(CompareMode.FLIP)
    d.settle()
    assert "A is shown in B's size" in comparing.remark
    comparing.forget()
    assert not comparing.state.on and comparing.kept is None
    _two_methods(d)


def _inspects_from_a(d: Driver) -> None:
    """A click on A inspects the pixel at the same place of B."""
    left, top, right, bottom = d.place("//Picture/picture of A")
    d.move_to(0.25 * left + 0.75 * right, 0.4 * top + 0.6 * bottom).click_here()
    picked = d.c.selection.picked
    assert picked is not None
    assert abs(picked.x - 0.75 * d.c.frame.width) <= 3 and abs(picked.y - 0.6 * d.c.frame.height) <= 3
    d.c.selection.clear()
    d.frames(2)


def _line(d: Driver, a: np.ndarray, b: np.ndarray) -> None:
    """The line between A and B is dragged as that of the other wipe; closely looked at, it waits at the edge."""
    d.c.comparing.start(CompareMode.WIPE)
    d.see(View.COLOR, wipe=0.5)
    left, _, right, _ = d.picture_edges()
    camera = d.c.session.camera
    d.drag(d.on_picture(0.5, 0.5), (0.2 * (right - left), 3.0))
    assert abs(d.c.session.draw.wipe - 0.7) < 0.02 and d.c.session.camera == camera
    column = wipe_column(b.shape[1], d.c.session.draw.wipe)
    saved = d.saved("dragged.png")
    assert np.array_equal(saved[:, :column], a[:, :column])
    assert np.array_equal(saved[:, column + 1 :], b[:, column + 1 :])
    d.c.session.set_draw(zoom=type(d.c.session.draw.zoom)(4.0, 0.2, 0.5))
    d.frames(3)
    d.drag(d.on_picture(0.998, 0.5), (-0.5 * (right - left), 0.0))
    assert abs(d.c.session.draw.wipe - 0.2) < 0.02 and d.c.session.camera == camera
    d.press("Shift+F")
    assert d.c.session.draw.zoom.fits


def _two_methods(d: Driver) -> None:
    """Each frame is traced by both, at rest and in motion, and each counts for itself."""
    d.change(method="paper+cache")
    d.press("Shift+C").settle()
    comparing = d.c.comparing
    assert comparing.second_method == "none" and comparing.state.mode is CompareMode.SIDE
    d.press("T").settle()
    frame, second = d.c.frame, d.c.traced.second
    assert (frame.settings.method, second.settings.method) == ("paper+cache", "none")
    assert second.time == frame.time and second.camera == frame.camera
    assert second.primitive.shape == frame.primitive.shape and (second.primitive == frame.primitive).all()
    assert frame.statistics.shadow.dynamic_only > 0 == second.statistics.shadow.dynamic_only
    assert frame.statistics.shadow.due == second.statistics.shadow.due
    d.c.comparing.trace_by("certified")
    d.settle()
    d.wait(lambda: d.c.baseline.measured is not None and d.c.baseline.measured.tells, "times of frames in turn", 60.0)
    found = beside(d.c.traced.second, d.c.frame, d.c.baseline.measured)
    times = {row.name: row.number for pair in zip(*found, strict=True) for row in pair}
    assert times["Frame"] > times["  shading"] > 0.0
    d.press("Space")
    moments = set()

    def moved() -> bool:
        traced = d.c.traced
        assert traced.second is None or traced.second.time == traced.frame.time
        if traced.second is not None:
            moments.add(traced.frame.time)
        return len(moments) >= 4

    d.wait(moved, "frames by both while time goes on", 60.0)
    d.press("Space").settle().press("Shift+C").settle()
    assert not comparing.state.on and d.c.traced.second is None
    assert d.ui.graphics.a.texture_id is None, "what is not seen takes no memory"
