"""The tour of the first start."""

from __future__ import annotations

from unittest.mock import patch

from imgui_bundle.immapp import icons_fontawesome_6 as icons

from tests.viewer.desk import place_of
from tests.viewer.driver import Driver
from tracer.inspect.why_in_words import Words, plain
from viewer.services import tour as tours
from viewer.services.paper_figures import FIGURE_4, SIDE
from viewer.services.tour import EXAMINED, STEPS
from viewer.state.preferences import load_preferences
from viewer.state.views import View
from viewer.util.resources import default_scene
from viewer.window.panels.status import doing

COST, WHOLE, MET, WHY, MOVE, FAILS, RULE, NEXT = STEPS
SHOW, SKIP = f"//Tour/{icons.ICON_FA_PLAY}  Show me", "//Tour/**/Next"


def touring(d: Driver) -> None:
    """The tour comes on the first start; a step is done by doing it, or skipped; Help has it again."""
    assert d.ui.tour.step is COST and not d.c.preferences.tour, "a first start begins with the tour, and only that"
    d.resize(900, 600).change(depth=1)  # there is less to trace
    with patch.object(tours, "SECONDS", 0.3):  # nobody looks
        _by_hand(d)
        _skipped(d)
        _shown(d)
    d.c.settings.finish()
    assert not load_preferences()[0].tour


def _by_hand(d: Driver) -> None:
    tour = d.ui.tour
    assert doing(d.c).startswith("idle") and tour.step is COST, "nothing has been done yet"
    assert d.c.frame.statistics.shadow.dynamic_only > 0, "the method at the start saves rays"
    d.ui.keymap.choose("Shadow culling", ["F7"])
    d.expect("Press F7 twice")
    d.c.preferences.keys.clear()
    d.expect("Press C twice")
    d.change(method="auto")
    assert not d.c.frame.statistics.shadow.dynamic_only
    d.expect("Choose Paper, the published method, above the picture, and then press C twice")
    d.change(method="paper")
    d.press("C").settle()
    d.expect("Press C once more")
    with patch.object(tours, "SECONDS", 90.0):
        d.press("C").wait(lambda: tour.is_done, "culling off and on", 60.0)
        assert "twice" not in d.text() and tour.step is COST, "it is told that it is done"
        d.click(f"//Tour/{icons.ICON_FA_CHECK}  Done")
    d.press("2").wait(lambda: tour.step is MET, "the occlusion modes", 10.0)
    d.press("3").pause(0.6)
    assert tour.step is MET, "half of it"
    d.click("//Tour/**/Back")
    d.pause(0.6)
    assert tour.step is WHOLE, "it is to be done once more"
    d.press("2").wait(lambda: tour.step is MET, "the occlusion modes once more", 10.0).press("3").pause(0.6)
    d.press("1").wait(lambda: tour.step is WHY, "the shadow modes", 10.0)
    d.pick(0.02, 0.1).settle()  # the sky
    assert tour.step is WHY
    d.pick(*place_of(d.c, lit=False)).wait(lambda: tour.step is MOVE, "a shadow that was clicked", 20.0)
    chosen = next(one for one in d.c.inspector.why.reasons if one.blocker >= 0)
    words = plain(Words(d.c.session.scene, d.c.inspector.why).answer(chosen))
    assert words.startswith("In shadow: blocked by "), f"it says which light is blocked, and by what: {words}"
    d.wait(lambda: len(d.c.session.scene.objects) > 1, "a scene in which something moves", 60.0).settle()
    d.press("Shift+O").pause(0.6)
    assert tour.step is MOVE, "nothing has moved yet"
    began = d.c.session.frame
    d.press("Space").wait(lambda: tour.is_done, "moving shadows", 60.0)
    assert d.c.session.frame >= began + 20, "no shadow was seen to move"
    _stage(d)
    d.open(default_scene())
    d.expect("Open Figure 4 again")
    assert not d.c.session.state.pace.fixed_size, "another scene has the window's size"
    d.click(SHOW)
    _stage(d)
    d.settle().press("8").wait(lambda: tour.step is RULE, "the wrong pixels", 60.0)
    d.expect("it covers", "when it was examined last")
    with patch.object(tours, "SECONDS", 90.0):
        d.press("Space").wait(lambda: tour.is_done, "the shadow that came", 60.0).expect("the shadow is there")
        d.click(f"//Tour/{icons.ICON_FA_CHECK}  Done").wait(lambda: tour.step is NEXT, "the end", 10.0).settle()
    assert d.c.session.frame >= EXAMINED and d.c.frame.width == d.c.frame.height == SIDE
    assert d.c.session.draw.view is View.COLOR and d.c.selection.picked is None, "nothing covers the shadow that came"
    assert all(d.command(name) for name in NEXT.commands), "the tour's end offers them"
    d.click(f"//Tour/{icons.ICON_FA_MAGNIFYING_GLASS_PLUS}  Figure 4")
    d.wait(lambda: d.ui.workspace == "Measure", "it", 20.0)
    d.wait(lambda: d.c.runs.zoom_test is not None, "the figure to begin", 60.0).press("Escape", "F2").settle()
    d.click("//Tour/Close")
    assert tour.step is None and not d.c.session.state.pace.fixed_size, "pictures have the window's size again"


def _stage(d: Driver) -> None:
    d.wait(lambda: d.c.session.scene.path == FIGURE_4 and d.c.session.state.pace.fixed_size and not d.c.session.playing,
           "the stage of the paper's Figure 4", 120.0)  # fmt: skip


def _skipped(d: Driver) -> None:
    """No step of the tour makes the picture smaller, and none is cut off."""
    tour = d.ui.tour
    d.choose("Help/Tour").wait(lambda: d.c.session.scene.path != FIGURE_4, "another scene than the tour's last", 60.0)
    for size in ((1400, 900), (900, 600)):
        d.resize(*size)
        _, _, right, bottom = d.place(SKIP)
        assert right < size[0] and bottom < size[1], f"the tour is cut off at {size}"
    before = d.ui.picture.area
    for step in STEPS[:-1]:
        assert tour.step is step and d.ui.picture.area == before
        d.click(SKIP)
    d.context.window_close("//Tour")
    d.frames(3)
    assert tour.step is None and not d.has(SKIP)


def _shown(d: Driver) -> None:
    """*Show me* does each step, and stays in the state that it has shown."""
    d.choose("Help/Tour").frames(3)
    d.change(method="auto")
    shown = {WHOLE: lambda: d.c.session.settings.method == "paper" and d.c.frame.statistics.shadow.traced,
             MET: lambda: d.c.session.draw.view is View.OCCLUSION, MOVE: lambda: d.c.selection.picked is not None,
             RULE: lambda: d.c.session.draw.view is View.DIFFERENCE}  # fmt: skip
    for step in STEPS[1:]:
        d.click(SHOW)
        d.wait(lambda step=step: d.ui.tour.step is step, f"the step {step.title}", 120.0)
        assert shown.get(step, lambda: True)()
    assert not d.has(SHOW)
    d.click("//Tour/Close")
