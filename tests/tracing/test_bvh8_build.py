"""Building 8-wide trees: whatever the input, for any number of threads, and worth its name."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import tracer
from tests.sweeps import cases
from tests.tracing.random_worlds import quickly
from tests.tracing.trees8 import NO_BOXES, assert_sound, cost, same, walk
from tests.tracing.worlds import random_corners, scene
from tracer.geometry.building import CANCELLED, DONE
from tracer.geometry.bvh8.build import build_tree
from tracer.geometry.primitives import triangle_rows
from tracer.geometry.wide_tree.build import SMALL, build_topology
from tracer.scene.model import Cancelled

SHAPES = {
    "scattered": lambda rng, n: random_corners(rng, n, 0.1),
    "far away": lambda rng, n: random_corners(rng, n, 0.1) + 1e4,
    "one point": lambda rng, n: np.full((n, 3, 3), rng.normal()),
    "all equal": lambda rng, n: np.tile(rng.normal(size=(1, 3, 3)), (n, 1, 1)),
    "same centre": lambda rng, n: rng.normal(size=(n, 1, 3)) * np.array([[1], [0], [-1]]),
    "on a line": lambda rng, n: rng.random((n, 1, 1)) * np.ones((1, 3, 3)),
    "flat": lambda rng, n: random_corners(rng, n, 0.3) * [1, 0, 1],
    "ever smaller": lambda rng, n: random_corners(rng, n, 0.1) * 0.8 ** np.arange(n)[:, None, None],
    "tiny": lambda rng, n: random_corners(rng, n, 0.1) * 1e-37,
    "huge": lambda rng, n: random_corners(rng, n, 0.1) * 1e30,
}


@quickly(60)
@given(st.sampled_from(sorted(SHAPES)), st.integers(0, 300), st.integers(0, 40), st.integers(0, 2**32 - 1))
def test_anything_makes_a_sound_tree(shape, triangles, boxes, seed):
    rng = np.random.default_rng(seed)
    rows = triangle_rows(np.asarray(SHAPES[shape](rng, triangles), np.float32).reshape(-1, 3, 3))
    around = random_corners(rng, boxes, 0.2)
    around = np.concatenate([around.min(1), around.max(1)], axis=1)
    assert_sound(build_tree(rows, around), rows, around)


@pytest.mark.parametrize("shape", cases(["scattered", "all equal", "ever smaller"], sorted(SHAPES)))
def test_thousands_make_a_sound_tree_which_no_number_of_threads_changes(shape):
    rng = np.random.default_rng(1)
    rows = triangle_rows(np.asarray(SHAPES[shape](rng, cases(2, 3) * SMALL), np.float32))
    boxes = np.tile(np.array([[0, 0, 0, 1, 1, 1]], np.float32), (50, 1))
    one, many = (build_tree(rows, boxes, threads=n) for n in (1, 4))
    assert_sound(one, rows, boxes)
    assert same(one, many)


def test_a_tree_over_nothing_is_one_empty_node():
    tree = build_tree(np.empty((0, 9), np.float32), NO_BOXES)
    assert_sound(tree, np.empty((0, 9), np.float32))
    assert tree.nodes.shape == (1, 64)


def test_a_tree_is_worth_its_name():
    rng = np.random.default_rng(2)
    corners = rng.random((10000, 1, 3)) + rng.normal(size=(10000, 3, 3)) * 0.002
    tree = build_tree(triangle_rows(corners.astype(np.float32)), NO_BOXES)
    found = walk(tree)
    assert cost(tree) < 18  # of leaves in the order given it would be 1200
    assert found.depth <= 8
    assert len(found.leaves) / len(found.nodes) > 5  # nodes are well filled


@pytest.mark.parametrize("depth", [10, 14, 40])
def test_no_way_down_is_longer_than_it_may_be(depth):
    """Not even over triangles of which each but the last is as large as all after it."""
    corners = random_corners(np.random.default_rng(6), 1000, 0.1) * 0.8 ** np.arange(1000)[:, None, None]
    rows, control = triangle_rows(corners.astype(np.float32)), np.zeros(2, np.int64)
    children = build_topology(rows, NO_BOXES, control, depth=depth).children
    levels = np.ones(len(children), int)
    for node, row in enumerate(children):
        levels[row[row >= 0]] = levels[node] + 1
    assert levels.max() <= depth
    assert depth < 40 or levels.max() > 10, "a bound was tested that nothing would have passed"


def test_a_build_that_is_cancelled_stops():
    rows = triangle_rows(random_corners(np.random.default_rng(0), 1000, 0.1))
    control = np.zeros(2, np.int64)
    build_tree(rows, NO_BOXES, control)
    assert control[DONE] == 1000
    control[CANCELLED] = 1
    with pytest.raises(Cancelled):
        build_tree(rows, NO_BOXES, control)


def test_progress_that_raises_cancels_a_large_build():
    told = []

    def stop(what: str, done: float) -> None:
        if what != "laying out primitives":
            told.append(done)
            raise Cancelled

    with pytest.raises(Cancelled):
        tracer.World(scene(random_corners(np.random.default_rng(0), 50000, 0.01)), accelerator="bvh8", progress=stop)
    assert told == [0.0]
