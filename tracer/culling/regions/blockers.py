"""Blockers: the triangles that are large enough to hide lights from a whole region.

Only geometry that never moves is taken, so that what blockers hide stays hidden.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Float64 = NDArray[np.float64]

MOST = 8192  # blockers of a scene, the largest triangles
LANES = 16


class Blockers(NamedTuple):
    """n triangles, those close together next to each other.  Points of a plane have two coordinates, along its axes.

    Attributes:
        frames: (n, 3, 4) float64: rows that take (x, y, z, 1) to the two coordinates and to the height above the plane.
        boxes: (n, 4) float64, the lower and the upper corner around the triangle in its plane.
        sides: (n, 3, 3) float64: for each side the unit normal inwards, and what to add for a point's distance from it.
        shapes: (n, 3) float64, what errors grow with: |e1| + |e2| and |e1||e2| over the length of the normal, and the
            longest side.
        numbers: (n,) int32, of the triangles.
        filters: (n / 16, 16, 16) float32, frames (the first 12) and boxes by column, of sixteen blockers at a time;
            those past n are empty.
        around: (n / 256, 6, 16) float32, the lower and upper corners of boxes around groups of sixteen blockers,
            sixteen groups at a time; those of nothing are NaN.
    """

    frames: Float64
    boxes: Float64
    sides: Float64
    shapes: Float64
    numbers: NDArray[np.int32]
    filters: NDArray[np.float32]
    around: NDArray[np.float32]


def find_blockers(triangles: NDArray[np.float32]) -> Blockers:
    """The blockers among triangles (t, 9), corner and two edges."""
    rows = triangles.astype(np.float64)
    across = np.linalg.norm(np.cross(rows[:, 3:6], rows[:, 6:]), axis=1)
    numbers = np.argsort(-across, kind="stable")[:MOST]
    numbers = numbers[across[numbers] > 0.0]
    numbers = numbers[_halved(rows[numbers, :3] + (rows[numbers, 3:6] + rows[numbers, 6:]) / 3.0)]
    corner, e1, e2 = (rows[numbers, k : k + 3] for k in (0, 3, 6))
    across, n = across[numbers, None], len(numbers)

    # Axes in each plane: along an edge at the corner that is nearest to a right angle, so that walls lie along them.
    first, second, third = (np.linalg.norm(e, axis=1) for e in (e1, e2, e2 - e1))
    longest = np.maximum(np.maximum(first, second), third)
    w = np.cross(e1, e2) / across
    u = np.where((first == longest)[:, None], e2, e1)
    u /= np.linalg.norm(u, axis=1, keepdims=True)
    frames = np.empty((n, 3, 4))
    frames[:, :, :3] = np.stack([u, np.cross(w, u), w], 1)
    frames[:, :, 3] = -np.einsum("nij,nj->ni", frames[:, :, :3], corner)
    local = np.zeros((n, 3, 2))
    for k, edge in ((1, e1), (2, e2)):
        local[:, k] = np.einsum("nij,nj->ni", frames[:, :2, :3], edge)

    # Corners go around counter-clockwise, so that the inside is on the left of each side.
    way = np.roll(local, -1, axis=1) - local
    inwards = np.stack([-way[..., 1], way[..., 0]], -1) / np.linalg.norm(way, axis=2)[..., None]
    sides = np.concatenate([inwards, -(inwards * local).sum(-1, keepdims=True)], 2)
    boxes = np.concatenate([local.min(1), local.max(1)], 1)
    shapes = np.stack([(first + second) / across[:, 0], first * second / across[:, 0], longest], 1)

    every = np.stack([corner, corner + e1, corner + e2], 1)
    filters = _by_column(np.concatenate([frames.reshape(n, 12), boxes], 1), 0.0)
    return Blockers(
        frames, boxes, sides, shapes, numbers.astype(np.int32), filters, _around(every.min(1), every.max(1))
    )


def _halved(places: Float64) -> NDArray[np.int64]:
    """An order of places (n, 3) in which sixteen that follow each other are close: halved again and again."""
    order, waiting = np.arange(len(places)), [(0, len(places))]
    while waiting:
        first, last = waiting.pop()
        if last - first > LANES:
            here = order[first:last]
            axis = int(np.argmax(np.ptp(places[here], axis=0)))
            order[first:last] = here[np.argsort(places[here, axis], kind="stable")]
            middle = first + LANES * max(1, (last - first) // (2 * LANES))
            waiting += [(first, middle), (middle, last)]
    return order


def _by_column(rows: Float64, nothing: float) -> NDArray[np.float32]:
    """Rows (n, k), sixteen at a time, column by column: (n / 16, k, 16) float32, filled up with `nothing`."""
    n, k = rows.shape
    padded = np.full((-(-n // LANES) * LANES, k), nothing, np.float32)
    padded[:n] = rows
    return np.ascontiguousarray(padded.reshape(-1, LANES, k).transpose(0, 2, 1))


def _around(low: Float64, high: Float64) -> NDArray[np.float32]:
    """Boxes (n / 256, 6, 16) around groups of sixteen boxes, a little larger."""
    groups = np.arange(0, len(low), LANES)
    if not len(groups):
        return np.empty((0, 6, LANES), np.float32)
    low, high = np.minimum.reduceat(low, groups), np.maximum.reduceat(high, groups)
    room = 1e-5 * np.maximum(np.abs(low), np.abs(high)).max()
    return _by_column(np.concatenate([low - room, high + room], 1), np.nan)
