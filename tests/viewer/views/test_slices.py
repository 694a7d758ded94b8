"""Slices through space and through trees: what each pixel sees of them, by a ray at a time; and slices as words."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from tests.viewer.drawn import values_in, words_in
from tests.viewer.fakes import CubesBuilt, make_frame, with_tree, with_voxels
from tracer.frame import Frame, Settings
from tracer.geometry.camera import pinhole
from viewer.state.draw_options import MIDDLE, Slice
from viewer.state.methods import missing
from viewer.state.readings import can_draw
from viewer.state.views import View
from viewer.views.slices import (
    BORDER,
    HIDDEN,
    LEVEL,
    LINE,
    NO_PART,
    NO_VOXEL,
    VOXEL_LINE,
    WAITS,
    PartSeen,
    middle_of,
    part_words,
    place_of,
    share_built,
    slice_codes,
    slice_seen,
    tree_codes,
    tree_seen,
    voxel_seen,
)
from viewer.views.tree import tree_of
from viewer.views.voxels import voxels_of

CUTS = [Slice(0, 0.0), Slice(0, 0.2), Slice(1, 0.3), Slice(1, 0.9), Slice(2, 0.5), Slice(2, 1.0)]


TREE_CUTS = [Slice(0, 0.3), Slice(1, 0.1), Slice(1, 0.9), Slice(2, 0.45)]


@pytest.fixture(scope="module")
def frame() -> Frame:
    """What is seen lies at different distances, so that some of it is before the slice."""
    plain = with_tree(with_voxels(make_frame(Settings(width=64, height=48))))
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


def _voxel(frame: Frame, cut: Slice, x: int, y: int) -> tuple[int, float]:
    """The number of the voxel that a pixel sees, -1 for none, and how far from a border of anything that is, in
    voxels."""
    grid = voxels_of(frame).grid
    point, distance = _met(frame, cut.axis, middle_of(grid, cut), x, y)
    along = (point - (grid.x, grid.y, grid.z)) * grid.per_unit
    sure = min(_from_borders(along, cut.axis), abs(distance - float(frame.depth[y, x])) * grid.per_unit)
    if not np.isfinite(along).all() or distance >= frame.depth[y, x]:
        return -1, sure
    index = np.floor(along).astype(int)
    index[cut.axis] = min(int(cut.at * (16, 8, 8)[cut.axis]), (15, 7, 7)[cut.axis])
    inside = all(0 <= i < n for i, n in zip(index, (16, 8, 8)))
    return (int((index[0] * 8 + index[1]) * 8 + index[2]) if inside else -1), sure


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


@pytest.mark.parametrize("cut", TREE_CUTS)
def test_each_pixel_sees_the_part_that_its_ray_meets_whatever_lies_before(frame: Frame, cut: Slice) -> None:
    tree, codes = tree_of(frame), tree_codes(frame, tree_of(frame), cut)
    seen, kinds = tree_seen(frame, tree, cut), set()
    for y in range(frame.height):
        for x in range(y % 2, frame.width, 2):
            point, distance = _met(frame, cut.axis, place_of(tree, cut), x, y)
            if min(_from_borders(4.0 * point, cut.axis), abs(distance - frame.depth[y, x])) < 1e-3:
                continue
            i, k = np.floor(4.0 * point[[0, 2]]) if point[0] == point[0] else (0, 0)
            if not ((point >= tree.extent[:3]) & (point < tree.extent[3:])).all():
                assert codes[y, x] == NO_PART and words_in(frame, View.TREE, 0, x, y, slice=cut) == ("-",)
                continue
            expected = (6 if k >= 0 else 3) | (0 if i % 2 == 0 else WAITS) | HIDDEN * (distance > frame.depth[y, x])
            assert int(codes[y, x]) & ~(LINE | BORDER) == expected, (x, y)
            owned = ("object 3",) if i >= 4 else ()
            what = "leaf of 2 primitives" if i % 2 == 0 else "not built yet"
            assert words_in(frame, View.TREE, 0, x, y, slice=cut) == (what, f"level {expected & LEVEL}", *owned)
            wide = 0.25 / (distance * float(pinhole(frame.camera, frame.width, frame.height).spread))
            assert seen.wide[y, x] == pytest.approx(wide, rel=1e-3)
            kinds.add(int(codes[y, x]) & (WAITS | HIDDEN))
    assert kinds >= {0, WAITS} if cut.axis else len(kinds) >= 1
    values = values_in(frame, View.TREE, slice=cut)
    assert np.array_equal(values.known, codes != NO_PART)


def test_lines_are_where_parts_end_and_borders_where_objects_do() -> None:
    frame = with_tree(make_frame(Settings(width=240, height=180)))
    cut, tree = Slice(2, 0.45), tree_of(frame)
    codes, parts = tree_codes(frame, tree, cut), tree_seen(frame, tree, cut).parts
    found = {LINE: 0, BORDER: 0}
    for y, x in np.argwhere(codes[:-1, :-1] != NO_PART):
        here, others = parts.numbers[y, x], (parts.numbers[y, x + 1], parts.numbers[y + 1, x])
        owners = parts.owners[y, x + 1], parts.owners[y + 1, x]
        assert not codes[y, x] & LINE or any(other != here for other in others)
        assert not codes[y, x] & BORDER or any(owner != parts.owners[y, x] for owner in owners)
        for flag in found:
            found[flag] += bool(codes[y, x] & flag)
    assert found[LINE] > 10 and found[BORDER] > 5


def test_the_share_that_is_built_is_that_of_the_slice_whatever_is_seen_of_it(frame: Frame) -> None:
    tree = tree_of(frame)
    assert share_built(tree, Slice(1, 0.5)) == share_built(tree, Slice(2, 0.1)) == 0.5
    assert (share_built(tree, Slice(0, 0.01)), share_built(tree, Slice(0, 0.1))) == (1.0, 0.0)


def test_a_tree_that_is_gone_shows_nothing(frame: Frame) -> None:
    gone = CubesBuilt()
    gone.alive = False
    assert (tree_codes(frame, gone, TREE_CUTS[0]) == NO_PART).all() and share_built(gone, TREE_CUTS[0]) is None
    assert not can_draw(make_frame(), View.TREE) and can_draw(frame, View.TREE)
    left = replace(frame, structures={"tree": gone})
    assert not can_draw(left, View.TREE) and "freed with its world" in missing(View.TREE, left).text
    with pytest.raises(ValueError, match="freed with its world"):
        tree_of(left)
    with pytest.raises(ValueError, match="built before"):
        tree_of(make_frame())
    assert part_words(None, "object") == ("-",)
    assert part_words(PartSeen(3, True, 0, -1), "piece") == ("empty leaf", "level 3")
    assert part_words(PartSeen(3, True, -1, 7), "piece") == ("inner node", "level 3", "piece 7")
