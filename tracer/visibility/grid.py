"""A grid of equal cubes around a scene, and in which of them points lie.

Points are led to their cubes in float32.  So each cube is taken to be a little larger, and `DIGITS` of the largest
coordinate is to be far less than that.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.runtime.kernels import inlined
from tracer.simd import i32x16, select, to_i32
from tracer.visibility.error_bounds import EPSILON, ZERO

SHIFT = 0.37  # of a cube: floors and walls at round numbers are not to lie just between two
DIGITS = 16 * EPSILON  # of the largest coordinate: more than how far off a shadow ray may be


class Grid(NamedTuple):
    """nx ny nz cubes, numbered along z, then y, then x.

    Attributes:
        x, y, z: where the grid begins, in units of the scene.
        per_unit: cubes in a unit of length.
        nx, ny, nz: how many there are along each axis.
    """

    x: float
    y: float
    z: float
    per_unit: float
    nx: int
    ny: int
    nz: int

    @property
    def cubes(self) -> int:
        """How many cubes there are."""
        return self.nx * self.ny * self.nz

    @property
    def side(self) -> float:
        """The side of a cube."""
        return 1.0 / self.per_unit

    @property
    def around(self) -> NDArray[np.float64]:
        """Lower and upper corner (2, 3) of all cubes together."""
        low = np.array([self.x, self.y, self.z])
        return np.stack([low, low + np.array([self.nx, self.ny, self.nz]) * self.side])


def boxes_of(grid: Grid, numbers: NDArray[np.int64], room: float, times: int = 1) -> NDArray[np.float64]:
    """Boxes (k, 6), lower and upper corner, of cubes (k,), larger by `room` of a cube; or of blocks of so many cubes on
    a side around them."""
    x, y, z = index_of(grid, numbers)
    low = np.stack([x, y, z], 1) // times * times * grid.side + np.array([grid.x, grid.y, grid.z])
    return np.concatenate([low - room * grid.side, low + (times + room) * grid.side], 1)


def index_of(grid: Grid, number: Any) -> tuple[Any, Any, Any]:
    """Which cubes along x, y and z numbers are those of."""
    x, yz = divmod(number, grid.ny * grid.nz)
    return (x, *divmod(yz, grid.nz))


def cube_at(grid: Grid, point: NDArray[np.float32]) -> int:
    """The cube of a point (3,), -1 for none."""
    at = np.floor((point.astype(np.float64) - (grid.x, grid.y, grid.z)) * grid.per_unit)
    if not ((at >= 0) & (at < (grid.nx, grid.ny, grid.nz))).all():
        return -1
    i, j, k = at.astype(np.int64).tolist()
    return int((i * grid.ny + j) * grid.nz + k)


@inlined
def place_of(grid, x, y, z):
    """Where points of the scene are in a grid, or in what begins as one does, a cube being 1 long."""
    scale = np.float32(grid.per_unit)
    return (x - np.float32(grid.x)) * scale, (y - np.float32(grid.y)) * scale, (z - np.float32(grid.z)) * scale


@inlined
def within(place, nx, ny, nz):
    """Mask of the places that lie among so many cubes: only these may be converted to indices."""
    inside = (place[0] >= ZERO) & (place[1] >= ZERO) & (place[2] >= ZERO)
    return inside & (place[0] < np.float32(nx)) & (place[1] < np.float32(ny)) & (place[2] < np.float32(nz))


@inlined
def indices(place, inside):
    """The cubes along each axis in which places lie, 0 for those that are not inside."""
    return (
        to_i32(select(inside, place[0], ZERO)),
        to_i32(select(inside, place[1], ZERO)),
        to_i32(select(inside, place[2], ZERO)),
    )


@inlined
def cubes_at(grid, x, y, z, nowhere):
    """Numbers of the cubes in which sixteen points lie, `nowhere` for those outside of the grid."""
    place = place_of(grid, x, y, z)
    inside = within(place, grid.nx, grid.ny, grid.nz)
    i, j, k = indices(place, inside)
    number = (i * np.int32(grid.ny) + j) * np.int32(grid.nz) + k
    return select(inside, number, i32x16(np.int32(nowhere)))
