"""Where words are put beside the pointer."""

from __future__ import annotations

Pair = tuple[float, float]
Rect = tuple[float, float, float, float]
"""Left, upper, right and lower edge."""


def beside(at: Pair, size: Pair, gaps: Pair, room: Rect, taken: Rect | None = None) -> Pair:
    """The left and the upper edge of what is so large and stands beside a point.

    It stands to the right and below by the first of the gaps, or else to the left or above by the second, wherever it
    fits into the room and covers nothing that is taken; where all of that would, it covers it all the same."""
    (x, y), (width, height), (after, before) = at, size, gaps
    lefts, tops = (x + after, x - before - width), (y + after, y - before - height)
    places = [(left, top) for top in tops for left in lefts if _inside((left, top), size, room)]
    if not places:
        return max(lefts[1], room[0]), max(tops[1], room[1])
    free = [place for place in places if taken is None or not _meets(place, size, taken)]
    return (free or places)[0]


def _inside(place: Pair, size: Pair, room: Rect) -> bool:
    left, top, right, lower = room
    return place[0] >= left and place[1] >= top and place[0] + size[0] <= right and place[1] + size[1] <= lower


def _meets(place: Pair, size: Pair, taken: Rect) -> bool:
    left, top, right, lower = taken
    return place[0] < right and place[0] + size[0] > left and place[1] < lower and place[1] + size[1] > top
