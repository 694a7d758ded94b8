"""What became of each shadow ray: what is recorded pixel by pixel agrees with what the frame counts."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given

import tracer
from tests.scenes import loaded
from tests.tracing.random_worlds import Walk, quickly, walks
from tests.tracing.shades import shadow_scene
from tracer.culling.fate import FATE, Fate
from tracer.culling.modes import OcclusionMode, ShadowMode, shadow_mode
from tracer.settings import RECORDS
from viewer.util.resources import embedded_scenes

SETTINGS = tracer.Settings(48, 40, depth=0, threads=2, record_fates=True)
METHODS = (*("none", "cells", "certified+cache", "auto", "paper+rest", "paper+lightbuffer", "voxels", "lie-exact"),)
BY_MODES = {Fate.PARTLY_OCCLUDED, Fate.PARTIAL_SHADOW, Fate.NOT_SEEN_WHOLE, Fate.DYNAMIC}


def fates_of(frame: tracer.Frame) -> np.ndarray:
    """(h, w, lights) uint8."""
    return np.stack([frame.fate(light) for light in range(frame.lights)], axis=-1)


def assert_counted(frame: tracer.Frame) -> None:
    """Summed over pixels, fates are the counters of a frame without bounces."""
    shadow = frame.statistics.shadow
    expected = (shadow.culled, shadow.dynamic_only, shadow.candidates_only, shadow.cache_hits, shadow.traced)
    assert frame.fates is not None
    for fates in (frame.fates & FATE, fates_of(frame)):
        count = np.bincount(fates.reshape(-1), minlength=len(Fate))
        assert tuple(count[Fate.CULLED : Fate.PARTLY_OCCLUDED]) == expected[:-1]
        assert count[Fate.PARTLY_OCCLUDED :].sum() == expected[-1]
        hit = frame.primitive >= 0
        assert (fates[hit] >= Fate.FACES_AWAY).all() and not fates[~hit].any(), "known of all that is seen"


@pytest.mark.parametrize("method", METHODS)
@given(walk=walks())
@quickly(4)
def test_fates_in_random_worlds_are_those_that_the_frame_counts(method: str, walk: Walk) -> None:
    renderer = tracer.Renderer(walk.scene, replace(SETTINGS, method=method))
    for time, camera in walk.frames[:4]:
        assert_counted(renderer.render(time, camera))


def by_modes(word: int, light: int) -> Fate:
    """What the paper's method does by a word of modes, as §2.4 has it."""
    by_occlusion = {
        OcclusionMode.INIT: Fate.NOT_SEEN_WHOLE,
        OcclusionMode.PARTIALLY_OCCLUDED: Fate.PARTLY_OCCLUDED,
        OcclusionMode.DYNAMIC: Fate.DYNAMIC,
    }
    by_shadow = {
        ShadowMode.INIT: Fate.NOT_SEEN_WHOLE,
        ShadowMode.FULL_SHADOW: Fate.CULLED,
        ShadowMode.NON_SHADOW: Fate.DYNAMIC_ONLY,
        ShadowMode.PARTIAL_SHADOW: Fate.PARTIAL_SHADOW,
    }
    return by_occlusion.get(OcclusionMode(word & 3)) or by_shadow[ShadowMode(word >> (2 + 2 * light) & 3)]


@pytest.mark.parametrize("method", ["paper", "cells"])
def test_fates_are_those_of_the_modes_that_the_frame_before_has_left(method: str) -> None:
    met = set[Fate]()

    @given(walk=walks())
    @quickly(3)
    def check(walk: Walk) -> None:
        renderer = tracer.Renderer(walk.scene, replace(SETTINGS, method=method))
        for time, camera in walk.frames[:5]:
            frame = renderer.render(time, camera)
            for y, x in np.argwhere(frame.primitive >= 0)[::7]:
                word = int(frame.modes_before[frame.cell[y, x]])
                for light in range(frame.lights):
                    fate = Fate(frame.fate(light)[y, x])
                    assert fate in (Fate.FACES_AWAY, by_modes(word, light))
                    met.add(fate)

    check()
    assert met >= {Fate.CULLED, Fate.DYNAMIC_ONLY, *BY_MODES}


@pytest.mark.parametrize("method", ["paper", "cells"])
def test_shadow_modes_gain_what_traced_rays_have_found_and_nothing_else(method: str) -> None:
    """In scenes in which nothing moves, without bounces, so that a ray's answer is what the picture shows (§2.5)."""
    gained = 0

    @given(walk=walks())
    @quickly(3)
    def check(walk: Walk) -> None:
        nonlocal gained
        still = replace(walk.scene, objects=walk.scene.objects[:1])
        renderer = tracer.Renderer(still, replace(SETTINGS, method=method, record_lights=True))
        for _, camera in walk.frames[:4]:
            frame = renderer.render(0.0, camera)
            assert frame.due is not None and frame.lit is not None
            for light in range(frame.lights):
                traced = frame.due[..., light] & (frame.fate(light) >= Fate.PARTLY_OCCLUDED)
                expected = shadow_mode(frame.modes_before, light)
                found = np.where(frame.lit[..., light], ShadowMode.NON_SHADOW, ShadowMode.FULL_SHADOW)
                np.bitwise_or.at(expected, frame.cell[traced], found[traced].astype(expected.dtype))
                assert np.array_equal(shadow_mode(frame.modes, light), expected)
                gained += np.count_nonzero(expected != shadow_mode(frame.modes_before, light))

    check()
    assert gained > 100


