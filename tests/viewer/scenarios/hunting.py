"""Back to frames that taught something, and to counterexamples that a hunt has found."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from tests.marbles import LAST, STEP, write_marbles
from tests.viewer.driver import Driver
from tracer.scene.load import load_scene
from viewer.state.picking import wrong_at
from viewer.window.panels.inspector import wrong_beyond
from viewer.window.panels.plots import PlotsState


def hunting(d: Driver) -> None:
    """A click in a plot, or on a frame in the inspector, goes back there; a hunt's finds are flown to and explained."""
    d.open(write_marbles(d.folder))
    d.change(method="paper", depth=2)
    _from_a_plot(d)
    _from_the_inspector(d)
    _to_a_find(d)


def _from_a_plot(d: Driver) -> None:
    c = d.c
    d.show_panel("Plots")
    for _ in range(3):
        d.press("RightArrow").settle()
    here, wanted = c.session.time, c.session.scene.frame_time(1)
    target = next(n for n, record in c.history.records.items() if record.state.time == wanted)
    _point_at_sample(d, target)
    d.click_here().settle()
    assert c.session.time == wanted, "the click on the plot did not lead there"
    d.press("Ctrl+Z").settle()
    assert c.session.time == here


def _point_at_sample(d: Driver, number: int) -> None:
    """The pointer onto a frame of a plot."""
    history, window = d.c.history, d.panel("Plots")
    for place in np.linspace(0.02, 0.98, 97):  # the plot says itself which frame the pointer is on
        d.ui.state(PlotsState).pointed = None
        d.move_to(window.pos.x + place * window.size.x, window.pos.y + 0.6 * window.size.y)
        if d.ui.state(PlotsState).pointed == number:
            return
    raise AssertionError(f"frame {number} is not found in the plot of frames {history.first} to {history.frames - 1}")


def _from_the_inspector(d: Driver) -> None:
    c = d.c
    c.session.set_pace(fixed_size=False)
    d.show_panel("Inspector").press("RightArrow").settle().pick()
    picked = c.selection.picked
    assert picked is not None
    taught = c.history.origins_of(c.frame, picked.primitive, wait=True)
    light, lesson = next((n, one) for n, one in enumerate(taught.lights) if one.lit >= 0)
    then = c.history.records[lesson.lit].state
    d.wait(lambda: c.inspector.why is not None, "the answer, which moves what is below it").scroll_down("Inspector")
    d.click(f"//Inspector/**/{light} lit/picture {lesson.lit}##0").settle()
    assert (c.session.time, c.session.camera) == (then.time, then.camera or c.session.scene.camera_at(then.time))


def _to_a_find(d: Driver) -> None:
    c, plan = d.c, d.c.runs.hunt_plan
    plan.size, plan.last, plan.step, plan.around, plan.keep = (96, 96), LAST, STEP, 4, 5
    d.show_panel("Hunt").start("Hunt").settle()
    found = c.runs.hunt.results
    assert c.runs.hunt.whole and found.finds and found.frames == LAST // STEP + 5
    d.change(samples=4)
    d.click("//Hunt/**/1##0").settle()
    assert (c.frame.width, c.frame.height) == (96, 96)
    find, picked = found.finds[0], c.selection.picked
    assert (picked.x, picked.y) == (find.x, find.y) and wrong_at(c.frame, find.x, find.y) > 0
    assert tuple(c.frame.color[find.y, find.x].tolist()) == find.color
    assert c.frame.settings.samples == 1 and c.session.settings.samples == 4, "refined, it is not as it was found"
    left, top, right, bottom = c.session.draw.zoom.shown()
    assert right - left < 0.3 and left < find.x / 96 < right and top < find.y / 96 < bottom, "its pixel is too small"
    d.wait(lambda: c.inspector.why is not None, "what the lights do there", 20.0)
    reasons = c.inspector.why.reasons
    assert sum(one.wrong for one in reasons) + wrong_beyond(c.inspector.why) == c.frame.wrong[find.y, find.x]
    if find.bounces == 0:
        one = reasons[find.light]
        assert one.wrong == 1 and (one.lit > 0) == find.lit and (one.blocker < 0) != find.lit
    d.click(f"//Hunt/**/{icons.ICON_FA_CODE_BRANCH}  Rays")
    d.wait(lambda: c.inspector.tree is not None, "its rays", 20.0)
    assert any(ray.shadows is not None and ray.shadows.wrong.any() for ray in c.inspector.tree.rays)
    _shrunk(d, lambda: d.show_panel("Hunt").click(f"//Hunt/**/{icons.ICON_FA_COMPRESS}  Shrink"))
    c.navigator.go_to_find(0)
    d.settle()
    d.wait(lambda: c.shrinking.offers, "the wrong pixel selected again", 20.0)
    _shrunk(d, lambda: d.show_panel("Inspector").click("//Inspector/**/Shrink"))
    c.navigator.go_to_find(0)
    d.show_panel("Hunt").settle().press("RightArrow").settle()
    d.wait(lambda: c.frame.settings.samples == 4 and c.frame.width > 96, "samples and size after a movement", 30.0)


def _shrunk(d: Driver, start: Callable[[], object]) -> None:
    """What starts shrinking leads to a folder with a scene of a few primitives."""
    folder = d.c.preferences.picture_folder
    before = set(folder.glob("*-shrunk-*"))
    start()
    d.wait(lambda: d.c.runs.current is None and set(folder.glob("*-shrunk-*")) > before, "the folder", 60.0)
    (made,) = set(folder.glob("*-shrunk-*")) - before
    assert load_scene(made / "scene.aff").primitive_count < d.c.session.scene.primitive_count
    d.settle()
