"""Two pictures in one: their signed difference in numbers, colours and words, and both side by side."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.viewer.drawn import values_in
from tests.viewer.fakes import make_frame, with_certificates
from tracer.frame import Settings
from viewer.state.comparison import CompareMode
from viewer.state.palette import LESS, MORE, SAME, WIPE_LINE, signed_map
from viewer.state.views import View
from viewer.state.zooming import Zoom
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


def test_certificates_and_work_are_compared_where_both_have_them():
    a = with_certificates(make_frame(Settings(width=160, height=80)))
    b = replace(a, certificates=a.certificates ^ a.certificates.dtype.type(1 << 4), cost=a.cost + 2)
    assert (difference_of(values_in(a, View.COST), values_in(b, View.COST)).pixels == 2.0).all()
    found = difference_of(values_in(a, View.CERTIFICATE, 1), values_in(b, View.CERTIFICATE, 1)).pixels
    assert (found == 1.0).all() and not difference_of(*[values_in(f, View.CERTIFICATE, 0) for f in (a, b)]).pixels.any()
    with pytest.raises(ValueError, match="nothing for the view Rays traced"):
        values_in(make_frame(), View.COST)


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


@pytest.mark.gui
def test_the_gpu_shows_crisp_pixels():
    """Enlarged, each pixel of a picture stays one colour; what is shown already is not drawn again."""
    moderngl = pytest.importorskip("moderngl")
    from viewer.window.display import Compared
    from viewer.window.magnifier import Magnifier

    frame = make_frame(Settings(width=33, height=19))
    a, b = (values_in(one, View.DEPTH) for one in (replace(frame, depth=frame.depth * 2), frame))
    found = difference_of(a, b)
    context = moderngl.create_context(standalone=True, require=330)
    with context:
        compared, magnifier = Compared(context), Magnifier(context)
        compared.draw_difference(found, 1.3)
        drawn, version = compared.difference, compared.difference.version
        compared.draw_difference(found, 1.3)
        assert drawn.version == version, "it is there"
        compared.draw_difference(replace(found), 1.3)
        assert drawn.version == version + 1, "another one may differ"
        expected = signed_picture(found.pixels, 1.3)
        read = np.frombuffer(drawn.picture.read(alignment=1), np.uint8).reshape(19, 33, 3)
        assert np.array_equal(read, expected)
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
            wrong = (shown != expected[y[:, None], x[None]]).any(axis=-1)
            assert wrong.mean() < 0.01, "but where rounding decides between two pixels"
        magnifier.release()
        compared.release()
    context.release()
