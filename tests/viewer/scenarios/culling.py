"""Culling and what it knows: switched on and off, certified, and explained for a pixel."""

from __future__ import annotations

import math

import numpy as np

from tests.viewer.desk import place_of
from tests.viewer.drawn import units_in
from tests.viewer.driver import Driver
from tracer.geometry.accelerators import BVH8, LAZY
from tracer.method import additions, bases
from viewer.state.views import View
from viewer.views.voxels import voxels_seen
from viewer.window.panels.light_buffer import CubeState, Unfolded
from viewer.window.panels.links import Pointed
from viewer.window.panels.view import words_in_space


def culling(d: Driver) -> None:
    """Resetting forgets, and tracing again culls; modes are there at once whatever culls; where a view has nothing to
    show, a note says so and a button switches; a method is chosen with its additions; key C switches culling off and
    on."""
    d.fix_resolution(240, 180)
    d.change(method="paper")
    due = d.c.frame.statistics.shadow.due
    for key, method, culls in (("Backspace", "paper", False), ("T", "paper", True), ("C", "none", False),
                               ("C", "paper", True)):  # fmt: skip
        d.press(key).settle()
        shadow = d.c.frame.statistics.shadow
        assert d.c.frame.settings.method == method and shadow.due == due > 0
        assert shadow.saved > 0 if culls else shadow.culled == 0
    d.show_panel("Culling")
    for symmetric in (True, False):
        d.click("//Culling/Symmetric occlusion test").settle()
        assert d.c.frame.settings.symmetric == symmetric
    for base in ("certified", "none"):
        d.change(method=base)
        traced = d.c.history.frames
        for view in (View.OCCLUSION, View.SHADOW, View.PIXEL_COUNT):
            d.press(view.key)
            assert d.c.scheduler.drawn_view is view and d.c.history.frames == traced
            d.expect_picture()
        assert units_in(d.c.frame, View.OCCLUSION)["fully rendered"]
        _use(d, View.DIFFERENCE, "paper")
    d.press(View.CERTIFICATE.key).settle()
    assert d.c.frame.certificates is None and d.c.scheduler.drawn_view is View.COLOR
    d.certify()
    _use(d, View.CERTIFICATE, "certified")
    d.choose("Culling/###Method certified")
    d.click("//Picture/##method")
    names = [*(kind.title for kind in bases()), *(kind.plus for kind in additions("certified"))]
    assert all(d.has(f"//##Combo_00/{name}") for name in names), "all are listed"
    d.click("//##Combo_00/+ occluder cache").press("Escape").settle()
    assert d.c.frame.settings.method == "certified+cache" and d.c.frame.certificates is not None
    d.expect_picture()
    for method in ("none", "certified+cache"):
        d.press("C").settle()
        assert d.c.frame.settings.method == method
    for key in ("H", "Shift+H"):
        d.press(key).settle()
        assert d.c.scheduler.drawn_view is d.c.session.draw.view and not d.c.scheduler.outdated
    _clusters(d)
    _space(d)


def _use(d: Driver, view: View, method: str) -> None:
    """Choose a view that has nothing to show, and press the button that gives it a method."""
    d.press(view.key).settle().click("//Picture/**/###instead").settle()
    used = d.c.frame.settings
    assert used.method.split("+")[0] == method


def _clusters(d: Driver) -> None:
    """Methods by clusters of lights have a view, and their error and the most clusters can be chosen."""
    _use(d, View.CUTS, "lightcuts")
    d.change(lamp_radius=0.3, lamp_samples=16)
    assert d.c.frame.statistics.cuts.most > 3 and d.c.scheduler.drawn_view is View.CUTS
    d.expect_picture()
    d.enter("//Culling/**/##lightcuts_error", 20.0)
    d.settle()  # the words above the sliders are of another length then, and the sliders elsewhere
    d.enter("//Culling/**/##lightcuts_nodes", 3).settle()
    used = d.c.frame.settings
    assert (used.lightcuts_error, used.lightcuts_nodes, d.c.frame.statistics.cuts.most) == (0.2, 3, 3)


def _space(d: Driver) -> None:
    """What methods keep of space: slices through voxels; cells by the lights that they ask; a light's cube."""
    d.change(lamp_radius=None, lamp_samples=None)
    assert d.c.frame.statistics.built is None and not d.c.history.values("built").any()
    for view, method in ((View.VOXELS, "voxels"), (View.CELL_LIGHTS, "lie-exact")):
        _use(d, view, method)
        d.expect_picture()
        if view is View.VOXELS:
            _slice(d)
    _tree(d)
    _light_buffer(d)


