"""Waves: every pixel once, and sorting that loses no ray, sorts, and does not look past a wave's end."""

from __future__ import annotations

import numpy as np
import pytest

from tracer.geometry.camera import pinhole
from tracer.runtime.kernels import kernel
from tracer.scene.model import Camera
from tracer.shading import direction_sort
from tracer.shading.blocks import all_blocks
from tracer.shading.direction_sort import sorted_by_direction
from tracer.shading.primary import primary_wave
from tracer.shading.spatial_sort import CELLS, FEWEST, sorted_by_position
from tracer.shading.wave import DIRECTION, HIT_ROWS, HIT_T, ORIGIN, PIXEL, RAY_ROWS, WAVE_ROWS, wave_in


@kernel
def _by_position(memory, n, spare):
    wave, left = sorted_by_position(wave_in(memory, n), spare)
    return wave.memory, left


@kernel
def _by_direction(memory, n, target):
    return sorted_by_direction(memory, n, target)


@kernel
def _primary(camera, tile, width, lanes, memory, place):
    return primary_wave(camera, tile, width, lanes, memory, place).size


def _wave(rng: np.random.Generator, n: int, rest: float) -> np.ndarray:
    """Rows of n rays far from the world's origin, with `rest` in the lanes past them."""
    memory = np.full((WAVE_ROWS, n // 16 * 16 + 32), rest, np.float32)
    memory[:HIT_ROWS, :n] = rng.uniform(-1, 1, (HIT_ROWS, n))
    memory[ORIGIN:DIRECTION, :n] += 50
    memory[HIT_T, :n] = rng.uniform(0, 2, n)
    memory[PIXEL].view(np.int32)[:n] = rng.permutation(n)
    return memory


def _columns(memory: np.ndarray, rows: int, n: int) -> np.ndarray:
    """Rays as bits (n, rows), sorted by pixel."""
    columns = memory[:rows, :n].view(np.int32).T
    return columns[np.argsort(columns[:, PIXEL])]


def _cells(memory: np.ndarray, n: int) -> np.ndarray:
    """Where points are along a Z curve through the box around them, told anew."""
    points = memory[ORIGIN:DIRECTION, :n] + memory[HIT_T, :n] * memory[DIRECTION : DIRECTION + 3, :n]
    return _along_a_z_curve(points, CELLS)


def _along_a_z_curve(points: np.ndarray, count: int) -> np.ndarray:
    """Where points (3, n) are along a curve through the box around them, with so many cells along each axis."""
    low, high = points.min(axis=1, keepdims=True), points.max(axis=1, keepdims=True)
    cells = np.minimum((points - low) * (np.float32(count) / (high - low)), count - 1).astype(np.int64)
    return sum(((cells[axis] >> bit) & 1) << (3 * bit + axis) for axis in range(3) for bit in range(4))


@pytest.mark.parametrize("n", [FEWEST + 1, 1600])
def test_points_are_sorted_by_position_whatever_lies_past_them(n: int):
    orders = []
    for rest in (0.0, np.nan, 3e38):
        memory = _wave(np.random.default_rng(3), n, rest)
        before, keys = memory.copy(), _cells(memory, n)
        sorted_memory, left = _by_position(memory, n, np.full_like(memory, np.nan))
        assert np.array_equal(_columns(sorted_memory, HIT_ROWS, n), _columns(before, HIT_ROWS, n))
        assert np.array_equal(_cells(sorted_memory, n), np.sort(keys)) and len(np.unique(keys)) > 50
        assert np.array_equal(left, before, equal_nan=True)
        orders.append(sorted_memory[PIXEL, :n].view(np.int32).tolist())
    assert orders[0] == orders[1] == orders[2]
    assert orders[0] == before[PIXEL, :n].view(np.int32)[np.argsort(keys, kind="stable")].tolist()


def test_a_small_wave_is_left_as_it_is():
    memory = _wave(np.random.default_rng(4), FEWEST, 0.0)
    before = memory.copy()
    same, _ = _by_position(memory, FEWEST, np.zeros_like(memory))
    assert np.array_equal(same, before)


@pytest.mark.parametrize(("n", "rest"), [(1, np.nan), (15, 3e38), (16, -1.0), (17, np.nan), (700, 3e38)])
def test_rays_are_sorted_by_direction_and_origin_whatever_lies_past_them(n: int, rest: float):
    memory = _wave(np.random.default_rng(5), n, rest)
    target = np.full_like(memory, np.nan)
    octants = (memory[DIRECTION : DIRECTION + 3, :n] < 0).T @ [1, 2, 4]
    assert _by_direction(memory, n, target) == (len(np.unique(octants)) > 1)
    if n > 1:
        cells = _along_a_z_curve(memory[ORIGIN:DIRECTION, :n], direction_sort.CELLS)
        assert n < 700 or len(np.unique(cells)) == direction_sort.CELLS**3
        order = np.lexsort([cells, octants])  # which leaves equal ones in their order
        assert np.array_equal(target[:RAY_ROWS, :n].view(np.int32), memory[:RAY_ROWS, order].view(np.int32))


@pytest.mark.parametrize("n", [5, 200])
def test_rays_of_one_octant_are_left_as_they_are(n: int):
    memory = _wave(np.random.default_rng(6), n, -1.0)
    memory[DIRECTION : DIRECTION + 3, :n] = np.abs(memory[DIRECTION : DIRECTION + 3, :n])
    assert not _by_direction(memory, n, np.zeros_like(memory))
    memory[DIRECTION, n - 1] *= -1
    assert _by_direction(memory, n, np.zeros_like(memory))


def test_rays_from_one_point_and_from_no_point_are_sorted_by_direction():
    """A box that has no size, and one that has no numbers, has one cell."""
    for origin in (3.0, np.nan, np.inf):
        memory = _wave(np.random.default_rng(7), 300, 0.0)
        memory[ORIGIN:DIRECTION, :300] = origin
        target = np.full_like(memory, np.nan)
        assert _by_direction(memory, 300, target)
        order = np.argsort((memory[DIRECTION : DIRECTION + 3, :300] < 0).T @ [1, 2, 4], kind="stable")
        assert np.array_equal(target[:RAY_ROWS, :300].view(np.int32), memory[:RAY_ROWS, order].view(np.int32))


@pytest.mark.parametrize("tile", [(0, 0, 64, 64), (64, 0, 65, 3), (0, 64, 37, 65), (5, 6, 22, 70)])
def test_a_tile_has_each_of_its_pixels_once(tile: tuple[int, int, int, int]):
    width, height = 70, 70
    left, top, right, bottom = tile
    camera = pinhole(Camera((0.0, 0.0, 5.0), (0.1, 0.2, -1.0)), width, height)
    memory, place = np.zeros((WAVE_ROWS, 4112), np.float32), np.zeros(4112, np.int32)
    n = _primary(camera, tile, width, all_blocks(width, height), memory, place)
    y, x = np.divmod(place[:n], width)
    assert sorted(zip(x.tolist(), y.tolist())) == [(i, j) for i in range(left, right) for j in range(top, bottom)]
    directions = camera.corner + x[:, None] * camera.column + y[:, None] * camera.row
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    np.testing.assert_allclose(memory[DIRECTION : DIRECTION + 3, :n].T, directions, atol=1e-6)
    assert memory[PIXEL, :n].view(np.int32).tolist() == list(range(n))
    if tile == (0, 0, 64, 64):  # a vector is a block of 4 x 4, a packet one of 16 x 8
        for size, (across, down) in ((16, (4, 4)), (128, (16, 8))):
            for start in range(0, n, size):
                assert np.ptp(x[start : start + size]) == across - 1 and np.ptp(y[start : start + size]) == down - 1


def test_of_a_tile_those_of_its_pixels_that_are_asked_for():
    size, camera = 70, pinhole(Camera((0.0, 0.0, 5.0), (0.1, 0.2, -1.0)), 70, 70)
    lanes, place = all_blocks(size, size), np.zeros(4112, np.int32)
    lanes[::2] = 1 << 6  # column 2 of row 1; one row of an edge's blocks comes before the picture's first
    n = _primary(camera, (0, 0, 64, 64), size, lanes, np.zeros((WAVE_ROWS, 4112), np.float32), place)
    y, x = np.divmod(np.arange(size * size), size)
    chosen = ((y // 4 % 2 == 0) | ((x % 4 == 2) & (y % 4 == 1))) & (x < 64) & (y < 64)
    assert sorted(place[:n]) == np.flatnonzero(chosen).tolist()
