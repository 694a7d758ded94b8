"""A slice through a tree: what each pixel sees of it, by a ray at a time, through everything."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from tests.viewer.drawn import values_in, words_in
from tests.viewer.fakes import CubesBuilt, make_frame, with_tree
from tracer.frame import Frame, Settings
from tracer.geometry.camera import pinhole
from viewer.state.draw_options import Slice
from viewer.state.missing import missing
from viewer.state.readings import can_draw
from viewer.state.views import View
from viewer.views.slices import (
    BORDER,
    HIDDEN,
    LEVEL,
    LINE,
    NO_PART,
    WAITS,
    PartSeen,
    part_words,
    place_of,
    share_built,
    tree_codes,
    tree_seen,
)
from viewer.views.tree import tree_of

CUTS = [Slice(0, 0.3), Slice(1, 0.1), Slice(1, 0.9), Slice(2, 0.45)]


@pytest.fixture(scope="module")
def frame() -> Frame:
    """What is seen lies at different distances, so that some of it is before the slice."""
    plain = with_tree(make_frame(Settings(width=64, height=48)))
    depth = np.where(np.indices(plain.depth.shape)[1] % 5 == 0, np.float32(1.5), np.float32(30.0))
    return replace(plain, depth=depth)


def _met(frame: Frame, cut: Slice, x: int, y: int) -> tuple[np.ndarray, float, float]:
    """Where the ray of a pixel meets the slice, NaN for nowhere, how far away, and how far that is from a border of
    anything: float64."""
    tree, rays = tree_of(frame), pinhole(frame.camera, frame.width, frame.height)
    way = np.array([float(rays.corner[k]) + x * float(rays.column[k]) + y * float(rays.row[k]) for k in range(3)])
    origin = np.array(frame.camera.position)
    t = (place_of(tree, cut) - origin[cut.axis]) / way[cut.axis]
    point, distance = origin + t * way, t * math.hypot(*way)
    sure = min(abs(4.0 * c - round(4.0 * c)) for k, c in enumerate(point) if k != cut.axis)
    return (point if t > 0.0 else np.full(3, np.nan)), distance, min(sure, abs(distance - float(frame.depth[y, x])))


@pytest.mark.parametrize("cut", CUTS)
def test_each_pixel_sees_the_part_that_its_ray_meets_whatever_lies_before(frame: Frame, cut: Slice) -> None:
    tree, codes = tree_of(frame), tree_codes(frame, tree_of(frame), cut)
    seen, kinds = tree_seen(frame, tree, cut), set()
    for y in range(frame.height):
        for x in range(y % 2, frame.width, 2):
            point, distance, sure = _met(frame, cut, x, y)
            if sure < 1e-3:
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
    assert (tree_codes(frame, gone, CUTS[0]) == NO_PART).all() and share_built(gone, CUTS[0]) is None
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