def _slice(d: Driver) -> None:
    """Keys and the panel go from layer to layer, and say what the pointer is on."""
    sides, before = d.c.frame.structures["voxels"].shape, d.shown()
    cut, traced = d.c.session.draw.slice, d.c.history.frames
    for key, step in (("Shift+RightBracket", 1), ("Shift+LeftBracket", 0)):
        d.press(key)
        assert d.c.session.draw.slice.layer(sides[cut.axis]) == cut.layer(sides[cut.axis]) + step
    d.show_panel("View").click("//View/**/z##slice")
    d.enter("//View/**/##layer", sides[2] // 2)
    cut = d.c.session.draw.slice
    assert (cut.axis, cut.layer(sides[2])) == (2, sides[2] // 2)
    assert (d.shown() != before).any() and d.c.history.frames == traced, "another slice has traced"
    seen = np.argwhere(voxels_seen(d.c.frame, cut)[0] >= 0)
    if len(seen):
        y, x = seen[len(seen) // 2].tolist()
        assert f", {sides[2] // 2}" in words_in_space(d.ui, x, y)[0]


def _tree(d: Driver) -> None:
    """What rays have had built of a tree is told; another tree, chosen from a list, has the same picture."""
    d.change(method="none", accelerator=LAZY)
    lazy, built = d.c.frame, d.c.frame.statistics.built
    assert 0 < built.primitives <= built.of and built.nodes > 0
    assert d.c.history.values("built")[-1] == 100.0 * built.share
    d.show_panel("Statistics").scroll_down("Statistics").expect("Built", "nodes")
    d.show_panel("Rendering").click("//Rendering/Rendering/##accelerator").click(f"//##Combo_00/{BVH8}").settle()
    assert d.c.frame.settings.accelerator == BVH8 and d.c.frame.statistics.built is None
    assert np.array_equal(d.c.frame.primitive, lazy.primitive)


def _light_buffer(d: Driver) -> None:
    """A line where the method has none; else the cube by lengths of lists, or by where full shadow begins."""
    state = d.ui.state(CubeState)
    d.show_panel("Light buffer")
    d.wait(lambda: isinstance(state.answer, str), "why there is none", 20.0)
    d.change(method="lightbuffer")
    d.wait(lambda: isinstance(state.answer, Unfolded), "the cube", 20.0)
    lists = state.answer
    d.click("//Light buffer/Distance at which full shadow begins")
    d.wait(lambda: (state.answer.picture != lists.picture).any(), "where full shadow begins", 20.0)


def explaining(d: Driver) -> None:
    """What the pointer is on, or was clicked, is explained beside the window's own frames; a key hides the lines."""
    inspector, traced = d.c.inspector, d.c.history.frames
    assert inspector.why is None
    shadow, lit = (place_of(d.c, lit) for lit in (False, True))

    def answered(blocked: bool) -> None:
        d.wait(lambda: inspector.why is not None and _is_blocked(d) == blocked, "an answer about a pixel", 20.0)

    d.point(*shadow)
    answered(blocked=True)
    assert not any(one.lit for one in inspector.why.reasons if one.blocker >= 0)
    hovering = d.lines_drawn()
    d.press("I")
    assert d.lines_drawn() == hovering, "shadow rays are drawn for a pixel that was not clicked"
    d.press("I")
    d.point(*lit)
    answered(blocked=False)
    d.pick(*shadow)
    assert d.c.selection.picked is not None
    d.point(*lit)
    answered(blocked=True)
    d.frames(5)
    assert _is_blocked(d), "it goes on following the pointer"
    assert d.c.history.frames == traced, "asking has traced a frame"
    point = inspector.tree.rays[0].end
    d.hold("D", 0.3).settle()
    assert inspector.why is not None and math.dist(inspector.tree.rays[0].end, point) < 0.2
    d.hover(f"//Inspector/**/{d.c.session.scene.lights[0].name}##light")
    assert d.ui.state(Pointed).light == 0
    d.point(*shadow)
    drawn = d.lines_drawn()
    d.press("I")
    assert not d.c.session.draw.rays and d.lines_drawn() < drawn - 50
    d.press("I")
    assert d.lines_drawn() == drawn
    d.press("Escape")
    assert d.c.selection.picked is None and d.lines_drawn() < drawn - 50, "Escape clears"
    d.pick(*shadow)
    assert d.c.selection.picked is not None
    d.pick(0.5, 0.02)
    assert d.c.selection.picked is None and inspector.why is None, "a click on nothing clears"


def _is_blocked(d: Driver) -> bool:
    """Whether something blocks a light at the pixel that is explained."""
    return any(one.blocker >= 0 for one in d.c.inspector.why.reasons)
