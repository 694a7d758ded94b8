"""Two pictures in one: their signed difference, in numbers, colours and words, and both beside each other."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.viewer.drawn import values_in
from tests.viewer.fakes import make_frame
from tracer.culling.fate import Fate
from tracer.frame import Settings
from viewer.state import palette
from viewer.state.comparison import CompareMode
from viewer.state.palette import LESS, MORE, SAME, WIPE_LINE, signed_map
from viewer.state.views import View
from viewer.views.compare import (
    ENDLESS,
    GAP,
    Difference,
    composed,
    diff_stats,
    difference_legend,
    difference_of,
    fitted,
    signed_picture,
)
from viewer.views.legend import NoteKind
from viewer.views.paint import in_bytes

A, B = (np.full((4, 10, 3), level, np.uint8) for level in (10, 200))


def difference_in(view: View, pixels: object) -> Difference:
    found = np.asarray(pixels, np.float32)
    return Difference(found, values_in(make_frame(), view), diff_stats(found))


def test_zero_has_a_colour_of_its_own_and_both_sides_are_alike():
    found = difference_in(View.DEPTH, [[-9.0, -2.0, -1.0, 0.0, 1.0, 2.0, 1e30]])
    drawn = signed_picture(found, 2.0, ringed=False)[0]
    assert [drawn[i].tolist() for i in (0, 1, 3, 5, 6)] == in_bytes(np.array([LESS, LESS, SAME, MORE, MORE])).tolist()
    middle = in_bytes((np.array([LESS, MORE]) + SAME) / 2.0)
    assert np.abs(drawn[[2, 4]].astype(int) - middle).max() <= 1
    assert np.array_equal(in_bytes(signed_map(3)), in_bytes(np.array([LESS, SAME, MORE])))
    assert not {LESS, MORE} & {one.color for one in (*palette.OCCLUSION.values(), *palette.FATES.values())}
    assert palette.CERTIFICATES[palette.Certificate.CANDIDATES].color == palette.FATES[Fate.CANDIDATES].color


def test_rings_are_around_what_differs_and_cover_none_of_it():
    pixels = np.zeros((120, 160))
    pixels[40, 50] = pixels[119, 0] = 1.0
    found = difference_in(View.COLOR, pixels)
    plain, ringed = (signed_picture(found, 1.0, one) for one in (False, True))
    changed = (plain != ringed).any(axis=-1)
    rows, columns = np.nonzero(changed[:100])
    assert len(rows) and np.hypot(rows - 40, columns - 50).max() < 8
    assert not changed[39:42, 49:52].any() and not changed[119, 0] and changed[110:].any()


def test_a_composed_picture_shows_what_the_window_does():
    wiped = composed(A, B, CompareMode.WIPE, 0.3, shows_a=False)
    assert (wiped[:, :3] == 10).all() and (wiped[:, 4:] == 200).all() and (wiped[:, 3] == in_bytes(WIPE_LINE)).all()
    side = composed(A, B, CompareMode.SIDE, 0.3, shows_a=False)
    assert side.shape == (4, 20 + GAP, 3) and (side[:, :10] == 10).all() and (side[:, -10:] == 200).all()
    for mode in (CompareMode.FLIP, CompareMode.WIPE):
        assert (composed(A, B, mode, 0.3, shows_a=True) == 10).all()
    assert (composed(A, B, CompareMode.FLIP, 0.3, shows_a=False) == 200).all()
    assert composed(A[:2, :5], B, CompareMode.FLIP, 0.3, shows_a=True).shape == B.shape


def test_a_picture_of_another_size_gives_its_nearest_pixels():
    numbers = np.arange(6).reshape(2, 3)
    assert fitted(numbers, (6, 4)).tolist() == np.repeat(np.repeat(numbers, 2, 0), 2, 1).tolist()
    assert fitted(numbers, (1, 1)).tolist() == [[4]] and fitted(numbers, (3, 2)) is numbers
    a, b = make_frame(Settings(width=16, height=8)), make_frame(Settings(width=32, height=16))
    found = difference_of(values_in(a, View.PRIMITIVE), values_in(b, View.PRIMITIVE))
    assert found.pixels.shape == (16, 32) and not found.pixels.any()


def test_a_difference_has_the_sign_of_b_and_the_strongest_channel():
    a = make_frame()
    color = a.color.copy()
    color[1, 2] += (0.1, -0.3, 0.2)
    color[4, 5] += (0.4, 0.1, 0.0)
    found = difference_of(values_in(a, View.COLOR), values_in(replace(a, color=color), View.COLOR))
    pixels, stats = found.pixels, found.stats
    assert pixels.shape == a.primitive.shape and pixels.dtype == np.float32
    assert pixels[1, 2] == pytest.approx(-0.3) and pixels[4, 5] == pytest.approx(0.4)
    assert (np.count_nonzero(pixels), stats.pixels, stats.of) == (2, 2, pixels.size)
    assert (stats.least, stats.largest) == pytest.approx((-0.3, 0.4))
    assert stats.mean == pytest.approx(0.1 / pixels.size) and 0.3 < stats.limit <= 0.4


@pytest.mark.parametrize(
    ("a", "b", "sign"),
    [
        (np.nan, np.nan, 0), (np.inf, np.inf, 0), (0.5, np.nan, 1), (np.nan, 0.5, -1), (np.inf, -np.inf, -1),
        (0.5, np.inf, 1),
    ],
)  # fmt: skip
def test_what_is_no_number_differs_without_end_and_spoils_no_figure(a: float, b: float, sign: int):
    frames = [make_frame(), make_frame()]
    for frame, number in zip(frames, (a, b), strict=True):
        frame.color = frame.color.copy()
        frame.color[2, 3] = number
    found = difference_of(*(values_in(frame, View.COLOR) for frame in frames))
    assert np.sign(found.pixels[2, 3]) == sign and found.stats.pixels == abs(sign)
    assert not sign or abs(found.pixels[2, 3]) > ENDLESS
    assert (found.stats.largest, found.stats.mean, found.stats.limit) == (0.0, 0.0, 1.0)
    assert signed_picture(found, found.stats.limit, ringed=True).shape == (*found.pixels.shape, 3)
    assert found.words(3, 2) and difference_legend(found, 1.0).title and not found.differing.known.any()


def test_modes_differ_or_do_not_and_what_hits_nothing_differs_without_end():
    a = make_frame()
    words = a.modes.copy()
    words[2] ^= words.dtype.type(3)  # another occlusion mode of one primitive
    found = difference_of(values_in(a, View.OCCLUSION), values_in(replace(a, modes=words), View.OCCLUSION)).pixels
    assert np.array_equal(found == 1.0, a.primitive == 2) and set(np.unique(found)) == {0.0, 1.0}
    gone = a.primitive == 1
    b = replace(a, primitive=np.where(gone, -1, a.primitive), depth=np.where(gone, np.inf, a.depth).astype(np.float32))
    difference = difference_of(values_in(a, View.DEPTH), values_in(b, View.DEPTH))
    found, stats = difference.pixels, difference.stats
    assert np.array_equal(found > ENDLESS, gone) and not found[~gone].any(), "both miss: no difference"
    assert (stats.pixels, stats.largest, stats.limit) == (gone.sum(), 0.0, 1.0)


def test_a_difference_is_put_into_words():
    found = difference_in(View.DEPTH, [[0.0, 0.25, -1.5, 1e30, -1e30]])
    said = [found.words(x, 0) for x in range(5)]
    assert said == [("0",), ("+0.25",), ("-1.5",), ("no value", "in B"), ("no value", "in A")]
    modes = difference_in(View.OCCLUSION, [[0.0, 1.0]])
    assert [modes.words(x, 0) for x in (0, 1)] == [("same",), ("other",)]
    none = difference_legend(difference_in(View.COLOR, np.zeros((8, 16))), 0.5)
    assert none.notes[0].kind is NoteKind.GOOD and "bit for bit" in none.notes[0].text
    pixels = np.zeros((8, 16))
    pixels[0, :4] = 0.5, -0.25, 0.5, 0.125
    legend = difference_legend(difference_in(View.COLOR, pixels), 0.5)
    assert (legend.scale.low, legend.scale.high, legend.scale.signed) == ("-0.5", "+0.5", True)
    assert {fact.name: fact.values[0] for fact in legend.facts} == {
        "pixels that differ": "4 (3.1 %)", "least and largest": "-0.25   +0.5", "mean": "+0.006836",
    }  # fmt: skip
    entries = difference_legend(difference_in(View.OCCLUSION, pixels), 0.5).entries
    assert [entry.color for entry in entries] == [MORE, SAME]
