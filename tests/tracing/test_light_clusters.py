"""The tree of lights, and bounds of what its clusters can be wrong by."""

from __future__ import annotations

import numpy as np
import pytest

from tests.sweeps import cases
from tests.tracing.halls import lights_of
from tracer.runtime.kernels import kernel
from tracer.scene.lights import COLOR, FALLS_OFF, Lamps, LampTable, Light
from tracer.shading.lightcuts.bounds import greatest_light, mirrored_direction
from tracer.shading.lightcuts.tree import CutTree, build_cut_tree
from tracer.shading.points import (
    DIFFUSE_ROW,
    EXPONENT_ROW,
    GEOMETRIC_ROW,
    NORMAL_ROW,
    POINT_ROWS,
    POSITION_ROW,
    SHINE_ROW,
    SPECULAR_ROW,
    points_in,
)
from tracer.simd import load_three, store

# --- the tree -------------------------------------------------------------------------------------


def twin(tree: CutTree, lamps: Lamps, node: int = 0) -> list[int]:
    """The lights below a node, by a naive walk that holds all that the tree says against them."""
    child = int(tree.children[node])
    below = [int(tree.reps[node])] if child == 0 else twin(tree, lamps, child) + twin(tree, lamps, child + 1)
    rows = lamps.rows[tree.owners[below]]
    assert tree.colors[node] == pytest.approx(rows[:, COLOR : COLOR + 3].astype(np.float64).sum(0), rel=1e-6)
    assert (tree.boxes[node, :3] == lamps.samples[below].min(0)).all()
    assert (tree.boxes[node, 3:] == lamps.samples[below].max(0)).all()
    assert sorted(tree.order[slice(*tree.spans[node])].tolist()) == sorted(below)
    if child:
        assert [tree.reps[node] == tree.reps[child], tree.reps[node] == tree.reps[child + 1]].count(True) == 1
    else:
        assert (tree.colors[node] == rows[0, COLOR : COLOR + 3]).all(), "a light's own colour, bit for bit"
    if node or len(set(rows[:, FALLS_OFF].tolist())) == 1:
        assert (rows[:, FALLS_OFF] == tree.falls[node]).all(), "clusters are of one kind"
    return below


@pytest.mark.parametrize("count", [1, 2, 3, 60])
def test_the_tree_holds_every_light_once_with_sums_boxes_and_representatives(count: int) -> None:
    lights = lights_of(count, count)
    lamps = LampTable(lights).at(np.array([light.position for light in lights]))
    tree = build_cut_tree(lamps)
    assert sorted(twin(tree, lamps)) == list(range(len(lamps.samples)))
    assert tree.owners.tolist() == np.repeat(np.arange(count), np.diff(lamps.first)).tolist()
    assert all(np.array_equal(a, b) for a, b in zip(tree, build_cut_tree(lamps), strict=True))


def test_lights_in_one_place_make_a_tree_as_well() -> None:
    lights = tuple(Light(f"light {i}", (1.0, 2.0, 3.0)) for i in range(50))
    lamps = LampTable(lights).at(np.array([light.position for light in lights]))
    assert len(twin(build_cut_tree(lamps), lamps)) == 50


# --- bounds ---------------------------------------------------------------------------------------


