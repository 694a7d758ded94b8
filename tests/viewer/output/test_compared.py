"""Comparisons without a GPU, and that shaders draw the same."""

from __future__ import annotations

import numpy as np
import pytest

from tests.viewer.fakes import make_frame
from viewer.output.compared import GAP, composed, difference_legend, signed_picture
from viewer.state.comparison import CompareMode, apart
from viewer.state.draw_options import MIDDLE
from viewer.state.palette import LESS, MORE, SAME, WIPE_LINE, signed_map
from viewer.state.views import View
from viewer.state.zooming import Zoom
from viewer.views import values_of
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


def test_the_legend_of_a_difference():
    values = values_of(make_frame(), View.COLOR, cut=MIDDLE)
    none = difference_legend(apart(np.zeros((8, 16), np.float32)), values, 1.0)
    assert none.notes[0].tone is NoteKind.GOOD and "bit for bit" in none.notes[0].text
    difference = np.zeros((8, 16), np.float32)
    difference[0, :4] = 0.5, -0.25, 0.5, 0.125
    legend = difference_legend(apart(difference), values, 0.5)
    assert (legend.scale.low, legend.scale.high, legend.scale.signed) == ("-0.5", "+0.5", True)
    assert {fact.name: fact.values[0] for fact in legend.facts} == {
        "pixels that differ": "4 (3.1 %)", "least and largest": "-0.25   +0.5", "mean": "+0.006836",
    }  # fmt: skip
    classes = difference_legend(apart(difference), values_of(make_frame(), View.OCCLUSION, cut=MIDDLE), 1.0)
    assert [entry.color for entry in classes.entries] == [MORE, SAME]


@pytest.mark.gui
def test_shaders_draw_the_same():
    """The signed difference, and crisp enlarged pixels; what is drawn at once is not drawn again."""
    moderngl = pytest.importorskip("moderngl")
    from viewer.window.compared import SignedDifference
    from viewer.window.magnifier import Magnifier
    from viewer.window.passes import Passes

    difference = np.random.default_rng(7).normal(size=(19, 33)).astype(np.float32)
    context = moderngl.create_context(standalone=True, require=330)
    with context:
        passes = Passes()
        drawn, magnifier = SignedDifference(passes), Magnifier(passes)
        drawn.draw(difference, 1.3)
        expected = signed_picture(difference, 1.3)
        assert np.abs(drawn.read().astype(int) - expected).max() <= 1
        for zoom in (Zoom(), Zoom(1.7, 0.4, 0.55), Zoom(64.0, 0.99, 0.01)):
            size = 140, 90
            magnifier.draw("one", drawn.picture, drawn.version, zoom, size)
            assert magnifier.texture_of("one", drawn.texture_id, zoom, size) is not None
            assert magnifier.texture_of("one", drawn.texture_id, zoom, (1, 1)) is None
            data = magnifier._targets["one"].read(components=3, alignment=1)
            shown = np.frombuffer(data, np.uint8).reshape(size[1], size[0], 3)
            left, top, right, bottom = zoom.shown()
            x = np.floor((left + (np.arange(size[0]) + 0.5) / size[0] * (right - left)) * 33).astype(int)
            y = np.floor((top + (np.arange(size[1]) + 0.5) / size[1] * (bottom - top)) * 19).astype(int)
            wrong = (shown != drawn.read()[y[:, None], x[None]]).any(axis=-1)
            assert wrong.mean() < 0.01, "but where rounding decides between two pixels"
        magnifier.release()
        drawn.release()
        passes.release()
    context.release()
