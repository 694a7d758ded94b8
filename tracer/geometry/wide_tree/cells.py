"""Triangles sorted by cells of a grid: what a large tree is divided by before any of it is built.

A cell holds the triangles the centres of whose boxes lie in it, and its box is around all of these.  One that holds too
many gets a grid of its own.  To sort triangles so takes three passes over them, where splitting them by planes takes
several passes for each level of a tree.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.geometry.boxes import interval
from tracer.geometry.building import CANCELLED, CHUNK, in_chunks
from tracer.runtime.kernels import kernel
from tracer.scene.arrays import Float32
from tracer.scene.model import Cancelled

IN_A_CELL, MOST_CELLS, FEWEST_CELLS = 64, 1 << 18, 8  # triangles, about; cells of one grid
FINEST = 1024  # cells along an axis
PART = 1 << 18  # triangles that are sorted before somebody may cancel
UNBOUNDED = np.array([np.inf] * 3 + [-np.inf] * 3, np.float32)
NO_EXTENT = np.float32(1e-30)  # centres closer together than this cannot be told apart


class Cells(NamedTuple):
    """m cells that hold something: `order` (n,) int32, the numbers of triangles, cell by cell; starts (m + 1,) int64,
    where those of each begin; boxes (m, 6) float32 around them."""

    order: NDArray[np.int32]
    starts: NDArray[np.int64]
    boxes: Float32


@kernel
def bound_centres(rows, order, first, last, bounds):
    """The least and the greatest centres, doubled, of triangles order[first] to order[last - 1], into bounds (6,)."""
    for axis in range(3):
        least, greatest = np.float32(np.inf), np.float32(-np.inf)
        for i in range(first, last):
            low, high = interval(rows, order[i], axis)
            least, greatest = min(least, low + high), max(greatest, low + high)
        bounds[axis], bounds[axis + 3] = least, greatest


@kernel
def find_cells(rows, order, first, last, low, scale, shape, cells):
    """The cells of triangles order[first] to order[last - 1], into cells[first] to cells[last - 1], in a grid of
    `shape` (3,) that begins at `low` and has `scale` cells to a unit, (3,) float32."""
    for i in range(first, last):
        cell = 0
        for axis in range(3):
            a, b = interval(rows, order[i], axis)
            place = int((a + b - low[axis]) * scale[axis])
            cell = cell * shape[axis] + min(max(place, 0), shape[axis] - 1)
        cells[i] = cell


@kernel
def count_in_cells(cells, first, last, starts):
    """Count triangles first to last - 1 in starts (m + 1,), each one behind its cell."""
    for i in range(first, last):
        starts[cells[i] + 1] += 1


@kernel
def sort_by_cell(rows, order, cells, first, last, base, ends, boxes, sorted_):
    """Put order[first] to order[last - 1] into `sorted_` by their cells, of which the next one of each goes to the
    place that ends (m,) says, counted from `base`; boxes (m, 6) grow around them."""
    for i in range(first, last):
        cell, triangle = cells[i], order[i]
        sorted_[base + ends[cell]] = triangle
        ends[cell] += 1
        for k in range(3):
            low, high = interval(rows, triangle, k)
            boxes[cell, k], boxes[cell, k + 3] = min(boxes[cell, k], low), max(boxes[cell, k + 3], high)


def _shape(extent: Float32, count: int) -> NDArray[np.int64]:
    """How many cells of about the same sides a grid over so many triangles has along each axis."""
    most = min(max(count // IN_A_CELL, FEWEST_CELLS), MOST_CELLS)
    sides = extent.astype(np.float64)
    side = sides.max() / FINEST
    while True:
        shape = np.clip(np.ceil(sides / max(side, 1e-300)), 1, FINEST)
        if shape.prod() <= most:
            return np.maximum(shape, np.where(sides == sides.max(), 2, 1)).astype(np.int64)
        side *= 1.1


def _parts(first: int, last: int, control: NDArray[np.int64]) -> Iterator[tuple[int, int]]:
    for start in range(first, last, PART):
        if control[CANCELLED]:
            raise Cancelled
        yield start, min(start + PART, last)


def cells_over(rows: Float32, most: int, control: NDArray[np.int64], threads: int = 1) -> Cells:
    """Sort triangles (n, 9), corner and two edges, into cells of at most so many each, where their centres differ.

    control (2,) int64: raises Cancelled once control[CANCELLED] is set."""
    n = len(rows)
    order, cells, scratch = np.arange(n, dtype=np.int32), np.empty(n, np.int32), np.empty(n, np.int32)
    found: list[tuple[NDArray[np.int64], Float32]] = [(np.empty(0, np.int64), np.empty((0, 6), np.float32))]
    waiting = [(0, n)] if n else []
    while waiting:
        first, last = waiting.pop()
        count = last - first
        # Lay a grid over the centres.
        parts = np.empty((-(-count // CHUNK), 6), np.float32)

        def bound(a: int, b: int, first: int = first, parts: Float32 = parts) -> None:
            bound_centres(rows, order, first + a, first + b, parts[a // CHUNK])

        in_chunks(bound, count, control, threads)
        low, high = parts[:, :3].min(0), parts[:, 3:].max(0)
        extent = high - low
        together = not (extent.max() > NO_EXTENT)
        shape = np.ones(3, np.int64) if together else _shape(extent, count)
        scale = np.zeros(3, np.float32)
        np.divide(shape.astype(np.float32), extent, out=scale, where=extent > NO_EXTENT)

        def find(
            a: int, b: int, first: int = first, low: Float32 = low, scale: Float32 = scale, shape: NDArray = shape
        ) -> None:
            find_cells(rows, order, first + a, first + b, low, scale, shape, cells)

        in_chunks(find, count, control, threads)
        # Sort them, and take cells that hold too many again.
        starts = np.zeros(shape.prod() + 1, np.int64)
        for a, b in _parts(first, last, control):
            count_in_cells(cells, a, b, starts)
        np.cumsum(starts, out=starts)
        ends, boxes = starts[:-1].copy(), np.repeat(UNBOUNDED[None], shape.prod(), axis=0)
        for a, b in _parts(first, last, control):
            sort_by_cell(rows, order, cells, a, b, first, ends, boxes, scratch)
        order[first:last] = scratch[first:last]
        counts = np.diff(starts)
        again = (counts > most) & (counts < count) & (not together)
        waiting += [(first + int(starts[c]), first + int(starts[c + 1])) for c in np.flatnonzero(again)]
        kept = (counts > 0) & ~again
        found.append((first + starts[:-1][kept], boxes[kept]))
    begin, around = np.concatenate([f[0] for f in found]), np.concatenate([f[1] for f in found])
    sequence = np.argsort(begin)
    return Cells(order, np.append(begin[sequence], n), np.ascontiguousarray(around[sequence]))
