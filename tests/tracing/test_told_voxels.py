"""What is told of voxels and cells: how a ray walks, by a search of all triangles, and which lights cells ask."""

from __future__ import annotations

from collections import Counter

import numpy as np

import tracer
from tests.sweeps import cases
from tests.tracing.nasty_worlds import nasty_walk, static_part
from tests.tracing.spaces import crossed_by, voxel_store
from tracer.culling.modes import FULL_SHADOW, NON_SHADOW
from tracer.culling.rest import nothing_rests
from tracer.culling.verdicts import Verdict
from tracer.geometry.world import World
from tracer.inspect.path_records import VERDICTS
from tracer.inspect.ray_tree import ray_tree
from tracer.neighbours.voxels.tell import Stop
from tracer.scene.lights import LampTable, Light
from tracer.visibility.grid import cube_at, index_of


def test_the_walk_that_is_told_ends_as_the_ray_does():
    rng, stops = np.random.default_rng(7), Counter[Stop]()
    for seed in range(cases(6, 100)):
        world = World(static_part(nasty_walk(seed).scene))
        if len(world.primitives.quadrics):
            continue
        places = world.scene.light_positions(0.0)
        store, rows = voxel_store(world, places, 4e5), world.triangles_of(0).rows
        low, high = (f(rows[:, :3].astype(np.float64), axis=0) for f in (np.min, np.max))
        for light, place in enumerate(places.astype(np.float32)):
            points = (low + rng.random((12, 3)) * (high - low)).astype(np.float32)
            hidden = crossed_by(rows, place.astype(np.float64), points.astype(np.float64))
            for point, blocked in zip(points, hidden.tolist(), strict=True):
                number, walk = cube_at(store.grid, point), store.walked(point, light)
                assert (walk is None) == (number < 0)
                if walk is None:
                    continue
                stops[walk.stop] += 1
                assert walk.first == index_of(store.grid, number) and walk.in_words(store.shown(), light)
                expected = {FULL_SHADOW: True, NON_SHADOW: False}.get(walk.state, walk.stop is Stop.BLOCKED)
                assert blocked == expected, (seed, light, walk)
                if walk.blocker >= 0:
                    one = rows[walk.blocker : walk.blocker + 1]
                    assert crossed_by(one, place.astype(np.float64), point[None].astype(np.float64)).all()
                assert (walk.stop is Stop.HERE) == (store.describe(0, point, light)[0] != "none")
    assert min(stops[stop] for stop in (Stop.HERE, Stop.KNOWN, Stop.BLOCKED)) > 5, stops


def test_pictures_hold_the_states_that_they_found():
    world = World(static_part(nasty_walk(2).scene))
    places = world.scene.light_positions(0.0)
    store = voxel_store(world, places)
    shown = store.shown()
    assert shown is store.shown() and np.array_equal(shown.words, store.words) and shown.known.all()
    kept = shown.words.copy()
    moved = places + np.array([0.3, 0.1, 0.2])
    table = LampTable(tuple(Light(f"light {i}", (0.0, 0.0, 0.0)) for i in range(len(places))))
    store.update(table.at(moved), nothing_rests(len(world.scene.objects)))
    store.classify(np.inf, 1)
    assert store.shown() is not shown and np.array_equal(shown.words, kept), "a picture that is kept has changed"
    del shown
    store.shown()
    words, before = store.words, store.words.copy()
    store.update(table.at(places), nothing_rests(len(world.scene.objects)))
    store.classify(np.inf, 1)
    assert store.words is words and not np.array_equal(words, before), "what no picture holds is not copied"


def test_culled_rays_say_what_their_voxels_and_cells_knew():
    walk = nasty_walk(0)
    for method, verdicts in (
        ("voxels", {Verdict.VOXEL_FULL, Verdict.VOXEL_LIT, Verdict.VOXEL_WALK}),
        ("lie-exact", {Verdict.CELL_FULL, Verdict.CELL_LIT, Verdict.CELL_TESTED}),
    ):
        renderer = tracer.Renderer(walk.scene, tracer.Settings(width=64, height=48, depth=0, method=method, threads=1))
        for time, camera in (*walk.frames[:1], *walk.frames[:1]):
            frame = renderer.render(time, camera)
        seen = Counter[Verdict]()
        for y, x in np.argwhere(frame.primitive >= 0)[::97].tolist():
            for ray in ray_tree(renderer, frame, x, y).rays:
                if ray.shadows is None:
                    continue
                for place in np.flatnonzero([VERDICTS[n].culled for n in ray.shadows.verdict]).tolist():
                    verdict = VERDICTS[ray.shadows.verdict[place]]
                    seen[verdict] += 1
                    assert ray.shadows.reason(place).told or verdict is Verdict.PASSED_OVER
        assert set(seen) <= verdicts | {Verdict.PASSED_OVER} and set(seen) & verdicts, (method, seen)
