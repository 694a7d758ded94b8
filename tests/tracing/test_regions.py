"""Regions: lights that a triangle hides from a whole region are not looked at."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.sweeps import ACCELERATORS, cases
from tests.tracing.worlds import quad, scene, wall
from tracer.culling.shadow_testing import LIGHT_MARGIN
from tracer.culling.verdicts import Verdict
from tracer.geometry.primitives import triangle_rows
from tracer.geometry.rays import ray_batch
from tracer.geometry.world import World
from tracer.inspect.ray_tree import ray_tree
from tracer.neighbours.regions.store import RegionStore, make_grid, region_boxes
from tracer.renderer import Renderer
from tracer.scene.animation import Animation, Keys, TrackSet
from tracer.scene.lights import LampTable, Light
from tracer.scene.model import Camera, Scene
from tracer.settings import Settings
from tracer.visibility.blockers import find_blockers
from tracer.visibility.budget import Budget
from tracer.visibility.grid import cube_at
from tracer.visibility.hidden_lights import first_blocker
from tracer.visibility.light_tree import LEAVES, build_light_tree

SETTINGS = Settings(width=64, height=48, depth=2, method="certified", threads=2)


def rows_of(corners: list) -> np.ndarray:
    return triangle_rows(np.array(corners, np.float32))


# --- the tree of lights ---------------------------------------------------------------------------


@pytest.mark.parametrize("count", [1, 2, 37, LEAVES, 3 * LEAVES + 5])
def test_every_light_is_in_one_leaf_and_below_boxes_that_hold_it(count: int):
    rng = np.random.default_rng(count)
    low = rng.normal(size=(count, 3))
    boxes = np.concatenate([low, low + rng.random((count, 3))], 1).astype(np.float32)
    tree = build_light_tree(boxes)
    leaves = np.flatnonzero(tree.children == 0)
    assert len(leaves) <= LEAVES
    assert (np.sort(np.concatenate([tree.order[a:b] for a, b in tree.lights[leaves]])) == np.arange(count)).all()
    for (first, last), box in zip(tree.lights, tree.boxes, strict=True):
        inside = boxes[tree.order[first:last]]
        assert (box[:3] == inside[:, :3].min(0)).all() and (box[3:] == inside[:, 3:].max(0)).all()


# --- blockers -------------------------------------------------------------------------------------


def test_blockers_are_the_largest_triangles_that_have_any_area():
    rng = np.random.default_rng(7)
    corners = rng.normal(size=(40, 3, 3)) * 10.0 ** rng.uniform(-2, 1, (40, 1, 1))
    corners[3] = corners[3, :1]  # of no area
    rows = rows_of(corners.tolist())
    blockers = find_blockers(rows, 1.0)
    assert sorted(blockers.numbers.tolist()) == [i for i in range(40) if i != 3]
    columns = blockers.groups.transpose(0, 2, 1).reshape(-1, 9)
    assert (columns[:39] == rows[blockers.numbers]).all() and not columns[39:].any()


def test_only_the_largest_are_taken(monkeypatch):
    monkeypatch.setattr("tracer.visibility.blockers.MOST", 2)
    small, large = quad((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)), quad((0, 0, 1), (2, 0, 1), (2, 2, 1), (0, 2, 1))
    assert sorted(find_blockers(rows_of(small + large), 1.0).numbers.tolist()) == [2, 3]


def test_nothing_has_no_blockers():
    assert len(find_blockers(np.empty((0, 9), np.float32), 1.0).numbers) == 0
    assert len(find_blockers(rows_of([[(0, 0, 0), (1, 0, 0), (2, 0, 0)]]), 1.0).numbers) == 0


# --- the proof ------------------------------------------------------------------------------------


def _rays(rng: np.random.Generator, lights: np.ndarray, region: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Origins and ends (n, 3) of rays from one box (6,) to another, many from corners to corners."""
    n, sides = 4000, np.stack([lights.reshape(2, 3), region.reshape(2, 3)])
    part = np.where(rng.random((n, 1, 1)) < 0.5, rng.random((n, 2, 3)), rng.integers(0, 2, (n, 2, 3)))
    points = (sides[:, 0] + part * (sides[:, 1] - sides[:, 0])).astype(np.float32)
    points = np.clip(points, sides[:, 0].astype(np.float32), sides[:, 1].astype(np.float32))
    return points[:, 0], points[:, 1]


