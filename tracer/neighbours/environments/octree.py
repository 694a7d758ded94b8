"""The octree of cells.

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
from tracer.visibility.grid import DIGITS, SHIFT, indices, place_of, within

LEVELS = 8  # of the octree below its root, at most
OUTSIDE, ROOT = 0, 1
LIT, HIDDEN, UNKNOWN = 0, -1, -2  # codes; others are places in the list of names
ROOM = 0.01  # of the smallest cells, by which all are taken to be larger


class Frame(NamedTuple):
    """Where the root begins, in units of the scene, how many of the smallest cells there are in a unit of length, all
    exact in float32, and how many levels are below the root."""

    x: float
    y: float
    z: float
    per_unit: float
    levels: int

    @property
    def side(self) -> float:
        """The side of the smallest cells."""
        return 1.0 / self.per_unit


class EnvironmentView(NamedTuple):
    """All cells, as kernels that are called by address read them.

    Attributes:
        frame: where they are.
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

    frame: Frame
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


def make_frame(bounds: NDArray[np.float64]) -> Frame:
    """An octree around bounds (2, 3), lower and upper corner."""
    extent, largest = max(float((bounds[1] - bounds[0]).max()), 1e-30), float(np.abs(bounds).max())
    finest = max(extent / (2**LEVELS - 1), 4.0 * DIGITS * largest / ROOM)
    levels = max(0, min(LEVELS, int(np.ceil(np.log2(extent / finest + 1.0)))))
    while 2**levels * finest < extent + 2.0 * SHIFT * finest:
        finest *= 1.05
    x, y, z = (bounds[0] - SHIFT * finest).astype(np.float32).tolist()
    return Frame(x, y, z, float(np.float32(1.0 / finest)), levels)


def boxes_of(frame: Frame, places: NDArray[np.int32]) -> NDArray[np.float64]:
    """Boxes (n, 6) of cells whose places (n, 4) are where they begin, in the smallest cells, and their level."""
    low = np.array([frame.x, frame.y, frame.z]) + places[:, :3] * frame.side
    side, room = 2.0 ** places[:, 3:] * frame.side, ROOM * frame.side
    return np.concatenate([low - room, low + side + room], 1)


@inlined
def cells_at(environments, x, y, z):
    """Numbers of the leaves in which sixteen points lie, OUTSIDE for those that are in none."""
    frame, child = environments.frame, address_of(environments.child)
    many, place = np.int64(1) << frame.levels, place_of(frame, x, y, z)
    there = within(place, many, many, many)
    i, j, k = indices(place, there)
    cell = select(there, i32x16(np.int32(ROOT)), i32x16(np.int32(OUTSIDE)))
    for level in range(frame.levels - 1, -1, -1):
        first, by = gather_i32x16(child, cell), np.int32(level)
        inner = first > np.int32(0)
        if bits_of(inner) == 0:
            break
        one = np.int32(1)
        octant = (((i >> by) & one) << np.int32(2)) | (((j >> by) & one) << one) | ((k >> by) & one)
        cell = select(inner, first + octant, cell)
    return cell
