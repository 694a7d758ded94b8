"""Words beside the pointer: inside, and not over what is taken."""

from __future__ import annotations

import pytest

from viewer.window.panels.area import Rect, beside

SIZE, GAPS, ROOM = (40.0, 20.0), (12.0, 6.0), (0.0, 0.0, 200.0, 100.0)


@pytest.mark.parametrize(
    ("at", "taken", "place"),
    [
        ((50.0, 50.0), None, (62.0, 62.0)),
        ((170.0, 50.0), None, (124.0, 62.0)),
        ((50.0, 90.0), None, (62.0, 64.0)),
        ((195.0, 95.0), None, (149.0, 69.0)),
        ((50.0, 50.0), (100.0, 70.0, 200.0, 100.0), (4.0, 62.0)),  # a legend on the right
        ((60.0, 50.0), (0.0, 65.0, 200.0, 100.0), (72.0, 24.0)),  # and one below
        ((170.0, 50.0), (0.0, 60.0, 160.0, 100.0), (124.0, 24.0)),
        ((50.0, 50.0), (60.0, 80.0, 200.0, 100.0), (4.0, 62.0)),
        ((50.0, 50.0), (62.0, 82.0, 200.0, 100.0), (62.0, 62.0)),  # which it only touches
        ((50.0, 50.0), (0.0, 0.0, 200.0, 100.0), (62.0, 62.0)),  # all is taken
        ((20.0, 50.0), (50.0, 60.0, 200.0, 100.0), (32.0, 24.0)),  # there is no room on the left
    ],
)
def test_words_stand_where_they_hide_nothing(at: tuple[float, float], taken: Rect | None, place: tuple[float, float]):
    assert beside(at, SIZE, GAPS, ROOM, taken) == place


def test_words_that_fit_nowhere_begin_where_they_can_be_read():
    assert beside((50.0, 50.0), (300.0, 20.0), GAPS, ROOM) == (0.0, 24.0)
