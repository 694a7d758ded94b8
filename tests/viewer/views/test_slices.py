"""Slices through space: which voxel each pixel sees, by a ray at a time; and slices as words."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from tests.viewer.drawn import words_in
from tests.viewer.fakes import make_frame, with_voxels
from tracer.frame import Frame, Settings
from tracer.geometry.camera import pinhole
from viewer.state.draw_options import MIDDLE, Slice
from viewer.state.views import View
from viewer.views.slices import NO_VOXEL, VOXEL_LINE, middle_of, slice_codes, slice_seen, voxel_seen
from viewer.views.voxels import voxels_of

CUTS = [Slice(0, 0.0), Slice(0, 0.2), Slice(1, 0.3), Slice(1, 0.9), Slice(2, 0.5), Slice(2, 1.0)]


@pytest.fixture(scope="module")
def frame() -> Frame:
    """What is seen lies at different distances, so that some of it hides the slice."""
    plain = with_voxels(make_frame(Settings(width=48, height=32)))
    depth = np.where(np.indices(plain.depth.shape)[1] % 5 == 0, np.float32(1.5), np.float32(30.0))
    return replace(plain, depth=depth)


def _voxel(frame: Frame, cut: Slice, x: int, y: int) -> tuple[int, float]:
    """The number of the voxel that a pixel sees, -1 for none, and how far from a border of anything that is, in voxels:
    float64, one ray at a time."""
    grid, rays = voxels_of(frame).grid, pinhole(frame.camera, frame.width, frame.height)
    way = np.array([float(rays.corner[k]) + x * float(rays.column[k]) + y * float(rays.row[k]) for k in range(3)])
    origin = np.array(frame.camera.position)
    t = (middle_of(grid, cut) - origin[cut.axis]) / way[cut.axis]
    along = (origin + t * way - (grid.x, grid.y, grid.z)) * grid.per_unit
    sure = min(abs(a - round(a)) for k, a in enumerate(along) if k != cut.axis)
    distance = t * math.hypot(*way)
    sure = min(sure, abs(distance - float(frame.depth[y, x])) * grid.per_unit)
    index = np.floor(along).astype(int)
    index[cut.axis] = min(int(cut.at * (16, 8, 8)[cut.axis]), (15, 7, 7)[cut.axis])
    inside = all(0 <= i < n for i, n in zip(index, (16, 8, 8)))
    if t <= 0.0 or distance >= frame.depth[y, x] or not inside:
        return -1, sure
    return int((index[0] * 8 + index[1]) * 8 + index[2]), sure


@pytest.mark.parametrize("cut", CUTS)
def test_each_pixel_sees_the_voxel_that_its_ray_meets(frame: Frame, cut: Slice) -> None:
    seen, met = slice_seen(frame, voxels_of(frame).grid, cut).numbers, 0
    for y in range(frame.height):
        for x in range(frame.width):
            number, sure = _voxel(frame, cut, x, y)
            if sure > 1e-3:
                assert seen[y, x] == number, (x, y)
                met += number >= 0
    assert met or cut.at in (0.0, 1.0)


def test_codes_are_states_with_lines_where_voxels_end(frame: Frame) -> None:
    states, cut = voxels_of(frame), Slice(2, 0.5)
    numbers, codes = slice_seen(frame, states.grid, cut).numbers, slice_codes(frame, states, 1, cut)
    assert ((codes == NO_VOXEL) == (numbers < 0)).all()
    for y, x in np.argwhere(numbers[:-1, :-1] >= 0):
        found = voxel_seen(states, 1, int(numbers[y, x]))
        assert codes[y, x] & 3 == found.state == int(states.words[numbers[y, x]] >> 4) & 3
        assert words_in(frame, View.VOXELS, 1, int(x), int(y), slice=cut)[0] == "{}, {}, {}".format(*found.place)
        if not codes[y, x] & VOXEL_LINE:
            continue
        assert numbers[y, x] != numbers[y, x + 1] or numbers[y, x] != numbers[y + 1, x]
    assert ((codes != NO_VOXEL) & (codes & VOXEL_LINE != 0)).any() and (codes & (VOXEL_LINE | NO_VOXEL) == 0).any()


def test_a_light_that_has_no_states_is_unknown_everywhere(frame: Frame) -> None:
    codes = slice_codes(frame, voxels_of(frame), 2, Slice(2, 0.5))
    assert (codes[codes != NO_VOXEL] & 3 == 0).all() and words_in(frame, View.VOXELS, 0, 0, 0, slice=Slice(0, 0.0)) == (
        "-",
    )


def test_the_largest_block_of_one_state_is_found(frame: Frame) -> None:
    states = voxels_of(frame)
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


def test_slices_as_words_and_as_json() -> None:
    for cut in (*CUTS, MIDDLE, Slice(1, 1 / 3)):
        assert Slice.parse(str(cut)) == cut
    assert Slice.parse("z") == Slice(2, MIDDLE.at)
    for wrong in ("w:0.5", "x:2", "x:1.5", "x:-0.1", "x:", ":0.5"):
        with pytest.raises(ValueError, match="is not a slice"):
            Slice.parse(wrong)
