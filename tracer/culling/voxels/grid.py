"""The grid of voxels around all that never moves."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.culling.certified.error_bounds import EPSILON

BLOCK = 8  # voxels along each side of a block, which is classified as a whole first
FINEST, FEWEST = 1 << 21, 1 << 14  # voxels, at most, and those of the smallest scenes
EACH = 6  # voxels for each primitive, about
SHIFT = 0.37  # of a voxel: floors and walls at round numbers are not to lie just between two
ROOM = 0.01  # of a voxel, by which each is taken to be larger, since points are led to theirs in float32
DIGITS = 16 * EPSILON  # of the largest coordinate: more than how far off a shadow ray may be


class VoxelGrid(NamedTuple):
    """nx ny nz voxels, numbered along z, then y, then x.

    Attributes:
        x, y, z: where the grid begins, in units of the scene.
        per_unit: voxels in a unit of length; all four are exact in float32.
        nx, ny, nz: how many there are along each axis, multiples of BLOCK.
    """

    x: float
    y: float
    z: float
    per_unit: float
    nx: int
    ny: int
    nz: int

    @property
    def voxels(self) -> int:
        """How many voxels there are."""
        return self.nx * self.ny * self.nz

    @property
    def side(self) -> float:
        """The side of a voxel."""
        return 1.0 / self.per_unit


def make_grid(bounds: NDArray[np.float64], wanted: int) -> VoxelGrid:
    """A grid of about `wanted` voxels, mostly fewer, around bounds (2, 3), lower and upper corner."""
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
    return VoxelGrid(x, y, z, per_unit, nx, ny, nz)


def voxels_for(primitives: int, bytes_each: int, memory: float) -> int:
    """How many voxels are worth having for so many primitives, in no more than so many bytes of memory."""
    return int(max(BLOCK**3, min(FINEST, max(FEWEST, EACH * primitives), memory / bytes_each)))


def box_of(grid: VoxelGrid, number: int) -> NDArray[np.float64]:
    """The box (6,) of a voxel, as large as it is taken to be."""
    x, yz = divmod(number, grid.ny * grid.nz)
    low = np.array([grid.x, grid.y, grid.z]) + np.array([x, *divmod(yz, grid.nz)]) * grid.side
    room = ROOM * grid.side
    return np.concatenate([low - room, low + grid.side + room])


def voxel_at(grid: VoxelGrid, point: NDArray[np.float32]) -> int:
    """The voxel of a point (3,), -1 for none."""
    at = np.floor((point.astype(np.float64) - (grid.x, grid.y, grid.z)) * grid.per_unit)
    if not ((at >= 0) & (at < (grid.nx, grid.ny, grid.nz))).all():
        return -1
    i, j, k = at.astype(np.int64).tolist()
    return int((i * grid.ny + j) * grid.nz + k)
