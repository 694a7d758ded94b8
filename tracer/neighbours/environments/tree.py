"""The octree of cells that environments are kept for: where its cells are, which are divided, and which are open."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tracer.neighbours.environments.octree import OUTSIDE, ROOT, Frame, make_frame

EACH = 34  # bytes of a cell, here


class CellTree:
    """Cells within bounds (2, 3), of which there is a root at first, and the cell of what is outside.

    `child` is the first of a cell's eight children, 0 for none; `open` cells are not settled yet; rays have ended in
    those that are `wanted`; `cells` (n, 4) are where they begin, in the smallest cells, and their level; `todo` has the
    bits of lights that are to be settled.  Of each array the first `count` are in use."""

    def __init__(self, bounds: NDArray[np.float64]) -> None:
        self.frame: Frame = make_frame(bounds)
        self.begin()

    def begin(self) -> None:
        """Begin anew."""
        n, self.count = 1024, 2
        self.child, self.open, self.wanted = np.zeros(n, np.int32), np.zeros(n, np.bool_), np.zeros(n, np.bool_)
        self.cells, self.parent = np.zeros((n, 4), np.int32), np.zeros(n, np.int32)
        self.todo = np.zeros(n, np.int64)
        self.cells[ROOT, 3] = self.frame.levels
        self.open[ROOT], self.todo[ROOT] = True, -1

    @property
    def room(self) -> int:
        """How many cells there is room for."""
        return len(self.child)

    @property
    def bytes(self) -> int:
        """Memory that the cells take, in bytes."""
        return EACH * self.count

    def leaves_open(self, bits: int) -> None:
        """All leaves are to be settled again, for the lights with these bits."""
        self.todo[: self.count] |= bits
        self.open[: self.count] |= self.child[: self.count] == 0
        self.open[OUTSIDE] = False

    def divide(self, cells: NDArray[np.int64]) -> None:
        """Divide leaves (n,) into eight children each, of which nothing is known yet."""
        first = self.count + 8 * np.arange(len(cells))
        self._grow(self.count + 8 * len(cells))
        self.child[cells] = first
        children = (first[:, None] + np.arange(8)).reshape(-1)
        level = np.repeat(self.cells[cells, 3] - 1, 8)
        octant = np.tile(np.arange(8), len(cells))
        bits = np.stack([octant >> 2, octant >> 1 & 1, octant & 1], 1)
        self.cells[children, :3] = np.repeat(self.cells[cells, :3], 8, axis=0) + (bits << level[:, None])
        self.cells[children, 3] = level
        self.parent[children] = np.repeat(cells, 8)
        self.open[children], self.todo[children] = True, -1
        self.count += len(children)

    def _grow(self, count: int) -> None:
        if count > self.room:
            room = max(count, 2 * self.room)
            for name in ("child", "open", "wanted", "cells", "parent", "todo"):
                setattr(self, name, lengthened(getattr(self, name), room, 0))

    def leaf_at(self, point: NDArray[np.float32]) -> int:
        """The leaf in which a point (3,) lies; OUTSIDE for none."""
        return int(self.leaves_at(point[None])[0])

    def leaves_at(self, points: NDArray[np.float32]) -> NDArray[np.int64]:
        """The leaves (n,) in which points (n, 3) lie, OUTSIDE for none."""
        frame = self.frame
        at = np.floor((points.astype(np.float64) - (frame.x, frame.y, frame.z)) * frame.per_unit)
        there = ((at >= 0) & (at < 2**frame.levels)).all(1)
        i, j, k = np.where(there[:, None], at, 0.0).astype(np.int64).T
        cell = np.where(there, ROOT, OUTSIDE)
        for level in range(frame.levels - 1, -1, -1):
            first = self.child[cell]
            octant = 4 * (i >> level & 1) + 2 * (j >> level & 1) + (k >> level & 1)
            cell = np.where(first > 0, first + octant, cell)
        return cell


def lengthened(array: NDArray, count: int, fill: int) -> NDArray:
    """The array with so many rows, the new ones filled."""
    more = np.full((count - len(array), *array.shape[1:]), fill, array.dtype)
    return np.concatenate([array, more])


def room_for(array: NDArray[np.int32], count: int) -> NDArray[np.int32]:
    """The array, or a longer one that begins with it."""
    return array if count <= len(array) else lengthened(array, max(count, 2 * len(array)), 0)
