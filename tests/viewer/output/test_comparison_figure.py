"""What a figure shows of its frames: one range of colours for all, and true counts."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from tests.viewer.fakes import make_frame, make_scene
from viewer.output.comparison import Comparison, Crop, Shown
from viewer.output.comparison_figure import figure
from viewer.state.draw_options import DrawOptions
from viewer.state.tone import Tone
from viewer.state.view_state import ViewState
from viewer.state.views import View


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


def test_differences_are_counted() -> None:
    drawn = shown(View.COLOR)
    assert drawn.differing("none") == 0 and drawn.differing("paper") == 1
    found = drawn.difference("paper")
    assert found[1, 2] > 0.0 and np.count_nonzero(found) == 1
    assert dict(drawn.counts("paper"))["pixels that differ"] == "1"


def test_pictures_have_the_tone_and_differences_are_of_what_was_traced() -> None:
    drawn = shown(View.COLOR)
    bright = replace(drawn, state=drawn.state.with_draw(tone=Tone(1.0)))
    assert (bright.pictures["none"] != drawn.pictures["none"]).any()
    assert np.array_equal(bright.difference("paper"), drawn.difference("paper"))


def test_maps_of_work_have_one_range() -> None:
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
    older = replace(drawn.comparison, edition=1)
    for warmed, words, of_old in (
        (0, "frame 0, ", "frame 0, "),
        (1, ", with what 1 earlier frame taught, ", ", after the frame before it, "),
        (2, ", with what 2 earlier frames taught, ", ", after the 2 frames before it, "),
    ):
        assert words in figure(replace(drawn, warmed=warmed)).get_suptitle()
        assert of_old in figure(replace(drawn, warmed=warmed, comparison=older)).get_suptitle(), (  # they keep theirs
            "older figures keep theirs"
        )
