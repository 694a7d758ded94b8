"""Two pictures in one: their signed difference, where it is largest, and what is said of both."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.viewer.drawn import values_in
from tests.viewer.fakes import make_frame
from tracer.frame import Settings
from tracer.statistics import FrameStatistics, ShadowCounts, WrongCounts
from viewer.state.columns import NO_TIME, rows
from viewer.state.comparison import (
    LEAST_MARKED,
    MOST_SPOTS,
    Compare,
    CompareMode,
    Side,
    elided,
    named,
    sizes_in_words,
    with_rings,
    worst_spots,
)
from viewer.state.in_turn import LEAST, InTurn
from viewer.state.palette import LESS, MORE, SAME, WIPE_LINE, signed_map
from viewer.state.views import View
from viewer.views.compare import (
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

A, B = (np.full((4, 10, 3), level, np.uint8) for level in (10, 200))


def to_bytes(color):
    return np.round(np.multiply(255.0, color)).astype(np.uint8)


def test_zero_has_a_colour_of_its_own_and_both_sides_are_alike():
    drawn = signed_picture(np.array([[-9.0, -2.0, -1.0, 0.0, 1.0, 2.0, 1e30]], np.float32), 2.0)[0]
    assert [drawn[i].tolist() for i in (0, 1, 3, 5, 6)] == [
        to_bytes(c).tolist() for c in (LESS, LESS, SAME, MORE, MORE)
    ]
    middle = [
        np.abs(drawn[i].astype(int) - (to_bytes(c).astype(int) + to_bytes(SAME)) / 2) for i, c in ((2, LESS), (4, MORE))
    ]
    assert np.max(middle) <= 1.0
    assert np.array_equal(to_bytes(signed_map(3)), to_bytes([LESS, SAME, MORE]))


def test_a_composed_picture_shows_what_the_window_does():
    wiped = composed(A, B, CompareMode.WIPE, 0.3, shows_a=False)
    assert (wiped[:, :3] == 10).all() and (wiped[:, 4:] == 200).all() and (wiped[:, 3] == to_bytes(WIPE_LINE)).all()
    side = composed(A, B, CompareMode.SIDE, 0.3, shows_a=False)
    assert side.shape == (4, 20 + GAP, 3) and (side[:, :10] == 10).all() and (side[:, -10:] == 200).all()
    for way in (CompareMode.FLIP, CompareMode.BLINK, CompareMode.WIPE):
        assert (composed(A, B, way, 0.3, shows_a=True) == 10).all()
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
    b = replace(a, color=color)
    found = difference_of(values_in(a, View.COLOR), values_in(b, View.COLOR)).pixels
    assert found.shape == a.primitive.shape and found.dtype == np.float32
    assert found[1, 2] == pytest.approx(-0.3) and found[4, 5] == pytest.approx(0.4)
    assert np.count_nonzero(found) == 2
    summed = diff_stats(found)
    assert (summed.pixels, summed.of) == (2, found.size)
    assert (summed.least, summed.largest) == pytest.approx((-0.3, 0.4))
    assert summed.mean == pytest.approx(0.1 / found.size) and 0.3 < summed.limit <= 0.4


def test_modes_differ_or_do_not_and_what_hits_nothing_differs_without_end():
    a = make_frame()
    words = a.modes.copy()
    words[2] ^= words.dtype.type(3)  # another occlusion mode of one primitive
    b = replace(a, modes=words)
    found = difference_of(values_in(a, View.OCCLUSION), values_in(b, View.OCCLUSION)).pixels
    assert np.array_equal(found == 1.0, a.primitive == 2) and set(np.unique(found)) == {0.0, 1.0}
    gone = a.primitive == 1
    b = replace(a, primitive=np.where(gone, -1, a.primitive), depth=np.where(gone, np.inf, a.depth).astype(np.float32))
    found = difference_of(values_in(a, View.DEPTH), values_in(b, View.DEPTH)).pixels
    assert np.array_equal(found > 1e29, gone) and not found[~gone].any(), "both miss: no difference"
    summed = diff_stats(found)
    assert (summed.pixels, summed.largest, summed.limit) == (gone.sum(), 0.0, 1.0)


def test_a_difference_is_put_into_words():
    depths, modes = (values_in(make_frame(), view) for view in (View.DEPTH, View.OCCLUSION))
    difference = np.array([[0.0, 0.25, -1.5, 1e30, -1e30]], np.float32)
    found = Difference(difference, depths, diff_stats(difference), ())
    said = [found.words(x, 0) for x in range(5)]
    assert said == [("0",), ("+0.25",), ("-1.5",), ("miss", "in B"), ("miss", "in A")]
    assert [replace(found, values=modes).words(x, 0) for x in (0, 1)] == [("same",), ("other",)]


def test_the_legend_of_a_difference():
    def told(difference, view=View.COLOR, limit=0.5):
        values = values_in(make_frame(), view)
        return difference_legend(Difference(difference, values, diff_stats(difference), ()), limit)

    none = told(np.zeros((8, 16), np.float32))
    assert none.notes[0].kind is NoteKind.GOOD and "bit for bit" in none.notes[0].text
    difference = np.zeros((8, 16), np.float32)
    difference[0, :4] = 0.5, -0.25, 0.5, 0.125
    legend = told(difference)
    assert (legend.scale.low, legend.scale.high, legend.scale.signed) == ("-0.5", "+0.5", True)
    assert {fact.name: fact.values[0] for fact in legend.facts} == {
        "pixels that differ": "4 (3.1 %)", "least and largest": "-0.25   +0.5", "mean": "+0.006836",
    }  # fmt: skip
    assert [entry.color for entry in told(difference, View.OCCLUSION).entries] == [MORE, SAME]


def side(frame, view=View.COLOR, light=0, scene="study", number=3) -> Side:
    return Side(frame, view, light, scene, number)


def test_sizes_that_differ_are_told_and_the_nearest_pixel_counts():
    a, b = make_frame(Settings(width=16, height=8)), make_frame(Settings(width=32, height=16))
    assert sizes_in_words(a, a) == ""
    more = make_frame(replace(a.settings, samples=16))
    assert sizes_in_words(a, more).startswith("A has 1 sample a pixel, B 16: edges differ by that.")
    assert sizes_in_words(a, b) == "A has 16 x 8 pixels, B 32 x 16: A is shown in B's size."
    assert sizes_in_words(make_frame(Settings(width=16, height=16)), b).endswith("size, stretched.")


def test_each_is_called_by_its_method_and_what_sets_it_apart():
    a = side(make_frame(Settings(width=16, height=8, method="none")))
    b = side(make_frame(Settings(width=16, height=8, method="paper")))
    assert (named(a, b), named(b, a), named(a, None)) == ("none", "paper", "none")
    later = side(make_frame(Settings(width=16, height=8, method="none"), time=2.0), number=7)
    assert (named(a, later), named(later, a)) == ("none, frame 3", "none, frame 7")
    shadow = replace(b, view=View.SHADOW, light=2)
    assert named(shadow, b) == "paper, shadow mode, light 2" and named(b, shadow) == "paper, colour"
    assert named(replace(a, scene="hall"), b) == "none, hall, frame 3"
    deep = side(make_frame(Settings(width=16, height=8, method="paper", depth=1)))
    assert named(deep, b) == "paper, depth 1"


def test_it_is_in_turn_that_pictures_blink():
    state = Compare(on=True, mode=CompareMode.BLINK, rate=2.0)
    assert [state.shows_a(seconds) for seconds in (0.0, 0.26, 0.51, 0.76)] == [False, True, False, True]
    assert not replace(state, mode=CompareMode.FLIP).shows_a(0.26)


def test_columns_have_differences_and_shares():
    a, b = make_frame(), make_frame()
    a = replace(a, statistics=FrameStatistics(shadow=ShadowCounts(due=1000, rays=1000)))
    b = replace(b, statistics=FrameStatistics(shadow=ShadowCounts(due=1000, culled=250, rays=750)))
    found = {row.name: row for row in rows(a, b)}
    culled, traced = found["Culled"], found["Traced"]
    assert (culled.difference, culled.share, culled.written_share) == (250, None, "-")
    assert culled.written(culled.difference, signed=True) == "+250"
    assert (traced.difference, traced.written_share) == (-250, "-25.0 %")
    assert found["Due"].written_share == "0 %"
    assert "Wrong answers" not in found and "Certificates made" not in found, "what neither has is left out"
    verified = replace(b, statistics=replace(b.statistics, wrong=WrongCounts(answers=3, due=1000, pixels=2)))
    wrong = {row.name: row for row in rows(a, verified)}["Wrong answers"]
    assert (wrong.written(wrong.a), wrong.written(wrong.b), wrong.written_share) == ("-", "3", "-")


def test_times_are_those_of_many_frames_in_turn_or_none():
    def took(seconds: float) -> FrameStatistics:
        return FrameStatistics(seconds=seconds, phases={"shading": seconds / 2.0})

    a, b = (replace(make_frame(Settings(method=method)), statistics=took(9.0)) for method in ("none", "paper"))
    rounds = tuple((took(0.2 + 0.001 * i), took(0.1)) for i in range(LEAST))
    timed = InTurn(("none", "paper"), rounds, prepares=False)
    found = {row.name: row for row in rows(a, b, timed)}
    frame, shading = found["Frame"], found["  shading"]
    assert (frame.written(frame.a), frame.written(frame.b), shading.written(shading.b)) == (
        "203.5 ms", "100.0 ms", "50.0 ms",
    )  # fmt: skip
    assert "2.0" in frame.tip
    other = replace(b, settings=Settings(method="certified"))
    for kept in (rows(a, b), rows(a, b, replace(timed, rounds=rounds[1:])), rows(a, other, timed)):
        frame = next(row for row in kept if row.name == "Frame")
        assert (frame.a, frame.b) == (None, None) and frame.tip == NO_TIME


def test_columns_say_what_is_shaded_so_far():
    a, b = make_frame(), make_frame()
    b.statistics.part = 0.25
    first = rows(a, b)[0]
    assert (first.name, first.a, first.b) == ("Shaded pixels", 128, 32)


@pytest.mark.parametrize(
    ("name", "other", "room", "shown"),
    [
        ("paper", "certified", 9, "paper"),
        ("certified+cache, frame 3", "certified+cache, frame 12", 24, "certified+cache, frame 3"),
        ("certified+cache, frame 3", "certified+cache, frame 12", 16, "certified+ca...3"),
        ("certified+cache, frame 3", "certified+cache, frame 12", 6, "ce...3"),
        ("certified+cache", "certified+rest", 10, "ce...cache"),
        ("certified+cache", "certified", 8, "certi..."),
        ("certified+cache, depth 10", "certified+cache, depth 2", 5, "...10"),
        ("certified, frame 3", "certified, depth 3, frame 3", 12, "ce...frame 3"),
        ("certified", "certified", 6, "cer..."),
        ("certified", "paper", 6, "cer..."),
    ],
)
def test_of_two_names_in_little_room_what_differs_is_seen(name: str, other: str, room: int, shown: str) -> None:
    found = elided(name, other, lambda text: len(text) <= room)
    assert found == shown and len(found) <= room


def test_the_worst_come_first_and_none_beside_another():
    difference = np.random.default_rng(3).normal(0.0, 0.01, (60, 90)).astype(np.float32)
    difference[10, 20], difference[11, 21], difference[40, 70] = -2.0, 1.9, 1.0
    difference[5, 80] = 1e30
    assert worst_spots(difference) == ((20, 10), (70, 40)), "what only one picture hits is told without rings"
    assert difference[10, 20] == -2.0, "the difference stays"
    difference[50, 10] = 2.0 * LEAST_MARKED - 0.01
    assert len(worst_spots(difference)) == 2
    assert worst_spots(np.zeros((4, 4), np.float32)) == worst_spots(np.zeros((0, 0), np.float32)) == ()
    assert len(worst_spots(np.random.default_rng(1).normal(size=(99, 99)).astype(np.float32))) == MOST_SPOTS


def test_modes_that_differ_are_marked_where_they_are_few():
    difference = np.zeros((80, 80), np.float32)
    difference[10:12, 10:12] = difference[60, 5] = 1.0
    assert set(worst_spots(difference, classes=True)) == {(10, 10), (5, 60)}
    difference[::9, ::9] = 1.0
    assert worst_spots(difference, classes=True) == ()


def test_rings_leave_what_they_mark():
    picture = np.full((120, 160, 3), 90, np.uint8)
    drawn = with_rings(picture, ((50, 40), (0, 119)))
    changed = (drawn != picture).any(axis=-1)
    assert changed.any() and not changed[39:42, 49:52].any() and not changed[119, 0]
    assert (drawn == 255).any() and (drawn == 0).any() and (picture == 90).all()
    rows, columns = np.nonzero(changed[:100])
    assert np.hypot(rows - 40, columns - 50).max() < 8
    assert with_rings(picture, ()) is picture
