"""The tree that is built where rays arrive: nobody can tell when a node was built, and no more is built than needed.

What it answers, test_world.py and test_rest_queries.py hold against every primitive in turn."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numba.core.runtime import _nrt_python, rtsys

import tracer
from tests.bench.meshes import bumpy_sphere, frequency_for
from tests.tracing.rays_and_movers import movers, random_rays
from tests.tracing.same import assert_same
from tests.tracing.worlds import random_corners, scene
from tracer.geometry.accelerators import KD_TREE, LAZY
from tracer.geometry.queries import DYNAMIC_OBJECTS, EVERYTHING
from tracer.geometry.rays import Rays
from tracer.scene.model import Camera


def a_large_world(seed: int = 3) -> tuple[tracer.World, Rays]:
    rng = np.random.default_rng(seed)
    made = scene(random_corners(rng, 6000, 0.02), dynamic=movers(rng, 4))
    return tracer.World(made, 0.0, LAZY), random_rays(rng, 3000)


def test_answers_and_counts_never_tell_when_or_by_whom_a_node_was_built() -> None:
    one, rays = a_large_world()
    hits, alone = one.closest_hits_each(rays)
    found, shadows = one.occluders_each(rays)
    for threads in (2, 8):
        world, _ = a_large_world()
        backwards = Rays(*(np.ascontiguousarray(part[..., ::-1]) for part in rays))
        for a, b in zip(hits, world.closest_hits(backwards, threads), strict=True):
            assert np.array_equal(a[::-1], b)
        assert np.array_equal(found, world.occluders(rays, threads))
        assert world.built() == one.built()
        assert np.array_equal(alone, world.closest_hits_each(rays)[1])
        assert np.array_equal(shadows, world.occluders_each(rays)[1])


def test_little_is_built_for_few_rays_and_no_more_for_the_same_ones() -> None:
    made = scene(bumpy_sphere(frequency_for(30_000)))
    world = tracer.World(made, 0.0, LAZY)
    before = world.built()
    assert before.primitives == 0 and before.of == made.primitive_count
    target = np.random.default_rng(0).normal(size=(300, 3)) * 0.01
    rays = tracer.RayBatch(np.tile([0.0, 0.0, 3.0], (300, 1)), target - [0.0, 0.0, 3.0])
    assert (world.closest_hits(rays).primitive >= 0).all()
    built = world.built()
    assert 0 < built.primitives < 0.1 * built.of and built.nodes > 10
    world.closest_hits(rays)
    assert world.built() == built and tracer.World(made, 0.0, KD_TREE).built() is None


def test_rays_that_ask_for_what_moves_enter_no_node_without() -> None:
    world, rays = a_large_world()
    (moving, _), (everything, _) = (
        world.occluders_each(rays, which)[1].sum(0) for which in (DYNAMIC_OBJECTS, EVERYTHING)
    )
    assert 0 < moving < everything / 4
    world.place(0.0, np.ones(5, np.bool_))
    assert not world.occluders_each(rays, DYNAMIC_OBJECTS)[1].any(), "all of it rests"


def test_memory_is_given_back() -> None:
    _nrt_python.memsys_enable_stats()
    try:
        world, rays = a_large_world()
        world.closest_hits(rays)  # compiled
        del world
        before = rtsys.get_allocation_stats()
        world, rays = a_large_world()
        world.closest_hits(rays)
        world.any_hits(rays)
        assert world.built().memory_bytes > 100_000
        del world, rays
        after = rtsys.get_allocation_stats()
    finally:
        _nrt_python.memsys_disable_stats()
    assert after.alloc - before.alloc == after.free - before.free > 1000


@pytest.mark.parametrize("method", ["none", "paper", "certified"])
def test_frames_are_those_of_the_kd_tree_and_the_same_for_any_number_of_threads(method: str) -> None:
    rng = np.random.default_rng(2)
    camera = Camera((0.5, 0.4, 3.0), (0.0, 0.0, -1.0), angle=35.0)
    made = scene(random_corners(rng, 3000, 0.05), dynamic=movers(rng, 3), lights=[(2, 3, 4)], camera=camera)
    settings = tracer.Settings(64, 48, 2, method, threads=1, accelerator=LAZY, record_lights=True)
    one, many = (tracer.Renderer(made, replace(settings, threads=threads)) for threads in (1, 4))
    eager = tracer.Renderer(made, replace(settings, accelerator=KD_TREE))
    for number in range(2):
        frame = one.render()
        assert_same(frame, many.render(), f"of frame {number} on 4 threads")
        assert frame.color.tobytes() == eager.render().color.tobytes()
    assert frame.statistics.built is not None and 0.0 < frame.statistics.built.share <= 1.0
    assert eager.render().statistics.built is None and frame.statistics.to_dict()["built"]["of"] == made.primitive_count
