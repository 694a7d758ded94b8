"""The tour of the first start."""

from __future__ import annotations

from unittest.mock import patch

from imgui_bundle import imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from tests.viewer.driver import Driver
from tracer.why_in_words import Words, plain
from viewer.services import tour as tours
from viewer.services.tour import STEPS, Step
from viewer.state.preferences import load_preferences
from viewer.state.views import View
from viewer.window.panels.status import doing

KEY = imgui.Key
FLY, CULLING, MODES, SHADOW, ZOOM = STEPS


SHOW, SKIP = f"//Picture/**/{icons.ICON_FA_PLAY}  Show me", "//Picture/**/Skip"


def touring(d: Driver) -> None:
    """The tour comes on the first start; a step is done by doing it, by "Show me", or skipped; Help has it again."""
    with patch.object(tours, "SECONDS", 0.3):  # nobody looks
        assert d.ui.tour.step is FLY and not d.c.preferences.tour, "a first start begins with the tour, and only that"
        _by_hand(d)
        _shown_and_skipped(d)
    d.press(KEY.c)
    d.settle()
    d.c.settings.finish()
    assert not load_preferences()[0].tour


def _shown(d: Driver, next_step: Step | None) -> None:
    """Have the step shown until this one is next."""
    d.click(SHOW)
    d.wait(lambda: d.ui.tour.step is next_step, "the step that is shown", 120.0)


def _by_hand(d: Driver) -> None:
    tour = d.ui.tour
    d.settle()
    assert doing(d.c).startswith("idle") and tour.step is FLY, "nothing has been done yet"
    d.hold(KEY.w, 0.1)
    assert tour.step is CULLING
    d.settle()
    assert d.c.frame.statistics.shadow.dynamic_only > 0, "the method at the start saves rays"
    d.ui.keymap.choose("Shadow culling", ["F7"])
    d.expect("Press F7 twice")
    d.ui.keymap.reset("Shadow culling")
    d.expect("Press C twice")
    d.change(method="auto")
    assert not d.c.frame.statistics.shadow.dynamic_only
    d.expect("Choose paper")
    d.change(method="paper")
    d.press(KEY.c)
    d.settle()
    d.expect("Press C once more")
    d.press(KEY.c)
    d.settle()
    d.wait(lambda: tour.step is MODES, "culling, seen on again", 10.0)
    d.press(KEY._2)
    assert tour.step is MODES, "half of it"
    d.press(KEY._3)
    assert tour.step is SHADOW
    d.context.mouse_move_to_pos((d.picture_edges()[0] + 3.0, d.picture_edges()[1] + 30.0))
    d.context.mouse_click(0)  # the sky
    d.frames(5)
    assert tour.step is SHADOW
    _shown(d, ZOOM)
    assert d.c.selection.picked is not None
    chosen = d.c.inspector.why.reasons[d.c.session.draw.light]
    words = plain(Words(d.c.session.scene, d.c.inspector.why).answer(chosen))
    assert words.startswith("In shadow: blocked by "), f"it says which light is blocked, and by what: {words}"
    d.c.runs.zoom_plan.steps, d.c.runs.zoom_plan.size = 3, (32, 32)
    _shown(d, None)
    assert d.c.runs.zoom_test is not None and d.c.runs.zoom_test.whole
    assert all(one.seen_whole for one in d.c.runs.zoom_test.results.approaches), "else there is no limit to see"
    assert tour.over
    d.settle()
    d.click("//Picture/**/Close")
    assert not tour.over and not d.has(SHOW)


def _shown_and_skipped(d: Driver) -> None:
    tour = d.ui.tour
    d.choose("Help/Tour")
    assert tour.step is FLY
    for size in ((1400, 900), (900, 600)):
        d.resize(*size)
        _, top, right, bottom = d.place(SHOW)
        assert d.picture_edges()[3] <= top, f"the tour covers the picture at {size}"
        assert right < size[0] and bottom < size[1], f"the tour is cut off at {size}"
    camera = d.c.session.camera
    _shown(d, CULLING)
    assert d.c.session.camera != camera
    d.change(method="auto")  # there is more to read then, and the button lies higher
    _shown(d, MODES)
    d.frames(5)
    assert d.c.session.settings.method == "paper" and d.c.frame.statistics.shadow.dynamic_only > 0, "it stays so"
    _shown(d, SHADOW)
    assert d.c.session.draw.view is View.SHADOW
    d.click(SKIP)
    assert tour.step is ZOOM
    d.click("//Picture/**/Finish")
    assert tour.step is None
