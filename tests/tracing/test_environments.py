"""Local illumination environments: what is proved of cells holds for every ray, and pictures are those of "none"."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

import tracer
from tests.sweeps import ACCELERATORS, cases
from tests.tracing.nasty_worlds import nasty_walk, static_part
from tests.tracing.spaces import environment_store, point_lamps
from tests.tracing.worlds import scene, wall
from tracer.culling.modes import FULL_SHADOW, MAX_CULLED_LIGHTS, NON_SHADOW
from tracer.culling.shadow_testing import LIGHT_MARGIN
from tracer.geometry.rays import ray_batch
from tracer.geometry.world import World
from tracer.neighbours.environments.octree import HIDDEN, LIT, OUTSIDE, UNKNOWN, boxes_of, make_grid
from tracer.neighbours.environments.store import CANDIDATES
from tracer.scene.lights import Light
from tracer.settings import Settings


def test_a_point_is_in_the_box_of_its_cell_by_either_way_down():
    rng = np.random.default_rng(2)
    for scale, move in ((1.0, 0.0), (1e-3, 5.0), (1e4, -1e6)):
        corners = np.array(wall(4, 3)) * scale + move
        points = (rng.random((200, 3)) * (4.0, 3.0, 0.0) * scale + move).astype(np.float32)
        store = environment_store(
            World(scene(corners)), point_lamps(np.array([[1.0, 1.0, 2.0]]) * scale + move), points
        )
        cells = store.tree.leaves_at(points)
        boxes = boxes_of(store.tree.grid, store.tree.cells[cells])
        assert (cells != OUTSIDE).all() and (store.tree.child[cells] == 0).all()
        assert (points >= boxes[:, :3]).all() and (points <= boxes[:, 3:]).all()
        assert [store.tree.leaf_at(point) for point in points] == cells.tolist()
    assert store.tree.leaf_at(np.full(3, 1e9, np.float32)) == OUTSIDE
    assert make_grid(np.zeros((2, 3))).nx >= 1


@pytest.mark.parametrize("accelerator", ACCELERATORS)
def test_whatever_is_proved_of_a_cell_holds_for_the_rays_into_it(accelerator: str):
    """No ray reaches a cell that a light is hidden from, all reach one that it lights; others meet blockers alone."""
    proved = Counter[str]()
    for seed in range(cases(6, 400)):
        rng = np.random.default_rng(seed)
        walk = nasty_walk(seed)
        world = World(static_part(walk.scene), 0.0, accelerator)
        places = walk.scene.light_positions(0.0).astype(np.float32)
        rows = world.triangles_of(0).rows.astype(np.float64)
        at = np.sort(rng.random((300, 2)), axis=1)
        those = rows[rng.integers(len(rows), size=300)]
        points = those[:, :3] + at[:, :1] * those[:, 3:6] + (1 - at[:, 1:]) * those[:, 6:]
        anywhere = points.min(0) + rng.random((300, 3)) * np.ptp(points, axis=0)
        points = np.concatenate([points, anywhere]).astype(np.float32)
        store = environment_store(world, point_lamps(places), points)
        cells = np.unique(store.tree.leaves_at(points))
        boxes = boxes_of(store.tree.grid, store.tree.cells[cells])
        part = np.where(rng.random((len(cells), 16, 1)) < 0.4, rng.integers(0, 2, (len(cells), 16, 3)),
                        rng.random((len(cells), 16, 3)))  # fmt: skip
        ends = (boxes[:, None, :3] + part * (boxes[:, None, 3:] - boxes[:, None, :3])).astype(np.float32)
        for light in range(store.held):
            flat = ends.reshape(-1, 3)
            rays = ray_batch(np.broadcast_to(places[light], flat.shape), flat - places[light], LIGHT_MARGIN, 1.0)
            blocked = world.any_hits(rays, threads=1).reshape(len(cells), 16)
            hits = world.closest_hits(rays, threads=1).primitive.reshape(len(cells), 16)
            for cell, stopped, met in zip(cells, blocked, hits, strict=True):
                code = store.codes[cell, light]
                if code == HIDDEN:
                    assert stopped.all(), (seed, cell)
                elif code == LIT:
                    assert not stopped.any(), (seed, cell)
                elif code > 0:
                    named = store.names[code + 1 : code + 1 + store.names[code]]
                    assert np.isin(met[stopped], named).all(), (seed, cell)
                proved[{HIDDEN: "hidden", LIT: "lit", UNKNOWN: "unknown"}.get(int(code), "blockers")] += 1
    assert min(proved[name] for name in ("hidden", "lit", "blockers")) > cases(30, 1000), proved


def test_with_samples_it_is_wrong_now_and_then_and_verify_counts():
    wrong = right = 0
    for seed in range(4):
        walk = nasty_walk(seed)
        settings = Settings(width=64, height=48, depth=1, method="lie", verify=True, threads=1)
        sampled, none = (
            tracer.Renderer(walk.scene, settings),
            tracer.Renderer(walk.scene, replace(settings, method="none")),
        )
        for time, camera in walk.frames[:2]:
            frame, expected = sampled.render(time, camera), none.render(time, camera)
            assert frame.reference is not None and frame.reference.tobytes() == expected.color.tobytes()
            shadow = frame.statistics.shadow
            wrong, right = wrong + shadow.wrong, right + shadow.due - shadow.wrong
    assert 0 < wrong < 0.1 * right, (wrong, right)


def test_memory_is_bounded_and_lights_without_room_are_traced():
    walk = nasty_walk(2)
    settings = Settings(width=64, height=48, depth=1, method="lie-exact", threads=1)
    for megabytes in (0.0, 0.02, 1.0):
        small = tracer.Renderer(walk.scene, replace(settings, certificate_memory=megabytes))
        none = tracer.Renderer(walk.scene, replace(settings, method="none"))
        for time, camera in walk.frames:
            assert small.render(time, camera).color.tobytes() == none.render(time, camera).color.tobytes()


def test_what_is_shown_of_cells_is_true_and_lights_behind_a_wall_are_passed_over():
    """Three walls one behind the other, with lights on either side of that in the middle."""
    one = np.array(wall(1, 1))
    corners = (one + np.array([0.0, -3.0, 3.0])[:, None, None, None] * (0, 0, 1)).reshape(-1, 3, 3)
    rng = np.random.default_rng(4)
    places = rng.random((2 * MAX_CULLED_LIGHTS, 3)) * (2.0, 1.5, 1.0) + (1.0, 0.7, 0.5)
    places[::2, 2] *= -1.0
    lights = tuple(Light(f"light {i}", tuple(place), (0.1, 0.1, 0.1)) for i, place in enumerate(places.tolist()))
    made = replace(scene(corners), lights=lights)
    camera = tracer.Camera((2.0, 1.5, -0.1), (0.0, 0.0, -1.0), (0.0, 1.0, 0.0), 60.0)
    settings = Settings(width=64, height=48, depth=1, method="lie-exact", threads=1)
    none = tracer.Renderer(made, replace(settings, method="none")).render(0.0, camera)
    renderer = tracer.Renderer(made, settings)
    frame = renderer.render(0.0, camera)
    assert frame.color.tobytes() == none.color.tobytes()
    assert frame.statistics.shadow.passed_over > 0.4 * none.statistics.shadow.due
    renderer.settings = replace(settings, record_lights=True)
    frame = renderer.render(0.0, camera)
    assert frame.certificates is not None and frame.asked is not None and frame.reached is not None
    shown = Counter[int]()
    for light in range(MAX_CULLED_LIGHTS):
        state = (frame.certificates >> frame.certificates.dtype.type(2 + 2 * light)) & 3
        shown.update(state[frame.primitive >= 0].tolist())
        assert (frame.reached[..., light][state == FULL_SHADOW] == 0).all()
        lit = state == NON_SHADOW
        assert (frame.reached[..., light][lit] == frame.asked[..., light][lit]).all()
    assert shown[FULL_SHADOW] > 0.4 * shown.total() and shown[CANDIDATES] > 0, shown
