"""Undo what a frame has certified, so that a cancelled frame leaves cells as they were.

The journal keeps the rows of old cells and owners before a frame changes them.  New cells, and new lists of names, are
at the end of their arrays, where the next frame writes over them.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.neighbours.certified.cells import LEAF, ROOTS, Cells
from tracer.neighbours.certified.tasks import KEPT, Tasks


class _Rows(NamedTuple):
    """What rows of cells held, by number."""

    number: NDArray[np.int64]
    words: NDArray[np.unsignedinteger]
    child: NDArray[np.int32]
    requests: NDArray[np.int32]
    lists: NDArray[np.int32]


class _Owners(NamedTuple):
    """What was known of owners, by number."""

    number: NDArray[np.int64]
    waiting: NDArray[np.int32]
    root: NDArray[np.int32]
    rooted: NDArray[np.int32]


class Journal:
    """What changes from now on: `note_owners` and `note_cells` come before each change."""

    def __init__(self, cells: Cells) -> None:
        self._used, self._named = int(cells.used[0]), int(cells.named[0])
        self._rows: list[_Rows] = []
        self._owners: list[_Owners] = []

    def note_owners(self, cells: Cells, owners: NDArray[np.int64]) -> None:
        """The roots of these owners (k,) may be made, and points are counted that request them."""
        roots = cells.receivers.view(np.int32)[owners >> 1, ROOTS + (owners & 1)]
        self._owners.append(_Owners(owners, cells.waiting[owners], roots, cells.rooted[owners >> 1]))

    def note_cells(self, cells: Cells, tasks: Tasks) -> None:
        """The results of tasks change the tasks' cells and, where they certify, all below these."""
        certified = (tasks.state != KEPT).any(axis=1)
        number = np.concatenate([tasks.cell, _below(cells, tasks.cell[certified])]).astype(np.int64)
        number = number[number < self._used]
        self._rows.append(
            _Rows(number, cells.words[number], cells.child[number], cells.requests[number], cells.lists[number])
        )

    def undo(self, cells: Cells) -> None:
        """Put back what was noted, the newest first, and forget cells that are new."""
        for rows in reversed(self._rows):
            cells.words[rows.number], cells.child[rows.number] = rows.words, rows.child
            cells.requests[rows.number], cells.lists[rows.number] = rows.requests, rows.lists
        for owners in reversed(self._owners):
            sides = owners.number >> 1, ROOTS + (owners.number & 1)
            cells.waiting[owners.number], cells.rooted[sides[0]] = owners.waiting, owners.rooted
            cells.receivers.view(np.int32)[sides] = owners.root
        cells.used[0], cells.named[0] = self._used, self._named


def _below(cells: Cells, roots: NDArray[np.int32]) -> NDArray[np.int32]:
    """All cells (k,) int32 that these are divided into."""
    found: list[NDArray[np.int32]] = [np.empty(0, np.int32)]
    while len(roots):
        child = cells.child[roots]
        roots = np.add.outer(child[child > LEAF], np.arange(4, dtype=np.int32)).reshape(-1)
        found.append(roots)
    return np.concatenate(found)
