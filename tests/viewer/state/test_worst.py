"""Where two pictures are furthest apart."""

from __future__ import annotations

import numpy as np

from viewer.state.worst import LEAST, MOST, with_rings, worst_spots


def test_the_worst_come_first_and_none_beside_another():
    difference = np.random.default_rng(3).normal(0.0, 0.01, (60, 90)).astype(np.float32)
    difference[10, 20], difference[11, 21], difference[40, 70] = -2.0, 1.9, 1.0
    difference[5, 80] = 1e30
    assert worst_spots(difference) == ((20, 10), (70, 40)), "what only one picture hits is told without rings"
    assert difference[10, 20] == -2.0, "the difference stays"
    difference[50, 10] = 2.0 * LEAST - 0.01
    assert len(worst_spots(difference)) == 2
    assert worst_spots(np.zeros((4, 4), np.float32)) == worst_spots(np.zeros((0, 0), np.float32)) == ()
    assert len(worst_spots(np.random.default_rng(1).normal(size=(99, 99)).astype(np.float32))) == MOST


def test_modes_that_differ_are_marked_where_they_are_few():
    difference = np.zeros((80, 80), np.float32)
    difference[10:12, 10:12] = difference[60, 5] = 1.0
    assert set(worst_spots(difference, classes=True)) == {(10, 10), (5, 60)}
    difference[::9, ::9] = 1.0
    assert worst_spots(difference, classes=True) == ()


def test_rings_leave_what_they_mark():
    picture = np.full((120, 160, 3), 90, np.uint8)
    drawn = with_rings(picture, ((50, 40), (0, 119)))
    changed = (drawn != picture).any(axis=-1)
    assert changed.any() and not changed[39:42, 49:52].any() and not changed[119, 0]
    assert (drawn == 255).any() and (drawn == 0).any() and (picture == 90).all()
    rows, columns = np.nonzero(changed[:100])
    assert np.hypot(rows - 40, columns - 50).max() < 8
    assert with_rings(picture, ()) is picture