@pytest.mark.parametrize("method", ("none", "certified+cache", "lightbuffer", "voxels", "free"))
def test_reasons_of_the_papers_modes_are_given_for_methods_that_cull_by_them_alone(method: str) -> None:
    renderer = tracer.Renderer(shadow_scene(), replace(SETTINGS, method=method))
    renderer.render()
    frame = renderer.render()
    assert not BY_MODES & {Fate(fate) for fate in np.unique(fates_of(frame))}


@pytest.mark.parametrize("method", ["certified+cache", "paper"])
def test_a_moving_shadow_is_where_light_comes_once_what_moves_is_gone(method: str) -> None:
    scene = loaded(embedded_scenes()["default"])
    renderer = tracer.Renderer(scene, replace(SETTINGS, width=72, height=60, method=method, record_lights=True))
    for number in range(3):
        frame = renderer.render(1.0 + number / 30.0)
    still = replace(scene, objects=scene.objects[:1])
    alone = tracer.Renderer(still, replace(frame.settings, method="none")).render(frame.time, frame.camera)
    assert frame.lit is not None and frame.due is not None and alone.lit is not None
    same, dark = frame.primitive == alone.primitive, 0
    for light in range(frame.lights):
        expected = same & alone.lit[..., light] & frame.due[..., light] & ~frame.lit[..., light]
        found = same & frame.moving_shadow(light)
        if method == "paper":  # it is wrong now and then about what is static
            fates = frame.fate(light)
            assert (fates[found & ~alone.lit[..., light]] == Fate.DYNAMIC_ONLY).all()
            expected, found = expected & (fates != Fate.CULLED), found & alone.lit[..., light]
        assert np.array_equal(found, expected), light
        dark += np.count_nonzero(found)
    assert dark > 50


def test_a_picture_of_which_a_part_is_shaded_says_what_the_modes_of_each_pixel_say() -> None:
    """Also of pixels that have not been shaded, which are due where the nearest that has been is due."""
    scene = loaded(embedded_scenes()["default"])
    renderer = tracer.Renderer(scene, replace(SETTINGS, width=96, height=80))
    for number in range(4):
        *parts, whole = renderer.refine(1.0 + number / 30.0, parts=(1, 4, 16))
    apart = []
    for part in parts:
        assert part.shaded is not None and not part.shaded.all()
        for light in range(whole.lights):
            fates, final = part.fate(light), whole.fate(light)
            assert np.array_equal(fates[part.shaded], final[part.shaded])
            hit = part.primitive >= 0
            guessed = hit & ~part.shaded & (fates >= Fate.CULLED) & (final >= Fate.CULLED)
            assert np.array_equal(fates[guessed], final[guessed])
            assert np.count_nonzero(part.moving_shadow(light) != whole.moving_shadow(light)) < 0.05 * fates.size
        apart.append(np.mean([part.fate(light) != whole.fate(light) for light in range(whole.lights)]))
    assert apart[0] < 0.15 and apart[1] < 0.06, "most of them have seen their own primitive"


def test_of_a_lamp_the_sample_that_asked_most_counts() -> None:
    settings = replace(SETTINGS, lamp_radius=0.4, lamp_samples=8)
    renderer = tracer.Renderer(loaded(embedded_scenes()["default"]), settings)
    for number in range(3):
        frame = renderer.render(1.0 + number / 30.0)
    shadow = frame.statistics.shadow
    fates = fates_of(frame)
    assert 8 * np.count_nonzero(fates == Fate.CULLED) >= shadow.culled > 0
    assert np.count_nonzero(fates >= Fate.CULLED) * 8 >= shadow.due


def test_without_a_record_there_is_one_line_and_with_one_the_picture_is_the_same() -> None:
    scene = shadow_scene()
    plain, recorded = (
        tracer.Renderer(scene, replace(SETTINGS, depth=2, record_fates=record)).render() for record in (False, True)
    )
    assert plain.fates is None and np.array_equal(plain.color, recorded.color)
    assert plain.statistics.shadow == recorded.statistics.shadow
    with pytest.raises(ValueError, match="did not record"):
        plain.fate(0)
    clustered = tracer.Renderer(scene, replace(SETTINGS, method="lightcuts")).render()
    assert clustered.fates is None, "single lights have no rays of their own"


def test_what_only_adds_to_a_frame_is_listed_once() -> None:
    assert {name for name in vars(SETTINGS) if name.startswith("record_")} | {"verify"} == set(RECORDS)
    all_recorded = replace(SETTINGS, **dict.fromkeys(RECORDS, True))
    alone = all_recorded.recording_only("record_lights")
    assert [name for name in RECORDS if getattr(alone, name)] == ["record_lights"]
    assert all_recorded.recording_only() == replace(SETTINGS, record_fates=False), "all else stays"
    assert all_recorded.records_fates and not replace(all_recorded, method="lightcuts").records_fates
