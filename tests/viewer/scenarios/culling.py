"""Culling and what it knows: switched on and off, certified, and explained for a pixel."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from imgui_bundle import imgui

from tests.viewer.drawn import classes_in, picture
from tests.viewer.driver import Driver
from tracer.method import additions, bases
from tracer.renderer import Renderer
from viewer.state.views import View
from viewer.views.tree import LAYERS
from viewer.views.voxels import voxels_seen
from viewer.window.keyboard import chord
from viewer.window.panels import slicing
from viewer.window.panels.light_buffer import CubeState, Unfolded
from viewer.window.panels.links import Pointed

KEY = imgui.Key


def culling(d: Driver) -> None:
    """Tracing again culls; the key switches it off and on; resetting forgets."""
    d.c.settings.change(method="paper")
    d.settle()
    first = d.c.frame.statistics.shadow
    assert first.due > 0 and first.culled == 0
    d.press(KEY.t)
    d.settle()
    second = d.c.frame.statistics.shadow
    assert second.saved > 0
    assert second.due == first.due
    d.press(KEY.c)
    d.settle()
    assert d.c.frame.settings.method == "none" and d.c.frame.statistics.shadow.culled == 0
    d.press(KEY.c)
    d.settle()
    d.press(KEY.backspace)
    d.settle()
    assert d.c.frame.statistics.shadow.culled == 0
    d.context.item_click("//Culling/Symmetric occlusion test")
    d.settle()
    assert d.c.frame.settings.symmetric


def certifying(d: Driver) -> None:
    """Modes are there at once whatever culls; where a view has nothing to show, a note says so and a button switches;
    a method is chosen with its additions; key C is off."""
    d.settle()
    d.wait(lambda: d.c.loader.ready, "the kernels that make certificates")
    d.fix_resolution(240, 180)
    for base in ("certified", "none"):
        d.c.settings.change(method=base)
        d.settle()
        traced = d.c.history.frames
        for key, view in ((KEY._2, View.OCCLUSION), (KEY._3, View.SHADOW), (KEY._7, View.PIXEL_COUNT)):
            d.press(key)
            assert d.c.scheduler.drawn_view is view and d.c.history.frames == traced
            assert np.abs(d.shown().astype(int) - picture(d.c.frame, view, d.c.session.draw.light)).max() <= 2
        seen = [row.name for row in classes_in(d.c.frame, View.OCCLUSION) if row.pixels]
        assert "fully rendered" in seen, seen
        said = d.c.frame.statistics.by_modes_in_all
        assert said.full_shadow + said.non_shadow > 0
        d.press(KEY._8)
        d.settle()
        d.context.item_click("//Picture/**/Use paper##instead")
        d.settle()
        assert d.c.frame.settings.method == "paper"
    d.press(KEY._0)
    assert d.c.session.draw.view is View.CERTIFICATE and d.c.frame.certificates is None
    assert d.c.scheduler.drawn_view is View.COLOR
    d.certify()
    d.context.item_click("//Picture/**/Use certified##instead")
    d.settle()
    assert d.c.frame.settings.method == "certified" and d.c.scheduler.drawn_view is View.CERTIFICATE
    d.context.menu_click("//##MainMenuBar/Culling/Method certified")
    d.context.item_click("//Culling/method/##method")
    names = [*(kind.name for kind in bases()), *(f"+{kind.name}" for kind in additions("certified"))]
    assert all(d.context.item_exists(f"//##Combo_00/{name}") for name in names), "all are listed"
    d.context.item_click("//##Combo_00/+cache")
    d.press(KEY.escape)
    d.settle()
    assert d.c.frame.settings.method == "certified+cache" == d.c.preferences.method
    assert d.c.frame.certificates is not None
    expected = picture(d.c.frame, View.CERTIFICATE, shading=d.c.session.draw.shading)
    assert np.abs(d.shown().astype(int) - expected).max() <= 2
    d.press(KEY.c)
    d.settle()
    assert d.c.frame.settings.method == "none"
    d.press(KEY.c)
    d.settle()
    assert d.c.frame.settings.method == "certified+cache"
    for key in ("H", "Shift+H"):
        d.press(chord(key))
        d.settle()
        assert d.c.scheduler.drawn_view is d.c.session.draw.view and not d.c.scheduler.outdated
    _clusters(d)
    _space(d)


def _clusters(d: Driver) -> None:
    """Methods by clusters of lights have a view, and their error and the most clusters can be chosen."""
    d.press(chord(View.CUTS.key))
    d.settle()
    d.context.item_click("//Picture/**/Use lightcuts##instead")
    d.c.settings.change(lamp_radius=0.3, lamp_samples=16)
    d.settle()
    assert d.c.frame.settings.method.startswith("lightcuts") and d.c.scheduler.drawn_view is View.CUTS
    assert d.c.frame.statistics.cuts.most > 3
    expected = picture(d.c.frame, View.CUTS)
    assert np.abs(d.shown().astype(int) - expected).max() <= 2
    d.context.item_input_value("//Culling/**/##lightcuts_error", 20.0)
    d.settle()  # the words above the sliders are of another length then, and the sliders elsewhere
    d.context.item_input_value("//Culling/**/##lightcuts_nodes", 3)
    d.settle()
    assert (d.c.frame.settings.lightcuts_error, d.c.frame.settings.lightcuts_nodes) == (0.2, 3)
    assert d.c.frame.statistics.cuts.most == 3


def _space(d: Driver) -> None:
    """What methods keep of space: a slice through voxels, which keys and a slider move; cells by the lights that they
    ask; and a light's cube in a panel."""
    d.c.settings.change(lamp_radius=None, lamp_samples=None)
    for view, name in ((View.VOXELS, "voxels"), (View.CELL_LIGHTS, "lie-exact")):
        d.press(chord(view.key))
        d.settle()
        assert d.c.scheduler.drawn_view is View.COLOR, "the method has nothing to show"
        d.context.item_click(f"//Picture/**/Use {name}##instead")
        d.settle()
        assert d.c.frame.settings.method.startswith(name) and d.c.scheduler.drawn_view is view
        expected = picture(d.c.frame, view, beneath=d.c.session.draw.beneath, slice=d.c.session.draw.slice)
        assert np.abs(d.shown().astype(int) - expected).max() <= 2
        if view is View.VOXELS:
            _slice(d)
    _tree(d)
    _light_buffer(d)


