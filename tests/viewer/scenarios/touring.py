"""The tour of the first start."""

from __future__ import annotations

from unittest.mock import patch

from imgui_bundle.immapp import icons_fontawesome_6 as icons

from tests.viewer.desk import place_of
from tests.viewer.driver import Driver
from tracer.inspect.why_in_words import Words, plain
from viewer.services import tour as tours
from viewer.services.tour import STEPS
from viewer.state.preferences import load_preferences
from viewer.state.views import View
from viewer.window.panels.status import doing

FLY, CULLING, MODES, SHADOW, ZOOM, DONE = STEPS
SHOW, SKIP = f"//Picture/**/{icons.ICON_FA_PLAY}  Show me", "//Picture/**/Skip"


def touring(d: Driver) -> None:
    """The tour comes on the first start; a step is done by doing it, or skipped; Help has it again."""
    assert d.ui.tour.step is FLY and not d.c.preferences.tour, "a first start begins with the tour, and only that"
    _by_hand(d)
    _skipped(d)
    with patch.object(tours, "SECONDS", 0.3):  # nobody looks
        _shown(d)
    d.c.settings.finish()
    assert not load_preferences()[0].tour


def _by_hand(d: Driver) -> None:
    tour = d.ui.tour
    assert doing(d.c).startswith("idle") and tour.step is FLY, "nothing has been done yet"
    d.hold("W", 0.1)
    assert tour.step is CULLING
    d.settle()
    assert d.c.frame.statistics.shadow.dynamic_only > 0, "the method at the start saves rays"
    d.ui.keymap.choose("Shadow culling", ["F7"])
    d.expect("Press F7 twice")
    d.c.preferences.keys.clear()
    d.expect("Press C twice")
    d.change(method="auto")
    assert not d.c.frame.statistics.shadow.dynamic_only
    d.expect("Choose paper, the published method, at the top of the Culling panel, and then press C twice")
    d.change(method="paper")
    d.press("C").settle()
    d.expect("Press C once more")
    d.press("C").settle()
    d.wait(lambda: tour.step is MODES, "culling, seen on again", 10.0)
    d.press("2")
    assert tour.step is MODES, "half of it"
    d.press("3")
    assert tour.step is SHADOW
    d.pick(0.02, 0.1).settle()  # the sky
    assert tour.step is SHADOW
    d.press("N").pick(*place_of(d.c, lit=False))  # the legend might lie over it
    d.wait(lambda: tour.step is ZOOM, "a shadow that was clicked", 20.0)
    chosen = next(one for one in d.c.inspector.why.reasons if one.blocker >= 0)
    words = plain(Words(d.c.session.scene, d.c.inspector.why).answer(chosen))
    assert words.startswith("In shadow: blocked by "), f"it says which light is blocked, and by what: {words}"
    d.c.runs.zoom_plan.steps, d.c.runs.zoom_plan.size = 3, (32, 32)
    d.choose("Run/Zoom test")
    d.wait(lambda: tour.step is DONE, "the end of the zoom test", 120.0)
    assert d.c.runs.zoom_test.whole
    d.settle().click("//Picture/**/Close")
    assert tour.step is None


def _skipped(d: Driver) -> None:
    tour = d.ui.tour
    d.choose("Help/Tour")
    for size in ((1400, 900), (900, 600)):
        d.resize(*size)
        _, top, right, bottom = d.place(SKIP)
        assert d.picture_edges()[3] <= top, f"the tour covers the picture at {size}"
        assert right < size[0] and bottom < size[1], f"the tour is cut off at {size}"
    for step in STEPS[:-1]:
        assert tour.step is step
        d.click(SKIP)
    d.click(f"//Picture/**/{icons.ICON_FA_XMARK}##end")
    assert tour.step is None and not d.has(SKIP)


def _shown(d: Driver) -> None:
    """*Show me* does each step, and stays in the state that it has shown."""
    d.choose("Help/Tour")
    d.change(method="auto")
    camera = d.c.session.camera
    for step in STEPS[1:]:
        d.click(SHOW)
        d.wait(lambda step=step: d.ui.tour.step is step, "the step that is shown", 120.0)
        if step is CULLING:
            assert d.c.session.camera != camera
        elif step is MODES:
            assert d.c.session.settings.method == "paper" and d.c.frame.statistics.shadow.dynamic_only > 0
        elif step is SHADOW:
            assert d.c.session.draw.view is View.SHADOW
        elif step is ZOOM:
            assert d.c.selection.picked is not None
    assert all(one.seen_whole for one in d.c.runs.zoom_test.results.approaches), "else there is no limit to see"
    assert not d.has(SHOW)
    d.click("//Picture/**/Close")
