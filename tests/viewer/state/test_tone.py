"""Exposure, white point and tone curve: what they do to colours, and that by default they do nothing."""

from __future__ import annotations

import numpy as np
import pytest

from viewer.state.tone import MOST_EXPOSURE, Curve, Tone, brighter, clipped, toned

GREYS = np.repeat(np.linspace(0.0, 8.0, 161, dtype=np.float32)[:, None, None], 3, axis=2)


def test_a_neutral_tone_leaves_colours_as_they_are():
    color = np.random.default_rng(0).normal(size=(4, 5, 3)).astype(np.float32)
    assert toned(color, Tone()) is color, "not even rounded"


@pytest.mark.parametrize("curve", Curve)
@pytest.mark.parametrize("white", [0.5, 1.0, 4.0])
def test_curves_rise_from_black_to_the_white_point(curve, white):
    shown = toned(GREYS, Tone(0.0, white, curve))
    assert shown.dtype == np.float32
    assert shown[0].max() == pytest.approx(0.0, abs=1e-6) and (np.diff(shown[:, 0, 0]) > 0.0).all()
    at_white = toned(np.full((1, 1, 3), white, np.float32), Tone(0.0, white, curve))
    assert at_white == pytest.approx(1.0, abs=1e-6)
    found = clipped(GREYS, Tone(0.0, white, curve))
    assert np.array_equal(found.bright[:, 0], GREYS[:, 0, 0] > white * (1.0 + 1e-6))


def test_a_stop_of_exposure_doubles_colours():
    assert np.array_equal(toned(GREYS, Tone(1.0)), 2.0 * GREYS)
    for curve in Curve:
        assert toned(GREYS, Tone(-2.0, 1.0, curve)) == pytest.approx(toned(GREYS / 4.0, Tone(0.0, 1.0, curve)))


def test_known_values_of_the_curves():
    half = np.full((1, 1, 3), 0.5, np.float32)
    assert toned(half, Tone(0.0, 1.0, Curve.SRGB)) == pytest.approx(0.735357, abs=1e-5)
    assert toned(half, Tone(0.0, 2.0, Curve.REINHARD)) == pytest.approx(0.5 * (1 + 0.5 / 4.0) / 1.5)

    def hable(x):
        return (x * (0.15 * x + 0.05) + 0.004) / (x * (0.15 * x + 0.5) + 0.06) - 0.02 / 0.3

    assert toned(half, Tone(0.0, 11.2, Curve.FILMIC)) == pytest.approx(hable(0.5) / hable(11.2), rel=1e-5)


def test_what_is_negative_is_black_and_a_single_channel_clips():
    color = np.array([[[-1.0, -0.5, 0.0], [0.0, 1.5, 0.2], [0.0, 0.0, 0.01]]], np.float32)
    found = clipped(color, Tone())
    assert found.black.tolist() == [[True, False, False]] and found.bright.tolist() == [[False, True, False]]


def test_exposure_has_limits_and_comes_back_to_none():
    tone = brighter(brighter(Tone(), 0.1), -0.1)
    assert tone.neutral
    assert brighter(Tone(MOST_EXPOSURE), 1.0).exposure == MOST_EXPOSURE
