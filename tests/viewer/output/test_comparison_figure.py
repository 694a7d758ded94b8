"""Figures of a comparison, and of the pictures of a zoom test."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.viewer.drawn import picture
from tests.viewer.fakes import make_frame, make_scene
from tracer.frame import Settings
from viewer.output.comparison import Comparison, Crop, Shown
from viewer.output.comparison_figure import figure
from viewer.state.draw_options import DrawOptions, Tone
from viewer.state.palette import WRONG
from viewer.state.view_state import ViewState
from viewer.state.views import View
from viewer.views.difference import Mark, ringed, wrong_marks


def test_wrong_pixels_have_rings() -> None:
    frame = make_frame(Settings(width=64, height=48, verify=True))
    pixels, ring = ringed(frame), wrong_marks(frame) == Mark.RING
    assert (pixels[ring] == np.round(255.0 * np.asarray(WRONG))).all() and ring.any()
    np.testing.assert_array_equal(pixels[~ring], picture(frame)[~ring])
    with pytest.raises(ValueError, match="not verified"):
        ringed(replace(frame, wrong=None))


def shown(view: View) -> Shown:
    right = make_frame()
    h, w = right.primitive.shape
    ones = np.ones((h, w), np.int32)
    right = replace(right, saved=0 * ones, cost=40 * ones, due_rays=20 * ones)
    color = right.color.copy()
    color[1, 2] = 1.0 - np.clip(color[1, 2], 0.0, 0.4)
    other = replace(right, color=color, cost=10 * ones, saved=30 * ones)
    settings = replace(right.settings, width=w, height=h)
    state = ViewState("scene.aff", settings=settings, draw=DrawOptions(view))
    compared = Comparison(("none", "paper"), (Crop(0, 0, 4, 3),))
    return Shown(make_scene(), state, compared, {"none": right, "paper": other}, right)


def test_differences_are_counted_of_what_was_traced_and_maps_of_work_have_one_range() -> None:
    drawn = shown(View.COLOR)
    found = drawn.difference("paper")
    assert found[1, 2] > 0.0 and np.count_nonzero(found) == 1
    assert dict(drawn.counts("paper"))["pixels that differ"] == "1" and drawn.differing("none") == 0
    bright = replace(drawn, state=drawn.state.with_draw(tone=Tone(1.0)))
    assert (bright.pictures["none"] != drawn.pictures["none"]).any()
    assert np.array_equal(bright.difference("paper"), drawn.difference("paper"))
    drawn = shown(View.COST)
    hit = drawn.reference.primitive >= 0
    assert drawn.span == (0.0, 40.0)
    by_hand = replace(drawn, state=drawn.state.with_draw(spans=((drawn.state.draw.view, (5.0, 10.0)),)))
    assert by_hand.span == (5.0, 10.0) and (by_hand.pictures["paper"] != drawn.pictures["paper"]).any()
    none, paper = (drawn.pictures[method][hit] for method in ("none", "paper"))
    assert (none != paper).any(axis=-1).all(), "ten rays do not look like forty"
    words = [text.get_text() for axes in figure(drawn).axes for text in axes.texts]
    assert {"the reference", "A", "pixels that differ"} <= set(words)
    assert "no difference" not in words


def test_the_title_counts_the_frames_that_were_traced_before() -> None:
    drawn = shown(View.COLOR)
    for warmed, words in ((0, "frame 0, 16"), (1, "0, with what 1 earlier frame taught, "), (2, "2 earlier frames ")):
        assert words in figure(replace(drawn, warmed=warmed)).get_suptitle()
