"""Colours can be told apart, tones do what they say, and the history tells what was there."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from tests.viewer.drawn import luminance
from tests.viewer.fakes import make_frame
from tracer.culling.fate import Fate
from tracer.frame import Settings
from viewer.state import palette
from viewer.state.draw_options import Curve, Tone, brighter, clipped, toned
from viewer.util.numbers import percent
from viewer.views import penumbra
from viewer.views.difference import Mark, wrong_marks


def dichromat(color: palette.Color) -> np.ndarray:
    """What is left of a colour without red-green vision (Vienot et al. 1999, deuteranopia, roughly linear)."""
    linear = np.power(color, 2.2)
    lms = np.array([[17.88, 43.52, 4.12], [3.46, 27.16, 3.87], [0.03, 0.18, 1.47]]) @ linear
    lms[1] = 0.4942 * lms[0] + 1.2483 * lms[2]
    back = np.linalg.inv([[17.88, 43.52, 4.12], [3.46, 27.16, 3.87], [0.03, 0.18, 1.47]]) @ lms
    return np.power(np.clip(back, 0.0, 1.0), 1 / 2.2)


def test_the_colour_of_wrong_answers_is_unmistakable():
    """Bright on black, and far from every colour of every other view, for the colour-blind too."""
    assert (luminance(palette.WRONG) + 0.05) / 0.05 > 4.5
    assert np.linalg.norm(dichromat(palette.WRONG)) > 0.8
    others = [one.color for one in (*palette.OCCLUSION.values(), *palette.SHADOW.values(), *penumbra.VIEW.classes)]
    others += [palette.BACKGROUND, palette.GREY]
    for other in [*others, palette.WIPE_LINE, *palette.color_map()]:
        assert np.linalg.norm(np.subtract(palette.WRONG, other)) > 0.5
        assert np.linalg.norm(dichromat(palette.WRONG) - dichromat(other)) > 0.15


@pytest.mark.parametrize(
    ("size", "magnified", "radius", "thickness"),
    [((64, 48), 1, 3, 1), ((1500, 40), 1, 8, 1), ((30, 4000), 1, 20, 3), ((1500, 40), 2, 4, 1), ((64, 48), 12, 1, 1)],
)
def test_rings_lie_at_one_distance_grow_with_the_picture_and_stay_small_on_screen(size, magnified, radius, thickness):
    frame = make_frame(Settings(width=size[0], height=size[1], verify=True))
    found = wrong_marks(frame, magnified)
    points = np.argwhere(frame.wrong > 0)
    rows, columns = np.indices(found.shape)
    distance = np.min([np.hypot(rows - y, columns - x) for y, x in points], axis=0)
    np.testing.assert_array_equal(found == Mark.WRONG, distance == 0)
    ring = found == Mark.RING
    assert ring.any() and (distance[ring] > radius).all()
    np.testing.assert_array_equal(ring, (distance > radius + 0.5) & (distance < radius + thickness + 0.5))


@pytest.mark.parametrize(
    ("part", "whole", "said"),
    [(0, 5, "0.0 %"), (5, 0, "-"), (1, 8, "12.5 %"), (1, 2000, "0.1 %"), (1, 9000, "0.011 %"), (3, 317e6, "9.5e-07 %")],
)
def test_a_small_share_does_not_look_like_none(part, whole, said):
    assert percent(part, whole) == said


@pytest.mark.parametrize("palette", [palette.OCCLUSION, palette.SHADOW, palette.CERTIFICATES])
def test_mode_colours_can_be_told_apart_without_red_green_vision(palette):
    for a, b in itertools.combinations(palette.values(), 2):
        assert np.linalg.norm(dichromat(a.color) - dichromat(b.color)) > 0.15


def test_one_fate_stands_out_and_words_can_be_read_on_each():
    colors = {fate: one.color for fate, one in palette.FATES.items()}
    assert palette.fate_palette() == list(colors.values())
    traced = palette.fate_palette(Fate.TRACED)
    assert [color == colors[fate] for fate, color in zip(colors, traced)] == [fate.is_traced for fate in colors]
    culled = palette.fate_palette(Fate.CULLED)
    assert [fate for fate, color in zip(colors, culled) if color == colors[fate]] == [Fate.CULLED]
    for color in colors.values():
        light, dark = sorted((luminance(color), luminance(palette.label_color(color))), reverse=True)
        assert (light + 0.05) / (dark + 0.05) >= 3.0, color


def test_the_colour_map_grows_lighter_all_the_way():
    grey = palette.color_map() @ np.array([0.2126, 0.7152, 0.0722])
    assert (np.diff(grey) > -1e-3).all() and grey[-1] - grey[0] > 0.6


GREYS = np.repeat(np.linspace(0.0, 8.0, 161, dtype=np.float32)[:, None, None], 3, axis=2)


@pytest.mark.parametrize("curve", Curve)
@pytest.mark.parametrize("white", [0.5, 1.0, 4.0])
def test_curves_rise_from_black_to_the_white_point(curve, white):
    shown = toned(GREYS, Tone(0.0, white, curve))
    assert shown.dtype == np.float32
    assert shown[0].max() == pytest.approx(0.0, abs=1e-6) and (np.diff(shown[:, 0, 0]) > 0.0).all()
    at_white = toned(np.full((1, 1, 3), white, np.float32), Tone(0.0, white, curve))
    assert at_white == pytest.approx(1.0, abs=1e-6)
    bright, _ = clipped(GREYS, Tone(0.0, white, curve))
    assert np.array_equal(bright[:, 0], GREYS[:, 0, 0] > white * (1.0 + 1e-6))


def test_a_stop_of_exposure_doubles_colours_and_has_limits():
    assert np.array_equal(toned(GREYS, Tone(1.0)), 2.0 * GREYS)
    for curve in Curve:
        assert toned(GREYS, Tone(-2.0, 1.0, curve)) == pytest.approx(toned(GREYS / 4.0, Tone(0.0, 1.0, curve)))
    assert brighter(brighter(Tone(), 0.1), -0.1).neutral
    assert brighter(Tone(16.0), 1.0).exposure == 16.0


def test_known_values_of_the_curves():
    assert toned(GREYS, Tone()) is GREYS, "not even rounded"
    half = np.full((1, 1, 3), 0.5, np.float32)
    assert toned(half, Tone(0.0, 1.0, Curve.SRGB)) == pytest.approx(0.735357, abs=1e-5)
    assert toned(half, Tone(0.0, 2.0, Curve.REINHARD)) == pytest.approx(0.5 * (1 + 0.5 / 4.0) / 1.5)

    def hable(x):
        return (x * (0.15 * x + 0.05) + 0.004) / (x * (0.15 * x + 0.5) + 0.06) - 0.02 / 0.3

    assert toned(half, Tone(0.0, 11.2, Curve.FILMIC)) == pytest.approx(hable(0.5) / hable(11.2), rel=1e-5)


def test_what_is_negative_is_black_and_a_single_channel_clips():
    color = np.array([[[-1.0, -0.5, 0.0], [0.0, 1.5, 0.2], [0.0, 0.0, 0.01]]], np.float32)
    bright, black = clipped(color, Tone())
    assert black.tolist() == [[True, False, False]] and bright.tolist() == [[False, True, False]]
