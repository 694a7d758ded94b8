"""The grid that divides a scene into regions: cubes, of which few are ever looked at."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.simd.records import I32, Bytes

FINEST, MOST = 256, 1 << 24  # regions along the longest side, and in all, at most
SHIFT = 0.37  # of a region: floors and walls at round numbers are not to lie just between two
ROOM = 1e-3  # of a region, by which each is taken to be larger: points are led to theirs in float32


class Grid(NamedTuple):
    """Regions, numbered along z, then y, then x.

    Attributes:
        x, y, z: where the grid begins, in units of the scene.
        per_unit: regions in a unit of length.
        nx, ny, nz: how many there are along each axis.
        certified: (nx ny nz,) int32, 1 more than the number of each region's list of lights; 0 while there is none.
        wanted: (nx ny nz,) bool, regions in which rays have ended that had no list.
    """

    x: float
    y: float
    z: float
    per_unit: float
    nx: int
    ny: int
    nz: int
    certified: I32
    wanted: Bytes


def make_grid(bounds: NDArray[np.float64]) -> Grid:
    """A grid around bounds (2, 3), lower and upper corner."""
    extent = np.maximum(bounds[1] - bounds[0], 1e-30)
    side = max(extent.max() / FINEST, (np.prod(np.maximum(extent, extent.max() / FINEST)) / MOST) ** (1 / 3))
    low = bounds[0] - SHIFT * side
    nx, ny, nz = (int(n) for n in np.floor((bounds[1] - low) / side) + 1)
    # Memory that nobody has touched is not taken.
    x, y, z = low.tolist()
    certified, wanted = np.zeros(nx * ny * nz, np.int32), np.zeros(nx * ny * nz, np.bool_)
    return Grid(x, y, z, 1.0 / side, nx, ny, nz, certified, wanted)


def boxes_of(grid: Grid, numbers: NDArray[np.int64], times: int = 1) -> NDArray[np.float64]:
    """Boxes (k, 6), lower and upper corner, of regions (k,), or of blocks of so many regions on a side around them."""
    x, yz = np.divmod(numbers, grid.ny * grid.nz)
    y, z = np.divmod(yz, grid.nz)
    low = np.stack([x, y, z], 1) // times * times / grid.per_unit + np.array([grid.x, grid.y, grid.z])
    side = times / grid.per_unit
    room = ROOM / grid.per_unit + 1e-6 * np.abs(low).max(1, keepdims=True, initial=0.0)
    return np.concatenate([low - room, low + side + room], 1)


def blocks_around(grid: Grid, numbers: NDArray[np.int64], times: int) -> NDArray[np.int64]:
    """A number (k,) for the block of so many regions on a side that each of regions (k,) lies in."""
    x, yz = np.divmod(numbers, grid.ny * grid.nz)
    y, z = np.divmod(yz, grid.nz)
    return ((x // times) * grid.ny + y // times) * grid.nz + z // times


def region_at(grid: Grid, point: NDArray[np.float32]) -> int:
    """The region of a point (3,), -1 for none."""
    at = np.floor((point.astype(np.float64) - (grid.x, grid.y, grid.z)) * grid.per_unit).astype(np.int64)
    if (at < 0).any() or (at >= (grid.nx, grid.ny, grid.nz)).any():
        return -1
    return int((at[0] * grid.ny + at[1]) * grid.nz + at[2])
