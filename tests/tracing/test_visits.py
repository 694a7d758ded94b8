"""The nodes that a ray enters: in kd-trees its very steps and tests, in all structures its very hits."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import tracer
from tests.tracing.glassy import SCENE
from tracer.geometry.accelerators import ACCELERATORS, BVH8, LAZY
from tracer.geometry.queries import DYNAMIC_OBJECTS
from tracer.geometry.rays import ray_batch
from tracer.scene.load import load_scene

RAYS = 120


@pytest.fixture(scope="module", params=ACCELERATORS)
def world(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tracer.World:
    """A triangle moves, a sphere and a cone do not, and a field of triangles makes trees of some depth."""
    path: Path = tmp_path_factory.mktemp("visits") / "scene.aff"
    rng = np.random.default_rng(7)
    field = [c + rng.uniform(-0.3, 0.3, (3, 3)) for c in rng.uniform(-1.5, 1.5, (150, 1, 3))]
    path.write_text(SCENE + "".join(f"p 3 {' '.join(f'{x:.4f}' for x in corners.flat)}\n" for corners in field))
    return tracer.World(load_scene(path), 6.0, request.param)


@pytest.fixture(scope="module")
def rays(world: tracer.World):
    rng = np.random.default_rng(5)
    starts, ends = rng.uniform(-2.0, 2.0, (2, RAYS, 3))
    return ray_batch(starts, ends - starts, 1e-5, 1.0)


def test_nearest_hits_are_those_of_the_query(world: tracer.World, rays):
    hits, costs = world.closest_hits_each(rays)
    found = 0
    for i in range(RAYS):
        visits = world.visits(rays, i, nearest=True)
        met = [(t, primitive) for visit in visits for primitive, t in visit.hits]
        t, primitive = min(met, default=(np.inf, -1))
        assert primitive == hits.primitive[i] and (primitive < 0 or np.float32(t) == hits.t[i])
        found += primitive >= 0
        if world.accelerator != BVH8:
            assert [len(visits), sum(len(visit.tested) for visit in visits)] == costs[i].tolist()
    assert 20 < found < RAYS - 20


def test_any_hits_are_those_of_the_query(world: tracer.World, rays):
    occluders, costs = world.occluders_each(rays)
    for i in range(RAYS):
        visits = world.visits(rays, i)
        met = [primitive for visit in visits for primitive, _ in visit.hits]
        assert bool(met) == (occluders[i] >= 0) and (not met or occluders[i] in met)
        early = [primitive for visit in visits[:-1] for primitive, _ in visit.hits]
        assert not early or world.accelerator == LAZY, "the first hit ends the walk"
        assert world.object_of[early].all(), "the first on what never moves does where all hang in one tree"
        if world.accelerator != BVH8:
            assert [len(visits), sum(len(visit.tested) for visit in visits)] == costs[i].tolist()
    moving, _ = world.occluders_each(rays, DYNAMIC_OBJECTS)
    for i in range(RAYS):
        visits = world.visits(rays, i, DYNAMIC_OBJECTS)
        assert any(visit.hits for visit in visits) == (moving[i] >= 0)
        assert {visit.tree for visit in visits} <= {"moving objects", "all objects", "object 1"}


def test_boxes_are_where_the_ray_enters_and_leaves_them(world: tracer.World, rays):
    leaves = 0
    for i in range(RAYS):
        origin, way = rays.origin[:, i].astype(float), rays.direction[:, i].astype(float)
        for visit in world.visits(rays, i, nearest=True):
            low, high = visit.corners.min(0), visit.corners.max(0)
            leaves += visit.leaf
            assert visit.leaf or not visit.tested
            if not visit.tree.startswith("object"):  # whose boxes are turned with the object
                for t in (visit.enter, visit.leave):
                    assert ((origin + t * way >= low - 1e-3) & (origin + t * way <= high + 1e-3)).all()
            assert visit.enter <= visit.leave and (visit.level > 0 or not visit.leaf or len(visit.tested) < 9)
    assert leaves > RAYS
