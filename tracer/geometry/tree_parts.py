"""What of a tree that is built where rays arrive lies at points of space: what is there by now, and what waits.

Reading builds nothing, and may happen while rays build: a part is there as a whole or not at all.
"""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

NOWHERE = -1  # the number of no part
OUTSIDE = 0.005  # of all primitives: so many may lie beyond each side of what most are in


class PartsAt(NamedTuple):
    """Of n points, the smallest part of a tree that is known around each.

    numbers (n,) int64, the same for points in one part, NOWHERE for points in none; owners (n,) int32, the object, or
    the piece of a large tree, that the part belongs to, -1 for neither; levels (n,) uint8 below the root; built (n,)
    uint8, 0 for a part that waits for its first ray; widths (n,) float32, the shorter side of the part across the axis
    that is asked for; held (n,) int32, how many primitives are in a leaf, -1 for what is none."""

    numbers: NDArray[np.int64]
    owners: NDArray[np.int32]
    levels: NDArray[np.uint8]
    built: NDArray[np.uint8]
    widths: NDArray[np.float32]
    held: NDArray[np.int32]


class TreeParts(Protocol):
    """A tree as a frame found it, with objects where they were then; it goes on being built, and it is let go of with
    its world, whoever keeps the frame: `alive` says that it has not been.

    `name` is that of the structure, `owner` the word for what owners are, `levels` is about how many levels there are
    where all is built, and `extent` (6,) float32 lies around most of it (`most_of`)."""

    name: str
    owner: str
    levels: int

    @property
    def alive(self) -> bool: ...

    @property
    def extent(self) -> NDArray[np.float32]: ...

    def at(self, points: NDArray[np.float32], across: int) -> PartsAt | None:
        """What lies at points (n, 3) float32, NaN for none, with widths across an axis, 0 to 2; None if the tree is no
        more."""


def most_of(boxes: NDArray[np.float32], weights: NDArray) -> NDArray[np.float32]:
    """The box (6,) around boxes (n, 6) but for those at its sides that hold no more than the part OUTSIDE of all
    weights (n,): a floor without an end is not what a model is as large as.  Zeros for no boxes."""
    found = np.zeros(6, np.float32)
    if len(boxes) == 0:
        return found
    for k in range(6):
        order = np.argsort(boxes[:, k] if k < 3 else -boxes[:, k], kind="stable")
        found[k] = boxes[order[np.searchsorted(np.cumsum(weights[order]), OUTSIDE * weights.sum())], k]
    return found


def nothing_at(n: int) -> PartsAt:
    """Where nothing has been found yet at n points."""
    return PartsAt(
        np.full(n, NOWHERE, np.int64),
        np.full(n, -1, np.int32),
        np.zeros(n, np.uint8),
        np.zeros(n, np.uint8),
        np.zeros(n, np.float32),
        np.full(n, -1, np.int32),
    )
