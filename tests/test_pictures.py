"""Views without a GPU: the colours mean what the legends say, and the shaders draw the same."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tracer.culling.modes import OcclusionMode, ShadowMode
from tracer.frame import Frame, Settings
from tracer.renderer import Renderer
from tracer.scene.load import load_scene
from viewer.pictures import SHADING, picture
from viewer.views import BACKGROUND, GREY, OCCLUSION_COLORS, SHADOW_COLORS, View

SCENE = """\
b 0.2 0.3 0.4
v from 0 1 4 at 0 0 0 up 0 1 0 angle 50 hither 1 resolution 32 32
a 0 9 10
l 2 4 3 1 1 1
l -3 4 2 0.5 0.5 0.5
f 0.8 0.6 0.4 0.9 0.1 10 0 1
p 4 -1 -0.5 -1 -1 -0.5 1 1 -0.5 1 1 -0.5 -1
f 0.3 0.5 0.8 0.9 0.1 10 0 1
s 0 0 0 0.5
x flyer { p 3 -0.2 0.8 0 0.2 0.8 0 0 1.1 0 }
k flyer { transl 4 -1 0 0 0 0 0 0  0 0 0 0 0 0 0  9 1 0 0 0 0 0  10 1 0 0 0 0 0 }
"""


@pytest.fixture(scope="module")
def frame(tmp_path_factory: pytest.TempPathFactory) -> Frame:
    """The third frame of a small scene, with a sphere that hides a part of the floor and a triangle that moves."""
    path = tmp_path_factory.mktemp("pictures") / "scene.aff"
    path.write_text(SCENE)
    renderer = Renderer(load_scene(path), Settings(width=96, height=64, threads=1))
    return [renderer.render(time) for time in (1.0, 2.0, 3.0)][-1]


def to_bytes(color: tuple[float, ...]) -> np.ndarray:
    return np.round(np.asarray(color) * 255.0).astype(np.uint8)


def test_colours_are_clamped_and_otherwise_untouched(frame: Frame) -> None:
    expected = np.round(np.clip(frame.color, 0, 1) * 255).astype(np.uint8)
    np.testing.assert_array_equal(picture(frame), expected)


@pytest.mark.parametrize("view", [v for v in View if v is not View.COLOR])
def test_what_is_missed_has_the_background(frame: Frame, view: View) -> None:
    missed = frame.primitive < 0
    assert missed.any()
    assert (picture(frame, view)[missed] == to_bytes(BACKGROUND)).all()


def test_occlusion_modes_have_their_colours(frame: Frame) -> None:
    drawn = picture(frame, View.OCCLUSION, shading=0.0)
    seen = set()
    for mode in OcclusionMode:
        there = frame.occlusion_mode == mode
        assert (drawn[there] == to_bytes(OCCLUSION_COLORS[mode])).all()
        seen |= {mode} if there.any() else set()
    assert {OcclusionMode.PARTIALLY_OCCLUDED, OcclusionMode.FULLY_RENDERED, OcclusionMode.DYNAMIC} <= seen


@pytest.mark.parametrize("light", [0, 1])
def test_shadow_modes_have_their_colours(frame: Frame, light: int) -> None:
    drawn = picture(frame, View.SHADOW, light, shading=0.0)
    moving = frame.occlusion_mode == OcclusionMode.DYNAMIC
    assert (drawn[moving] == to_bytes(OCCLUSION_COLORS[OcclusionMode.DYNAMIC])).all()
    for mode in ShadowMode:
        there = (frame.shadow_mode[..., light] == mode) & ~moving
        assert (drawn[there] == to_bytes(SHADOW_COLORS[mode])).all()


def test_every_primitive_has_a_colour_of_its_own(frame: Frame) -> None:
    drawn = picture(frame, View.PRIMITIVE, shading=0.0)
    hit = frame.primitive >= 0
    colors = {tuple(c) for c in drawn[hit]}
    assert len(colors) == len(np.unique(frame.primitive[hit]))


def test_a_light_past_the_culled_ones_is_drawn_as_unknown(frame: Frame) -> None:
    many = replace(frame, lights=40)
    drawn = picture(many, View.SHADOW, 35, shading=0.0)
    still = (frame.primitive >= 0) & (frame.occlusion_mode != OcclusionMode.DYNAMIC)
    assert (drawn[still] == to_bytes(GREY)).all()


def test_a_light_that_is_not_there(frame: Frame) -> None:
    with pytest.raises(ValueError, match="no light 2: the scene's lights are 0 to 1"):
        picture(frame, View.SHADOW, 2)


@pytest.mark.gui
@pytest.mark.parametrize("view", list(View))
def test_shaders_draw_the_same(frame: Frame, view: View, tmp_path: Path) -> None:
    moderngl = pytest.importorskip("moderngl")
    from viewer.display import Display, Look

    context = moderngl.create_context(standalone=True, require=330)
    with context:
        display = Display()
        display.upload(frame)
        display.draw(Look(view=view, light=1, shading=SHADING))
        on_gpu = display.read()[..., :3].astype(int)
        display.release()
    context.release()
    here = picture(frame, view, 1).astype(int)
    assert np.abs(on_gpu - here).max() <= 1
