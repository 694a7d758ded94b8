"""Which modes an object's box concerns: all that it may, by rays into it, and no others, by planes beside it."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.tracing.random_worlds import quickly
from tracer.culling.dependence import drop_dependent
from tracer.culling.modes import DYNAMIC, FULL_SHADOW, FULLY_RENDERED, INIT, NON_SHADOW, PARTIALLY_OCCLUDED, word_type
from tracer.geometry.primitives import Outlines, triangle_rows

BOTH = FULL_SHADOW | NON_SHADOW


NO_TRIANGLES, NO_BOXES = np.empty((0, 3, 3)), np.empty((0, 6))
TO_WORLD = np.array([[1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0], [0, 2, 0, 1, 1, 0, 1, 2, 0, 0, 0.5, 3]], np.float64)


def outlines_of(corners: np.ndarray, boxes: np.ndarray = NO_BOXES) -> Outlines:
    """Triangles (t, 3, 3), every other of an object with a map of its own, and boxes (q, 6) of quadrics."""
    owners = np.arange(len(corners) + len(boxes), dtype=np.int32) % 2
    linear, place = np.split(TO_WORLD[1].reshape(3, 4), [3], axis=1)
    corners = corners.copy()
    corners[1::2] = (corners[1::2] - place[:, 0]) @ np.linalg.inv(linear).T
    return Outlines(triangle_rows(corners), TO_WORLD, owners, boxes.astype(np.float32))


def dropped(outlines: Outlines, light: np.ndarray, boxes: np.ndarray) -> np.ndarray:
    """(units,) whether each loses the mode of one light by these boxes (k, 6)."""
    words = np.full(len(outlines.object_of), FULL_SHADOW << 2, np.uint32)
    drop_dependent(words, outlines, light[None].astype(np.float32), boxes.astype(np.float32), FULL_SHADOW, 1)
    assert np.isin(words, (0, FULL_SHADOW << 2)).all()
    return words == 0


def corners_of_boxes(boxes: np.ndarray) -> np.ndarray:
    """(n, 8, 3) of boxes (n, 6)."""
    return np.stack([boxes[:, [x, 1 + y, 2 + z]] for x, y, z in product((0, 3), repeat=3)], axis=1)


def random_boxes(rng: np.random.Generator, n: int, size: float) -> np.ndarray:
    low = rng.uniform(-1, 1, (n, 3))
    return np.concatenate([low, low + size * rng.random((n, 3))], axis=1)


def rays_meet(light: np.ndarray, points: np.ndarray, box: np.ndarray) -> np.ndarray:
    """(n,) whether segments from a light to points (n, 3) meet a box (6,)."""
    with np.errstate(divide="ignore", invalid="ignore"):
        sides = (np.stack([box[:3], box[3:]])[:, None] - light) / (points - light)
    return np.minimum(sides.max(0).min(1), 1.0) >= np.maximum(sides.min(0).max(1), 0.0)


def separated(a: np.ndarray, b: np.ndarray) -> bool:
    """Whether the hulls of points a (n, 3) and b (m, 3) keep clear of one another by some plane, which is found by
    walking towards the least difference between them (Gilbert 1966)."""
    x = a[0] - b[0]
    for _ in range(400):
        y = a[(a @ x).argmin()] - b[(b @ x).argmax()]
        if x @ y > 1e-3 * np.linalg.norm(x):
            return True  # all differences lie on that side of the plane
        step = y - x
        x = x + np.clip(-(x @ step) / max(step @ step, 1e-30), 0.0, 1.0) * step
    return False


@pytest.mark.parametrize("round_ones", [False, True])
def test_a_mode_is_dropped_where_a_ray_meets_the_box_and_kept_where_a_plane_keeps_it_out(round_ones: bool):
    seen = {"met": 0, "separated": 0}

    @quickly(16)
    @given(st.integers(0, 2**32 - 1), st.sampled_from([0.05, 0.5, 2.0]), st.sampled_from([0.1, 0.5, 1.5]))
    def check(seed: int, size: float, room: float) -> None:
        rng = np.random.default_rng(seed)
        corners, light, n = rng.uniform(-1, 1, (40, 1, 3)) + rng.normal(size=(40, 3, 3)) * size, rng.normal(size=3), 40
        if round_ones:
            outlines = outlines_of(NO_TRIANGLES, random_boxes(rng, n, size))
            corners = corners_of_boxes(outlines.boxes.astype(np.float64))
        else:
            outlines = outlines_of(corners)
        weights = rng.dirichlet(np.full(corners.shape[1], 0.5), (n, 200))
        points = np.einsum("nsc,ncx->nsx", weights, corners)
        for box in random_boxes(rng, 4, room).astype(np.float32).astype(np.float64):
            lost = dropped(outlines, light, box[None])
            met = np.array([rays_meet(light, p, box).any() for p in points])
            assert lost[met].all()
            pyramids = np.concatenate([np.broadcast_to(light, (n, 1, 3)), corners], axis=1)
            clear = ~met
            clear[clear] = [separated(pyramid, corners_of_boxes(box[None])[0]) for pyramid in pyramids[clear]]
            assert not lost[clear].any()
            seen["met"] += int(met.sum())
            seen["separated"] += int(clear.sum())

    check()
    assert min(seen.values()) > 60, seen


@pytest.mark.parametrize("lights", [1, 15, 16, 40])
def test_modes_of_the_lights_concerned_are_dropped_and_no_others(lights: int):
    """A square over a floor, lit from above and from below by turns: it only ever is between it and the former."""
    word = word_type(lights)
    floor = np.array([[[-1, -1, 0], [1, -1, 0], [0, 1, 0]], [[9, 9, 0], [9.5, 9, 0], [9, 9.5, 0]]], np.float32)
    box = np.array([[-0.1, -0.1, 2.0, 0.1, 0.1, 2.1]], np.float32)
    places = np.array([[0, 0, 5.0 if i % 2 else -5.0] for i in range(lights)], np.float32)
    culled = min(lights, 31)
    for mode in (FULL_SHADOW, NON_SHADOW):
        for occlusion in (INIT, PARTIALLY_OCCLUDED, FULLY_RENDERED, DYNAMIC):
            words = np.full(2, occlusion | sum(BOTH << 2 + 2 * i for i in range(culled)), word)
            before = words.copy()
            drop_dependent(words, outlines_of(floor), places, box, mode, 1)
            expected = int(before[0]) & ~sum(mode << 2 + 2 * i for i in range(1, culled, 2))
            if occlusion == FULLY_RENDERED and culled > 1:
                expected &= ~3
            assert words[0] == (before[0] if occlusion == DYNAMIC else expected)
            assert words[1] == before[1]


def test_every_thread_count_drops_the_same_and_several_boxes_what_each_does():
    rng = np.random.default_rng(3)
    corners = rng.uniform(-1, 1, (20000, 1, 3)) + rng.normal(size=(20000, 3, 3)) * 0.1
    lights, boxes = rng.normal(size=(3, 3)).astype(np.float32), random_boxes(rng, 4, 0.5).astype(np.float32)
    given = rng.integers(0, 2**8, 20000).astype(np.uint32)
    results = []
    for threads in (1, 2, 4):
        words = given.copy()
        drop_dependent(words, outlines_of(corners), lights, boxes, NON_SHADOW, threads)
        results.append(words)
    one_by_one = given.copy()
    for box in boxes:
        drop_dependent(one_by_one, outlines_of(corners), lights, box[None], NON_SHADOW, 1)
    assert all(np.array_equal(words, one_by_one) for words in results)
    changed = (one_by_one != given).mean()
    assert 0.05 < changed < 0.9
