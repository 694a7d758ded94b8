"""What 8-wide trees answer: what is there and nothing else, whoever a ray travels with."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import tracer
from tests.bench.rays import Surfaces, incoherent_rays, joined, mirror_rays, points_of, primary_rays, shadow_rays
from tests.scenes import loaded
from tests.tracing import brute
from tests.tracing.answers import Answers, ask, chosen
from tests.tracing.brute8 import meet_all8
from tests.tracing.random_worlds import END, quickly, scenes
from tests.tracing.shoals import shoals
from tests.tracing.worlds import affine, moved, quad, quadrics, random_corners, scene
from tracer.geometry.queries import batch_of
from tracer.geometry.rays import Rays
from tracer.scene.model import CONE, SPHERE

VIEWS = [("kitchen/kitchen.aff", 400), ("museum/museum5.aff", 40)]
SIDE = 96


def of_8(content: tracer.Scene, time: float = 0.0) -> tracer.World:
    return tracer.World(content, time, accelerator="bvh8")


@cache
def view(path: Path, number: int) -> tuple[tracer.World, tracer.World, dict[str, Rays]]:
    """A frame's world in both structures, and rays of four kinds that belong to it."""
    content = loaded(path)
    time = content.frame_time(number)
    wide, kd = of_8(content, time), tracer.World(content, time, accelerator="kdtree")
    primary = primary_rays(content.camera_at(time), SIDE, SIDE)
    hits = kd.closest_hits(primary)
    hits.primitive[hits.primitive >= content.triangle_count] = -1  # surfaces are those of triangles
    points = points_of(Surfaces.of(content, time), primary, hits)
    lights = content.light_positions(time).astype(np.float32)
    return wide, kd, {
        "primary": primary,
        "shadow": joined([shadow_rays(points, light)[0] for light in lights]),
        "mirror": mirror_rays(points),
        "incoherent": incoherent_rays(kd.bounds(), SIDE * SIDE, 7),
    }  # fmt: skip


@pytest.mark.parametrize("kind", ["primary", "shadow", "mirror", "incoherent"])
@pytest.mark.parametrize("name, number", VIEWS)
def test_views_are_what_the_kd_tree_sees(bart: Path, name: str, number: int, kind: str):
    wide, kd, kinds = view(bart / name, number)
    rays = kinds[kind]
    a, b = wide.closest_hits(rays), kd.closest_hits(rays)
    assert len(rays.t_min) > 4000 and (b.primitive >= 0).mean() > 0.05
    near = np.isclose(a.t, b.t, rtol=1e-4, atol=1e-6 * np.abs(kd.bounds()).max())
    assert near.mean() > 0.999 and near[a.primitive == b.primitive].all()
    assert (a.primitive == b.primitive).mean() > 0.98  # where several lie in one plane, rounding picks one
    assert ((a.primitive >= 0) == (b.primitive >= 0)).mean() > 0.999
    assert (wide.any_hits(rays) == kd.any_hits(rays)).mean() > 0.999
    for world, hits in ((wide, a), (kd, b)):
        assert np.array_equal(world.any_hits(rays), hits.primitive >= 0)


def assert_right(world: tracer.World, rays: Rays) -> Answers:
    """Answers are those of rays against every leaf, to the last bit."""
    found, (static, dynamic) = ask(world, rays), meet_all8(world, rays)
    t = np.minimum(static.t, dynamic.t)
    t = np.concatenate([t, np.full((len(t), 1), np.inf, np.float32)], axis=1)  # and nothing, in the end
    primitive = np.where(np.isfinite(t).any(axis=1), t.argmin(axis=1), -1)  # of equally near ones the first
    assert np.array_equal(found.primitive, primitive)
    assert np.array_equal(found.t, t.min(axis=1))
    hit = primitive >= 0
    for name in ("u", "v"):
        weights = np.where(np.isfinite(static.t), getattr(static, name), getattr(dynamic, name))
        assert np.array_equal(getattr(found, name)[hit], weights[hit, primitive[hit]])
        assert not getattr(found, name)[~hit].any()
    assert np.array_equal(found.static, np.isfinite(static.t).any(axis=1))
    assert np.array_equal(found.dynamic, np.isfinite(dynamic.t).any(axis=1))
    named = world.occluders(rays)
    assert np.array_equal(named >= 0, hit) and np.isfinite(t[hit, named[hit]]).all()
    return found


