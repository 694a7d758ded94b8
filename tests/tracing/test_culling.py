"""Shadow culling over frames: what is culled, what must not be, and when modes are dropped."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import tracer
from tests.tracing.shades import floor, roof, shadow_scene
from tests.tracing.worlds import moved, scene
from tracer.culling.modes import OcclusionMode, ShadowMode, occlusion_mode, shadow_mode
from tracer.scene.model import Camera

SETTINGS = tracer.Settings(width=48, height=48, depth=2, threads=1, verify=True)
LIGHT = (0.0, 0.0, 20.0)


def test_what_is_due_is_saved_or_traced_and_saved_is_culled_or_dynamic_only():
    renderer = tracer.Renderer(shadow_scene(), replace(SETTINGS, verify=False))
    first, second = (renderer.render().statistics.shadow for _ in range(2))
    assert (first.saved, first.traced, first.due) == (0, first.due, second.due)
    assert second.saved == second.culled + second.dynamic_only and min(second.culled, second.dynamic_only) > 0
    assert second.traced == second.due - second.saved == second.rays, "nothing moves"
    other = tracer.Renderer(shadow_scene(), replace(SETTINGS, method="certified+cache"))
    for _ in range(4):
        shadow = other.render().statistics.shadow
    assert shadow.candidates_only + shadow.cache_hits > 0
    assert shadow.due == shadow.saved + shadow.candidates_only + shadow.cache_hits + shadow.traced


def test_modes_tell_lit_shadowed_and_partly_shadowed_apart():
    frame = tracer.Renderer(shadow_scene(), replace(SETTINGS, width=96, height=96)).render()
    seen_whole = occlusion_mode(frame.modes) == OcclusionMode.FULLY_RENDERED
    found = set(shadow_mode(frame.modes, 0)[seen_whole].tolist())
    assert {ShadowMode.FULL_SHADOW, ShadowMode.NON_SHADOW, ShadowMode.PARTIAL_SHADOW} <= found


def test_a_moving_object_leaves_no_stale_shadow():
    """Its shadow falls on squares that are known as NON_SHADOW; taken away, the light is back."""
    above = np.eye(4)
    with_object = shadow_scene(dynamic=(moved("kite", roof(5.0, 0.6), _shifted(above, 2.0)),))
    gone = shadow_scene(dynamic=(moved("kite", roof(5.0, 0.6), _shifted(above, 200.0)),))
    renderer = tracer.Renderer(gone, replace(SETTINGS, record_lights=True))
    renderer.render()
    lit = renderer.render().lit
    # The same renderer, its object placed elsewhere: what culling knows must still hold.
    renderer.world.scene = renderer.scene = with_object
    shadowed = renderer.render()
    reference = tracer.Renderer(with_object, replace(SETTINGS, method="none", record_lights=True)).render()
    assert (shadowed.lit != lit).any()
    assert np.array_equal(shadowed.lit, reference.lit)
    assert np.array_equal(shadowed.color, reference.color)
    assert shadowed.statistics.shadow.dynamic_only > 0


def _shifted(matrix: np.ndarray, x: float) -> np.ndarray:
    result = matrix.copy()
    result[0, 3] = x
    return result


def test_a_primitive_on_the_screens_edge_is_partially_occluded():
    close = Camera((0.0, 0.0, 4.0), (0.0, 0.0, -1.0), angle=40.0)
    frame = tracer.Renderer(scene(floor(), lights=[LIGHT], camera=close), SETTINGS).render()
    edge = np.concatenate([frame.occlusion_mode[0], frame.occlusion_mode[-1], frame.occlusion_mode[:, 0]])
    assert (edge == OcclusionMode.PARTIALLY_OCCLUDED).all()
    assert (frame.occlusion_mode == OcclusionMode.FULLY_RENDERED).any()


@pytest.mark.parametrize("zoom_factor, anew", [(4.0, True), (1000.0, False)])
def test_a_primitive_past_the_zoom_factor_is_examined_anew(zoom_factor, anew):
    renderer = tracer.Renderer(scene(floor(), lights=[LIGHT]), replace(SETTINGS, zoom_factor=zoom_factor))
    before = renderer.render()
    after = renderer.render(camera=Camera((0.0, 0.0, 3.0), (0.0, 0.0, -1.0), angle=40.0))
    middle = after.primitive[24, 24]
    assert after.pixel_count[middle] > 4 * before.pixel_count[middle] > 0
    mode = OcclusionMode.INIT if anew else OcclusionMode.FULLY_RENDERED
    assert occlusion_mode(after.modes)[middle] == mode
    assert after.highest_count[middle] == (after if anew else before).pixel_count[middle]


def test_fully_rendered_outlives_later_occlusion():
    renderer = tracer.Renderer(scene(floor(), lights=[LIGHT]), replace(SETTINGS, zoom_factor=1000.0))
    whole = occlusion_mode(renderer.render().modes) == OcclusionMode.FULLY_RENDERED
    cut = renderer.render(camera=Camera((1.3, 1.3, 6.0), (0.0, 0.0, -1.0), angle=20.0))
    at_edge = np.unique(cut.primitive[0][cut.primitive[0] >= 0])
    assert whole[at_edge].any()
    assert (occlusion_mode(cut.modes)[at_edge[whole[at_edge]]] != OcclusionMode.PARTIALLY_OCCLUDED).all()


def test_modes_learnt_at_one_resolution_do_not_speak_at_a_finer_one():
    renderer = tracer.Renderer(shadow_scene(), SETTINGS)
    renderer.render()
    renderer.settings = replace(SETTINGS, width=96, height=96)
    assert renderer.render().statistics.shadow.culled == 0
    assert renderer.render().statistics.shadow.culled > 0
    renderer.settings = SETTINGS
    assert renderer.render().statistics.shadow.culled > 0


def test_a_coarser_resolution_begins_with_what_a_finer_one_has_seen_whole():
    fine, coarse = replace(SETTINGS, width=96, height=96), replace(SETTINGS, width=32, height=32)
    renderer = tracer.Renderer(scene(floor(), lights=[LIGHT]), fine)
    before = renderer.render()
    renderer.settings = coarse
    first = renderer.render()
    assert first.statistics.shadow.saved > 0
    middle = before.primitive[48, 48]
    assert first.highest_count[middle] == round(before.pixel_count[middle] / 9)
    for distance, mode in ((6.0, OcclusionMode.FULLY_RENDERED), (4.0, OcclusionMode.INIT)):  # 2.8, 6.3 times as many
        near = renderer.render(camera=Camera((0.0, 0.0, distance), (0.0, 0.0, -1.0), angle=40.0))
        assert occlusion_mode(near.modes)[middle] == mode


def test_of_a_light_that_has_moved_a_coarser_resolution_takes_over_nothing():
    still = scene(floor(), lights=[LIGHT])
    renderer = tracer.Renderer(still, replace(SETTINGS, width=96, height=96))
    for _ in range(2):
        saved = renderer.render().statistics.shadow.saved
    renderer.settings = replace(SETTINGS, width=32, height=32)
    renderer.scene = replace(still, lights=(replace(still.lights[0], position=(1.0, 2.0, 9.0)),))
    assert saved > 0 == renderer.render().statistics.shadow.saved


def test_of_many_resolutions_the_latest_are_remembered():
    renderer = tracer.Renderer(shadow_scene(), SETTINGS)
    renderer.render()
    for width in range(8, 8 + 40):  # a window's edge is dragged
        renderer.settings = replace(SETTINGS, width=width, height=8)
        renderer.render()
    assert renderer.render().statistics.shadow.dynamic_only > 0
    assert len(renderer.state.histories) == 16
    renderer.settings = SETTINGS
    assert renderer.render().statistics.shadow.culled == 0


def test_reset_forgets_everything():
    renderer = tracer.Renderer(shadow_scene(), SETTINGS)
    renderer.render()
    renderer.reset_modes()
    assert renderer.render().statistics.shadow.culled == 0


@pytest.mark.parametrize("questions", (0, 2, 4, 6, 8, 11, 12))
def test_a_cancelled_frame_teaches_nothing(questions):
    """Wherever it is cut short: 4 tiles of primary rays, 4 strips of occlusion testing, 4 tiles of shading."""
    settings = replace(SETTINGS, width=128, height=128)
    renderer, untouched = (tracer.Renderer(shadow_scene(), settings) for _ in range(2))
    for r in (renderer, untouched):
        r.render()
    asked = iter([False] * questions)
    elsewhere = Camera((12.0, 0.0, 4.0), (-12.0, 0.0, -4.0), (0.0, 0.0, 1.0), 40.0)
    if questions < 12:
        with pytest.raises(tracer.Cancelled):
            renderer.render(camera=elsewhere, cancel=lambda: next(asked, True))
    else:
        for r in (renderer, untouched):
            r.render(camera=elsewhere, cancel=lambda: next(asked, False))
    a, b = renderer.render(), untouched.render()
    assert np.array_equal(a.modes, b.modes)
    assert a.statistics.shadow == b.statistics.shadow
