"""Why is this shadow ray culled, or traced?  A sentence for a click, whose links lead on."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
from imgui_bundle import imgui

from tests.viewer.driver import Driver
from tests.viewer.scenarios.fitting import check_fit
from tracer.culling.fate import Fate
from tracer.culling.modes import OcclusionMode, ShadowMode
from tracer.inspect.reasons import Reason, Rule, Why
from tracer.inspect.why_in_words import Words, plain
from viewer.output.ray_rows import RaySubset
from viewer.state import navigation
from viewer.window.panels import rays
from viewer.window.panels.rays import RaysState

FULLY, PARTLY = OcclusionMode.FULLY_RENDERED, OcclusionMode.PARTIALLY_OCCLUDED
ROOM = Path(__file__).resolve().parents[3] / "assets" / "scenes" / "default.aff"


def why(d: Driver) -> None:
    """A culled shadow, and a primitive that is partially occluded: each click is answered by one sentence, at the top
    of the Inspector, and the names in it are links."""
    d.c.settings.change(method="paper")
    d.open(ROOM)
    for _ in range(3):
        d.press("T").settle()
    _rays(d)
    _culled(d)
    _occluded(d)
    _taught(d)
    _in_a_small_window(d)
    _in_motion(d)


def _culled(d: Driver) -> None:
    """The pixel's light is chosen by a click on its line, and the fate is said first."""
    one = _click(d, _of(d, FULLY, ShadowMode.FULL_SHADOW), lambda one: one.rule is Rule.FULL_SHADOW)
    d.c.settings.set_light((one.light + 1) % len(d.c.session.scene.lights))
    d.frames(3).click(f"//Inspector/$${one.light}/{d.ui.light_name(one.light)}##light")
    assert d.c.session.draw.light == one.light
    said = plain(Words(d.c.session.scene, d.c.inspector.why).reason(one))
    assert said == "Culled: fully rendered, and every shadow ray so far was blocked (§2.4)."
    assert one.fate is Fate.CULLED and not one.lit
    d.click(f"//Inspector/answer/{_named(d, one.blocker)}##0")
    assert d.c.selection.picked.primitive == one.blocker, "what is in the way is a link"


def _occluded(d: Driver) -> None:
    """What hides it is named and outlined, and the pixel at which it does is a link, as the thing is."""
    inside = _of(d, PARTLY) & ~_at_border(d)
    one = _click(d, inside, _by_something(d))
    by, words = d.c.inspector.why.coverage.occluded, Words(d.c.session.scene, d.c.inspector.why)
    hider = _named(d, by.primitive)
    text = plain(words.reason(one))
    assert f"partially occluded by {hider} at " in text and text.endswith("so its shadow mode is not trusted (§2.4).")
    drawn = d.lines_drawn()
    link = next(part for part in words.reason(one) if not isinstance(part, str) and part.pixel is not None)
    d.hover(f"//Inspector/reason/{hider}##0")
    assert d.lines_drawn() > drawn, "a name that the pointer is on is outlined"
    d.press("I")
    assert d.lines_drawn() < drawn, "no outline of what hides it, and no squares"
    d.press("I")
    d.click(f"//Inspector/reason/{hider}##0")
    assert d.c.selection.picked.primitive == by.primitive
    _click(d, inside, _by_something(d))
    d.click(f"//Inspector/reason/{link.text}##1")
    assert (d.c.selection.picked.x, d.c.selection.picked.y) == link.pixel == by.pixel


def _taught(d: Driver) -> None:
    """Who taught a shadow mode is named, and the link leads back to that picture."""
    one = _click(d, _of(d, FULLY, ShadowMode.PARTIAL_SHADOW), lambda one: one.rule is Rule.PARTIAL_SHADOW)
    d.c.settings.set_light(one.light)
    d.frames(3)
    number = max(d.c.history.origins_of(d.c.frame, d.c.selection.picked.primitive, wait=True).lights[one.light])
    assert d.has(f"//Inspector/reason/picture {number}##0")
    d.press("X")
    d.wait(lambda: rays.rows(d.ui), "the rays", 20.0)
    d.frames(3)
    left = d.c.session.camera
    d.c.motion.move(navigation.look(left, 0.02, 0.0, d.c.motion.world_up))
    d.settle()
    assert d.c.session.camera != left
    d.click(f"//Inspector/reason/picture {number}##0").settle()
    assert d.c.session.camera == left, "it goes back to that picture, and what is selected stays so"
    assert d.c.selection.pixel is not None


