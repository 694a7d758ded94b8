"""The grid that divides a scene into regions: cubes, of which few are ever looked at."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tracer.geometry.boxes import OUTWARDS
from tracer.visibility.grid import SHIFT, Grid, boxes_of, index_of

FINEST, MOST = 256, 1 << 24  # regions along the longest side, and in all, at most
ROOM = 1e-3  # of a region, by which each is taken to be larger: points are led to theirs in float32


def make_grid(bounds: NDArray[np.float64]) -> Grid:
    """A grid around bounds (2, 3), lower and upper corner."""
    extent = np.maximum(bounds[1] - bounds[0], 1e-30)
    side = max(extent.max() / FINEST, (np.prod(np.maximum(extent, extent.max() / FINEST)) / MOST) ** (1 / 3))
    low = bounds[0] - SHIFT * side
    nx, ny, nz = (int(n) for n in np.floor((bounds[1] - low) / side) + 1)
    x, y, z = low.tolist()
    return Grid(x, y, z, 1.0 / side, nx, ny, nz)


def region_boxes(grid: Grid, numbers: NDArray[np.int64], times: int = 1) -> NDArray[np.float64]:
    """`boxes_of` regions (k,), or of blocks of them, with room for all points that are led to them."""
    boxes = boxes_of(grid, numbers, ROOM, times)
    return boxes + 1e-6 * np.abs(boxes).max(1, keepdims=True, initial=0.0) * OUTWARDS


def blocks_around(grid: Grid, numbers: NDArray[np.int64], times: int) -> NDArray[np.int64]:
    """A number (k,) for the block of so many regions on a side that each of regions (k,) lies in."""
    x, y, z = index_of(grid, numbers)
    return ((x // times) * grid.ny + y // times) * grid.nz + z // times
