"""Where a window should be on the screens that there are."""

from __future__ import annotations

import pytest

pytest.importorskip("imgui_bundle")
from viewer.window.window_place import Rect, brought_back

LEFT, RIGHT, ABOVE = (0, 0, 1600, 1000), (1600, 0, 1920, 1080), (0, -1000, 1600, 1000)
FRAME = (2, 20, 2, 3)


@pytest.mark.parametrize(
    ("place", "screens"),
    [
        ((100, 50, 800, 600), [LEFT]),
        ((-300, 50, 800, 600), [LEFT]),
        ((1200, 50, 800, 600), [LEFT, RIGHT]),
        ((1200, -500, 300, 600), [LEFT, ABOVE]),
        ((5000, 5000, 800, 600), []),
    ],
    ids=["inside", "partly outside", "on two screens", "on one above the other", "no screen at all"],
)
def test_a_window_that_is_seen_stays(place: Rect, screens: list[Rect]) -> None:
    assert brought_back(place, screens) == place


@pytest.mark.parametrize(
    ("place", "screens", "expected"),
    [
        ((5000, 5000, 800, 600), [LEFT], (798, 397, 800, 600)),
        ((1590, 990, 800, 600), [LEFT], (798, 397, 800, 600)),
        ((1700, 100, 800, 600), [LEFT], (798, 100, 800, 600)),
        ((1700, 100, 800, 600), [LEFT, (0, 1000, 1600, 1000)], (798, 100, 800, 600)),
        ((100, -300, 800, 600), [LEFT], (100, 20, 800, 600)),
        ((-9000, -9000, 3000, 2000), [LEFT, RIGHT], (2, 20, 1596, 977)),
        ((9000, 0, 800, 600), [LEFT, RIGHT], (2718, 20, 800, 600)),
    ],
    ids=["far away", "only a corner", "its screen gone", "the nearest", "its bar above", "too large", "from the right"],
)
def test_another_comes_wholly_to_the_nearest(place: Rect, screens: list[Rect], expected: Rect) -> None:
    assert brought_back(place, screens, FRAME) == expected
    assert brought_back(expected, screens, FRAME) == expected
