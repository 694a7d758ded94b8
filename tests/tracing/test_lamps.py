"""Lamps: lights that shine from many points."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.sweeps import ACCELERATORS
from tests.tracing.shades import BEHIND, floor, going, kite, roof
from tests.tracing.worlds import random_corners, scene
from tracer.culling.modes import FULLY_RENDERED, ShadowMode
from tracer.inspect.one_light import with_light
from tracer.inspect.why import why
from tracer.renderer import Renderer
from tracer.scene.animation import Animation
from tracer.scene.lights import Light
from tracer.scene.model import Camera, Scene
from tracer.settings import Settings

LAMP = Light("lamp", (0.0, 0.0, 20.0), (0.9, 0.8, 0.7), kind="sphere", radius=3.0, samples=16)
POINT = Light("point", (2.0, 3.0, 12.0), (0.3, 0.2, 0.1))
SETTINGS = Settings(width=96, height=96, depth=2, method="none", threads=2, record_lights=True)


def room(*lights: Light, kites: bool = False) -> Scene:
    """A floor below a roof, under these lights, perhaps with a kite that rests, flies and rests again."""
    flight = Animation({"kite": going([(0, -1.5), (1, -1.5), (2, 1.5), (4, 1.5)])})
    moving = {"dynamic": (kite("kite"),), "animation": flight} if kites else {}
    return replace(scene(floor() + roof(6.0, 1.0), camera=BEHIND, **moving), lights=lights)


def as_points(lamp: Light) -> tuple[Light, ...]:
    """A point light for each sample of a lamp."""
    color = tuple(np.float32(np.array(lamp.color) / lamp.samples).tolist())
    places = np.float32(np.array(lamp.position) + lamp.offsets()).tolist()
    return tuple(Light(f"{lamp.name} {k}", tuple(p), color, falloff=lamp.falloff) for k, p in enumerate(places))


@pytest.mark.parametrize("accelerator", ACCELERATORS)
@pytest.mark.parametrize("falloff", ["none", "inverse square"])
def test_a_lamp_is_the_lights_that_its_samples_are(accelerator: str, falloff: str):
    lamp, settings = replace(LAMP, falloff=falloff), replace(SETTINGS, accelerator=accelerator)
    frame = Renderer(room(lamp, POINT), settings).render(0.0)
    points = Renderer(room(*as_points(lamp), POINT), settings).render(0.0)
    assert frame.color.tobytes() == points.color.tobytes()
    assert frame.asked is not None and points.due is not None and frame.reached is not None and points.lit is not None
    assert (frame.asked[..., 0] == points.due[..., :16].sum(axis=-1)).all()
    assert (frame.reached[..., 0] == points.lit[..., :16].sum(axis=-1)).all()
    assert frame.asked[..., 1].tobytes() == points.asked[..., 16].tobytes()
    penumbra = (frame.reached[..., 0] > 0) & (frame.reached[..., 0] < frame.asked[..., 0])
    assert penumbra.sum() > 50, "no penumbra: this shows nothing"
    assert frame.statistics.shadow.due == points.statistics.shadow.due


@pytest.mark.parametrize("accelerator", ACCELERATORS)
@pytest.mark.parametrize("method", ["none", "certified"])
def test_one_light_alone_is_recorded_as_among_all(accelerator: str, method: str):
    """Beside moving objects, too, and whatever is known of the light; the frames that follow stay the same."""
    scene_, settings = room(LAMP, POINT, kites=True), replace(SETTINGS, accelerator=accelerator, method=method)
    all_lights = Renderer(scene_, settings)
    alone = Renderer(scene_, replace(settings, record_lights=False))
    for time in (0.0, 0.5, 1.5, 1.5):
        expected, frame = all_lights.render(time), alone.render(time)
        assert expected.asked is not None and expected.reached is not None and frame.asked is None
        for light in (1, 0):
            found = with_light(alone, frame, light)
            assert found.only_light == light and found.color is frame.color
            for name in ("asked", "reached"):
                samples = getattr(found, name)
                assert samples.shape == (96, 96, 1) and samples.dtype == np.uint16
                assert np.array_equal(samples[..., 0], getattr(expected, name)[..., light]), (name, light, time)
        assert frame.color.tobytes() == expected.color.tobytes()
    with pytest.raises(IndexError):
        with_light(alone, frame, 2)


def test_samples_and_pixels_in_the_penumbra_are_counted():
    frame = Renderer(room(LAMP, POINT), SETTINGS).render(0.0)
    assert frame.asked is not None and frame.reached is not None
    counted, partly = frame.statistics.samples, (frame.reached > 0) & (frame.reached < frame.asked)
    assert counted is not None and counted.penumbra == partly.any(axis=-1).sum() > 50
    assert (counted.due, counted.reached) == (frame.asked.sum(), frame.reached.sum())
    assert Renderer(room(LAMP), replace(SETTINGS, record_lights=False)).render(0.0).statistics.samples is None


def test_of_a_part_of_a_picture_it_is_known_which_pixels_were_shaded():
    renderer = Renderer(room(LAMP, POINT), SETTINGS)
    *parts, whole = renderer.refine(0.0, parts=(1, 4, 16))
    assert whole.shaded is None and whole.asked is not None
    for frame in parts:
        assert frame.shaded is not None and frame.asked is not None
        assert frame.shaded.mean() == pytest.approx(frame.statistics.part, abs=0.01)
        assert (
            np.array_equal(frame.asked[frame.shaded], whole.asked[frame.shaded])
            and not frame.asked[~frame.shaded].any()
        )
    renderer.settings = replace(SETTINGS, record_lights=False)
    first = next(iter(renderer.refine(0.0, parts=(1, 16))))
    assert first.asked is None and 0 < first.shaded.sum() < first.shaded.size
    assert np.array_equal(with_light(renderer, first, 0).asked[..., 0], whole.asked[..., 0]), "between two parts"


def test_what_is_recorded_is_of_the_first_sample_of_each_pixel():
    once = Renderer(room(LAMP, POINT), replace(SETTINGS, record_work=True)).render(0.0)
    thrice = Renderer(room(LAMP, POINT), replace(SETTINGS, record_work=True, samples=3)).render(0.0)
    for name in ("asked", "reached", "saved", "cost", "due_rays"):
        assert np.array_equal(getattr(once, name), getattr(thrice, name)), name
    assert not np.array_equal(once.color, thrice.color)


def test_light_falls_off_with_the_square_of_the_distance():
    """At the foot of the lamp on a floor of reflectance 0.8: 0.8 / 20 squared, beside the ambient light."""
    lamp = Light("lamp", (0.0, 0.0, 20.0), (400.0, 200.0, 100.0), falloff="inverse square")
    bare = replace(scene(floor(), camera=BEHIND), lights=(lamp,))
    dark = replace(bare, lights=())
    lit, ambient = (Renderer(s, SETTINGS).render(0.0).color[48, 48] for s in (bare, dark))
    assert lit - ambient == pytest.approx([0.8, 0.4, 0.2], rel=1e-3)


SHAPES = {
    "sphere": {"radius": 0.3},
    "rectangle": {"edges": ((0.6, 0.0, 0.0), (0.0, 0.3, 0.2))},
    "dome": {"radius": 0.4, "edges": ((0.0, 0.0, -1.0),)},
}


@pytest.mark.parametrize("accelerator", ACCELERATORS)
@pytest.mark.parametrize("kind", SHAPES)
@pytest.mark.parametrize("samples", [36, 64, 100])
def test_nearly_all_rays_of_lamps_are_answered_untraced(accelerator: str, kind: str, samples: int):
    """Also those of the penumbra, and all of them rightly."""
    lamp = replace(LAMP, position=(0.3, 0.2, 12.0), kind=kind, samples=samples, **SHAPES[kind])
    settings = replace(SETTINGS, method="certified", accelerator=accelerator, verify=True)
    frame = Renderer(room(lamp), settings).render(0.0)
    shadow = frame.statistics.shadow
    assert frame.asked is not None and frame.reached is not None
    penumbra = int(frame.asked[(frame.reached > 0) & (frame.reached < frame.asked)].sum())
    assert penumbra > 0.005 * shadow.due and min(shadow.culled, shadow.dynamic_only) > 1000
    assert shadow.wrong == 0 and shadow.rays < 0.02 * shadow.due
    assert shadow.saved + shadow.rays == shadow.due


@pytest.mark.parametrize("accelerator", ACCELERATORS)
def test_rays_of_a_lamp_that_moves_are_answered_as_well(accelerator: str):
    """Beside one that rests, flies and rests again, which beams must find in every frame."""
    flying = Animation(
        {"kite": going([(0, -1.5), (1, -1.5), (2, 1.5), (4, 1.5)]), "lamp": going([(0, -2.0), (4, 2.0)])}
    )
    lamp = replace(LAMP, position=(0.3, 0.2, 12.0), radius=0.5, samples=64, track="lamp")
    made = replace(room(lamp, POINT, kites=True), animation=flying)
    settings = replace(SETTINGS, method="certified", accelerator=accelerator, verify=True, record_lights=False)
    renderer = Renderer(made, settings)
    for time in (0.0, 0.4, 0.8, 1.2, 1.6, 2.4, 2.8, 3.2):
        shadow = renderer.render(time).statistics.shadow
        assert shadow.wrong == 0, time
        assert shadow.saved > 0.95 * 64 / 65 * shadow.due, time


@pytest.mark.parametrize("accelerator", ACCELERATORS)
def test_points_that_lie_far_apart_are_answered_each_by_its_own_beam(accelerator: str):
    """Neighbours in a cloud of small triangles see the lamp by other ways, with too much between them for one beam."""
    rng = np.random.default_rng(5)
    cloud = random_corners(rng, 10000, 0.07) * 6.0 - np.array([3.0, 3.0, 0.0])
    lamp = replace(LAMP, position=(1.0, 2.0, 14.0), radius=0.05, samples=64)
    camera = Camera((0.0, -9.0, 8.0), (0.0, 9.0, -6.0))
    made = replace(scene(floor() + cloud.tolist(), camera=camera), lights=(lamp,))
    settings = replace(SETTINGS, method="certified", accelerator=accelerator, verify=True)
    shadow = Renderer(made, settings).render(0.0).statistics.shadow
    assert shadow.wrong == 0 and min(shadow.culled, shadow.dynamic_only) > 1000
    assert shadow.rays < 0.3 * shadow.due, "beams of vectors alone answer half of them"


def test_modes_are_kept_for_the_lamp_and_speak_for_all_its_samples():
    """FULL_SHADOW where every sample is blocked, NON_SHADOW where none is, PARTIAL_SHADOW in the penumbra."""
    renderer = Renderer(room(replace(LAMP, radius=0.5)), replace(SETTINGS, method="paper"))
    frame = renderer.render(0.0)
    assert frame.asked is not None and frame.reached is not None
    seen = {mode: 0 for mode in ShadowMode}
    for unit in np.unique(frame.primitive[frame.primitive >= 0]):
        here = (frame.primitive == unit) & (frame.asked[..., 0] > 0)
        if not here.any():
            continue
        asked, reached = frame.asked[here][:, 0].sum(), frame.reached[here][:, 0].sum()
        expected = (reached < asked) * ShadowMode.FULL_SHADOW | (reached > 0) * ShadowMode.NON_SHADOW
        assert frame.shadow_mode[here][0, 0] == expected, unit
        seen[ShadowMode(expected)] += 1
    assert min(seen[mode] for mode in (ShadowMode.FULL_SHADOW, ShadowMode.NON_SHADOW, ShadowMode.PARTIAL_SHADOW)) > 0
    again = renderer.render(0.1)
    assert (again.occlusion_mode == FULLY_RENDERED).any() and again.statistics.shadow.culled > 0


def test_other_samples_or_another_size_teach_modes_anew():
    renderer = Renderer(room(LAMP, POINT), replace(SETTINGS, method="paper"))
    renderer.render(0.0)
    for change in ({"lamp_samples": 4}, {"lamp_samples": None}, {"lamp_radius": 2.0}):
        before = renderer.render(0.0)
        assert before.statistics.shadow.culled > 0
        renderer.settings = replace(renderer.settings, **change)
        frame = renderer.render(0.0)
        assert frame.statistics.by_modes[0].full_shadow == 0, f"{change}: the lamp is another one"
        fresh = Renderer(renderer.scene, renderer.settings).render(0.0)
        assert frame.color.tobytes() == fresh.color.tobytes()


@pytest.mark.parametrize("method", ["certified", "certified+cache", "paper+rest", "cells+rest"])
def test_what_moves_beside_lamps_leaves_no_old_shadow(method: str):
    renderer = Renderer(room(LAMP, POINT, kites=True), replace(SETTINGS, method=method, verify=True))
    allowed = 0.0 if "certified" in method else 0.01  # the paper's modes are sampled
    for time in (0.0, 0.4, 0.8, 1.2, 1.6, 2.4, 2.8, 3.2):
        shadow = renderer.render(time).statistics.shadow
        assert shadow.wrong <= allowed * shadow.due, time


def test_a_verified_frame_counts_wrong_samples():
    frame = Renderer(room(LAMP), replace(SETTINGS, method="paper", verify=True)).render(0.0)
    none = Renderer(room(LAMP), SETTINGS).render(0.0)
    assert frame.reference is not None and frame.reference.tobytes() == none.color.tobytes()


def test_reasons_count_the_samples_that_reach_the_point():
    renderer = Renderer(room(LAMP, POINT), SETTINGS)
    frame = renderer.render(0.0)
    assert frame.asked is not None and frame.reached is not None
    partly = np.argwhere((frame.reached[..., 0] > 0) & (frame.reached[..., 0] < frame.asked[..., 0]))
    for y, x in partly[:: len(partly) // 12]:
        for light, one in enumerate(why(renderer, frame, int(x), int(y)).reasons):
            assert (one.lit, one.fate.is_due) == (frame.reached[y, x, light], frame.asked[y, x, light] > 0)
            assert one.rays == frame.asked[y, x, light] or not one.fate.is_due


def test_a_picture_that_is_refined_becomes_the_whole_one():
    lamps = room(LAMP, POINT)
    whole = Renderer(lamps, replace(SETTINGS, method="paper")).render(0.0)
    *_, last = Renderer(lamps, replace(SETTINGS, method="paper")).refine(0.0, parts=(1, 16))
    assert last.color.tobytes() == whole.color.tobytes() and last.modes.tobytes() == whole.modes.tobytes()
