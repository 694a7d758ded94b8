"""`tracer.reference`, the paper in one file, and the method `paper`: the same pictures, modes and counters."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import tracer
from tests.scenes import loaded
from tests.tracing.random_worlds import Walk, quickly, walks
from tracer.culling.modes import occlusion_mode, shadow_mode
from tracer.reference import Reference, ReferenceFrame

SCENES = Path(__file__).resolve().parents[2] / "assets" / "scenes"


def counts_of(frame: tracer.Frame) -> dict[str, int]:
    """A frame's counters by the reference's names."""
    s = frame.statistics
    counts = {"shadow_rays": s.shadow.rays, "occlusion_tests": s.occlusion_tests}
    counts |= {name: getattr(s.shadow, name) for name in ("due", "culled", "dynamic_only")}
    for kind, rays in (("primary", s.primary), ("secondary", s.secondary), ("shadow", s.shadow)):
        counts |= {f"{kind}_rays": rays.rays, f"{kind}_steps": rays.traversal_steps}
        counts |= {f"{kind}_tests": rays.intersection_tests}
    return counts


def assert_same(frame: tracer.Frame, expected: ReferenceFrame, lights: int) -> None:
    assert counts_of(frame) == expected.counts
    assert np.array_equal(frame.primitive, expected.primitive)
    assert np.array_equal(occlusion_mode(frame.modes), expected.modes.occlusion)
    for light in range(lights):
        known = expected.modes.shadow[:, light] if light < expected.modes.shadow.shape[1] else 0
        assert np.array_equal(shadow_mode(frame.modes, light), np.broadcast_to(known, len(frame.modes)))
    assert np.array_equal(frame.pixel_count, expected.modes.pixel_count)
    assert np.array_equal(frame.highest_count, expected.modes.highest_count)
    assert np.array_equal(frame.color, expected.color)


def renderers(scene: tracer.Scene, **settings) -> tuple[tracer.Renderer, Reference]:
    chosen = tracer.Settings(method="paper", accelerator="kdtree", threads=2, **settings)
    reference = Reference(scene, chosen)
    return tracer.Renderer(scene, chosen, world=reference.world), reference


@pytest.mark.parametrize("lights, examples", [(0, 4), (1, 4), (3, 6), (17, 3), (33, 4)])
def test_frames_of_random_scenes_are_those_of_the_reference(lights: int, examples: int) -> None:
    """Moving cameras, lights and objects; modes in 32 and in 64 bits, and lights past what they hold."""
    seen: Counter[str] = Counter()

    @quickly(examples)
    @given(walks(lights), st.booleans(), st.sampled_from([1.0, 2.0, 4.0]), st.integers(0, 12))
    def check(walk: Walk, symmetric: bool, zoom_factor: float, depth: int) -> None:
        fast, reference = renderers(
            walk.scene, width=34, height=14, depth=depth, symmetric=symmetric, zoom_factor=zoom_factor
        )
        none = tracer.Renderer(walk.scene, replace(fast.settings, method="none"), world=reference.world)
        for number, (time, camera) in enumerate(walk.frames):
            expected = reference.render(time, camera)
            assert_same(fast.render(time, camera), expected, lights)
            if number == 0:  # nothing is culled yet
                assert np.array_equal(none.render(time, camera).color, expected.color)
            seen.update(expected.counts)

    check()
    of_no_light = {"shadow_rays", "due", "culled", "dynamic_only", "shadow_steps", "shadow_tests"}
    assert {name for name, count in seen.items() if not count} == (set() if lights else of_no_light)


def along(scene: tracer.Scene, frames: int, **settings) -> Counter[str]:
    """Render the first twentieth of a scene's animation both ways, and add up what was counted."""
    fast, reference = renderers(scene, width=64, height=48, **settings)
    start, end = scene.time_range
    total: Counter[str] = Counter()
    for k in range(frames):
        time = start + (end - start) * k / 20 / frames
        expected = reference.render(time)
        assert_same(fast.render(time), expected, len(scene.lights))
        total.update(expected.counts)
    return total


@pytest.mark.parametrize("name", ["kitchen/kitchen", "robot/Robot", "museum/museum5"])
def test_films_of_bart_are_those_of_the_reference(bart: Path, name: str) -> None:
    total = along(loaded(bart / f"{name}.aff"), 4, depth=10)
    assert total["culled"] > 0


def test_a_film_of_the_default_scene_is_that_of_the_reference() -> None:
    """With textures, glass, mirrors and moving objects."""
    total = along(loaded(SCENES / "default.aff"), 5, depth=10, symmetric=True)
    assert total["culled"] and total["dynamic_only"]


@pytest.mark.parametrize("other", [{"kind": "sphere", "radius": 0.1, "samples": 4}, {"falloff": "inverse square"}])
def test_only_points_have_a_reference(other: dict) -> None:
    scene = loaded(SCENES / "figure3.aff")
    lights = (replace(scene.lights[0], name="lamp 7", **other),)
    with pytest.raises(ValueError, match="lamp 7"):
        Reference(replace(scene, lights=lights), tracer.Settings(8, 8))
