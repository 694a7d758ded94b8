"""The light buffer: what its cubes say is true, by brute force, and its pictures are those of `none`."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import tracer
from tests.sweeps import ACCELERATORS, crossed
from tests.tracing.nasty_worlds import nasty_walk
from tests.tracing.random_worlds import quickly
from tests.tracing.shades import BEHIND, floor, going, kite, roof
from tests.tracing.worlds import nasty_triangles, scene
from tracer.culling.shadow_testing import LIGHT_MARGIN
from tracer.culling.verdicts import Verdict
from tracer.inspect.ray_tree import ray_tree
from tracer.neighbours.lightbuffer.cube import BLOCKED, COUNT, FIRST, LIT, WIDTH_BITS
from tracer.neighbours.lightbuffer.cubes import Cube, CubeMaker, items_of
from tracer.neighbours.lightbuffer.moving import depths_of
from tracer.neighbours.lightbuffer.tell import Said, cell_of, full_depths, list_lengths, tell
from tracer.scene.animation import Animation
from tracer.scene.model import Cancelled

F = np.float32
SETTINGS = tracer.Settings(width=64, height=48, depth=1, method="none", threads=2, record_lights=True)


def cube_of(world: tracer.World, light: np.ndarray, side: int = 16, longest: int = 8) -> Cube:
    """The cube of all that never moves around a light (3,)."""
    items = items_of(world, [0], world.outlines())
    bounds = world.bounds().astype(np.float64).reshape(2, 3)
    reach = 1.01 * float(np.linalg.norm(np.abs(light - bounds).max(0)))
    made = CubeMaker(items, lambda _: reach, longest).make(light[None], side, 1e9, 2)[0]
    assert made is not None
    return made


def crossings(corners: np.ndarray, light: np.ndarray, ways: np.ndarray) -> np.ndarray:
    """(ways, triangles) float64, how far along each way (n, 3) a triangle is, inf where it is not: no float32."""
    a, b, c = (corners[:, k].astype(np.float64) for k in range(3))
    e1, e2, s = b - a, c - a, light.astype(np.float64) - a
    n = np.cross(e1, e2)
    with np.errstate(all="ignore"):
        det = -(ways @ n.T)
        t = (s * n).sum(1) / det
        u = (ways @ np.cross(e2, s).T) / det
        v = (ways @ np.cross(s, e1).T) / det
        inside = (u >= 0) & (v >= 0) & (u + v <= 1) & (t > 0)
    return np.where(inside, t, np.inf)


def ways_around(rng: np.random.Generator, corners: np.ndarray, light: np.ndarray, n: int) -> np.ndarray:
    """Ways (n, 3) from the light: at random, and along edges, towards corners and along seams of the cube."""
    ways = rng.normal(size=(n, 3))
    weights = rng.dirichlet(np.full(3, 0.5), n)
    through = np.einsum("nk,nkc->nc", weights, corners[rng.integers(len(corners), size=n)].astype(np.float64)) - light
    ways = np.where(rng.random((n, 1)) < 0.7, through, ways)
    seam = rng.random(n) < 0.1
    ways[seam, 1] = ways[seam, 0] * rng.choice([-1.0, 1.0], seam.sum())
    return ways[np.abs(ways).max(1) > 1e-9]


@pytest.mark.parametrize(("accelerator", "longest"), crossed(ACCELERATORS, [2, 64]))
def test_what_a_cell_says_is_true_by_brute_force(accelerator: str, longest: int):
    """Nothing lies before a near plane; a far plane lies behind a hit; and between them all hits are candidates."""
    seen = dict.fromkeys(("lit", "blocked", "between", "listed"), 0)

    @quickly(14)
    @given(st.integers(0, 2**32 - 1), st.sampled_from([1e-3, 1.0, 1e3]), st.sampled_from([0.0, 20.0]))
    def check(seed: int, scale: float, shift: float) -> None:
        rng = np.random.default_rng(seed)
        corners = ((nasty_triangles(rng, 30) + shift) * scale).astype(F)
        world = tracer.World(scene(corners), accelerator=accelerator)
        light = ((rng.normal(size=3) * rng.choice([0.5, 2.0, 10.0]) + 0.5 + shift) * scale).astype(F)
        cube = cube_of(world, light, longest=longest)
        ways = ways_around(rng, corners, light, 600)
        there = crossings(corners, light, ways)
        counted = cube.records.view(np.int32)
        for way, depths in zip(ways, there, strict=True):
            number = cube.cells[cell_of(way, cube.side)] >> WIDTH_BITS
            record = cube.records[number].astype(np.float64)
            near, far = record[LIT : LIT + 3] @ way, record[BLOCKED : BLOCKED + 3] @ way
            # Distances along the way, in its own length, at which each plane stands.
            lit_to = 1.0 / near if near > 0.0 else np.inf
            blocked_from = 1.0 / far if far > 0.0 else np.inf
            assert depths.min() >= lit_to * (1 - 1e-12)
            assert depths.min() <= blocked_from and lit_to <= blocked_from
            seen["lit"] += np.isinf(lit_to)
            seen["blocked"] += np.isfinite(blocked_from)
            between = np.flatnonzero(depths < blocked_from)
            seen["between"] += len(between)
            first, count = counted[number, FIRST], counted[number, COUNT]
            if count:
                seen["listed"] += 1
                names = cube.numbers[cube.lists[first : first + count]]
                assert set(between.tolist()) <= set(names.tolist())

    check()
    assert min(seen.values()) > 150, seen


@pytest.mark.parametrize("accelerator", ACCELERATORS)
def test_what_a_cube_tells_of_points_is_what_rays_meet(accelerator: str):
    """Points at random, and close to surfaces, on either side: lit and blocked are what the structure says."""
    rng, said = np.random.default_rng(7), dict.fromkeys(Said, 0)
    for scale in (1e-2, 1.0, 1e2):
        corners = (nasty_triangles(rng, 40) * scale).astype(F)
        world = tracer.World(scene(corners), accelerator=accelerator)
        light = ((rng.normal(size=3) * 1.5 + 0.5) * scale).astype(F)
        cube = cube_of(world, light)
        ways = ways_around(rng, corners, light, 1500)
        nearest = crossings(corners, light, ways).min(1)
        close = 1 + rng.choice([-1, 1], len(ways)) * 10.0 ** rng.uniform(-7, 0, len(ways))
        lengths = np.where(np.isfinite(nearest), nearest * close, rng.random(len(ways)))
        points = (light + ways * np.abs(lengths)[:, None]).astype(F)
        batch = tracer.RayBatch(np.broadcast_to(light, points.shape), points - light, LIGHT_MARGIN, 1.0)
        for point, blocked in zip(points, world.any_hits(batch, threads=1), strict=True):
            told = tell(cube, light, point).said
            said[told] += 1
            if told in (Said.EMPTY, Said.BEFORE) and np.abs(point - light).max() > 1e-5:
                assert not blocked
            if told is Said.BEHIND:
                assert blocked
    assert min(said.values()) > 30, said


def test_what_moves_is_no_nearer_than_depths_say():
    rng = np.random.default_rng(3)
    for _ in range(6):
        low = rng.normal(size=(5, 3)) * 3
        boxes = np.concatenate([low, low + rng.random((5, 3))], 1).astype(F)
        light = rng.normal(size=3).astype(F)
        depths = depths_of(boxes, light, 16)
        points = boxes[:, None, :3] + rng.random((5, 200, 3)) * (boxes[:, None, 3:] - boxes[:, None, :3])
        for point in points.reshape(-1, 3):
            way = point - light
            assert depths[cell_of(way, 16)] <= np.abs(way).max()
    assert (depths > 1e30).any(), "not everywhere is something that moves"


def paused_scene(**extra) -> tracer.Scene:
    """A roof over a floor, and a kite that rests from 1 to 2 s, and in the first frame."""
    tracks = {"kite": going([(0, -1.5), (1, 0.0), (2, 0.0), (3, 1.5)])}
    corners = [*floor(), *roof(3.0, 1.0)]
    return scene(corners, dynamic=(kite("kite"),), animation=Animation(tracks), lights=[(0.5, 0.3, 9.0)], **extra)


def test_cubes_are_kept_dropped_and_made_as_things_move():
    settings = replace(SETTINGS, method="lightbuffer")
    renderer = tracer.Renderer(paused_scene(), settings)
    method = renderer.state.method("lightbuffer")
    made, cubes, resting = [], [], []
    for time in (0.0, 0.5, 1.0, 1.5, 2.0, 2.0, 2.5):
        frame = renderer.render(time)
        expected = tracer.Renderer(renderer.scene, SETTINGS).render(time)
        assert frame.color.tobytes() == expected.color.tobytes()
        buffer = method.buffers[0]
        cubes.append(buffer.static)
        made.append(frame.statistics.certificates)
        resting.append(buffer.resting is not None)
        assert frame.statistics.light_buffers == [256]
    assert made == [2, 0, 0, 1, 0, 0, 0] and resting == [True, False, False, True, True, True, False]
    assert all(cube is cubes[0] for cube in cubes), "what never moves is kept"


def test_where_memory_is_scarce_cells_are_larger_and_at_last_lights_are_traced():
    walk = paused_scene()
    expected = tracer.Renderer(walk, SETTINGS).render()
    sides, taken = [], []
    for memory in (256.0, 0.2, 0.05, 0.0):
        settings = replace(SETTINGS, method="lightbuffer", light_buffer_memory=memory)
        renderer = tracer.Renderer(walk, settings)
        frame = renderer.render()
        assert frame.color.tobytes() == expected.color.tobytes()
        sides += frame.statistics.light_buffers
        taken.append(renderer.memory_bytes)
        assert (frame.statistics.shadow.culled > 0) == (sides[-1] > 0)
    assert sides[0] == 256 and 16 <= sides[2] < sides[1] < 256 and sides[3] == 0
    assert taken == sorted(taken, reverse=True)
    for wrong in ({"light_buffer_side": 100}, {"light_buffer_memory": -1.0}):
        with pytest.raises(ValueError, match="light_buffer_"):
            replace(SETTINGS, **wrong).validated()


def test_a_cancelled_build_leaves_nothing_half_made():
    walk = nasty_walk(1, frames=2)
    renderer = tracer.Renderer(walk.scene, replace(SETTINGS, method="lightbuffer"))
    method, asked = renderer.state.method("lightbuffer"), [0]

    def cancel() -> bool:
        asked[0] += bool(getattr(method, "buffers", None))
        return asked[0] > 3

    with pytest.raises(Cancelled):
        renderer.render(*walk.frames[0], cancel=cancel)
    expected = tracer.Renderer(walk.scene, SETTINGS).render(*walk.frames[0])
    assert renderer.render(*walk.frames[0]).color.tobytes() == expected.color.tobytes()


def test_the_inspector_says_what_the_light_sees():
    made = paused_scene(camera=BEHIND)
    renderer = tracer.Renderer(made, replace(SETTINGS, method="lightbuffer", record_work=True))
    frame = renderer.render()
    verdicts, named = set(), set()
    for y in range(0, frame.height, 5):
        for x in range(0, frame.width, 5):
            tree = ray_tree(renderer, frame, x, y)
            assert tree.due - tree.traced == frame.saved[y, x]
            verdicts |= set(tree.counts)
            for ray in tree.rays:
                if ray.shadows is not None:
                    named |= {name for why in ray.shadows.reasons.values() for name in why.named}
    assert {Verdict.BUFFER_LIT, Verdict.BUFFER_FULL} <= verdicts
    first = len(floor())
    assert named and named <= set(range(first, first + 4)), "the roof and the kite are what hides the light"
    renderer.state.forget()
    assert renderer.memory_bytes < 1e6


def test_lists_and_depths_of_a_cube_are_what_they_are():
    """A square right above the light: its middle cells are covered from its height on."""
    world = tracer.World(scene([*roof(2.0, 1.0)]))
    cube = cube_of(world, np.zeros(3, F))
    lengths, depths = list_lengths(cube), full_depths(cube)
    assert lengths.shape == depths.shape == (6, 16, 16)
    up, others = 4, [0, 1, 2, 3, 5]
    assert (lengths[others] == 0).all() and np.isinf(depths[others]).all()
    covered = np.isfinite(depths[up])
    assert covered.sum() >= 16 and not covered[0].any(), "the rim of the face is open"
    x = (np.arange(16) + 0.5) / 8 - 1
    away = 2 * np.sqrt(1 + x[:, None] ** 2 + x**2)
    assert np.allclose(depths[up][covered], away[covered], rtol=1e-5)
