"""Slices through space: what each pixel sees of them, by a ray at a time; and slices as words."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from tests.viewer.drawn import values_in, words_in
from tests.viewer.fakes import make_frame, with_voxels
from tracer.frame import Frame, Settings
from tracer.geometry.camera import pinhole
from viewer.state.draw_options import MIDDLE, Slice
from viewer.state.views import View
from viewer.views import voxels
from viewer.views.voxels import voxels_of, voxels_seen

CUTS = [Slice(0, 0.0), Slice(0, 0.2), Slice(1, 0.3), Slice(1, 0.9), Slice(2, 0.5), Slice(2, 1.0)]


@pytest.fixture(scope="module")
def seen() -> Frame:
    """What is seen lies at different distances, so that some of it is before the slice."""
    plain = with_voxels(make_frame(Settings(width=32, height=24)))
    depth = np.where(np.indices(plain.depth.shape)[1] % 5 == 0, np.float32(1.5), np.float32(30.0))
    return replace(plain, depth=depth)


def _met(frame: Frame, axis: int, place: float, x: int, y: int) -> tuple[np.ndarray, float]:
    """Where the ray of a pixel meets the plane across an axis, NaN for nowhere, and how far away: float64."""
    rays = pinhole(frame.camera, frame.width, frame.height)
    way = np.array([float(rays.corner[k]) + x * float(rays.column[k]) + y * float(rays.row[k]) for k in range(3)])
    origin = np.array(frame.camera.position)
    t = (place - origin[axis]) / way[axis]
    return (origin + t * way if t > 0.0 else np.full(3, np.nan)), t * math.hypot(*way)


def _from_borders(cells: np.ndarray, axis: int) -> float:
    """How far a point, in units of cells, is from the nearest border of a cell across another axis."""
    return float(min(abs(c - round(c)) for k, c in enumerate(cells) if k != axis)) if np.isfinite(cells).all() else 1.0


@pytest.mark.parametrize("cut", CUTS)
def test_each_pixel_sees_the_voxel_that_its_ray_meets(seen: Frame, cut: Slice) -> None:
    states, (numbers, lines), found = voxels_of(seen), voxels_seen(seen, cut), 0
    grid, sides = states.grid, states.shape
    for y in range(seen.height):
        for x in range(seen.width):
            point, distance = _met(seen, cut.axis, voxels.plane_of(states, cut), x, y)
            along = (point - (grid.x, grid.y, grid.z)) * grid.per_unit
            if min(_from_borders(along, cut.axis), abs(distance - seen.depth[y, x]) * grid.per_unit) < 1e-3:
                continue
            index = tuple(np.floor(along).astype(int)) if np.isfinite(along).all() else (-1,) * 3
            there = distance < seen.depth[y, x] and all(0 <= i < n for i, n in zip(index, sides, strict=True))
            index = tuple(cut.layer(sides[k]) if k == cut.axis else i for k, i in enumerate(index))
            assert numbers[y, x] == (np.ravel_multi_index(index, sides) if there else -1), (x, y)
            said = "{}, {}, {}".format(*index) if there else "-"
            assert words_in(seen, View.VOXELS, 1, x, y, slice=cut)[0] == said
            found += there
    assert found or cut.at in (0.0, 1.0)
    for y, x in np.argwhere(lines[:-1, :-1]):
        assert numbers[y, x] != numbers[y, x + 1] or numbers[y, x] != numbers[y + 1, x]
    modes = values_in(seen, View.VOXELS, 1, slice=cut).numbers[..., 0]
    assert (modes[numbers >= 0] == states.words[numbers[numbers >= 0]] >> np.uint32(4) & 3).all()
    assert (values_in(seen, View.VOXELS, 2, slice=cut).numbers[numbers >= 0] == 0).all(), "a light without states"


def test_the_largest_block_of_one_state_is_found(seen: Frame) -> None:
    states = voxels_of(seen)
    words = np.zeros_like(states.words)
    grid = np.zeros(states.shape, np.uint32)
    grid[8:12, 4:8, 0:4] = 1
    grid[0, 0, 0] = 2
    words[:-1] = grid.reshape(-1) << np.uint32(2)
    made = replace(states, words=words)
    levels = {(9, 5, 1): 4, (0, 0, 0): 1, (1, 1, 1): 1, (2, 2, 2): 2, (6, 6, 6): 4, (13, 1, 6): 4}
    for index, level in levels.items():
        assert made.level(0, index) == level, index
    assert made.counts(0) == (16 * 64 - 65, 64, 1)


def test_slices_as_words_and_by_layers() -> None:
    for cut in (*CUTS, MIDDLE, Slice(1, 1 / 3)):
        assert Slice.parse(str(cut)) == cut
    assert Slice.parse("z") == Slice(2, MIDDLE.at)
    for wrong in ("w:0.5", "x:2", "x:1.5", "x:-0.1", "x:", ":0.5"):
        with pytest.raises(ValueError, match="is not a slice"):
            Slice.parse(wrong)
    layers = [MIDDLE.in_layer(number, 8).layer(8) for number in (-1, 0, 3, 7, 8)]
    assert layers == [0, 0, 3, 7, 7]