def _rays(d: Driver) -> None:
    """The tree of a pixel's rays is unfolded, filtered, and picked out in the picture."""
    c, state = d.c, d.ui.state(RaysState)
    c.selection.clear()
    assert not rays.are_listed(d.ui), "they are folded at first"
    d.press("X")
    assert c.inspector.tree is None, "nothing is clicked"
    traced = c.history.frames
    d.pick(*d.places(c.frame.primitive >= 0)[0])
    d.wait(lambda: c.inspector.tree is not None, "the rays of the clicked pixel", 20.0)
    tree = c.inspector.tree
    assert c.history.frames == traced, "asking has traced a frame"
    assert (tree.x, tree.y) == c.selection.pixel and tree.due > 0
    d.frames(3)
    drawn, everything = d.lines_drawn(), len(rays.rows(d.ui))
    # Filters hide rows and lines.
    d.click("//Inspector/wrong")
    assert state.shown.shown is RaySubset.WRONG and len(rays.rows(d.ui)) < everything and d.lines_drawn() < drawn
    d.click("//Inspector/all")
    assert len(rays.rows(d.ui)) == everything
    # A row that the pointer is on is picked out; a click selects it.
    row = next(row for _, row in rays.rows(d.ui) if len(row.places) == 1 and "traced" in row.text)
    d.hover(f"//Inspector/**/{row.key}/##row")
    assert state.pointed is not None and state.pointed.key == row.key
    d.click(f"//Inspector/**/{row.key}/##row")
    assert state.selected == row.key

    # The path ray folds; the tree goes with the selection.
    top = rays.rows(d.ui)[0][1].key
    for count in (1, everything):
        state.toggled ^= {top}
        d.frames(2)
        assert len(rays.rows(d.ui)) == count
    d.press("Escape")
    assert c.inspector.tree is None and not rays.are_listed(d.ui)


def _in_a_small_window(d: Driver) -> None:
    """Long names and sentences fit into a narrow panel."""
    size = imgui.get_io().display_size
    d.resize(900, 600)
    _click(d, _of(d, PARTLY), lambda one: True)
    check_fit(d, "The Inspector in a small window")
    d.resize(int(size.x), int(size.y)).settle()


def _in_motion(d: Driver) -> None:
    """While the film plays, in parts or whole, every frame of it is answered, and no answer goes before the next."""
    for every_frame in (False, True):
        d.c.session.set_pace(every_frame=every_frame)
        d.c.session.go_to_frame(0)
        d.settle()
        _click(d, _of(d, PARTLY) & ~_at_border(d), _by_something(d))
        times, answers = [d.c.frame.time], [d.c.inspector.why]
        d.c.motion.toggle_play()

        def many_seen(times: list[float] = times, answers: list[Why] = answers) -> bool:
            if d.c.selection.pixel is None:
                return True  # the film has left it behind
            found, time = d.c.inspector.why, d.c.frame.time
            assert found is not None, "it came and went"
            answers += [found] * (found is not answers[-1])
            times += [time] * (time != times[-1])
            return len(times) > 10

        d.wait(many_seen, "a film", 60.0)
        d.c.motion.toggle_play()
        d.settle()
        assert len(times) > 5 and len(answers) >= len(times) - 1, (len(times), len(answers))


def _by_something(d: Driver) -> Callable[[Reason], bool]:
    def wanted(one: Reason) -> bool:
        by = d.c.inspector.why.coverage.occluded
        return one.rule is Rule.PARTLY_OCCLUDED and by is not None and not by.at_edge and by.primitive >= 0

    return wanted


def _click(d: Driver, here: np.ndarray, wanted: Callable[[Reason], bool]) -> Reason:
    """Click a pixel of those that are `here` that has such a reason, and return the first."""
    near = d.places(here)
    for place in near[:: max(1, len(near) // 20)]:
        d.c.selection.clear()
        d.pick(*place)
        d.wait(lambda: d.c.inspector.why is not None, "the reasons", 20.0)
        d.frames(3)
        found = next((one for one in d.c.inspector.why.reasons if wanted(one)), None)
        if found is not None:
            return found
    raise AssertionError("no pixel has such a reason")


def _of(d: Driver, occlusion: OcclusionMode, shadow: ShadowMode | None = None) -> np.ndarray:
    """Where primitives have such modes, for any light."""
    frame = d.c.frame
    here = frame.occlusion_mode == occlusion
    return here if shadow is None else here & (frame.shadow_mode == shadow).any(-1)


def _at_border(d: Driver) -> np.ndarray:
    """Where primitives are seen that the screen's edge cuts off."""
    seen = d.c.frame.primitive
    return np.isin(seen, np.concatenate([seen[0], seen[-1], seen[:, 0], seen[:, -1]]))


def _named(d: Driver, primitive: int) -> str:
    return Words(d.c.session.scene, d.c.inspector.why).primitive(primitive).text
