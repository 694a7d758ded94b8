"""What is told of voxels and cells: how a ray walks, by a search of all triangles, and which lights cells ask."""

from __future__ import annotations

from collections import Counter

import numpy as np

import tracer
from tests.sweeps import cases
from tests.tracing.nasty_worlds import nasty_walk, static_part, with_lamps
from tests.tracing.spaces import crossed_by, environment_store, point_lamps, voxel_store
from tracer.culling.modes import FULL_SHADOW, NON_SHADOW
from tracer.culling.rest import nothing_rests
from tracer.culling.verdicts import Verdict
from tracer.geometry.world import World
from tracer.inspect.path_records import VERDICTS
from tracer.inspect.ray_tree import ray_tree
from tracer.neighbours.environments.octree import HIDDEN, OUTSIDE
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


def test_cells_ask_all_lights_but_those_that_they_know_to_be_hidden():
    rng, fewer = np.random.default_rng(3), 0
    for seed, count in ((1, 3), (4, 5), (6, 40)):
        walk = nasty_walk(seed, count)
        made = with_lamps(walk).scene if seed == 4 else walk.scene
        world = World(static_part(made))
        lamps = (
            point_lamps(made.light_positions(0.0))
            if seed != 4
            else LampTable(made.lights).at(made.light_positions(0.0))
        )
        rows = world.triangles_of(0).rows
        low, high = (f(rows[:, :3].astype(np.float64), axis=0) for f in (np.min, np.max))
        points = (low + rng.random((40, 3)) * (high - low)).astype(np.float32)
        store = environment_store(world, lamps, points)
        store._known[rng.integers(0, len(lamps.places), 2)] = False  # as if they had moved
        cells = np.array([store.tree.leaf_at(point) for point in points], np.int32)
        asked = store.asked_in(cells)
        for cell, number in zip(cells.tolist(), asked.tolist(), strict=True):
            (starts, lights), of = store.further.lists.arrays(), store.further.of[cell]
            listed = set(lights[starts[of - 1] : starts[of]].tolist()) if of > 0 else set()
            expected = 0
            for light in range(len(lamps.places)):
                known = store._known[light]
                if light < store.held:
                    looks = not known or store.codes[cell, light] != HIDDEN or light in listed
                else:
                    looks = not known or of == 0 or light in listed
                expected += looks
            assert number == expected, (seed, cell)
            fewer += number < len(lamps.places)
        assert store.asked_in(np.array([OUTSIDE, -1], np.int32)).tolist() == [len(lamps.places), -1]
    assert fewer


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
