"""The octree of cells: where they are, which are divided, and what kernels are given of them.

A cell has a code for each light that is held: HIDDEN, LIT, where its blockers begin in a list of names (their number
first), or UNKNOWN.  Codes are those of leaves; what lies outside of the root has cell 0, of which nothing is known.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.runtime.kernels import inlined
from tracer.simd import address_of, bits_of, gather_i32x16, i32x16, select
from tracer.simd.records import I32, I64, Bytes, F32x2D, F32x3D, I64x2D, reading
from tracer.visibility.grid import DIGITS, SHIFT, Grid, indices, place_of, within

LEVELS = 8  # of the octree below its root, at most
OUTSIDE, ROOT = 0, 1
LIT, HIDDEN, UNKNOWN = 0, -1, -2  # codes; others are places in the list of names
CELL = 34  # bytes of a cell in `CellTree`
ROOM = 0.01  # of the smallest cells, by which all are taken to be larger


class EnvironmentView(NamedTuple):
    """All cells, as kernels that are called by address read them.

    Attributes:
        grid: of the smallest cells, a power of two on each side.
        levels: how many are below the root.
        child: (cells,) int32, the first of a cell's eight children, 0 for a leaf.
        open: (cells,) bool, leaves about which more could be known.
        wanted: (cells,) bool, those of them in which rays have ended.
        codes: (cells * held lights,) int32, of each cell and light.
        held: how many lights, the first ones, have codes.
        names: (m,) int32, numbers of primitives.
        of: (cells,) int32, the number of the list of the further lights that may shine into a cell, 0 where that is not
            known.
        starts, lights: (n + 1,) int64 and (k,) int32, these lists (`tracer.visibility.hidden_lights.LightLists`).
        light_space: (held lights, primitives, LIGHT_ROW) float32 (`tracer.visibility.light_space`).
        known: (lights,) bool, lights that stand where codes have them.
        resting: (k, 6) float32, boxes around what rests now.
        by_ray: whether steps and tests are counted ray by ray, or for vectors of sixteen.
        looks: (lights, words) int64 (`tracer.culling.stages.Stages`), or without rows.
        cell: (pixels,) int32, gets the cell at each primary hit; empty where nobody wants to know.
    """

    grid: Grid
    levels: int
    child: I32
    open: Bytes
    wanted: Bytes
    codes: I32
    held: int
    names: I32
    of: I32
    starts: I64
    lights: I32
    light_space: F32x3D
    known: Bytes
    resting: F32x2D
    by_ray: bool
    looks: I64x2D
    cell: I32


environments_at = reading(EnvironmentView)


def make_grid(bounds: NDArray[np.float64]) -> Grid:
    """The grid of the smallest cells of an octree around bounds (2, 3), lower and upper corner.

    Where it begins, and how many there are in a unit of length, are exact in float32."""
    extent, largest = max(float((bounds[1] - bounds[0]).max()), 1e-30), float(np.abs(bounds).max())
    finest = max(extent / (2**LEVELS - 1), 4.0 * DIGITS * largest / ROOM)
    many = 2 ** max(0, min(LEVELS, int(np.ceil(np.log2(extent / finest + 1.0)))))
    while many * finest < extent + 2.0 * SHIFT * finest:
        finest *= 1.05
    x, y, z = (bounds[0] - SHIFT * finest).astype(np.float32).tolist()
    return Grid(x, y, z, float(np.float32(1.0 / finest)), many, many, many)


def boxes_of(grid: Grid, places: NDArray[np.int32]) -> NDArray[np.float64]:
    """Boxes (n, 6) of cells whose places (n, 4) are where they begin, in the smallest cells, and their level."""
    low = np.array([grid.x, grid.y, grid.z]) + places[:, :3] * grid.side
    side, room = 2.0 ** places[:, 3:] * grid.side, ROOM * grid.side
    return np.concatenate([low - room, low + side + room], 1)


@inlined
def cells_at(environments, x, y, z):
    """Numbers of the leaves in which sixteen points lie, OUTSIDE for those that are in none."""
    grid, child = environments.grid, address_of(environments.child)
    place = place_of(grid, x, y, z)
    there = within(place, grid.nx, grid.ny, grid.nz)
    i, j, k = indices(place, there)
    cell = select(there, i32x16(np.int32(ROOT)), i32x16(np.int32(OUTSIDE)))
    for level in range(environments.levels - 1, -1, -1):
        first, by = gather_i32x16(child, cell), np.int32(level)
        inner = first > np.int32(0)
        if bits_of(inner) == 0:
            break
        one = np.int32(1)
        octant = (((i >> by) & one) << np.int32(2)) | (((j >> by) & one) << one) | ((k >> by) & one)
        cell = select(inner, first + octant, cell)
    return cell


class CellTree:
    """Cells within bounds (2, 3), of which there is a root at first, and the cell of what is outside.

    `child` is the first of a cell's eight children, 0 for none; `open` cells are not settled yet; rays have ended in
    those that are `wanted`; `cells` (n, 4) are where they begin, in the smallest cells, and their level; `todo` has the
    bits of lights that are to be settled.  Of each array the first `count` are in use."""

    def __init__(self, bounds: NDArray[np.float64]) -> None:
        self.grid: Grid = make_grid(bounds)
        #: How many levels are below the root.
        self.levels = self.grid.nx.bit_length() - 1
        self.begin()

    def begin(self) -> None:
        """Begin anew."""
        n, self.count = 1024, 2
        self.child, self.open, self.wanted = np.zeros(n, np.int32), np.zeros(n, np.bool_), np.zeros(n, np.bool_)
        self.cells, self.parent = np.zeros((n, 4), np.int32), np.zeros(n, np.int32)
        self.todo = np.zeros(n, np.int64)
        self.cells[ROOT, 3] = self.levels
        self.open[ROOT], self.todo[ROOT] = True, -1

    @property
    def room(self) -> int:
        """How many cells there is room for."""
        return len(self.child)

    @property
    def bytes(self) -> int:
        """Memory that the cells take, in bytes."""
        return CELL * self.count

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
        grid = self.grid
        at = np.floor((points.astype(np.float64) - (grid.x, grid.y, grid.z)) * grid.per_unit)
        there = np.all((at >= 0) & (at < grid.nx), axis=1)
        i, j, k = np.where(there[:, None], at, 0.0).astype(np.int64).T
        cell = np.where(there, ROOT, OUTSIDE)
        for level in range(self.levels - 1, -1, -1):
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