@kernel
def bounds_of(memory, directions, boxes, colors, falls):
    """Bounds (boxes, n) of clusters at points in rows of memory; directions (3, n) are those of the viewer's rays."""
    points, found = points_in(memory), np.empty((len(boxes), memory.shape[1]), np.float32)
    for k in range(len(boxes)):
        for v in range(memory.shape[1] // 16):
            mirror = mirrored_direction(load_three(points.normal, v), load_three(directions, v))
            color = colors[k, 0], colors[k, 1], colors[k, 2]
            bound = greatest_light(points, mirror, boxes[k], color, falls[k], v)
            store(found[k:].ctypes.data + 64 * v, bound)
    return found


def unit(a: np.ndarray) -> np.ndarray:
    return a / np.linalg.norm(a, axis=-1, keepdims=True)


def sent(points: np.ndarray, directions: np.ndarray, place: np.ndarray, falls: bool) -> np.ndarray:
    """What a light of colour 1 sends to each point, (n, 3): Phong, naively, in float64."""
    p = points.astype(np.float64).T
    position, normal = p[:, POSITION_ROW : POSITION_ROW + 3], p[:, NORMAL_ROW : NORMAL_ROW + 3]
    away = place.astype(np.float64) - position
    length = np.linalg.norm(away, axis=1)
    toward = away / length[:, None]
    cosine = (normal * toward).sum(1)
    view = directions.astype(np.float64).T
    mirrored = view - 2 * (view * normal).sum(1, keepdims=True) * normal
    along = np.maximum((mirrored * toward).sum(1), 0.0)
    shines = (p[:, SHINE_ROW] > 0) & (along > 0)
    specular = np.where(shines, along ** p[:, EXPONENT_ROW], 0.0)
    local = p[:, DIFFUSE_ROW : DIFFUSE_ROW + 3] * cosine[:, None]
    local += p[:, SPECULAR_ROW : SPECULAR_ROW + 3] * specular[:, None]
    faced = (cosine > 0) & ((p[:, GEOMETRIC_ROW : GEOMETRIC_ROW + 3] * away).sum(1) > 0)
    return np.where(faced[:, None], local / (length[:, None] ** 2 if falls else 1.0), 0.0)


@pytest.mark.parametrize("seed", range(cases(6, 60)))
def test_no_cluster_is_wrong_by_more_than_its_bound(seed: int) -> None:
    rng, n = np.random.default_rng(seed), 64
    points = np.zeros((POINT_ROWS, n), np.float32)
    points[POSITION_ROW : POSITION_ROW + 3] = rng.normal(size=(3, n)) * 10.0 ** rng.uniform(-2, 2)
    geometric = unit(rng.normal(size=(n, 3)))
    normal = unit(geometric + 0.3 * rng.normal(size=(n, 3)) * rng.integers(2))
    normal *= np.sign((normal * geometric).sum(1, keepdims=True))
    points[GEOMETRIC_ROW : GEOMETRIC_ROW + 3], points[NORMAL_ROW : NORMAL_ROW + 3] = geometric.T, normal.T
    points[DIFFUSE_ROW : DIFFUSE_ROW + 3] = rng.random((3, n))
    points[SPECULAR_ROW : SPECULAR_ROW + 3] = rng.random((3, n)) * (rng.random(n) < 0.6)
    points[SHINE_ROW] = points[SPECULAR_ROW : SPECULAR_ROW + 3].max(0)
    points[EXPONENT_ROW] = 10.0 ** rng.uniform(0, 2.5, n)
    directions = np.ascontiguousarray(unit(rng.normal(size=(n, 3))).T, np.float32)

    clusters = []
    for _ in range(40):
        spread, count = 10.0 ** rng.uniform(-3, 1), int(rng.integers(2, 7))
        middle = points[POSITION_ROW : POSITION_ROW + 3, rng.integers(n)] + rng.normal(size=3) * 10.0 ** rng.uniform(
            -2, 2
        )
        clusters.append(((middle + rng.normal(size=(count, 3)) * spread).astype(np.float32), rng.random((count, 3))))
    boxes = np.array([[*places.min(0), *places.max(0)] for places, _ in clusters], np.float32)
    colors = np.array([color.sum(0) for _, color in clusters], np.float32)
    falls = rng.random(len(clusters)) < 0.5
    found, tight = bounds_of(points, directions, boxes, colors, falls).astype(np.float64), []
    for (places, color), bound, total, fall in zip(clusters, found, colors, falls, strict=True):
        each = [sent(points, directions, place, bool(fall)) for place in places]
        lit = rng.random((len(places), n)) < 0.7
        light = sum((c * s).sum(1) * seen for c, s, seen in zip(color, each, lit, strict=True))
        for rep in range(len(places)):
            wrong = np.abs(light - (total * each[rep]).sum(1) * lit[rep])
            assert (wrong <= bound * (1 + 1e-6) + 1e-12).all()
        whole = sum((c * s).sum(1) for c, s in zip(color, each, strict=True))
        tight.append(bound[whole > 0] / whole[whole > 0])
    assert np.median(np.concatenate(tight)) < 4.0, "and bounds say something"
