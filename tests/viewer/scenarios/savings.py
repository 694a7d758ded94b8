"""What culling saves, above the picture: the sentence, the bar, and the key that hides both."""

from __future__ import annotations

from imgui_bundle import imgui
from PIL import Image

from tests.viewer.driver import Driver
from tracer.culling.fate import Fate
from viewer.output import capture
from viewer.state.savings import bar_of, in_words, sentence
from viewer.state.views import View
from viewer.util.numbers import percent
from viewer.util.resources import default_scene
from viewer.window.panels.savings import standing

KEY = imgui.Key


def said(d: Driver) -> str:
    return in_words(sentence(d.c.frame, standing(d.c)))


def savings(d: Driver) -> None:
    """In the scene that the program opens, at rest: the sentence tells what the counters say, and how the paper's
    method compares with none; the picture stays where it is, whatever is said above it."""
    d.settle()
    d.c.settings.change(method="paper")
    d.fix_resolution(320, 240)
    d.c.loader.open(default_scene())
    d.wait(lambda: d.c.session.scene is not None and d.c.session.scene.path.stem == "default", "the scene")
    d.settle()
    d.wait(lambda: "fast as none" in said(d), "a comparison with none", 120.0)
    shadow, words = d.c.frame.statistics.shadow, said(d)
    assert shadow.saved > 0.1 * shadow.due and shadow.saved == shadow.culled + shadow.dynamic_only
    assert words.startswith(f"paper: {percent(shadow.saved, shadow.due)} of shadow rays saved, "), words
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
    d.press(KEY.v)
    d.settle()
    assert " wrong" in said(d) and "not verified" not in said(d) and "fast as none" in said(d), said(d)
    assert (d.c.frame.modes == modes).all(), "nothing was learnt meanwhile"
    d.press(KEY.v)
    d.press(KEY.c)
    d.settle()
    assert said(d).startswith("none: every shadow ray is traced; the paper's modes would save "), said(d)
    would = bar_of(d.c.frame)
    assert would[0].would and would[0].rays == d.c.frame.statistics.by_modes_in_all.full_shadow > 0
    assert d.picture_edges() == edges, "the picture has moved"
    d.press(KEY.c)
    d.settle()
    assert "fast as none" in said(d), "what was measured of this picture is known still"
    d.context.key_down(KEY.d)
    d.frames(5)
    assert said(d).endswith("speed is measured once the picture rests"), said(d)
    assert d.picture_edges() == edges
    d.context.key_up(KEY.d)
    d.settle()
    d.press("Shift+B")
    assert not d.c.preferences.savings and d.picture_edges()[1] < edges[1], "the picture has the room"
    d.press("Shift+B")
    d.settle()
    assert d.picture_edges() == edges


def _saved(d: Driver) -> None:
    """A saved picture carries both, with what is known of steps and time."""
    p = d.c.preferences
    p.savings_in_pictures, folder = True, p.picture_folder
    d.press(KEY.f12)
    d.wait(lambda: not d.c.captures.busy and any(folder.glob("*.png")), "the saved picture")
    saved, frame = next(folder.glob("*.png")), d.c.frame
    with Image.open(saved) as picture:
        assert picture.width == frame.width and frame.height < picture.height < 1.5 * frame.height
    said = capture.read(saved).draw.savings
    assert " steps, " in said and "fast as none (" in said
    p.savings_in_pictures = False


def _pixels(d: Driver) -> None:
    """A click on a part of the bar shows its pixels, another one those of all parts again."""
    d.click("//Picture/traced##savings")
    d.settle()
    assert d.c.scheduler.drawn_view is View.FATE
    d.click("//Picture/traced##savings")
    assert d.ui.fate_shown is None
    all_bright = d.shown().astype(int).sum(-1)
    d.click("//Picture/culled##savings")
    assert d.ui.fate_shown is Fate.CULLED
    culled, now = d.c.frame.fate(d.c.session.draw.light) == Fate.CULLED, d.shown().astype(int).sum(-1)
    others = (d.c.frame.primitive >= 0) & ~culled
    assert (
        culled.any()
        and (now[culled] == all_bright[culled]).all()
        and now[others].mean() < all_bright[others].mean() / 2
    )
    d.press(KEY._1)
    d.settle()
    assert d.ui.fate_shown is None
