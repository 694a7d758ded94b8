"""Recent occluders: of lamps by the hundred, samples that a triangle hid from neighbours are hidden for certain."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.sweeps import ACCELERATORS, crossed
from tests.tracing.shades import going, kite
from tests.tracing.worlds import quad, scene, wall
from tracer.culling.modes import MAX_CULLED_LIGHTS
from tracer.renderer import Renderer
from tracer.scene.animation import Animation
from tracer.scene.lights import Light
from tracer.scene.model import Camera, Scene
from tracer.settings import Settings

SETTINGS = Settings(width=48, height=36, depth=1, method="certified", threads=2)


def tiled(samples: int = 20, radius: float = 0.15, lights: int = 40, **extra) -> Scene:
    """A wall of tiles, none of which hides a lamp from a region, and without one of them, between lamps and a floor."""
    floor = quad((0.0, 0.0, 0.0), (4.0, 0.0, 0.0), (4.0, 0.0, 5.0), (0.0, 0.0, 5.0))
    places = np.random.default_rng(1).uniform((0.3, 0.4, -2.5), (3.7, 2.8, -0.6), (lights, 3)).tolist()
    lamps = [
        Light(f"lamp {i}", tuple(p), (0.04, 0.05, 0.05), kind="sphere", radius=radius, samples=samples)
        for i, p in enumerate(places)
    ]
    extra.setdefault("camera", Camera((2.0, 2.5, 7.0), (0.0, -0.6, -1.0), angle=50.0))
    return replace(scene(floor + wall(13, 11, hole=(6, 4)), **extra), lights=tuple(lamps))


def test_rays_that_small_triangles_block_are_not_traced():
    settings = replace(SETTINGS, width=64, height=48)
    renderer, truth = (Renderer(tiled(), replace(settings, method=m)) for m in ("certified", "none"))
    frame, none = renderer.render(0.0), truth.render(0.0)
    assert frame.color.tobytes() == none.color.tobytes()
    shadow, rays = frame.statistics.shadow, none.statistics.shadow.rays
    assert shadow.rays < 0.25 * rays and shadow.due < 0.5 * rays, "lamps are passed over where all of them is hidden"
    assert shadow.culled > 0.05 * rays, "of other lamps, some samples"


@pytest.mark.parametrize(("accelerator", "samples"), crossed(ACCELERATORS, [9, 33, 100]))
def test_every_sample_that_is_culled_is_blocked(accelerator: str, samples: int):
    """Each is traced, and the samples that arrive are those of none."""
    settings = replace(SETTINGS, width=32, height=24, accelerator=accelerator, verify=True, record_lights=True)
    frame = Renderer(tiled(samples, lights=MAX_CULLED_LIGHTS + 1), settings).render(0.0)
    assert frame.statistics.shadow.wrong == 0 and frame.statistics.shadow.culled > 0.5 * frame.statistics.shadow.due
    none = Renderer(tiled(samples, lights=MAX_CULLED_LIGHTS + 1), replace(settings, method="none")).render(0.0)
    assert frame.asked.tobytes() == none.asked.tobytes() and frame.reached.tobytes() == none.reached.tobytes()


def test_lamps_that_touch_and_cut_triangles_and_those_of_no_size():
    """In the plane of the wall, through it, on a tile's corner, below the floor, around all, and in one point."""
    given = tiled(12, lights=34)
    places = [(2.0, 1.4, 0.0), (2.0, 1.4, 0.05), (4.0 / 13.0, 3.0 / 11.0, 0.0), (1.0, -0.01, 2.0), (2.0, 1.0, 1.0)]
    radii = [0.2, 0.2, 1e-4, 0.05, 30.0]
    touching = tuple(
        replace(lamp, position=p, radius=r) for lamp, p, r in zip(given.lights, places, radii, strict=False)
    )
    given = replace(given, lights=(*touching, *(replace(lamp, radius=0.0) for lamp in given.lights[5:])))
    for accelerator in ACCELERATORS:
        settings = replace(SETTINGS, accelerator=accelerator, verify=True)
        frame = Renderer(given, settings).render(0.0)
        assert frame.statistics.shadow.wrong == 0 and frame.statistics.shadow.culled > 1000, accelerator
        none = Renderer(given, replace(settings, method="none", verify=False)).render(0.0)
        assert frame.color.tobytes() == none.color.tobytes(), accelerator


def test_moving_objects_are_asked_and_moving_lamps_followed():
    flies, rests = going([(0, 0.0), (1, 0.7), (2, 1.0)]), going([(0, 0.5), (0.8, 2.0), (1, 2.0), (2, 3.5)])
    animation = Animation({"kite": rests, "flies": flies})
    given = tiled(dynamic=(kite("kite", z=1.0),), animation=animation, time_range=(0.0, 2.0))
    given = replace(given, lights=tuple(replace(lamp, track="flies") for lamp in given.lights[:8]) + given.lights[8:])
    renderer, truth = (Renderer(given, replace(SETTINGS, method=m)) for m in ("certified+rest", "none"))
    for time in (0.0, 0.5, 1.0, 1.0, 1.0, 1.5):
        picture = truth.render(time).color
        assert renderer.render(time).color.tobytes() == picture.tobytes(), time
    alone = Renderer(replace(given, objects=given.objects[:1]), truth.settings).render(time).color
    assert (alone != picture).any(axis=-1).sum() > 20, "the object is nowhere to be seen"