@pytest.mark.parametrize("accelerator", ACCELERATORS)
def test_no_ray_gets_past_a_blocker_that_hides_a_light(accelerator: str):
    """Walls of many sizes, turned and moved away from the origin; rays close to edges above all."""
    proved = 0
    for seed in range(cases(12, 600)):
        rng = np.random.default_rng(seed)
        turn = np.linalg.qr(rng.normal(size=(3, 3)))[0] if rng.random() < 0.5 else np.eye(3)
        scale = 10.0 ** rng.uniform(-2, 3)
        place, move = turn * scale, rng.normal(size=3) * scale * rng.choice([0.0, 1.0, 30.0])
        columns, rows = (int(n) for n in rng.choice([1, 1, 2, 3, 5], 2))
        hole = (columns // 2, rows // 2) if columns > 1 and rng.random() < 0.3 else None
        corners = np.array(wall(columns, rows, hole)) @ place.T + move
        world = World(scene(corners), accelerator=accelerator)
        store = RegionStore(world, LampTable((Light("light", (0.0, 0.0, 0.0)),)).at(np.zeros((1, 3))))
        for _ in range(12):
            middle = np.array([rng.uniform(0, 4), rng.uniform(0, 3), 0.0])
            away = np.array([*rng.normal(size=2) * rng.choice([0.2, 1.0]), 1.0])
            centers = middle + away * 10.0 ** rng.uniform(-1.5, 0.5), middle - away * 10.0 ** rng.uniform(-1, 0.5)
            half = 10.0 ** rng.uniform(-3, -0.5, (2, 1)) * rng.random((2, 3)) * scale
            light, region = (
                np.concatenate([place @ c + move - h, place @ c + move + h]).astype(np.float32).astype(np.float64)
                for c, h in zip(centers, half, strict=True)
            )
            if first_blocker(store.hidden.blockers, region[None], light[None]) < 0:
                continue
            origins, ends = _rays(rng, light, region)
            blocked = world.any_hits(ray_batch(origins, ends - origins, LIGHT_MARGIN, 1.0), threads=1)
            assert blocked.all(), (seed, int((~blocked).sum()))
            proved += 1
    assert proved > cases(12, 600), proved


# --- regions --------------------------------------------------------------------------------------


def test_a_point_lies_in_the_box_of_its_region():
    rng = np.random.default_rng(3)
    for scale, move in ((1.0, 0.0), (1e-3, 5.0), (1e4, -1e6)):
        points = (rng.random((500, 3)) * (4.0, 1.0, 0.01) * scale + move).astype(np.float32)
        grid = make_grid(np.stack([points.min(0), points.max(0)]).astype(np.float64))
        numbers = np.array([cube_at(grid, point) for point in points])
        assert (numbers >= 0).all()
        for times in (1, 8):
            boxes = region_boxes(grid, numbers, times)
            assert (points >= boxes[:, :3]).all() and (points <= boxes[:, 3:]).all()
    assert cube_at(grid, np.full(3, 1e9, np.float32)) == -1


# --- frames ---------------------------------------------------------------------------------------


def rooms(lights: int = 48, samples: int = 4, moves: bool = False) -> Scene:
    """Two rooms on either side of a wall with a window, under lamps in both; one may fly from the one to the other."""
    floor = [(0.0, 0.0, -8.0), (4.0, 0.0, -8.0), (4.0, 0.0, 8.0), (0.0, 0.0, 8.0)]
    rng = np.random.default_rng(5)
    places = rng.uniform((0.3, 2.0, 0.3), (3.7, 2.8, 4.0), (lights, 3)) * np.where(
        rng.random((lights, 1)) < 0.5, 1, (1, 1, -1)
    )
    lamps = tuple(
        Light(f"lamp {i}", tuple(p), (0.05, 0.05, 0.04), kind="sphere", radius=0.05, samples=samples)
        for i, p in enumerate(places.tolist())
    )
    animation = Animation.empty()
    if moves:
        way = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, -4.0], [0.0, 0.0, -4.0]])
        animation = Animation(
            {"flies": TrackSet(translation=Keys(np.array([0.0, 1.0, 2.0, 4.0]), way, np.zeros((4, 3))))}
        )
        lamps = (*lamps[:-1], replace(lamps[-1], position=(2.0, 2.0, 2.0), track="flies"))
    return replace(
        scene(quad(*floor) + wall(5, 4, hole=(2, 2)), animation=animation, time_range=(0.0, 4.0)),
        lights=lamps,
        camera=Camera((2.0, 1.6, 7.0), (0.0, -0.2, -1.0), angle=60.0),
    )