def _light_buffer(d: Driver) -> None:
    """A line where the method has none; else the cube by lengths of lists, or by where full shadow begins."""
    state = d.ui.state(CubeState)
    d.ui.show_panel("Light buffer")
    d.wait(lambda: isinstance(state.answer, str), "why there is none", 20.0)
    d.c.settings.change(method="lightbuffer")
    d.settle()
    d.wait(lambda: isinstance(state.answer, Unfolded), "the cube", 20.0)
    lists = state.answer
    d.frames(3)
    assert imgui.internal.find_window_by_name("Light buffer").draw_list.vtx_buffer.size() > 0
    d.context.item_click("//Light buffer/distance at which full shadow begins")
    # Whatever the picture is traced anew for meanwhile, its lists stay as they are.
    d.wait(lambda: (state.answer.cross != lists.cross).any(), "where full shadow begins", 20.0)
    assert state.depths


def _tree(d: Driver) -> None:
    """What rays have had built of a tree, also where the camera looks at nothing; keys go through it."""
    d.press(chord(View.TREE.key))
    d.settle()
    d.context.item_click("//Picture/**/Use kdtree-lazy##instead")
    d.settle()
    assert d.c.frame.settings.accelerator == "kdtree-lazy" and d.c.scheduler.drawn_view is View.TREE
    d.c.settings.change(method="none")
    d.settle()
    at = d.c.session.draw.slice
    assert "all that has been seen" in d.c.pictures.now().warmup.unknown
    expected = picture(
        d.c.frame, View.TREE, shading=d.c.session.draw.shading, beneath=d.c.session.draw.beneath, slice=at
    )
    assert np.abs(d.shown().astype(int) - expected).max() <= 2
    d.press(chord("Shift+RightBracket"))
    assert d.c.session.draw.slice.layer(LAYERS) == at.layer(LAYERS) + 1
    d.press(chord("Shift+LeftBracket"))
    home = d.c.session.camera
    x, y, z = home.direction
    d.c.motion.move(replace(home, direction=(-x, -y, -z)))
    d.settle()
    assert (d.c.frame.primitive < 0).all() and d.c.scheduler.drawn_view is View.TREE
    assert d.c.frame.statistics.built.primitives == 3, "what was built stays"
    d.c.motion.move(home)
    d.c.settings.change(accelerator="bvh8")
    d.settle()


