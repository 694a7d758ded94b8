"""What culling saves, above the picture: the sentence, the bar, and the key that hides both."""

from __future__ import annotations

from tests.viewer.driver import Driver
from tracer.culling.fate import Fate
from viewer.output import capture
from viewer.state.savings import bar_of, in_words, sentence
from viewer.state.views import View
from viewer.util.numbers import percent
from viewer.util.resources import default_scene
from viewer.window.panels.savings import standing


def _said(d: Driver) -> str:
    return in_words(sentence(d.c.frame, standing(d.c)))


def savings(d: Driver) -> None:
    """In the scene that the program opens, at rest: the sentence tells what the counters say, and how the paper's
    method compares with none; the picture stays where it is, whatever is said above it."""
    d.c.settings.change(method="paper")
    d.fix_resolution(240, 180)
    d.open(default_scene())
    d.wait(lambda: "fast as tracing all" in _said(d), "a comparison with none", 120.0)
    shadow, words = d.c.frame.statistics.shadow, _said(d)
    assert shadow.saved > 0.1 * shadow.due and shadow.saved == shadow.culled + shadow.dynamic_only
    assert words.startswith(f"Paper: {percent(shadow.saved, shadow.due)} of shadow rays saved, "), words
    assert ", not verified, " in words and " fewer steps, " in words, words
    d.wait(lambda: d.c.baseline.measured.settled, "the comparison to end", 120.0)
    bar = {part.fate.name: part.rays for part in bar_of(d.c.frame)}
    assert bar == {"CULLED": shadow.culled, "DYNAMIC_ONLY": shadow.dynamic_only, "TRACED": shadow.traced}
    _saved(d)
    _pixels(d)
    traced, modes = d.c.history.frames, d.c.frame.modes
    d.frames(10)
    assert d.c.history.frames == traced, "measuring has shown a picture"
    edges = d.picture_edges()
    d.press("V").settle()
    assert " wrong" in _said(d) and "not verified" not in _said(d) and "fast as tracing all" in _said(d), _said(d)
    assert (d.c.frame.modes == modes).all(), "nothing was learnt meanwhile"
    d.press("V", "C").settle()
    assert _said(d).startswith("Every shadow ray is traced; the paper's modes would save "), _said(d)
    would = bar_of(d.c.frame)
    assert would[0].would and would[0].rays == d.c.frame.statistics.by_modes_in_all.full_shadow > 0
    assert d.picture_edges() == edges, "the picture has moved"
    d.press("C").settle()
    assert "fast as tracing all" in _said(d), "what was measured of this picture is known still"
    with d.held("D"):
        assert _said(d).endswith("speed is measured once the picture rests"), _said(d)
        assert d.picture_edges() == edges
    d.settle().press("Shift+B")
    assert not d.c.preferences.savings and d.picture_edges()[1] < edges[1], "the picture has the room"
    d.press("Shift+B").settle()
    assert d.picture_edges() == edges


def _saved(d: Driver) -> None:
    """A saved picture carries both, with what is known of steps and time."""
    d.c.preferences.savings_in_pictures = True
    frame, (height, width, _) = d.c.frame, d.saved("savings.png").shape
    assert width == frame.width and frame.height < height < 1.5 * frame.height
    said = capture.read(d.pictures / "savings.png").draw.savings
    assert " steps, " in said and "fast as tracing all (" in said
    d.c.preferences.savings_in_pictures = False


def _pixels(d: Driver) -> None:
    """A click on a part of the bar shows its pixels, another one those of all parts again."""
    d.click("//Picture/traced##savings").settle()
    assert d.c.scheduler.drawn_view is View.FATE
    d.click("//Picture/traced##savings")
    assert d.ui.fate_shown is None
    all_bright = d.shown().astype(int).sum(-1)
    d.click("//Picture/culled##savings")
    assert d.ui.fate_shown is Fate.CULLED
    culled, now = d.c.frame.fate(d.c.session.draw.light) == Fate.CULLED, d.shown().astype(int).sum(-1)
    others = (d.c.frame.primitive >= 0) & ~culled
    assert culled.any() and (now[culled] == all_bright[culled]).all()
    assert now[others].mean() < all_bright[others].mean() / 2
    d.press("1").settle()
    assert d.ui.fate_shown is None
