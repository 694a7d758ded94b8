"""Zooming into the picture: what is under the pointer stays there, and nothing but the picture is shown."""

from __future__ import annotations

import numpy as np
import pytest

from viewer.state.zooming import FIT, MOST, Zoom, panned, pixels_shown, zoomed


def test_what_is_under_the_pointer_stays_there():
    lots = np.random.default_rng(5)
    zoom = FIT
    for _ in range(200):
        at = tuple(lots.uniform(0.2, 0.8, 2))
        before, closer = zoom.to_picture(*at), zoomed(zoom, 1.3, at)
        if closer.scale < MOST:
            assert closer.to_picture(*at) == pytest.approx(before)
        left, top, right, bottom = closer.shown()
        assert -1e-9 <= left < right <= 1.0 + 1e-9 and -1e-9 <= top < bottom <= 1.0 + 1e-9
        zoom = closer if lots.random() < 0.7 else FIT


def test_there_is_an_end_to_both_sides():
    assert zoomed(FIT, 1e6, (0.5, 0.5)).scale == MOST
    assert zoomed(Zoom(2.0, 0.75, 0.25), 0.1, (0.1, 0.9)) == FIT
    there_and_back = zoomed(zoomed(FIT, 2.0**0.5, (0.3, 0.4)), 2.0**-0.5, (0.8, 0.9))
    assert there_and_back == FIT


def test_a_hand_moves_the_picture_as_far_as_its_edge():
    zoom = Zoom(4.0, 0.5, 0.5)
    assert panned(zoom, 0.5, -0.25) == Zoom(4.0, 0.375, 0.5625)
    assert panned(zoom, 100.0, 100.0).shown()[:2] == (0.0, 0.0)
    assert panned(zoom, -100.0, -100.0).shown()[2:] == (1.0, 1.0)
    assert panned(FIT, 1.0, 1.0) is FIT


def test_the_pixels_that_are_seen():
    assert pixels_shown(FIT, 16, 8) == (range(0, 16), range(0, 8))
    columns, rows = pixels_shown(Zoom(4.0, 0.5, 0.5), 16, 8)
    assert (columns, rows) == (range(6, 10), range(3, 5))
    assert pixels_shown(Zoom(4.0, 0.53, 0.5), 16, 8)[0] == range(6, 11), "those seen in part count too"