@pytest.mark.parametrize("accelerator", ACCELERATORS)
def test_lights_that_a_wall_hides_are_passed_over_and_nothing_changes(accelerator: str):
    settings = replace(SETTINGS, accelerator=accelerator)
    renderer, truth = Renderer(rooms(), settings), Renderer(rooms(), replace(settings, method="none"))
    none = truth.render(0.0)
    for _ in range(2):
        frame = renderer.render(0.0)
        assert frame.color.tobytes() == none.color.tobytes()
    shadow, all_due = frame.statistics.shadow, none.statistics.shadow.due
    assert shadow.passed_over > (0.2 if accelerator == "bvh8" else 0.1) * all_due
    assert shadow.due < (0.95 if accelerator == "bvh8" else 0.98) * all_due and frame.statistics.certificates == 0


def test_what_is_recorded_of_lights_that_are_passed_over_is_what_none_records():
    settings = replace(SETTINGS, record_lights=True, record_work=True, verify=True)
    frame = Renderer(rooms(), settings).render(0.0)
    none = Renderer(rooms(), replace(settings, method="none")).render(0.0)
    assert frame.statistics.shadow.culled > 1000 and frame.statistics.shadow.wrong == 0
    verified = Renderer(rooms(), replace(SETTINGS, verify=True)).render(0.0).statistics
    assert verified.wrong.untraced > 1000 and verified.shadow.passed_over == 0, "answers that may be wrong are counted"
    assert frame.statistics.shadow.due == none.statistics.shadow.due
    for name in ("color", "asked", "reached", "reference", "due_rays"):
        assert getattr(frame, name).tobytes() == getattr(none, name).tobytes(), name


def test_a_light_that_flies_through_the_wall_is_looked_at_wherever_it_is():
    settings = replace(SETTINGS, depth=0)
    renderer, truth = (Renderer(rooms(moves=True), replace(settings, method=m)) for m in ("certified", "none"))
    for time in (0.0, 0.5, 1.2, 1.6, 2.5, 3.0, 0.0):
        assert renderer.render(time).color.tobytes() == truth.render(time).color.tobytes(), time


def test_other_lamps_are_certified_anew():
    renderer = Renderer(rooms(), SETTINGS)
    for change in ({}, {"lamp_radius": 1.0}, {"lamp_samples": 2}, {"lamp_radius": 0.0}):
        renderer.settings = replace(renderer.settings, **change)
        none = Renderer(renderer.scene, replace(renderer.settings, method="none")).render(0.0)
        for _ in range(2):
            frame = renderer.render(0.0)
            assert frame.color.tobytes() == none.color.tobytes(), change
        assert frame.statistics.shadow.passed_over > 0, change


def test_a_budget_of_certificates_is_kept():
    renderer = Renderer(rooms(), replace(SETTINGS, certificates=100))
    made = [renderer.render(0.0).statistics.certificates for _ in range(3)]
    assert made == [100, 100, 100]


def test_memory_is_bounded():
    lit = rooms()
    store = RegionStore(World(lit), LampTable(lit.lights).at(lit.light_positions(0.0)))
    store.wanted[:: len(store.wanted) // 50] = True
    made = store.certify(Budget(), threads=2).certificates
    assert made > 50 and store.bytes > 0 and not store.wanted.any() and store.certified.any()
    store.keep_within(store.bytes)
    assert store.certified.any()
    store.keep_within(store.bytes - 1)
    assert not store.certified.any()


def test_reasons_name_what_hides_a_light():
    renderer = Renderer(rooms(samples=1), SETTINGS)
    frame = renderer.render(0.0)
    rays = [ray_tree(renderer, frame, x, 40).rays[0].shadows for x in (8, 30, 50)]
    hidden = [(s, *one) for s in rays for one in s.reasons.items() if one[1].verdict is Verdict.PASSED_OVER]
    assert len(hidden) > 20 and not any(s.lit[place] for s, place, _ in hidden)
    assert all(2 <= why.named[0] < 42 for _, _, why in hidden), "a triangle of the wall"
