"""The tree that is built where rays arrive: against its naive twin, and that nobody can tell when a node was built."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numba.core.runtime import _nrt_python, rtsys

import tracer
from tests.bench.meshes import bumpy_sphere, frequency_for
from tests.tracing import brute
from tests.tracing.naive_lazy_tree import LazyTraversal, node_at
from tests.tracing.naive_tree import Line
from tests.tracing.random_worlds import END, quickly, scenes
from tests.tracing.rays_and_movers import movers, random_rays
from tests.tracing.same import assert_same
from tests.tracing.worlds import quad, random_corners, scene
from tracer.geometry.accelerators import KD_TREE, LAZY
from tracer.geometry.boxes import transform_boxes
from tracer.geometry.lazy_tree.hierarchy import LEAST, Hierarchy, hierarchy_over
from tracer.geometry.lazy_tree.node import OBJECTS, SUBTREE
from tracer.geometry.primitives import triangle_rows
from tracer.geometry.queries import DYNAMIC_OBJECTS, EVERYTHING, STATIC_GEOMETRY, batch_of
from tracer.geometry.rays import Hits, Rays
from tracer.scene.model import Camera


def assert_same_way(world: tracer.World, rays: Rays, there: np.ndarray) -> np.ndarray:
    """Answers, steps and tests of all queries, ray by ray; the sums (queries, steps and tests)."""
    n, placed, structure = len(rays.t_min), world.placed, world.structure
    met = brute.meet_all(world, rays, there)
    hits = Hits(np.empty(n, np.float32), np.empty(n, np.int32), np.empty(n, np.float32), np.empty(n, np.float32))
    blocked, sums, parts = np.zeros(n, np.uint8), np.zeros((4, 2), np.int64), structure.world
    nearest = batch_of(rays, hits)
    for i in range(n):
        line = Line(tuple(rays.origin[:, i]), tuple(rays.direction[:, i]))
        counts = np.zeros((4, 2), np.int64)
        structure.closest.call(placed.data, nearest.ctypes.data, i, i + 1, counts[0].ctypes.data)
        twin = LazyTraversal(parts, line, rays.t_min[i], rays.t_max[i], met.t[i])
        assert (hits.t[i], hits.primitive[i]) == twin.closest()
        assert (hits.t[i], hits.primitive[i]) == (met.t[i].min(initial=np.inf), met.closest()[i])
        expected = [[twin.steps, twin.tests]]
        for which in (STATIC_GEOMETRY, DYNAMIC_OBJECTS, EVERYTHING):
            batch = batch_of(rays, blocked=blocked, which=which)
            structure.any_hit.call(placed.data, batch.ctypes.data, i, i + 1, counts[which].ctypes.data)
            twin = LazyTraversal(parts, line, rays.t_min[i], rays.t_max[i], met.t[i])
            assert blocked[i] == twin.what(which)
            expected.append([twin.steps, twin.tests])
        assert (blocked[i] != 0) == (hits.primitive[i] >= 0)
        assert counts.tolist() == expected
        sums += counts
    return sums


def test_rays_go_the_naive_twins_way_through_random_scenes() -> None:
    sums = np.zeros((4, 2), np.int64)

    @quickly(12)
    @given(scenes(), st.floats(0.0, END), st.integers(0, 2**32 - 1))
    def check(made: tracer.Scene, time: float, seed: int) -> None:
        nonlocal sums
        world, rng = tracer.World(made, time, LAZY), np.random.default_rng(seed)
        there = brute.primitives_there(made, time)
        sums += assert_same_way(world, random_rays(rng, 15), there)
        world.place(time, rng.random(len(made.objects)) < 0.5)
        sums += assert_same_way(world, random_rays(rng, 15), there)

    check()
    assert (sums > 0).all(), sums


@pytest.mark.parametrize("static, objects", [(1500, 0), (700, 1), (700, 9), (0, 30)])
def test_rays_go_the_naive_twins_way_through_large_nodes_and_among_many_objects(static: int, objects: int) -> None:
    rng = np.random.default_rng(static + objects)
    made = scene(random_corners(rng, static, 0.03) if static else (), dynamic=movers(rng, objects))
    world = tracer.World(made, 0.0, LAZY)
    sums = assert_same_way(world, random_rays(rng, 40), np.ones(made.primitive_count, np.bool_))
    assert (sums[0] > 0).all() and (sums[DYNAMIC_OBJECTS] > 0).all() == (objects > 0)


def a_large_world(seed: int = 3) -> tuple[tracer.World, Rays]:
    rng = np.random.default_rng(seed)
    made = scene(random_corners(rng, 6000, 0.02), dynamic=movers(rng, 4))
    return tracer.World(made, 0.0, LAZY), random_rays(rng, 3000)


def test_answers_and_counts_never_tell_when_or_by_whom_a_node_was_built() -> None:
    one, rays = a_large_world()
    hits, alone = one.closest_hits_each(rays)
    found, shadows = one.occluders_each(rays)
    for threads in (2, 4, 8):
        world, _ = a_large_world()
        backwards = Rays(*(np.ascontiguousarray(part[..., ::-1]) for part in rays))
        for a, b in zip(hits, world.closest_hits(backwards, threads), strict=True):
            assert np.array_equal(a[::-1], b)
        assert np.array_equal(found, world.occluders(rays, threads))
        assert world.built() == one.built()
        assert np.array_equal(alone, world.closest_hits_each(rays)[1])
        assert np.array_equal(shadows, world.occluders_each(rays)[1])


def test_little_is_built_for_few_rays_and_no_more_for_the_same_ones() -> None:
    made = scene(bumpy_sphere(frequency_for(60_000)))
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


def primitives_of(hierarchy: Hierarchy, group: int) -> list[int]:
    first, count = int(hierarchy.first[group]), int(hierarchy.counts[group])
    if first >= 0:
        return list(range(first, first + count))
    return [p for child in range(~first, ~first + count) for p in primitives_of(hierarchy, child)]


@pytest.mark.parametrize("sizes", [[1], [16], [17], [5000], [3, 300, 1, 1, 40] * 9, [1] * 700])
def test_groups_hold_whole_pieces_or_parts_of_one(sizes: list[int]) -> None:
    rng, n = np.random.default_rng(0), sum(sizes)
    corners = random_corners(rng, n + 7, 0.1)
    starts = 7 + np.cumsum(sizes) - sizes
    made = hierarchy_over(triangle_rows(corners), np.empty((0, 6), np.float32), starts, np.array(sizes))
    groups = [primitives_of(made, group) for group in range(len(made.boxes))]
    roots = groups[len(groups) - made.roots :]
    assert sorted(p for group in roots for p in group) == list(range(7, n + 7)) and len(roots) <= 16
    piece_of = np.repeat(np.arange(len(sizes)), sizes)
    for group, box, weight in zip(groups, made.boxes, made.weights, strict=True):
        assert weight == len(group)
        inside = corners[group].reshape(-1, 3)
        assert np.allclose(box, [*inside.min(0), *inside.max(0)], atol=1e-6)
        pieces = np.unique(piece_of[np.array(group) - 7])
        assert len(pieces) == 1 or len(group) == np.isin(piece_of, pieces).sum()
    assert made.weights[: len(made.weights) - made.roots].min(initial=1) >= 1
    assert made.counts[made.first >= 0].max() <= LEAST


def test_splits_lie_at_the_borders_of_pieces() -> None:
    """Two tables with many triangles each, far from each other: the first plane that parts them touches one of them."""
    side, step = np.linspace(0.0, 1.0, 13), np.array([0.08, 0.0, 0.0])
    ends = [(np.array([x, y, 0.0]), np.array([x, y + 0.08, 0.1])) for x in side[:-1] for y in side[:-1]]
    table = np.array([triangle for a, b in ends for triangle in quad(a, a + step, b + step, b)])
    corners = np.concatenate([table, table[:200] + np.array([5.0, 0.0, 0.0])]).astype(np.float32)
    made = scene(corners)
    part_of = np.repeat(np.arange(2, dtype=np.int32), [len(table), 200])
    pieces = (replace(made.objects[0], parts=("one", "two"), part_of=part_of),)
    world = tracer.World(replace(made, objects=pieces), 0.0, LAZY)
    root = node_at(world.structure.world.root)
    borders = np.array([corners[: len(table)].reshape(-1, 3).max(0)[0], corners[len(table) :].reshape(-1, 3).min(0)[0]])
    assert root.kind == 0 and np.abs(borders - root.plane).min() < 1e-6


def test_objects_hang_where_they_are_and_only_there() -> None:
    rng = np.random.default_rng(8)
    world = tracer.World(scene(random_corners(rng, 2000, 0.02), dynamic=movers(rng, 20, 4)), 0.0, LAZY)
    parts, seen = world.structure.world, set()
    boxes = transform_boxes(parts.object_boxes.astype(np.float64), world.pose(0.0).to_world)

    def descend(address: int, box: np.ndarray) -> None:
        node = node_at(address)
        if node.kind == SUBTREE or (node.kind < 3 and not node.flags):
            return
        if node.kind == OBJECTS:
            for o in node.objects:
                assert (boxes[o, :3] <= box[3:] + 1e-4).all() and (boxes[o, 3:] >= box[:3] - 1e-4).all()
                seen.add(o)
            return
        for side, child in enumerate((node.first, node.second)):
            half = box.copy()
            half[node.kind if side else node.kind + 3] = node.plane
            descend(child, half)

    descend(parts.root, parts.bounds)
    assert seen == set(range(1, 21))


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
    for number in range(3):
        frame = one.render()
        assert_same(frame, many.render(), f"of frame {number} on 4 threads")
        assert frame.color.tobytes() == eager.render().color.tobytes()
    assert frame.statistics.built is not None and 0.0 < frame.statistics.built.share <= 1.0
    assert eager.render().statistics.built is None and frame.statistics.to_dict()["built"]["of"] == made.primitive_count