def _slice(d: Driver) -> None:
    """Keys and the panel go from layer to layer, and say what the pointer is on."""
    sides, before = d.c.frame.structures["voxels"].shape, d.shown()
    axis = d.c.session.draw.slice.axis
    layer, traced = d.c.session.draw.slice.layer(sides[axis]), d.c.history.frames
    d.press("Shift+RightBracket")
    assert d.c.session.draw.slice.layer(sides[axis]) == layer + 1
    d.press("Shift+LeftBracket")
    assert d.c.session.draw.slice.layer(sides[axis]) == layer
    d.click("//View/**/z##slice")
    d.enter("//View/**/##layer", sides[2] // 2)
    cut = d.c.session.draw.slice
    assert (cut.axis, cut.layer(sides[2])) == (2, sides[2] // 2)
    assert (d.shown() != before).any() and d.c.history.frames == traced, "another slice has traced"
    seen = np.argwhere(voxels_seen(d.c.frame, cut)[0] >= 0)
    if len(seen):
        y, x = seen[len(seen) // 2].tolist()
        assert f", {sides[2] // 2}" in slicing.lines_at(d.ui, x, y)[0]


def explaining(d: Driver) -> None:
    """What the pointer is on, or was clicked, is explained beside the window's own frames; a key hides the lines."""
    d.settle()
    explaining = d.c.inspector
    assert explaining.answer is None
    traced = d.c.history.frames
    left, top, right, bottom = d.picture_edges()
    shadow, lit = (_places(d, lit) for lit in (False, True))
    d.context.mouse_move_to_pos((left + shadow[0] * (right - left), top + shadow[1] * (bottom - top)))
    d.wait(lambda: explaining.answer is not None, "an answer about the pointer's pixel", 20.0)
    blocked = [one for one in explaining.answer.reasons if one.blocker >= 0]
    assert blocked and not any(one.lit for one in blocked)
    d.frames(3)
    hovering = _lines_drawn(d)
    d.press(KEY.i)
    assert _lines_drawn(d) == hovering, "shadow rays are drawn for a pixel that was not clicked"
    d.press(KEY.i)
    d.context.mouse_move_to_pos((left + lit[0] * (right - left), top + lit[1] * (bottom - top)))
    d.wait(lambda: all(one.blocker < 0 for one in explaining.answer.reasons), "an answer about another pixel", 20.0)
    d.context.mouse_move_to_pos((left + shadow[0] * (right - left), top + shadow[1] * (bottom - top)))
    d.context.mouse_click(0)
    d.frames(3)
    assert d.c.selection.picked is not None
    d.context.mouse_move_to_pos((left + lit[0] * (right - left), top + lit[1] * (bottom - top)))
    d.wait(lambda: explaining.answer is not None, "an answer about what was clicked", 20.0)
    assert any(one.blocker >= 0 for one in explaining.answer.reasons), "it goes on following the pointer"
    assert d.c.history.frames == traced, "asking has traced a frame"
    point = explaining.tree.rays[0].end
    d.hold(KEY.d, 0.3)
    d.settle()
    assert explaining.answer is not None and math.dist(explaining.tree.rays[0].end, point) < 0.2
    d.context.mouse_move(f"//Inspector/**/{d.c.session.scene.lights[0].name}##light")
    d.frames(3)
    assert d.ui.state(Pointed).light == 0
    d.context.mouse_move_to_pos((left + shadow[0] * (right - left), top + shadow[1] * (bottom - top)))
    d.frames(3)
    drawn = _lines_drawn(d)
    d.press(KEY.i)
    assert not d.c.session.draw.rays and _lines_drawn(d) < drawn - 50
    d.press(KEY.i)
    assert _lines_drawn(d) == drawn
    d.press(KEY.escape)
    assert d.c.selection.picked is None and _lines_drawn(d) < drawn - 50, "Escape clears"
    d.context.mouse_click(0)
    d.frames(3)
    assert d.c.selection.picked is not None
    d.context.mouse_move_to_pos((left + 0.5 * (right - left), top + 0.02 * (bottom - top)))
    d.context.mouse_click(0)
    d.frames(3)
    assert d.c.selection.picked is None and explaining.answer is None, "a click on nothing clears"


def _lines_drawn(d: Driver) -> int:
    """How much is drawn over the picture, in corners of triangles."""
    return imgui.internal.find_window_by_name("Picture").draw_list.vtx_buffer.size()


def _places(d: Driver, lit: bool) -> tuple[float, float]:
    """A pixel of the square, on the picture, that a light which is due reaches, or does not, and so its neighbours."""
    renderer = Renderer(d.c.session.scene, replace(d.c.frame.settings, method="none", record_lights=True))
    frame = renderer.render(d.c.frame.time, d.c.frame.camera)
    here = (frame.primitive >= 0) & (frame.primitive < d.c.session.scene.triangle_count)
    here &= (frame.lit == frame.due).all(-1) if lit else (frame.due & ~frame.lit).any(-1)
    inner = here.copy()
    for shift in (-4, 4):
        inner &= np.roll(here, shift, 0) & np.roll(here, shift, 1)
    y, x = np.argwhere(inner)[inner.sum() // 2]
    return (x + 0.5) / frame.width, (y + 0.5) / frame.height
