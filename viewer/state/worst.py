"""Where two pictures are furthest apart: a few spots to look at, and rings around them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from viewer.state.comparison import ENDLESS

MOST = 5
"""Spots that are marked, at most."""
LEAST = 0.25
"""Of the largest difference: what is smaller is not marked."""
RING = (1.0, 1.0, 1.0)
"""The colour of rings."""

Spot = tuple[int, int]


def worst_spots(difference: NDArray[np.float32], classes: bool = False) -> tuple[Spot, ...]:
    """Column and row of the pixels that differ most, the worst first, and none near another, of a difference (h, w).

    Differences without end, of what only one picture hits, are none of them.  Of `classes`, which differ or do not, all
    spots are found, or none where there are more than can be marked: these are seen without marks."""
    height, width = difference.shape
    size = np.abs(difference)
    size[~(size < ENDLESS)] = 0.0
    near = max(4, max(width, height) // 24)
    spots: list[Spot] = []
    worst = 0.0
    while size.size:
        y, x = divmod(int(size.argmax()), width)
        found = float(size[y, x])
        if found <= LEAST * worst or len(spots) == MOST:
            return () if classes and found > 0.0 else tuple(spots)
        worst = worst or found
        spots.append((x, y))
        size[max(0, y - near) : y + near + 1, max(0, x - near) : x + near + 1] = 0.0
    return ()


def with_rings(picture: NDArray[np.uint8], spots: tuple[Spot, ...]) -> NDArray[np.uint8]:
    """A picture (h, w, 3) with a ring around each spot, dark and light, so that it is seen on any ground."""
    if not spots:
        return picture
    height, width = picture.shape[:2]
    side, found = max(width, height), picture.copy()
    radius, thickness = max(3.0, side / 120.0), max(1.0, side / 700.0)
    rows, columns = np.arange(height)[:, None], np.arange(width)[None]
    for x, y in spots:
        off = np.abs(np.hypot(columns - x, rows - y) - radius)
        found[off <= 1.5 * thickness] = 0
        found[off <= 0.5 * thickness] = np.round(np.multiply(255.0, RING))
    return found