def test_random_scenes_are_seen_as_they_are():
    seen = {"static": 0, "dynamic": 0, "triangles": 0, "quadrics": 0, "misses": 0}

    @quickly(12)
    @given(scenes(), st.floats(0.0, END), st.integers(0, 2**32 - 1))
    def check(made: tracer.Scene, time: float, seed: int) -> None:
        world, rng = of_8(made, time), np.random.default_rng(seed)
        for rays in shoals(rng, int(rng.integers(1, 150))).values():
            found = assert_right(world, rays)
            hits = found.primitive[found.primitive >= 0]
            seen["static"] += int((world.object_of[hits] == 0).sum())
            seen["dynamic"] += int((world.object_of[hits] != 0).sum())
            seen["triangles"] += int((hits < made.triangle_count).sum())
            seen["quadrics"] += int((hits >= made.triangle_count).sum())
            seen["misses"] += len(found.t) - len(hits)

    check()
    assert min(seen.values()) > 250, seen


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("n, size", [(1, 0.5), (40, 0.3), (3000, 0.02)])
def test_triangles_are_seen_as_they_are(seed: int, n: int, size: float):
    rng = np.random.default_rng(seed)
    world = of_8(scene(random_corners(rng, n, size)))
    for rays in shoals(rng, 130).values():
        assert_right(world, rays)


def assert_same(expected: Answers, found: Answers, where: str) -> None:
    differing = expected.differing(found)
    assert not differing.any(), f"{where}: {np.flatnonzero(differing)}"


def assert_alone_or_not(world: tracer.World, rays: Rays, strangers: Rays, seed: int) -> None:
    """Each ray's answers are the same, bit for bit, alone and in all kinds of company."""
    rng, n = np.random.default_rng(seed), len(rays.t_min)
    expected = ask(world, rays)
    for i in rng.permutation(n)[:12]:
        alone = ask(world, chosen(rays, np.array([i])))
        assert_same(expected.of(slice(i, i + 1)), alone, f"ray {i} alone")
    for order in (rng.permutation(n), np.arange(n)[::-1], np.repeat(np.arange(n), 2)):
        assert_same(expected.of(order), ask(world, chosen(rays, order)), "in another order")
    first = 0
    while first < n:
        last = min(n, first + int(rng.choice([1, 2, 7, 15, 16, 17, 100, 127, 128, 129, 300])))
        assert_same(expected.of(slice(first, last)), ask(world, rays, first, last), f"from {first} to {last}")
        first = last
    mixed = joined([rays, strangers])
    order = rng.permutation(len(mixed.t_min))
    ours = order < n
    assert_same(expected.of(order[ours]), ask(world, chosen(mixed, order)).of(ours), "among strangers")
    ended = Rays(*(a.copy() for a in rays))
    over = rng.random(n) < rng.choice([0.1, 0.9])
    ended.t_max[over] = rng.choice(np.array([0.0, -1.0, -np.inf], np.float32), int(over.sum()))
    found = ask(world, ended)
    assert_same(expected.of(~over), found.of(~over), "among rays that have ended")
    over = found.of(over)
    assert (over.primitive == -1).all() and (over.t == np.inf).all() and not (over.static | over.dynamic).any()


def test_answers_do_not_depend_on_the_company_in_random_scenes():
    @quickly(6)
    @given(scenes(), st.floats(0.0, END), st.integers(0, 2**32 - 1))
    def check(made: tracer.Scene, time: float, seed: int) -> None:
        world, rng = of_8(made, time), np.random.default_rng(seed)
        kinds = shoals(rng, 200)
        for rays in kinds.values():
            assert_alone_or_not(world, rays, kinds["anywhere"], seed)

    check()


