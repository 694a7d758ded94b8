"""The tour of the first start."""

from __future__ import annotations

from unittest.mock import patch

from imgui_bundle import imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from tests.viewer.driver import Driver
from tracer.why_in_words import Words, plain
from viewer.services import tour as steps
from viewer.services.tour import STEPS
from viewer.state.preferences import load_preferences
from viewer.state.views import View
from viewer.window.panels.status import doing

KEY = imgui.Key


def touring(d: Driver) -> None:
    """The tour comes on the first start; a step is done by doing it, by "Show me", or skipped; Help has it again."""
    with patch.object(steps, "SECONDS", 0.3):  # nobody looks
        _tour(d)


def _tour(d: Driver) -> None:
    tour = d.ui.tour
    assert tour.at == 0 and not d.c.preferences.tour, "a first start begins with the tour, and only that one"
    d.settle()
    assert doing(d.c).startswith("idle")
    show, skip = f"//Picture/**/{icons.ICON_FA_PLAY}  Show me", "//Picture/**/Skip"
    finish = "//Picture/**/Finish"
    d.frames(5)
    assert tour.at == 0, "nothing has been done yet"
    d.hold(KEY.w, 0.1)
    assert tour.at == 1 and STEPS[1].title == "Turn culling off and on"
    d.settle()
    assert d.c.frame.statistics.shadow.dynamic_only > 0, "the method at the start saves rays"
    d.ui.keymap.choose("Shadow culling", ["F7"])
    assert "Press F7 twice" in tour.text(tour.step)
    d.ui.keymap.reset("Shadow culling")
    assert "Press C twice" in tour.text(tour.step)
    d.press(KEY._2)
    assert tour.at == 1 and tour.done == {0}
    d.press(KEY._3)
    assert tour.at == 1 and tour.done == {0, 2}, "a later step that is done early counts"
    d.change(method="auto")
    assert not d.c.frame.statistics.shadow.dynamic_only and "Choose paper" in tour.text(tour.step)
    d.change(method="paper")
    assert tour.at == 1 and "Press C twice" in tour.text(tour.step)
    d.press(KEY.c)
    d.settle()
    assert tour.at == 1 and "Press C once more" in tour.text(tour.step), "off, but not on again"
    d.press(KEY.c)
    d.settle()
    d.wait(lambda: tour.at == 3, "culling, seen on again", 10.0)
    d.context.mouse_move_to_pos((d.picture_edges()[0] + 3.0, d.picture_edges()[1] + 30.0))
    d.context.mouse_click(0)  # the sky
    d.frames(5)
    assert tour.at == 3
    d.click(show)
    d.wait(lambda: tour.at == 4, "a shadow that was clicked", 60.0)
    assert d.c.selection.picked is not None
    chosen = d.c.inspector.why.reasons[d.c.session.draw.light]
    words = plain(Words(d.c.session.scene, d.c.inspector.why).answer(chosen))
    assert words.startswith("In shadow: blocked by "), f"it says which light is blocked, and by what: {words}"
    d.c.runs.zoom_plan.steps, d.c.runs.zoom_plan.size = 3, (32, 32)
    d.click(show)
    d.wait(lambda: tour.at is None, "the zoom test", 120.0)
    assert d.c.runs.zoom_test is not None and d.c.runs.zoom_test.whole
    assert all(one.seen_whole for one in d.c.runs.zoom_test.results.approaches), "else there is no limit to see"
    assert tour.over
    d.settle()
    d.click("//Picture/**/Close")
    assert not tour.over and not d.has(show)

    d.choose("Help/Tour")
    assert tour.at == 0
    for size in ((1400, 900), (900, 600)):
        d.resize(*size)
        button = d.context.item_info(show).rect_full
        assert d.picture_edges()[3] <= button.min.y, f"the tour covers the picture at {size}"
        assert button.max.x < size[0] and button.max.y < size[1], f"the tour is cut off at {size}"
    camera = d.c.session.camera
    d.click(show)
    d.wait(lambda: tour.at == 1, "the flight that is shown", 90.0)
    assert d.c.session.camera != camera
    d.change(method="auto")  # there is more to read then, and the button lies higher
    d.click(show)
    d.wait(lambda: tour.at == 2, "culling off and on", 90.0)
    assert d.c.session.settings.method == "paper" and d.c.frame.statistics.shadow.dynamic_only > 0, "it stays so"
    d.frames(5)
    assert d.c.session.settings.method == "paper"
    d.click(show)
    d.wait(lambda: tour.at == 3, "the modes", 90.0)
    assert d.c.session.draw.view is View.COLOR
    d.frames(5)
    assert tour.at == 3
    d.click(skip)
    assert tour.at == 4
    d.click(finish)
    assert tour.at is None
    d.press(KEY.c)
    d.settle()
    d.c.settings.finish()
    assert not load_preferences()[0].tour
