"""The grid of voxels around all that never moves."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tracer.visibility.grid import DIGITS, SHIFT, Grid

BLOCK = 8  # voxels along each side of a block, which is classified as a whole first
FINEST, FEWEST = 1 << 21, 1 << 14  # voxels, at most, and those of the smallest scenes
EACH = 6  # voxels for each primitive, about
ROOM = 0.01  # of a voxel, by which each is taken to be larger, since points are led to theirs in float32


def make_grid(bounds: NDArray[np.float64], wanted: int) -> Grid:
    """A grid of about `wanted` voxels, mostly fewer, around bounds (2, 3), lower and upper corner.

    Its sides are multiples of BLOCK, and where it begins is exact in float32."""
    extent, largest = np.maximum(bounds[1] - bounds[0], 1e-30), float(np.abs(bounds).max())
    extent = np.maximum(extent, 1e-3 * extent.max())
    side = float((np.prod(extent) / max(wanted, BLOCK**3)) ** (1 / 3))
    side = max(side, 4.0 * DIGITS * largest / ROOM, float(extent.max()) / 1024, 1e-30)
    for _ in range(64):  # until so many fit, blocks being whole
        per_unit = float(np.float32(1.0 / side))
        low = (bounds[0] - SHIFT * side).astype(np.float32)
        sides = (np.floor((bounds[1] - low) * per_unit + 0.5) + 1).astype(np.int64)
        nx, ny, nz = (int(n) for n in -(-sides // BLOCK) * BLOCK)
        if nx * ny * nz <= max(wanted, BLOCK**3):
            break
        side *= 1.05
    x, y, z = low.tolist()
    return Grid(x, y, z, per_unit, nx, ny, nz)


def voxels_for(primitives: int, bytes_each: int, memory: float) -> int:
    """How many voxels are worth having for so many primitives, in no more than so many bytes of memory."""
    return int(max(BLOCK**3, min(FINEST, max(FEWEST, EACH * primitives), memory / bytes_each)))
