"""The two queries, through trees and placement, against brute force."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import tracer
from tests.sweeps import EVERY_ACCELERATOR, cases
from tests.tracing import brute, naive
from tests.tracing.brute8 import meet_all8
from tests.tracing.random_worlds import END, quickly, scenes
from tests.tracing.worlds import affine, moved, quadrics, random_corners, scene
from tracer.geometry.kdtree.build import CANCELLED, build_tree
from tracer.geometry.primitives import triangle_rows
from tracer.geometry.queries import DYNAMIC_OBJECTS, STATIC_GEOMETRY, any_hits_by
from tracer.runtime.kernels import kernel
from tracer.scene.model import SPHERE, Cancelled


def random_rays(rng: np.random.Generator, n: int) -> tuple[np.ndarray, np.ndarray]:
    origins, targets = rng.normal(size=(n, 3)) + 0.5, rng.random((n, 3))
    directions = targets - origins
    directions[: n // 10, rng.integers(3)] = 0.0  # parallel to a plane
    return origins.astype(np.float32), directions.astype(np.float32)


@pytest.fixture(params=EVERY_ACCELERATOR)
def accelerator(request) -> str:
    return request.param


def assert_same_answers(world, corners, origins, directions):
    hits = world.closest_hits(tracer.RayBatch(origins, directions), threads=1)
    blocked = world.any_hits(tracer.RayBatch(origins, directions), threads=1)
    compared = 0
    for i, (o, d) in enumerate(zip(origins.astype(float), directions.astype(float), strict=True)):
        t, index = naive.closest_triangle(corners, o, d)
        if naive.edge_distance(corners, o, d) < 1e-5:
            continue  # rounding may decide either way
        compared += 1
        assert hits.t[i] == pytest.approx(t, rel=2e-4)
        assert blocked[i] == (index >= 0)
        if index >= 0:  # of coplanar triangles rounding picks one; it must itself be at that distance
            alone, _ = naive.closest_triangle(corners[hits.primitive[i]][None], o, d)
            assert alone == pytest.approx(t, rel=2e-4)
    assert compared > len(origins) // 2


@pytest.mark.parametrize("seed", range(cases(2, 6)))
@pytest.mark.parametrize("n, size", [(40, 0.3), (300, 0.05)])
def test_queries_agree_with_brute_force(accelerator, seed, n, size):
    rng = np.random.default_rng(seed)
    corners = random_corners(rng, n, size)
    assert_same_answers(tracer.World(scene(corners), 0.0, accelerator), corners, *random_rays(rng, 60))


def test_queries_agree_with_float64_in_random_scenes(accelerator):
    """Triangles, spheres and cones, static, moving, vanishing and deforming."""
    compared: Counter[str] = Counter()

    @quickly(20)
    @given(scenes(), st.floats(0.0, END), st.integers(0, 2**32 - 1))
    def check(made: tracer.Scene, time: float, seed: int) -> None:
        world = tracer.World(made, time, accelerator)
        origins, directions = random_rays(np.random.default_rng(seed), 20)
        rays = tracer.RayBatch(origins, directions)
        hits, blocked = world.closest_hits(rays, threads=1), world.any_hits(rays, threads=1)
        for i, (o, d) in enumerate(zip(origins.astype(float), directions.astype(float), strict=True)):
            t, margin = naive.meet_all(made, time, o, d)
            if margin < 1e-4:
                continue  # rounding may decide either way
            nearest = t.min(initial=np.inf)
            assert blocked[i] == np.isfinite(nearest)
            assert hits.t[i] == pytest.approx(nearest, rel=5e-4)
            assert (hits.primitive[i] >= 0) == blocked[i]
            assert not blocked[i] or t[hits.primitive[i]] == pytest.approx(nearest, rel=5e-4)
            if blocked[i]:
                kind = "triangle" if hits.primitive[i] < made.triangle_count else "quadric"
                compared[f"dynamic {kind}" if made.object_of(hits.primitive[i]) else kind] += 1

    check()
    assert len(compared) == 4 and min(compared.values()) >= 5, compared


def test_occluders_are_met_by_their_rays_alone(accelerator):
    """By the arithmetic of each structure, bit for bit; something static is named where anything static blocks."""
    seen: Counter[str] = Counter()

    @quickly(20)
    @given(scenes(), st.floats(0.0, END), st.integers(0, 2**32 - 1))
    def check(made: tracer.Scene, time: float, seed: int) -> None:
        world, rng = tracer.World(made, time, accelerator), np.random.default_rng(seed)
        rays = tracer.RayBatch(*random_rays(rng, 150), 0.0, np.where(rng.random(150) < 0.5, np.inf, 1.0))
        if accelerator == "bvh8":
            met = np.isfinite(np.stack([meetings.t for meetings in meet_all8(world, rays)])).any(axis=0)
        else:
            met = np.isfinite(brute.meet_all(world, rays, brute.primitives_there(made, time)).t)
        found, static = world.occluders(rays), world.object_of == 0
        blocked = found >= 0
        assert np.array_equal(blocked, met.any(axis=1)) and np.array_equal(blocked, world.any_hits(rays))
        assert met[blocked, found[blocked]].all()
        assert np.array_equal(static[found] & blocked, met[:, static].any(axis=1))
        seen.update(static=int((static[found] & blocked).sum()), dynamic=int((~static[found] & blocked).sum()))
        seen.update(triangles=int((found[blocked] < made.triangle_count).sum()), misses=int((~blocked).sum()))
        seen.update(quadrics=int((found >= made.triangle_count).sum()))

    check()
    assert len(seen) == 5 and min(seen.values()) >= 50, seen


@kernel
def _ask(placed, rays, blocked, occluders, counts):
    any_hits_by(placed, rays, STATIC_GEOMETRY | DYNAMIC_OBJECTS, blocked, occluders, 0, len(rays.t_min), counts)


def test_kernels_are_told_the_same_occluders(accelerator):
    rng = np.random.default_rng(7)
    moving = moved("moving", random_corners(rng, 30, 0.1), np.eye(4))
    world = tracer.World(scene(random_corners(rng, 30, 0.1), dynamic=(moving,)), 0.0, accelerator)
    rays = tracer.RayBatch(*random_rays(rng, 500))
    blocked, occluders = np.empty(500, np.uint8), np.empty(500, np.int32)
    _ask(world.placed, rays, blocked, occluders, np.zeros(2, np.int64))
    assert np.array_equal(occluders, world.occluders(rays, 1))
    assert np.array_equal(
        blocked, np.where(occluders < 0, 0, np.where(occluders < 30, STATIC_GEOMETRY, DYNAMIC_OBJECTS))
    )
    assert set(blocked) == {0, STATIC_GEOMETRY, DYNAMIC_OBJECTS}


def test_an_object_scaled_to_nothing_is_not_there(accelerator):
    gone = moved("gone", random_corners(np.random.default_rng(0), 20, 0.3), np.zeros((4, 4)))
    world = tracer.World(scene(dynamic=(gone,)), 0.0, accelerator)
    origins, directions = random_rays(np.random.default_rng(1), 50)
    assert not world.any_hits(tracer.RayBatch(origins, directions)).any()


def test_an_empty_world_is_missed(accelerator):
    world = tracer.World(scene(), 0.0, accelerator)
    assert world.closest_hits(tracer.RayBatch([[0, 0, 0]], [[0, 0, 1]])).primitive.tolist() == [-1]
    assert not world.any_hits(tracer.RayBatch([[0, 0, 0]], [[0, 0, 1]]))[0]


@pytest.mark.parametrize("make", [lambda n: np.zeros((n, 3, 3)), lambda n: np.tile(np.eye(3), (n, 1, 1))])
def test_a_thousand_equal_triangles_still_make_a_tree(accelerator, make):
    world = tracer.World(scene(make(1000)), 0.0, accelerator)
    hits = world.closest_hits(tracer.RayBatch([[2, 2, 2]], [[-1, -1, -1]]))
    assert hits.primitive[0] in (-1, 0)  # the lowest number wins among equal distances


def test_every_thread_count_gives_the_same_hits(accelerator):
    rng = np.random.default_rng(5)
    world = tracer.World(scene(random_corners(rng, 2000, 0.02)), 0.0, accelerator)
    rays = tracer.RayBatch(*random_rays(rng, 20000))
    one, many = world.closest_hits(rays, 1), world.closest_hits(rays, 4)
    assert all(np.array_equal(a, b) for a, b in zip(one, many, strict=True))
    assert np.array_equal(world.any_hits(rays, 1), world.any_hits(rays, 3))
    assert np.array_equal(world.occluders(rays, 1), world.occluders(rays, 3))


def test_spheres_live_beside_triangles(accelerator):
    floor, ball = [[[-9, -9, -5], [9, -9, -5], [0, 9, -5]]], quadrics([(SPHERE, affine(), (1, 1))])
    world = tracer.World(scene(floor, ball), 0.0, accelerator)
    hits = world.closest_hits(tracer.RayBatch([[0, 0, 5], [3, 0, 5]], [[0, 0, -1], [0, 0, -1]]))
    assert hits.primitive.tolist() == [1, 0]
    assert hits.t.tolist() == [4.0, 10.0]


def test_a_cancelled_build_stops():
    control = np.zeros(2, np.int64)
    control[CANCELLED] = 1
    corners = random_corners(np.random.default_rng(0), 1000, 0.1)
    boxes = np.concatenate([corners.min(1), corners.max(1)], axis=1)
    tree, _ = build_tree(boxes, triangle_rows(corners), control)
    assert len(tree.items) == 0


def test_progress_that_raises_cancels_a_large_build(accelerator):
    def stop(what: str, done: float) -> None:
        if what != "laying out primitives":
            raise Cancelled

    with pytest.raises(Cancelled):
        tracer.World(scene(random_corners(np.random.default_rng(0), 20000, 0.01)), 0.0, accelerator, progress=stop)


@pytest.mark.parametrize("n", [1, 5])
@pytest.mark.parametrize("t_max", [np.inf, "array"])
def test_batches_are_copies_that_can_be_written_to(n, t_max):
    origins = np.zeros((n, 3), np.float32)
    origins.flags.writeable = False
    limits = np.ones(n, np.float32) if t_max == "array" else t_max
    batch = tracer.RayBatch(origins, origins, t_max=limits)
    for array in batch:
        assert array.flags.writeable
        assert array.flags.c_contiguous
        assert not np.shares_memory(array, origins)
        assert not np.shares_memory(array, np.asarray(limits))


def test_rays_of_the_wrong_shape_are_refused():
    with pytest.raises(ValueError, match=r"\(n, 3\)"):
        tracer.RayBatch([[0, 0]], [[0, 0]])


def test_an_unknown_accelerator_is_named():
    with pytest.raises(ValueError, match="octree"):
        tracer.World(scene(), accelerator="octree")
