"""Two pictures in numbers: their difference, what they are called, and their statistics in columns."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.viewer.fakes import make_frame, with_certificates
from tracer.frame import Settings
from tracer.statistics import FrameStatistics, ShadowCounts, WrongCounts
from viewer.state.columns import NO_TIME, rows
from viewer.state.comparison import (
    Comparison,
    Side,
    Way,
    apart,
    difference_words,
    elided,
    fitted,
    named,
    signed_difference,
    sizes_in_words,
)
from viewer.state.in_turn import LEAST, InTurn
from viewer.state.slices import MIDDLE
from viewer.state.values import values_of
from viewer.state.views import View


def side(frame, view=View.COLOR, light=0, scene="study", number=3) -> Side:
    return Side(frame, view, light, scene, number)


def test_a_difference_has_the_sign_of_b_and_the_strongest_channel():
    a = make_frame()
    color = a.color.copy()
    color[1, 2] += (0.1, -0.3, 0.2)
    color[4, 5] += (0.4, 0.1, 0.0)
    b = replace(a, color=color)
    found = signed_difference(values_of(a, View.COLOR, cut=MIDDLE), values_of(b, View.COLOR, cut=MIDDLE))
    assert found.shape == a.primitive.shape and found.dtype == np.float32
    assert found[1, 2] == pytest.approx(-0.3) and found[4, 5] == pytest.approx(0.4)
    assert np.count_nonzero(found) == 2
    summed = apart(found)
    assert (summed.pixels, summed.of) == (2, found.size)
    assert (summed.least, summed.largest) == pytest.approx((-0.3, 0.4))
    assert summed.mean == pytest.approx(0.1 / found.size) and 0.3 < summed.limit <= 0.4


def test_modes_differ_or_do_not_and_what_hits_nothing_differs_without_end():
    a = make_frame()
    words = a.modes.copy()
    words[2] ^= words.dtype.type(3)  # another occlusion mode of one primitive
    b = replace(a, modes=words)
    found = signed_difference(values_of(a, View.OCCLUSION, cut=MIDDLE), values_of(b, View.OCCLUSION, cut=MIDDLE))
    assert np.array_equal(found == 1.0, a.primitive == 2) and set(np.unique(found)) == {0.0, 1.0}
    gone = a.primitive == 1
    b = replace(a, primitive=np.where(gone, -1, a.primitive), depth=np.where(gone, np.inf, a.depth).astype(np.float32))
    found = signed_difference(values_of(a, View.DEPTH, cut=MIDDLE), values_of(b, View.DEPTH, cut=MIDDLE))
    assert np.array_equal(found > 1e29, gone) and not found[~gone].any(), "both miss: no difference"
    summed = apart(found)
    assert (summed.pixels, summed.largest, summed.limit) == (gone.sum(), 0.0, 1.0)


def test_sizes_that_differ_are_told_and_the_nearest_pixel_counts():
    a, b = make_frame(Settings(width=16, height=8)), make_frame(Settings(width=32, height=16))
    assert sizes_in_words(a, a) == ""
    more = make_frame(replace(a.settings, samples=16))
    assert sizes_in_words(a, more).startswith("A has 1 sample a pixel, B 16: edges differ by that.")
    assert sizes_in_words(a, b) == "A has 16 x 8 pixels, B 32 x 16: A is shown in B's size."
    assert sizes_in_words(make_frame(Settings(width=16, height=16)), b).endswith("size, stretched.")
    numbers = np.arange(6).reshape(2, 3)
    assert fitted(numbers, (6, 4)).tolist() == np.repeat(np.repeat(numbers, 2, 0), 2, 1).tolist()
    assert fitted(numbers, (1, 1)).tolist() == [[4]] and fitted(numbers, (3, 2)) is numbers
    found = signed_difference(values_of(a, View.PRIMITIVE, cut=MIDDLE), values_of(b, View.PRIMITIVE, cut=MIDDLE))
    assert found.shape == (16, 32) and not found.any()


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
    state = Comparison(on=True, way=Way.BLINK, rate=2.0)
    assert [state.shows_a(seconds) for seconds in (0.0, 0.26, 0.51, 0.76)] == [False, True, False, True]
    state.way = Way.FLIP
    assert not state.shows_a(0.26)
    state.held = True
    assert state.shows_a(0.0)


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


def test_certificates_and_work_are_compared_where_both_have_them():
    a = with_certificates(make_frame(Settings(width=160, height=80)))
    b = replace(a, certificates=a.certificates ^ a.certificates.dtype.type(1 << 4), cost=a.cost + 2)
    assert (signed_difference(values_of(a, View.COST, cut=MIDDLE), values_of(b, View.COST, cut=MIDDLE)) == 2.0).all()
    found = signed_difference(
        values_of(a, View.CERTIFICATE, 1, cut=MIDDLE), values_of(b, View.CERTIFICATE, 1, cut=MIDDLE)
    )
    assert (found == 1.0).all() and not signed_difference(
        *[values_of(f, View.CERTIFICATE, 0, cut=MIDDLE) for f in (a, b)]
    ).any()
    with pytest.raises(ValueError, match="nothing for the view Rays traced"):
        values_of(make_frame(), View.COST, cut=MIDDLE)


def test_a_difference_is_put_into_words():
    values = values_of(make_frame(), View.DEPTH, cut=MIDDLE)
    difference = np.array([[0.0, 0.25, -1.5, 1e30, -1e30]], np.float32)
    said = [difference_words(difference, values, x, 0) for x in range(5)]
    assert said == [("0",), ("+0.25",), ("-1.5",), ("miss", "in B"), ("miss", "in A")]
    classes = values_of(make_frame(), View.OCCLUSION, cut=MIDDLE)
    assert [difference_words(difference, classes, x, 0) for x in (0, 1)] == [("same",), ("other",)]


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
