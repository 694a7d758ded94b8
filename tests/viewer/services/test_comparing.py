"""What is compared with what, without a window."""

from __future__ import annotations

import gc
from dataclasses import replace

import numpy as np

from tests.viewer.desk import ELSEWHERE, Desk
from tests.viewer.drawn import values_in
from tests.viewer.fakes import make_frame, with_tree
from tracer.frame import Settings
from tracer.geometry.accelerators import BVH8, LAZY
from viewer.state.comparison import CompareMode, Side
from viewer.state.draw_options import Slice, Tone
from viewer.state.views import View


def keep(desk: Desk, method: str = "none") -> None:
    desk.c.settings.change(method=method)
    desk.rest()
    desk.c.comparing.keep()


def test_what_is_kept_stays_whatever_is_changed_since(desk: Desk) -> None:
    comparing = desk.c.comparing
    assert comparing.seen is None and comparing.b is not None and comparing.a is None
    keep(desk)
    kept, color = comparing.a.frame, comparing.a.frame.color.copy()
    desk.c.settings.change(method="paper")
    desk.c.motion.move(ELSEWHERE)
    desk.rest()
    comparing.start(CompareMode.DIFFERENCE)
    desk.rest()
    seen, b = comparing.seen, comparing.b
    assert seen.a.frame is kept and np.array_equal(seen.a.frame.color, color)
    assert (seen.a.method, seen.b.method) == ("none", "paper") and seen.b.frame is desk.c.frame
    assert seen.names == ("A  none", "B  paper")
    found = seen.difference
    assert comparing.difference(seen.a, seen.b) is found, "found out once"
    assert np.array_equal(found.pixels != 0.0, (b.frame.color != color).any(axis=-1)) and found.stats.pixels
    desk.c.session.set_draw(tone=Tone(exposure=2.0))
    assert comparing.limit(found) == found.stats.limit / 4.0, "brighter, smaller differences are seen"
    comparing.held = True
    comparing.update()
    assert comparing.seen.shows_a and comparing.seen.difference is None, "A alone while the key is held"
    comparing.forget()
    comparing.update()
    assert comparing.seen is None and comparing.a is None


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


def test_maps_of_both_have_one_range(desk: Desk) -> None:
    comparing, session = desk.c.comparing, desk.c.session
    desk.c.session.set_draw(view=View.DEPTH)
    keep(desk)
    alone = comparing.span(View.DEPTH)
    desk.c.motion.move(ELSEWHERE)
    desk.rest()
    comparing.start(CompareMode.SIDE)
    a, b = comparing.a, comparing.b
    both = comparing.span(View.DEPTH)
    hit = [side.frame.depth[np.isfinite(side.frame.depth)] for side in (a, b)]
    assert alone is None and both[0] <= min(np.median(d) for d in hit) and both[1] >= max(np.median(d) for d in hit)
    session.change(draw=session.draw.with_span((1.0, 2.0), View.DEPTH))
    assert comparing.span(View.DEPTH) == (1.0, 2.0), "a range that was chosen is kept"
    assert comparing.span(View.COLOR) is None


def test_a_whose_tree_is_gone_is_shown_as_a_picture(desk: Desk) -> None:
    comparing = desk.c.comparing
    desk.c.settings.change(accelerator=LAZY)
    desk.c.session.set_draw(view=View.TREE)
    keep(desk)
    comparing.start(CompareMode.SIDE)
    assert comparing.a.view is View.TREE and comparing.span(View.TREE) is not None
    desk.c.settings.change(accelerator=BVH8)
    desk.rest()
    desk.c.settings.change(accelerator=LAZY)
    desk.rest()
    gc.collect()
    assert comparing.b.view is View.TREE and comparing.a.view is View.COLOR
    assert comparing.span(View.TREE) is None


def test_a_difference_is_that_of_the_chosen_slice(desk: Desk) -> None:
    comparing = desk.c.comparing
    a, b = (
        Side(with_tree(make_frame(settings)), View.TREE, 0, "", 0) for settings in (Settings(), Settings(samples=2))
    )
    for cut in (Slice(1, 0.25), Slice(0, 0.6)):
        desk.c.session.set_draw(slice=cut)
        found = comparing.difference(a, b)
        assert found is not None and comparing.difference(a, b) is found
        expected = values_in(b.frame, View.TREE, slice=cut)
        assert np.array_equal(found.values.numbers, expected.numbers)
    assert not np.array_equal(expected.numbers, values_in(b.frame, View.TREE, slice=Slice(1, 0.25)).numbers)


def side(settings: Settings, time: float = 0.0, view: View = View.COLOR, light: int = 0, scene: str = "study") -> Side:
    return Side(make_frame(settings, time=time), view, light, scene, round(3 + 2 * time))


def test_each_is_called_by_its_method_and_what_sets_it_apart() -> None:
    none, paper = Settings(16, 8, method="none"), Settings(16, 8, method="paper")
    a, b = side(none), side(paper)
    for one, other, name in (
        (a, b, "none"),
        (b, a, "paper"),
        (a, side(none, 2.0), "none, frame 3"),
        (side(none, 2.0), a, "none, frame 7"),
        (side(paper, view=View.SHADOW, light=2), b, "paper, shadow mode, light 2"),
        (b, side(paper, view=View.SHADOW, light=2), "paper, colour"),
        (side(none, scene="hall"), b, "none, hall, frame 3"),
        (side(Settings(16, 8, method="paper", depth=1)), b, "paper, depth 1"),
    ):
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