@pytest.mark.parametrize("n", [16, 128, 304])
def test_rays_without_a_direction_in_common_visit_the_same_in_any_company(n: int):
    """For the nearest hits, as many nodes are opened and leaves tested as in two halves."""
    rng = np.random.default_rng(n)
    world = of_8(scene(random_corners(rng, 3000, 0.08)))
    origins = rng.normal(size=(n, 3))
    origins *= 3 / np.linalg.norm(origins, axis=1, keepdims=True)  # outside, where no two boxes begin at the same t
    rays = tracer.RayBatch(origins, rng.random((n, 3)) - origins)
    hits = world.closest_hits(rays)
    batch, counts = batch_of(rays, hits), np.zeros(2, np.int64)
    world.structure.closest.call(world.placed.data, batch.ctypes.data, 0, n, counts.ctypes.data)
    halves = np.zeros(2, np.int64)
    for first in (0, n // 2):
        world.structure.closest.call(world.placed.data, batch.ctypes.data, first, first + n // 2, halves.ctypes.data)
    assert counts.tolist() == halves.tolist()
    assert counts[0] > 3 * n and counts[1] > n


@pytest.mark.parametrize("odd", [np.nan, np.inf, -np.inf, 0.0])
@pytest.mark.parametrize("where", ["origin", "direction"])
@pytest.mark.parametrize("ended", [False, True])
def test_rays_that_lead_nowhere_disturb_no_others(odd: float, where: str, ended: bool):
    rng = np.random.default_rng(8)
    world = of_8(scene(random_corners(rng, 2000, 0.05)))
    for kind, rays in shoals(rng, 400).items():
        expected, odd_ones = ask(world, rays), rng.random(400) < 0.1
        mixed = Rays(*(a.copy() for a in rays))
        getattr(mixed, where)[rng.integers(3), odd_ones] = odd
        if ended:
            mixed.t_max[odd_ones] = 0.0
        found = ask(world, mixed)
        assert_same(expected.of(~odd_ones), found.of(~odd_ones), kind)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("copies", ["static", "dynamic"])
def test_of_equally_near_ones_the_lowest_number_is_hit(seed: int, copies: str):
    """Every triangle lies there four times, in other blocks and in other trees."""
    rng = np.random.default_rng(seed)
    corners = random_corners(rng, 60, 0.2)
    order = np.concatenate([rng.permutation(60) for _ in range(4)])
    if copies == "static":
        made = scene(corners[order])
    else:
        parts = tuple(moved(f"part {i}", corners[order[60 * i : 60 * i + 60]], np.eye(4)) for i in range(1, 4))
        made = scene(corners[order[:60]], dynamic=parts)
    world = of_8(made)
    flat = corners[order].reshape(240, 9)
    lowest = np.array([np.flatnonzero((flat == row).all(axis=1))[0] for row in flat])
    for rays in shoals(rng, 130).values():
        hit = assert_right(world, rays).primitive
        assert np.array_equal(hit[hit >= 0], lowest[hit[hit >= 0]])


def test_a_quadric_gives_way_to_a_triangle_as_near():
    """Beyond them lies the same again, in the order of numbers reversed: quadrics come last."""
    ball = quadrics([(SPHERE, affine(), (1, 1)), (SPHERE, affine(), (1, 1))])
    world = of_8(scene(quad((-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, 1, 1)), ball))
    found = assert_right(world, tracer.RayBatch([[0, 0, 5], [0, 0, -5]], [[0, 0, -1], [0, 0, 1]]))
    assert found.t.tolist() == [4.0, 4.0]
    assert found.primitive.tolist() == [0, 2]


@pytest.mark.parametrize("seed", range(6))
def test_rays_along_edges_and_planes_of_a_lattice(seed: int):
    """No number here is rounded, so that the kd-tree's intersectors, too, must agree on every hit, on edges and all."""
    rng = np.random.default_rng(seed)
    low, size, axes = rng.integers(0, 8, (60, 3)), 2 ** rng.integers(0, 3, 60), rng.integers(3, size=60)
    corners = []
    for corner, side, axis in zip(low, size, axes, strict=True):
        a, b = np.delete(np.eye(3) * side, axis, axis=0)
        corners += quad(corner, corner + a, corner + a + b, corner + b)
    world = of_8(scene(np.array(corners, np.float32)))
    directions = rng.integers(-1, 2, (300, 3))
    directions[(directions == 0).all(axis=1)] = 1
    origins = rng.integers(0, 8, (300, 3)) - rng.integers(0, 9, (300, 1)) * directions
    rays = tracer.RayBatch(origins, directions)
    found = assert_right(world, rays)
    met = brute.meet_all(world, rays, np.ones(120, np.bool_))
    assert np.array_equal(found.t, met.t.min(axis=1)) and np.array_equal(found.primitive, met.closest())
    assert 0 < (found.primitive >= 0).sum() < 300


def test_what_has_no_area_is_never_hit():
    rng = np.random.default_rng(2)
    corners = rng.random((40, 1, 3)) + rng.normal(size=(40, 3, 3)) * 0.2
    flat = corners.repeat(3, axis=0)
    flat[1::3, 2] = flat[1::3, 1]  # an edge
    flat[2::3] = flat[2::3, :1]  # a point
    world, without = of_8(scene(flat)), of_8(scene(corners))
    for rays in shoals(rng, 130).values():
        found, expected = assert_right(world, rays), assert_right(without, rays)
        hit = expected.primitive >= 0
        assert np.array_equal(found.primitive, np.where(hit, 3 * expected.primitive, -1))
        assert np.array_equal(found.t, expected.t)
    points = of_8(scene(np.zeros((1000, 3, 3))))
    assert not (ask(points, tracer.RayBatch([[0, 0, -1]], [[0, 0, 1]])).primitive >= 0).any()


UP = float(np.nextafter(np.float32(1), np.float32(2)))
INTERVALS = [(0, np.inf), (0, 1), (0, UP), (0, 0.5), (1, 2), (1, 2.5), (0.5, 0.5), (1, 1), (2, 1), (3, np.inf)]


@pytest.mark.parametrize("x, met", [(0.0, {0: 1, 2: 1, 5: 2}), (30.0, {0: 2, 5: 2})])
def test_the_interval_is_open_at_both_ends(x: float, met: dict[int, float]):
    """Planes at t = 0, 1, 2 and 3, and elsewhere a sphere from t = 0 to 2."""
    floors = [t for z in range(4) for t in quad((-9, -7, z), (9, -7, z), (9, 9, z), (-9, 9, z))]
    world = of_8(scene(floors, quadrics([(SPHERE, affine(move=(30, 0, 1)), (1, 1))])))
    lower, upper = np.array(INTERVALS, np.float32).T
    origins, directions = np.tile([x, 0.0, 0.0], (10, 1)), np.tile([0.0, 0.0, 1.0], (10, 1))
    rays = tracer.RayBatch(origins, directions, lower, upper)
    found, expected = ask(world, rays), [met.get(i, np.inf) for i in range(10)]
    assert found.static.tolist() == np.isfinite(expected).tolist()
    assert found.t.tolist() == expected
    for i in range(10):
        assert_same(found.of(np.repeat(i, 20)), ask(world, chosen(rays, np.repeat(i, 20))), "among its like")


def test_hits_are_found_again_in_no_shorter_interval():
    rng = np.random.default_rng(5)
    world = of_8(scene(random_corners(rng, 500, 0.1), quadrics([(CONE, affine(0.3, (0.5, 0.5, 0.2)), (1.0, 0.3))])))
    for rays in shoals(rng, 500).values():
        found = ask(world, rays)
        hit = np.flatnonzero(found.primitive >= 0)
        rays, found = chosen(rays, hit), found.of(hit)
        past = np.nextafter(found.t, np.float32(np.inf))
        again = ask(world, rays._replace(t_max=past))
        assert not found.differing(again).any()
        nothing = ask(world, rays._replace(t_max=found.t))
        assert (nothing.primitive == -1).all() and not nothing.static.any()
        beyond, flat = ask(world, rays._replace(t_min=found.t)), found.primitive < 500
        assert (beyond.t[flat] > found.t[flat]).all()
        assert (beyond.t >= found.t).all()  # where a quadric is hit is rounded last


def test_many_spheres_and_cones_are_seen_as_they_are():
    rng = np.random.default_rng(6)
    rows = [
        (SPHERE if i % 2 else CONE, affine(rng.uniform(0.02, 0.2), rng.random(3)), (1.0, rng.uniform(-1, 1)))
        for i in range(60)
    ]
    world = of_8(scene(random_corners(rng, 30, 0.05), quadrics(rows)))
    hits = 0
    for rays in shoals(rng, 130).values():
        hits += int((assert_right(world, rays).primitive >= 30).sum())
    assert hits > 300


@pytest.mark.parametrize("dynamic", [False, True])
def test_where_nothing_is_nothing_is_hit(dynamic: bool):
    gone = (moved("gone", random_corners(np.random.default_rng(0), 20, 0.3), np.zeros((4, 4))),) * dynamic
    world = of_8(scene(dynamic=gone))
    for rays in shoals(np.random.default_rng(1), 130).values():
        found = assert_right(world, rays)
        assert (found.primitive == -1).all() and not (found.static | found.dynamic).any()


def test_no_rays_have_no_answers():
    world = of_8(scene(random_corners(np.random.default_rng(0), 20, 0.3)))
    none = tracer.RayBatch(np.empty((0, 3)), np.empty((0, 3)))
    assert len(world.closest_hits(none).t) == len(world.any_hits(none)) == 0
