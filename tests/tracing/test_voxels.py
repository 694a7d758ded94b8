"""Voxel occlusion testing: what is proved of voxels holds for every ray, and pictures are those of "none"."""

from __future__ import annotations

import itertools
from collections import Counter

import numpy as np
import pytest

from tests.sweeps import ACCELERATORS, cases
from tests.tracing.nasty_worlds import nasty_walk, static_part
from tests.tracing.spaces import crossed_by, voxel_store
from tests.tracing.worlds import scene, wall
from tracer.culling.modes import FULL_SHADOW, NON_SHADOW, shadow_mode
from tracer.culling.rest import nothing_rests
from tracer.culling.shadow_testing import LIGHT_MARGIN
from tracer.geometry.primitives import triangle_rows
from tracer.geometry.rays import ray_batch
from tracer.geometry.world import World
from tracer.neighbours.voxels.grid import BLOCK, ROOM, make_grid, voxels_for
from tracer.scene.lights import LampTable, Light
from tracer.visibility.grid import boxes_of, cube_at

# --- the grid -------------------------------------------------------------------------------------


def test_points_lie_in_the_boxes_of_their_voxels_and_grids_are_no_finer_than_asked():
    rng = np.random.default_rng(3)
    for size, move, wanted in ((1.0, 0.0, 4096), (1e-3, 5.0, 1 << 20), (1e4, -1e6, 30000), (1.0, 0.0, 1)):
        points = (rng.random((300, 3)) * (4.0, 1.0, 0.001) * size + move).astype(np.float32)
        grid = make_grid(np.stack([points.min(0), points.max(0)]).astype(np.float64), wanted)
        assert grid.cubes <= max(wanted, BLOCK**3) and grid.nx % BLOCK == grid.ny % BLOCK == grid.nz % BLOCK == 0
        for point in points:
            number = cube_at(grid, point)
            box = boxes_of(grid, np.array([number]), ROOM)[0]
            assert number >= 0 and (point >= box[:3]).all() and (point <= box[3:]).all()
    assert cube_at(grid, np.full(3, 1e9, np.float32)) == -1


def test_less_memory_means_larger_voxels():
    assert voxels_for(10**6, 8, 1e5) < voxels_for(10**6, 8, 1e6) <= 1e6 / 8
    world = World(scene(wall(3, 2)))
    light = np.array([[1.0, 1.0, 3.0]])
    sizes = [voxel_store(world, light, memory) for memory in (4e4, 4e5, 4e7)]
    assert sizes[0].grid.side > sizes[1].grid.side > sizes[2].grid.side
    assert sizes[0].bytes < 1e5 and sizes[1].bytes < 5e5


def test_every_part_of_a_triangle_lies_in_voxels_that_name_it():
    rng = np.random.default_rng(5)
    for seed in range(cases(5, 12)):
        walk = nasty_walk(seed)
        world = World(static_part(walk.scene))
        store = voxel_store(world, world.scene.light_positions(0.0))
        rows = world.triangles_of(0).rows.astype(np.float64)
        view = store.view(np.empty(0, np.int32))
        named = [set(view.names[first:last].tolist()) for first, last in itertools.pairwise(view.starts)]
        across = np.linalg.norm(np.cross(rows[:, 3:6], rows[:, 6:]), axis=1)
        for i in np.flatnonzero(across > 0)[:60]:
            for u, v in np.sort(rng.random((20, 2)), axis=1):
                point = rows[i, :3] + u * rows[i, 3:6] + (1.0 - v) * rows[i, 6:]
                number = cube_at(store.grid, point.astype(np.float32))
                assert number >= 0 and i in named[number], (seed, i)


# --- the proof ------------------------------------------------------------------------------------


