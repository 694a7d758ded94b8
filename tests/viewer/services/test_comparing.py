"""What is compared with what, without a window."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.viewer.desk import ELSEWHERE, Desk
from tests.viewer.drawn import values_in
from tests.viewer.fakes import make_frame, with_voxels
from tracer.frame import Settings
from viewer.state.comparison import CompareMode, Side
from viewer.state.draw_options import Slice, Tone
from viewer.state.views import View


def keep(desk: Desk, method: str = "none") -> None:
    desk.c.settings.change(method=method)
    desk.rest()
    desk.c.comparing.keep()


def test_a_is_seen_in_the_view_of_b_where_it_has_what_that_needs(desk: Desk) -> None:
    comparing = desk.c.comparing
    keep(desk, "paper")
    comparing.start(CompareMode.DIFFERENCE)
    for view, seen in ((View.COST, View.COLOR), (View.DEPTH, View.DEPTH)):
        desk.c.session.set_draw(view=view)
        desk.rest()
        assert (comparing.a.view, comparing.b.view) == (seen, view)
        assert (comparing.seen.difference is None) == (seen is not view) == ("its picture is shown" in comparing.remark)
    assert comparing.seen.mode is CompareMode.DIFFERENCE
    found = comparing.seen.difference
    desk.c.session.set_draw(tone=Tone(exposure=2.0))
    assert comparing.limit(found) == found.stats.limit / 4.0, "more exposure shows smaller differences"


def test_maps_of_both_have_one_range(desk: Desk) -> None:
    comparing, session = desk.c.comparing, desk.c.session
    desk.c.session.set_draw(view=View.DEPTH)
    keep(desk)
    alone = comparing.span(View.DEPTH)
    desk.c.motion.move(ELSEWHERE)
    desk.rest()
    comparing.start(CompareMode.SIDE)
    low, high = comparing.span(View.DEPTH)
    middle = [np.median(side.frame.depth[np.isfinite(side.frame.depth)]) for side in (comparing.a, comparing.b)]
    assert alone is None and low <= min(middle) and max(middle) <= high
    session.change(draw=session.draw.with_span((1.0, 2.0), View.DEPTH))
    assert comparing.span(View.DEPTH) == (1.0, 2.0), "a range that was chosen is kept"
    assert comparing.span(View.COLOR) is None


def test_a_difference_is_that_of_the_chosen_slice(desk: Desk) -> None:
    comparing = desk.c.comparing
    sides = [Side(with_voxels(make_frame(Settings(samples=samples))), View.VOXELS, 0, "", 0) for samples in (1, 2)]
    found = []
    for cut in (Slice(1, 0.25), Slice(0, 0.6)):
        desk.c.session.set_draw(slice=cut)
        found.append(comparing.difference(*sides).values.numbers)
        assert np.array_equal(found[-1], values_in(sides[1].frame, View.VOXELS, slice=cut).numbers)
    assert not np.array_equal(*found)


def side(method: str, time: float = 0.0, view: View = View.COLOR, scene: str = "study", **settings: int) -> Side:
    frame = make_frame(Settings(16, 8, method=method, **settings), time=time)
    return Side(frame, view, 2, scene, round(3 + 2 * time))


@pytest.mark.parametrize(
    ("one", "other", "name"),
    [
        (side("none"), side("paper"), "None (trace all)"),
        (side("none"), side("none", 2.0), "None (trace all), frame 3"),
        (side("none", 2.0), side("paper"), "None (trace all), frame 7"),
        (side("paper", view=View.SHADOW), side("paper"), "Paper, shadow mode, light 2"),
        (side("paper"), side("paper", view=View.SHADOW), "Paper, colour"),
        (side("none", scene="hall"), side("paper"), "None (trace all), hall, frame 3"),
        (side("paper", depth=1), side("paper"), "Paper, depth 1"),
    ],
)
def test_each_is_called_by_its_method_and_what_sets_it_apart(one: Side, other: Side, name: str) -> None:
    assert one.named(other) == name


def test_sizes_and_samples_that_differ_are_told(desk: Desk) -> None:
    comparing = desk.c.comparing
    keep(desk)
    comparing.start(CompareMode.WIPE)
    frame = comparing.kept.frame
    for settings, said in (
        (replace(frame.settings, width=10, height=5), f"A has 10 x 5 pixels, B {frame.width} x {frame.height}: A is"),
        (replace(frame.settings, samples=1 + frame.settings.samples), f"A has {1 + frame.settings.samples} samples a"),
        (frame.settings, ""),
    ):
        comparing.kept = replace(comparing.kept, frame=make_frame(settings))
        assert comparing.remark.startswith(said) and bool(comparing.remark) is bool(said)
