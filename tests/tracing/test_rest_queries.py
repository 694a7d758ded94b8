"""What queries answer where some objects rest: the same, but that these count as static geometry."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import tracer
from tests.sweeps import EVERY_ACCELERATOR
from tests.tracing import brute
from tests.tracing.brute8 import meet_all8
from tests.tracing.random_worlds import END, quickly, scenes
from tests.tracing.shoals import shoals
from tests.tracing.worlds import moved, quadrics, random_corners, scene
from tracer.geometry.queries import DYNAMIC_OBJECTS, STATIC_GEOMETRY, batch_of
from tracer.geometry.rays import Rays
from tracer.scene.model import SPHERE


@pytest.fixture(params=EVERY_ACCELERATOR)
def accelerator(request) -> str:
    return request.param


def assert_same_but_for_what_is_static(
    still: tracer.World, world: tracer.World, rests: np.ndarray, rays: Rays
) -> Counter:
    """A world in which some objects rest, (objects,) bool, answers as `still`, in which nothing does."""
    if hasattr(still.structure, "static"):
        met = np.isfinite(np.stack([meetings.t for meetings in meet_all8(still, rays)])).any(axis=0)
    else:
        there = np.isin(still.object_of, np.flatnonzero(still.object_boxes()[:, 0] < still.object_boxes()[:, 3]))
        met = np.isfinite(brute.meet_all(still, rays, there | (still.object_of == 0)).t)
    for a, b in zip(still.closest_hits(rays, 1), world.closest_hits(rays, 1), strict=True):
        assert np.array_equal(a, b)
    assert np.array_equal(still.any_hits(rays, 1), world.any_hits(rays, 1))
    lies = (still.object_of == 0) | rests[still.object_of]
    static, dynamic = met[:, lies].any(axis=1), met[:, ~lies].any(axis=1)
    n, counts = len(rays.t_min), np.zeros(2, np.int64)
    for which in (STATIC_GEOMETRY, DYNAMIC_OBJECTS, STATIC_GEOMETRY | DYNAMIC_OBJECTS):
        blocked, occluders = np.empty(n, np.uint8), np.empty(n, np.int32)
        batch = batch_of(rays, blocked=blocked, which=which, occluders=occluders)
        world.structure.any_hit.call(world.placed.data, batch.ctypes.data, 0, n, counts.ctypes.data)
        asked = np.where(
            static & bool(which & STATIC_GEOMETRY),
            STATIC_GEOMETRY,
            np.where(dynamic & bool(which & DYNAMIC_OBJECTS), DYNAMIC_OBJECTS, 0),
        )
        assert np.array_equal(blocked, asked)
        assert np.array_equal(occluders >= 0, blocked > 0)
        hit = blocked > 0
        assert met[hit, occluders[hit]].all() and np.array_equal(lies[occluders[hit]], blocked[hit] == STATIC_GEOMETRY)
    resting = (met[:, lies & (still.object_of != 0)].any(axis=1)).sum()
    return Counter(static=int(static.sum()), resting=int(resting), moving=int(dynamic.sum()))


def test_queries_answer_the_same_whatever_rests(accelerator):
    seen: Counter[str] = Counter()

    @quickly(20)
    @given(scenes(), st.floats(0.0, END), st.integers(0, 2**32 - 1))
    def check(made: tracer.Scene, time: float, seed: int) -> None:
        rng = np.random.default_rng(seed)
        still, world = (tracer.World(made, time, accelerator) for _ in range(2))
        rests = rng.random(len(made.objects)) < 0.5
        world.place(time, rests)
        assert world.placed.has_dynamic == (still.object_boxes()[1:, 0] < still.object_boxes()[1:, 3])[~rests[1:]].any()
        assert np.allclose(world.bounds(), still.bounds(), rtol=1e-4)
        for rays in shoals(rng, 60).values():
            seen.update(assert_same_but_for_what_is_static(still, world, rests, rays))
        world.place(time)
        assert world.placed.has_dynamic == still.placed.has_dynamic

    check()
    assert len(seen) == 3 and min(seen.values()) > 200, seen


@pytest.mark.parametrize("objects", [1, 3, 40])
def test_many_objects_rest_and_many_move(accelerator, objects):
    rng = np.random.default_rng(objects)
    parts = []
    for i in range(objects):
        matrix = np.eye(4)
        matrix[:3, :3] = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        matrix[:3, 3] = rng.normal(size=3) * 0.3
        part = moved(f"part {i}", random_corners(rng, int(rng.integers(1, 12)), 0.2), matrix)
        ball = quadrics([(SPHERE, np.eye(4)[:3] * rng.uniform(5, 20), (1, 1))])
        parts.append(replace(part, quadrics=ball) if i % 3 == 0 else part)
    made = scene(random_corners(rng, 20, 0.1), dynamic=tuple(parts))
    still, world = (tracer.World(made, 0.0, accelerator) for _ in range(2))
    for share in (0.0, 0.3, 0.8, 1.0):
        rests = rng.random(1 + objects) < share
        world.place(0.0, rests)
        for rays in shoals(rng, 40).values():
            assert_same_but_for_what_is_static(still, world, rests, rays)
