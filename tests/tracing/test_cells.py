"""Virtual cells: how triangles are cut, which cell a point is in, and what they are good for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import tracer
from tests.tracing import naive_cells
from tests.tracing.random_worlds import quickly
from tests.tracing.worlds import moved, quad, scene
from tracer.culling import cells
from tracer.culling.modes import OcclusionMode, occlusion_mode
from tracer.scene.model import Camera

HALF_SQUARE = np.array([0, 0, 0, 1, 0, 0, 0, 1, 0], np.float32)  # whose x and y are its weights u and v


def units(first: list[int], primitives, u, v) -> list[int]:
    found = np.empty(len(primitives), np.int32)
    arrays = np.array(first, np.int32), np.array(primitives, np.int32), np.array(u, np.float32), np.array(v, np.float32)
    cells.units_of(*arrays, found)
    return found.tolist()


def weights(draw, count: int) -> np.ndarray:
    """(count, 3) weights of the corners of points in a triangle, some of them on its edges and corners."""
    kinds = st.one_of(st.just(0.0), st.floats(0.0, 1.0, width=32))
    rows = draw(st.lists(st.tuples(kinds, kinds, kinds), min_size=count, max_size=count))
    w = np.array(rows, np.float64) + np.array([1e-30, 0.0, 0.0])
    return w / w.sum(axis=1, keepdims=True)


@quickly(60, shrink=True)
@given(st.integers(0, cells.MAX_LEVEL), st.integers(1, 24), st.data())
def test_a_point_lies_within_the_corners_of_its_cell(level: int, points: int, data: st.DataObject):
    """Sixteen at a time and those left over, next to another primitive and to misses."""
    count, w = 4**level, weights(data.draw, points)
    missed = data.draw(st.lists(st.booleans(), min_size=points, max_size=points))
    found = units([0, 5, 5 + count], np.where(missed, -1, 1), w[:, 1], w[:, 2])
    for unit, miss, (_, u, v) in zip(found, missed, w, strict=True):
        if miss:
            assert unit == -1
            continue
        assert 5 <= unit < 5 + count
        corners = cells.corners_of(HALF_SQUARE, count, unit - 5)[:, :2]
        inside = np.linalg.solve((corners[1:] - corners[0]).T, np.array([u, v]) - corners[0])
        slack = 1e-6 * 2**level
        assert inside.min() >= -slack and inside.sum() <= 1 + slack


@quickly(80, shrink=True)
@given(st.integers(0, cells.MAX_LEVEL), st.data())
def test_the_quadtree_leads_to_the_same_cell(level: int, data: st.DataObject):
    """Anywhere but on a border, where rounding decides."""
    (_, u, v) = weights(data.draw, 1)[0].astype(np.float32)
    x, y = float(u) * 2**level, float(v) * 2**level
    if min(abs(z - round(z)) for z in (x, y, x + y)) > 1e-3:
        assert units([0, 4**level], [0], [u], [v]) == [naive_cells.cell_of(4**level, u, v)]


@pytest.mark.parametrize("level", range(5))
def test_cells_are_congruent_and_tile_their_triangle_in_order(level: int):
    count = 4**level
    corners = np.array([cells.corners_of(HALF_SQUARE, count, i) for i in range(count)])
    edges = np.sort(np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2), axis=1)
    assert np.allclose(edges, np.array([1.0, 1.0, np.sqrt(2.0)]) / 2**level)
    middles = corners.mean(axis=1)
    assert units([0, count], [0] * count, middles[:, 0], middles[:, 1]) == list(range(count))


@pytest.mark.parametrize("count", [15, 16, 33])
def test_weights_from_outside_a_triangle_lead_to_one_of_its_cells(count: int):
    """Rays that pass just outside meet it, as the 8-wide trees have it; and the weights of quadrics mean nothing."""
    outside = [(-2e-6, 0.49, 7), (0.49, -2e-6, 2), (1.0000001, 0.0, 6), (0.0, 1.0000002, 15), (0.5000002, 0.5, 11)]
    u, v, expected = (np.resize(column, count) for column in zip(*outside, strict=True))
    assert units([0, 16], [0] * count, u, v) == expected.tolist()
    wild = np.resize([np.nan, np.inf, -np.inf, 1e30, -7.0], count)
    assert set(units([0, 16], [0] * count, wild, wild[::-1])) <= set(range(16))
    assert units([0, 1], [0] * count, wild, wild[::-1]) == [0] * count


def test_cells_have_about_one_area_and_what_is_small_stays_whole(monkeypatch):
    monkeypatch.setattr(cells, "AIM", 1000)
    areas = np.random.default_rng(3).lognormal(0.0, 3.0, 400)
    levels = cells.levels(areas)
    area = areas.sum() / cells.AIM
    assert (areas[levels == 0] <= 2 * area).all() and (levels == 0).any()
    cut = (areas / 4.0**levels)[(levels > 0) & (levels < cells.MAX_LEVEL)]
    assert len(cut) and cut.min() >= area / 2 and cut.max() <= 2 * area


@quickly(100)
@given(
    st.lists(st.one_of(st.just(0.0), st.floats(1e-30, 1e30), st.just(np.inf), st.just(np.nan)), max_size=40),
    st.integers(0, 30),
    st.integers(1, 500),
)
def test_units_are_never_more_than_there_is_room_for(areas: list[float], others: int, room: int):
    before, cells.MAX_UNITS = cells.MAX_UNITS, room
    try:
        levels = cells.levels(np.array(areas, np.float64), others)
    finally:
        cells.MAX_UNITS = before
    assert levels.shape == (len(areas),) and (levels >= 0).all()
    assert (4**levels).sum() + others <= max(room, len(areas) + others)


def test_what_moves_or_is_round_is_one_unit(monkeypatch):
    monkeypatch.setattr(cells, "AIM", 64)
    floor = quad((-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0))
    kite = moved("kite", floor, np.eye(4))
    world = tracer.World(scene(floor, dynamic=(kite,)))
    assert cells.first_units(world.placed.triangles, world.object_of).tolist() == [0, 16, 32, 33, 34]


LIGHT = (0.0, 0.0, 20.0)
SETTINGS = tracer.Settings(width=96, height=96, depth=2, method="cells", threads=1, verify=True)


def large_floor(**extra):
    """A floor of two triangles that go on beyond the picture, half of it under a roof that the camera sees."""
    plane = quad((-9, -9, 0), (9, -9, 0), (9, 9, 0), (-9, 9, 0))
    roof = quad((-4, -4, 6), (0, -4, 6), (0, 4, 6), (-4, 4, 6))
    camera = Camera((0.0, -9.0, 3.0), (0.0, 9.0, -3.0), (0.0, 0.0, 1.0), 40.0)
    return scene(plane + roof, lights=[LIGHT], camera=camera, **extra)


def test_a_floor_that_is_never_seen_whole_is_culled_cell_by_cell(monkeypatch):
    monkeypatch.setattr(cells, "AIM", 2000)
    by_method = {m: tracer.Renderer(large_floor(), replace(SETTINGS, method=m)) for m in ("none", "paper", "cells")}
    for _ in range(2):
        frames = {method: renderer.render() for method, renderer in by_method.items()}
    shadow = frames["cells"].statistics.shadow
    assert frames["paper"].statistics.shadow.culled == frames["paper"].statistics.shadow.dynamic_only == 0
    assert shadow.culled > 100 and shadow.dynamic_only > 100
    assert shadow.saved > 0.7 * shadow.due
    assert frames["cells"].statistics.occlusion_tests == frames["paper"].statistics.occlusion_tests
    assert frames["cells"].reference.tobytes() == frames["none"].color.tobytes()


def test_a_frame_tells_the_cells_that_pixels_see(monkeypatch):
    monkeypatch.setattr(cells, "AIM", 200)
    renderer = tracer.Renderer(large_floor(), SETTINGS)
    renderer.render()
    frame = renderer.render()
    hit = frame.primitive >= 0
    first = cells.first_units(renderer.world.placed.triangles, renderer.world.object_of)
    assert len(frame.modes) == len(frame.pixel_count) == len(frame.highest_count) == first[-1]
    assert (frame.cell is frame.cells) and ((frame.cell >= 0) == hit).all()
    assert (np.searchsorted(first, frame.cell[hit], side="right") - 1 == frame.primitive[hit]).all()
    assert np.array_equal(np.bincount(frame.cell[hit], minlength=first[-1]), frame.pixel_count)
    assert (frame.occlusion_mode[hit] == occlusion_mode(frame.modes)[frame.cell[hit]]).all()
    edge = np.concatenate([frame.occlusion_mode[0], frame.occlusion_mode[-1], frame.occlusion_mode[:, 0]])
    edge = edge[edge != 255]
    assert len(edge) and (edge == OcclusionMode.PARTIALLY_OCCLUDED).all()
    # The point that a pixel sees lies in its cell.
    y, x = (int(i[len(i) // 2]) for i in np.nonzero(hit))
    primitive, unit = int(frame.primitive[y, x]), int(frame.cell[y, x])
    triangle, count = renderer.world.placed.triangles[primitive], int(first[primitive + 1] - first[primitive])
    corners = cells.corners_of(triangle, count, unit - int(first[primitive]))
    right, up, forward = frame.camera.basis()
    half = np.tan(np.radians(frame.camera.angle) / 2)
    ray = forward + half * ((2 * x + 1) / 96 - 1) * right - half * ((2 * y + 1) / 96 - 1) * up
    point = np.array(frame.camera.position) + frame.depth[y, x] * ray / np.linalg.norm(ray)
    inside, *_ = np.linalg.lstsq((corners[1:] - corners[0]).T, point - corners[0], rcond=None)
    assert inside.min() > -1e-3 and inside.sum() < 1 + 1e-3


def test_modes_of_cells_do_not_speak_of_primitives(monkeypatch):
    """Nor the other way round: each has a memory of its own, and finds it again."""
    monkeypatch.setattr(cells, "AIM", 2000)
    renderer = tracer.Renderer(large_floor(), SETTINGS)
    renderer.render()
    culled = renderer.render().statistics.shadow.culled
    renderer.settings = replace(SETTINGS, method="paper")
    assert renderer.render().statistics.shadow.culled == 0
    renderer.settings = SETTINGS
    assert renderer.render().statistics.shadow.culled == culled > 0
