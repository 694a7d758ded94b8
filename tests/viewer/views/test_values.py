"""The exact value of a pixel, as a number and in words; and zooming into the picture."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.viewer.drawn import values_in, words_in
from tests.viewer.fakes import in_part, make_frame, with_everything
from tracer.frame import Settings
from viewer.state.pixels import FIT, MOST, Zoom, panned, pixels_shown, zoomed
from viewer.state.views import View, can_draw
from viewer.views.base import histogram

FRAME = with_everything(make_frame(Settings(width=16, height=8, verify=True, record_work=True)))


def test_pixels_are_put_into_words():
    part = in_part(FRAME)
    said = {(view, x): words_in(FRAME, view, 0, x, 2) for view in View for x in (2, 3, 4, 5, 6, 8, 13, 15)}
    nodes, bound = (FRAME.layers[name][2, 5] for name in ("cut nodes", "cut bound"))
    expected = {
        (View.COLOR, 2): ("0.500",) * 3, (View.OCCLUSION, 2): ("partially", "occluded"),
        (View.SHADOW, 4): ("full", "shadow"), (View.SHADOW, 8): ("dynamic",),
        (View.PRIMITIVE, 13): ("6",), (View.PRIMITIVE, 15): ("miss",), (View.DEPTH, 3): ("2",),
        (View.NORMAL, 3): ("+0.000", "+0.000", "+1.000"), (View.PIXEL_COUNT, 6): ("16 now", "32 examined"),
        (View.DIFFERENCE, 3): ("1 wrong",), (View.COST, 3): (str(FRAME.cost[2, 3]),),
        (View.PENUMBRA, 5): (f"{FRAME.reached[2, 5, 0]} of {FRAME.asked[2, 5, 0]}",),
        (View.LIGHTS, 5): (str(np.count_nonzero(FRAME.asked[2, 5])),),
        (View.CUTS, 5): (str(nodes), f"± {100 * bound:.3g} %"),
    }  # fmt: skip
    assert {key: said[key] for key in expected} == expected
    assert words_in(FRAME, View.SAVED, 0, 3, 2, shares=True) == (
        f"{100 * FRAME.saved[2, 3] / FRAME.due_rays[2, 3]:.0f} %",
    )
    for view in (View.DIFFERENCE, View.COST, View.SAVED, View.PENUMBRA, View.LIGHTS):
        assert words_in(part, view, 0, 3, 2) == ("?",) and words_in(part, view, 0, 4, 2) != ("?",)
        assert (values_in(part, view).known <= part.shaded).all()


@pytest.mark.parametrize("view", list(View))
def test_every_view_has_values_and_words_for_every_pixel(view):
    values = values_in(FRAME, view, 1)
    assert values.numbers.shape == (8, 16, len(values.names)) and values.numbers.dtype == np.float32
    assert values.known.shape == (8, 16) and np.isfinite(values.numbers[values.known]).all()
    assert all(words_in(FRAME, view, 1, x, y) for x in range(16) for y in range(8))
    bare = make_frame()
    if not can_draw(bare, view, 1):
        assert words_in(bare, view, 1, 0, 0) == ()
        with pytest.raises(ValueError, match="nothing"):
            values_in(bare, view, 1)


def test_a_histogram_counts_its_pixels_and_nothing_else():
    color = np.random.default_rng(3).random((8, 16, 3)).astype(np.float32)
    frame = replace(FRAME, color=color)
    rows, columns = slice(2, 5), slice(4, 12)
    found = histogram(values_in(frame, View.COLOR), rows, columns)
    part = color[rows, columns].reshape(-1, 3)
    assert found.counts.sum(axis=1).tolist() == [24, 24, 24] and (found.pixels, found.of) == (24, 24)
    for figures, expected in ((found.least, part.min(0)), (found.largest, part.max(0)), (found.mean, part.mean(0))):
        assert figures == pytest.approx(tuple(expected))
    edges = np.linspace(found.low, found.high, found.counts.shape[1] + 1)
    assert np.array_equal(found.counts[1], np.histogram(part[:, 1], edges)[0])


def test_whole_numbers_have_a_bin_each_and_misses_none():
    found = histogram(values_in(FRAME, View.COST), slice(0, 8), slice(0, 16))
    assert found.counts.shape[1] == FRAME.cost.max() - FRAME.cost.min() + 1
    assert np.array_equal(found.counts[0], np.bincount(FRAME.cost.reshape(-1))[FRAME.cost.min() :])
    depth = histogram(values_in(FRAME, View.DEPTH), slice(0, 8), slice(10, 16))
    assert (depth.pixels, depth.of) == (32, 48) and depth.largest == (2.0,)
    assert histogram(values_in(FRAME, View.DEPTH), slice(0, 8), slice(14, 16)) is None


def test_what_is_under_the_pointer_stays_there():
    lots = np.random.default_rng(5)
    zoom = FIT
    for _ in range(200):
        at = tuple(lots.uniform(0.2, 0.8, 2))
        before, closer = zoom.to_picture(*at), zoomed(zoom, 1.3, at)
        if closer.scale < MOST:
            assert closer.to_picture(*at) == pytest.approx(before)
        left, top, right, bottom = closer.shown()
        assert -1e-9 <= left < right <= 1.0 + 1e-9 and -1e-9 <= top < bottom <= 1.0 + 1e-9
        zoom = closer if lots.random() < 0.7 else FIT


def test_there_is_an_end_to_both_sides():
    assert zoomed(FIT, 1e6, (0.5, 0.5)).scale == MOST
    assert zoomed(Zoom(2.0, 0.75, 0.25), 0.1, (0.1, 0.9)) == FIT
    there_and_back = zoomed(zoomed(FIT, 2.0**0.5, (0.3, 0.4)), 2.0**-0.5, (0.8, 0.9))
    assert there_and_back == FIT


def test_a_hand_moves_the_picture_as_far_as_its_edge():
    zoom = Zoom(4.0, 0.5, 0.5)
    assert panned(zoom, 0.5, -0.25) == Zoom(4.0, 0.375, 0.5625)
    assert panned(zoom, 100.0, 100.0).shown()[:2] == (0.0, 0.0)
    assert panned(zoom, -100.0, -100.0).shown()[2:] == (1.0, 1.0)
    assert panned(FIT, 1.0, 1.0) == FIT


def test_the_pixels_that_are_seen():
    assert pixels_shown(FIT, 16, 8) == (range(0, 16), range(0, 8))
    columns, rows = pixels_shown(Zoom(4.0, 0.5, 0.5), 16, 8)
    assert (columns, rows) == (range(6, 10), range(3, 5))
    assert pixels_shown(Zoom(4.0, 0.53, 0.5), 16, 8)[0] == range(6, 11), "those seen in part count too"


def test_minus_zero_of_a_normal_is_zero():
    frame = replace(FRAME, normal=np.full_like(FRAME.normal, -0.0))
    assert words_in(frame, View.NORMAL, 0, 0, 0) == ("+0.000",) * 3
