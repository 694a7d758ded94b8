"""The occluder cache: it changes nothing but what is asked, and is believed only where the trees would say the same."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import tracer
from tests.sweeps import ACCELERATORS, crossed
from tests.tracing.random_worlds import Walk, quickly, walks
from tests.tracing.same import assert_only_asked_less
from tests.tracing.worlds import affine, moved, nasty_triangles, quad, quadrics, scene
from tracer.culling import cells
from tracer.culling.occluder_cache import OccluderSlots, merge_occluders, surely_blocked
from tracer.culling.shadow_testing import LIGHT_MARGIN
from tracer.runtime.kernels import kernel
from tracer.scene.model import SPHERE
from tracer.simd import address_of, bits_of, load_i32x16, load_three

F = np.float32


@kernel
def _ask(triangles, light, directions, numbers, padding, sure):
    for v in range(len(sure)):
        lanes = load_i32x16(address_of(numbers) + 64 * v)
        sure[v] = bits_of(surely_blocked(triangles, light, load_three(directions, v), LIGHT_MARGIN, lanes, padding))


def believed(triangles: np.ndarray, light: np.ndarray, ends: np.ndarray, numbers: np.ndarray) -> np.ndarray:
    """(n,) bool for rays from a light (3,) to ends (n, 3), each with the triangle (t, 9) of its number cached."""
    n = len(ends)
    directions, asked = np.zeros((3, -(-n // 16) * 16), F), np.zeros(-(-n // 16) * 16, np.int32)
    directions[:, :n], asked[:n] = (ends - light).T, numbers
    sure = np.zeros(len(asked) // 16, np.int32)
    padding = np.float32(OccluderSlots(triangles, len(triangles)).padding)
    _ask(triangles, light, directions, asked, padding, sure)
    return np.array([(sure[i >> 4] >> (i & 15)) & 1 for i in range(n)], np.bool_)


@pytest.mark.parametrize("accelerator", ACCELERATORS)
def test_what_is_believed_the_trees_say_too(accelerator: str):
    """Rays that pass a triangle near its edges and corners, on either side, and that begin or end near it."""
    counted = np.zeros(2, np.int64)

    @quickly(15)
    @given(
        st.integers(0, 2**32 - 1), st.sampled_from([1e-9, 1e-3, 1.0, 1.0, 1e3, 1e9]), st.sampled_from([0.0, 1.0, 40.0])
    )
    def check(seed: int, scale: float, shift: float) -> None:
        rng = np.random.default_rng(seed)
        corners = ((nasty_triangles(rng, 12) + shift) * scale).astype(F)
        world = tracer.World(scene(corners), accelerator=accelerator)
        triangles = world.placed.triangles
        light = ((rng.normal(size=3) * rng.choice([0.5, 2.0, 30.0]) + 0.5 + shift) * scale).astype(F)
        n = 400
        numbers = rng.integers(len(corners), size=n)
        weights = rng.dirichlet(np.full(3, 0.7), n)
        close = rng.random(n) < 0.6
        weights[close, rng.integers(3, size=close.sum())] = rng.normal(size=close.sum()) * 10.0 ** rng.uniform(-8, -3)
        weights /= weights.sum(axis=1, keepdims=True)
        through = np.einsum("nk,nkc->nc", weights, corners[numbers].astype(np.float64))
        beyond = np.where(rng.random(n) < 0.3, 1 + rng.normal(size=n) * 1e-6, np.exp(rng.normal(size=n)))
        ends = (light + (through - light) * beyond[:, None]).astype(F)
        directions = ends - light
        sure = believed(triangles, light, ends, numbers)
        batch = tracer.RayBatch(np.broadcast_to(light, directions.shape), directions, LIGHT_MARGIN, 1.0)
        blocked = world.any_hits(batch, threads=1)
        assert blocked[sure].all()
        counted[:] += sure.sum(), (blocked & ~sure).sum()

    check()
    assert counted.min() > 250  # both what is believed and what had to be asked


def test_rays_through_the_inside_of_a_triangle_are_believed():
    rng = np.random.default_rng(5)
    corners = (rng.random((40, 3, 3)) * 2 - 1).astype(F)
    corners = corners[
        np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) > 0.3
    ]
    triangles = tracer.World(scene(corners)).placed.triangles
    numbers = np.repeat(np.arange(len(corners)), 30)
    weights = 0.01 + 0.97 * rng.dirichlet(np.ones(3), len(numbers))
    through = np.einsum("nk,nkc->nc", weights, corners[numbers])
    light = np.array([0.3, -0.2, 4.0], F)
    normal = np.cross(triangles[numbers, 3:6], triangles[numbers, 6:])
    steep = np.abs(((through - light) * normal).sum(1)) > 0.2 * np.linalg.norm(normal, axis=1)
    assert believed(triangles, light, (light + 2 * (through - light)).astype(F), numbers)[steep].all()
    assert not believed(triangles, light, (light + 0.99 * (through - light)).astype(F), numbers).any()


@quickly(50, shrink=True)
@given(st.integers(1, 4), st.integers(0, 2**32 - 1))
def test_of_what_workers_find_the_highest_number_is_kept(workers: int, seed: int):
    rng = np.random.default_rng(seed)
    occluders = rng.integers(-1, 9, 50).astype(np.int32)
    found = np.where(rng.random((workers, 50)) < 0.5, rng.integers(0, 9, (workers, 50)), -1).astype(np.int32)
    best = found.max(axis=0)
    expected = np.where(best >= 0, best, occluders)
    merge_occluders(occluders, found)
    assert np.array_equal(occluders, expected)
    assert (found == -1).all()


@pytest.mark.parametrize(("method", "accelerator"), crossed(["none", "paper", "cells"], ACCELERATORS))
def test_frames_of_random_scenes_are_those_without_a_cache(
    method: str, accelerator: str, monkeypatch: pytest.MonkeyPatch
):
    """Moving cameras, lights and objects; spheres and cones; lights past what words hold."""
    monkeypatch.setattr(cells, "AIM", 150)
    hits = 0

    @quickly(4)
    @given(walks(), st.integers(0, 3))
    def check(walk: Walk, depth: int) -> None:
        nonlocal hits
        settings = tracer.Settings(
            40, 32, depth, method, threads=2, verify=True, record_lights=True, accelerator=accelerator
        )
        without = tracer.Renderer(walk.scene, settings)
        cached = tracer.Renderer(walk.scene, replace(settings, method=method + "+cache"))
        for time, camera in walk.frames:
            frame = cached.render(time, camera)
            assert_only_asked_less(frame, without.render(time, camera))
            hits += frame.statistics.shadow.cache_hits

    check()
    assert hits > 1000


LIGHT = (0.0, 0.0, 20.0)
FLOOR = quad((-3, -3, 0), (3, -3, 0), (3, 3, 0), (-3, 3, 0))
ROOF = quad((-1, -1, 6), (1, -1, 6), (1, 1, 6), (-1, 1, 6))
SETTINGS = tracer.Settings(width=48, height=48, depth=0, method="none+cache", threads=1, accelerator="kdtree")


def shaded(roof=ROOF, **extra) -> tracer.Renderer:
    made = scene(FLOOR + roof, lights=[LIGHT], **extra)
    camera = replace(made.camera, position=(0.0, -12.0, 4.0), direction=(0.0, 12.0, -4.0), up=(0.0, 0.0, 1.0))
    return tracer.Renderer(replace(made, camera=camera), SETTINGS)


def test_what_blocked_the_light_need_not_be_asked_for_again():
    renderer = shaded()
    first, second = renderer.render().statistics.shadow, renderer.render().statistics.shadow
    assert first.cache_hits == 0
    assert second.cache_hits > 50
    assert second.rays == first.rays - second.cache_hits
    assert second.intersection_tests < first.intersection_tests
    assert second.traversal_steps < first.traversal_steps
    renderer.reset_modes()
    assert renderer.render().statistics.shadow == first


def test_what_is_round_or_moves_is_not_cached():
    ball = quadrics([(SPHERE, affine(1.0, (0.0, 0.0, 6.0)), (0.0, 0.0))])
    for renderer in (shaded([], static_quadrics=ball), shaded([], dynamic=(moved("roof", ROOF, np.eye(4)),))):
        renderer.settings = replace(SETTINGS, record_lights=True)
        renderer.render()
        frame = renderer.render()
        assert (frame.due & ~frame.lit).sum() > 50
        assert frame.statistics.shadow.cache_hits == 0


def test_a_method_that_takes_no_cache_along_asks_none():
    renderer = shaded()
    renderer.render()
    renderer.settings = replace(SETTINGS, method="none")
    assert renderer.render().statistics.shadow.cache_hits == 0
    renderer.settings = SETTINGS
    assert renderer.render().statistics.shadow.cache_hits > 0  # what was known before is not forgotten


@pytest.mark.parametrize("questions", range(4))
def test_a_cancelled_frame_leaves_the_cache_as_it_was(questions: int):
    renderer = shaded()
    renderer.settings = replace(SETTINGS, width=128, height=64)
    asked = iter([False] * questions)
    with pytest.raises(tracer.Cancelled):
        renderer.render(cancel=lambda: next(asked, True))
    assert renderer.render().statistics.shadow.cache_hits == 0


def test_further_samples_leave_nothing_in_the_cache():
    one, many = shaded(), shaded()
    many.settings = replace(SETTINGS, samples=3)
    for _ in range(3):
        assert one.render().statistics.shadow == many.render().statistics.shadow
