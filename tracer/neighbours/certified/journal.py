"""Undo what a frame has certified, so that a cancelled frame leaves cells as they were.

The journal keeps the rows of old cells and owners before a frame changes them.  New cells, and new lists of names, are
at the end of their arrays, where the next frame writes over them.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from tracer.neighbours.certified.cells import LEAF, ROOTS, Cells
from tracer.neighbours.certified.tasks import KEPT, Tasks


class Journal:
    """What changes from now on: `note_owners` and `note_cells` come before each change."""

    def __init__(self, cells: Cells) -> None:
        self._used, self._named = int(cells.used[0]), int(cells.named[0])
        self._before: list[tuple[str, Any, NDArray]] = []  # what was in some places of an array of cells, by its name

    def note_owners(self, cells: Cells, owners: NDArray[np.int64]) -> None:
        """The roots of these owners (k,) may be made, and points are counted that request them."""
        sides = owners >> 1, ROOTS + (owners & 1)
        self._note(cells, owners, "waiting")
        self._note(cells, sides[0], "rooted")
        self._note(cells, sides, "receivers")

    def note_cells(self, cells: Cells, tasks: Tasks) -> None:
        """The results of tasks change the tasks' cells and, where they certify, all below these."""
        certified = (tasks.state != KEPT).any(axis=1)
        number = np.concatenate([tasks.cell, _below(cells, tasks.cell[certified])]).astype(np.int64)
        self._note(cells, number[number < self._used], "words", "child", "requests", "lists")

    def _note(self, cells: Cells, places: Any, *names: str) -> None:
        self._before += [(name, places, _whole(cells, name)[places]) for name in names]

    def undo(self, cells: Cells) -> None:
        """Put back what was noted, the newest first, and forget cells that are new."""
        for name, places, values in reversed(self._before):
            _whole(cells, name)[places] = values
        cells.used[0], cells.named[0] = self._used, self._named


def _whole(cells: Cells, name: str) -> NDArray:
    """An array of cells, that of receivers as whole numbers, which is what roots are."""
    return getattr(cells, name).view(np.int32) if name == "receivers" else getattr(cells, name)


def _below(cells: Cells, roots: NDArray[np.int32]) -> NDArray[np.int32]:
    """All cells (k,) int32 that these are divided into."""
    found: list[NDArray[np.int32]] = [np.empty(0, np.int32)]
    while len(roots):
        child = cells.child[roots]
        roots = np.add.outer(child[child > LEAF], np.arange(4, dtype=np.int32)).reshape(-1)
        found.append(roots)
    return np.concatenate(found)