@pytest.mark.parametrize("accelerator", ACCELERATORS)
def test_whatever_is_proved_of_a_voxel_holds_for_the_rays_into_it(accelerator: str):
    """Rays to points all over each voxel, many to its corners: none passes into a full one, all into a null one."""
    rng, proved = np.random.default_rng(11), Counter[int]()
    for seed in range(cases(8, 400)):
        walk = nasty_walk(seed)
        world = World(static_part(walk.scene), 0.0, accelerator)
        lights = walk.scene.light_positions(0.0)
        store = voxel_store(world, lights, 4e5)
        rows = world.triangles_of(0).rows
        for light, place in enumerate(lights.astype(np.float32)):
            modes = shadow_mode(store.words[:-1], light)
            for mode in (FULL_SHADOW, NON_SHADOW):
                numbers = np.flatnonzero(modes == mode)
                # Those next to others are proved by the least.
                edge = np.flatnonzero(modes[numbers] != modes[np.minimum(numbers + 1, len(modes) - 1)])
                some = np.unique(np.r_[rng.permutation(numbers)[:40], numbers[rng.permutation(edge)[:60]]])
                if not len(some):
                    continue
                boxes = boxes_of(store.grid, some, ROOM)
                part = np.where(rng.random((len(some), 24, 1)) < 0.4, rng.integers(0, 2, (len(some), 24, 3)),
                                rng.random((len(some), 24, 3)))  # fmt: skip
                ends = (boxes[:, None, :3] + part * (boxes[:, None, 3:] - boxes[:, None, :3])).reshape(-1, 3)
                ends = ends.astype(np.float32)
                rays = ray_batch(np.broadcast_to(place, ends.shape), ends - place, LIGHT_MARGIN, 1.0)
                blocked = world.any_hits(rays, threads=1)
                assert (blocked == (mode == FULL_SHADOW)).all(), (seed, light, mode, int(blocked.sum()))
                if not len(world.primitives.quadrics):
                    crossed = crossed_by(rows, place.astype(np.float64), ends.astype(np.float64))
                    assert (crossed == (mode == FULL_SHADOW)).all(), (seed, light, mode)
                proved[mode] += len(some)
    assert min(proved.values()) > 20 * cases(8, 400), proved


def test_a_wall_hides_the_voxels_behind_it_and_no_others():
    """Most of what is unknown lies where the wall is, or where its shadow ends."""
    small = (np.array(wall(1, 1)) * 0.4 + (1.2, 0.9, 0.0)).tolist()
    corners = small + (np.array(wall(1, 1)) - (0, 0, 2)).tolist()
    world, light = World(scene(corners)), np.array([[2.0, 1.5, 4.0]])
    store, rows = voxel_store(world, light, 2e7), triangle_rows(np.array(corners, np.float32))
    rng, seen = np.random.default_rng(1), Counter[tuple[bool, str]]()
    points = (rng.random((4000, 3)) * (4.0, 3.0, 1.6) - (0, 0, 1.8)).astype(np.float32)
    crossed = crossed_by(rows, light[0], points.astype(np.float64))
    for point, hidden in zip(points, crossed, strict=True):
        seen[bool(hidden), store.describe(0, point, 0)[0]] += 1
    assert seen[True, "lit"] == seen[False, "full"] == 0
    assert seen[True, "full"] > seen[True, "none"] and seen[False, "lit"] > 8 * seen[False, "none"], seen


# --- frames ---------------------------------------------------------------------------------------


def test_a_light_that_moves_is_classified_anew_and_others_are_not():
    world = World(scene(wall(3, 2, (1, 0))))
    places = np.array([[1.0, 1.0, 3.0], [2.0, 1.0, -3.0]])
    moved = np.array([[1.0, 1.0, 3.0], [2.25, 1.0, -3.0]])
    store, fresh = voxel_store(world, places), voxel_store(world, moved)
    table = LampTable(tuple(Light(f"light {i}", (0.0, 0.0, 0.0)) for i in range(2)))
    store.update(table.at(moved), nothing_rests(1))
    assert store.describe(0, np.array([1, 1, 0], np.float32), 1)[0] == "none"
    assert not shadow_mode(store.words, 1).any() and shadow_mode(store.words, 0).any()
    made = store.classify(np.inf, 2).certificates
    assert 0 < made < fresh.grid.cubes
    assert np.array_equal(store.words, fresh.words)
    assert store.classify(np.inf, 1).certificates == 0, "nothing is left to do"
