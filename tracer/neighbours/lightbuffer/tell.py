"""What a cube says of a point, and of its cells, for people: as kernels read it, in Python."""

from __future__ import annotations

from enum import Enum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.neighbours.lightbuffer.cube import BLOCKED, COUNT, FIRST, LIT, NOTHING, WIDTH_BITS
from tracer.neighbours.lightbuffer.cubes import Cube


class Said(Enum):
    """What a cube says of a point."""

    EMPTY = "nothing is there"
    BEFORE = "before all that is there"
    BEHIND = "behind what covers the cell"
    CANDIDATES = "among a few candidates"
    UNKNOWN = "unknown"


class Told(NamedTuple):
    """What is said, and the primitives that it rests on, by number: what covers the cell, or its candidates."""

    said: Said
    named: tuple[int, ...] = ()


class LightCube(NamedTuple):
    """What a light sees, as a picture found it: the `cube` of all that never moves, around `place` (3,); or `why` it
    has none, in words."""

    place: NDArray[np.float32]
    cube: Cube | None
    why: str = ""


def cell_of(way: NDArray[np.float32], side: int) -> tuple[int, int, int]:
    """(face, row, column) of a way (3,) from the light (`cube.cells_of`)."""
    axis = 0 if abs(way[0]) >= max(abs(way[1]), abs(way[2])) else (2 if abs(way[2]) > abs(way[1]) else 1)
    others = [k for k in range(3) if k != axis]
    with np.errstate(all="ignore"):
        places = np.nan_to_num(way[others] / abs(way[axis])) * (0.5 * side) + 0.5 * side
    column, row = np.clip(places, 0, side - 1).astype(int).tolist()
    return 2 * axis + int(way[axis] < 0), row, column


def tell(cube: Cube, light: NDArray[np.float32], point: NDArray[np.float32]) -> Told:
    """What a cube around light (3,) says of a point (3,)."""
    way = (point - light).astype(np.float32)
    number = int(cube.cells[cell_of(way, cube.side)]) >> WIDTH_BITS
    record, counted = cube.records[number], cube.records.view(np.int32)[number]
    length = float(np.linalg.norm(way.astype(np.float64)))
    if number == NOTHING:
        return Told(Said.EMPTY)
    first, count = int(counted[FIRST]), int(counted[COUNT])
    names = tuple(int(cube.numbers[row]) for row in cube.lists[first : first + count])
    if float(record[BLOCKED : BLOCKED + 3] @ way) > 1.0 and length <= cube.sure:
        return Told(Said.BEHIND, names or ((int(cube.every[first]),) if first >= 0 else ()))
    if float(record[LIT : LIT + 3] @ way) < 1.0:
        return Told(Said.BEFORE)
    return Told(Said.CANDIDATES if count else Said.UNKNOWN, names)


def list_lengths(cube: Cube) -> NDArray[np.int32]:
    """(6, side, side) int32, the candidates of each cell; -1 where there are too many, or only one that covers it."""
    numbers = cube.cells >> WIDTH_BITS
    counts = cube.records.view(np.int32)[:, COUNT]
    return np.where((numbers != NOTHING) & (counts[numbers] == 0), -1, counts[numbers]).astype(np.int32)


def full_depths(cube: Cube) -> NDArray[np.float32]:
    """(6, side, side) float32: how far from the light, in the middle of each cell, shadow begins; inf for nowhere."""
    middle = (np.arange(cube.side) + 0.5) * (2.0 / cube.side) - 1.0
    y, x = np.meshgrid(middle, middle, indexing="ij")
    planes = cube.records[:, BLOCKED : BLOCKED + 3][cube.cells >> WIDTH_BITS].astype(np.float64)
    depths = np.full(cube.cells.shape, np.inf, np.float32)
    for face in range(6):
        axis, sign = face >> 1, -1.0 if face & 1 else 1.0
        ways = np.empty((*x.shape, 3))
        ways[..., axis] = sign
        ways[..., [k for k in range(3) if k != axis]] = np.stack([x, y], -1)
        inverse = (planes[face] * ways).sum(-1)
        far = np.linalg.norm(ways, axis=-1)
        depths[face] = np.where(inverse > 0.0, far / np.maximum(inverse, 1e-30), np.inf)
    return depths
