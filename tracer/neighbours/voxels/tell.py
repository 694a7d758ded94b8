"""What voxels say of a ray, and of themselves, for people: as kernels read them, in Python."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.culling.modes import FULL_SHADOW, NON_SHADOW, shadow_mode
from tracer.culling.shadow_testing import LIGHT_MARGIN
from tracer.neighbours.voxels.grid import BLOCK
from tracer.visibility.grid import Grid

Index = tuple[int, int, int]


@dataclass(frozen=True, eq=False)  # arrays cannot be compared as one
class VoxelStates:
    """The voxels of a scene as a picture found them.

    `words` (voxels + 1,) are the packed words of all voxels, with one more for what lies outside; `known` (lights,)
    says of which lights they hold states.  A light's state is its shadow mode in a word: FULL_SHADOW for a voxel that
    is full, NON_SHADOW for one that is lit, 0 for one that is unknown."""

    grid: Grid
    words: NDArray[np.unsignedinteger]
    known: NDArray[np.bool_]

    @property
    def shape(self) -> Index:
        """How many voxels there are along x, y and z."""
        return self.grid.nx, self.grid.ny, self.grid.nz

    def states(self, light: int, numbers: NDArray[np.int64]) -> NDArray[np.uint8]:
        """The states of voxels of these numbers, of any shape; all unknown for a light of which nothing is held."""
        if not (0 <= light < len(self.known) and self.known[light]):
            return np.zeros(numbers.shape, np.uint8)
        return shadow_mode(self.words[numbers], light)

    def counts(self, light: int) -> tuple[int, int, int]:
        """How many voxels are unknown, full and lit."""
        found = np.bincount(self.states(light, np.arange(self.grid.cubes)), minlength=3)
        return int(found[0]), int(found[FULL_SHADOW]), int(found[NON_SHADOW])

    def level(self, light: int, index: Index) -> int:
        """The side, in voxels, of the largest block around a voxel all of which has its state: 1, 2, 4 or BLOCK."""
        side, (i, j, k) = BLOCK, index
        while side > 1:
            a, b, c = (np.arange(n // side * side, n // side * side + side) for n in (i, j, k))
            numbers = (a[:, None, None] * self.grid.ny + b[:, None]) * self.grid.nz + c
            if len(np.unique(self.states(light, numbers))) == 1:
                break
            side //= 2
        return side


class Stop(Enum):
    """Where a ray's walk towards the light ended."""

    HERE = "in the voxel that it begins in"
    KNOWN = "in a voxel of which all is known"
    BLOCKED = "at a primitive that blocks it"
    LIGHT = "at the light"
    OUTSIDE = "where the grid ends"


class Walked(NamedTuple):
    """The way of a shadow ray from voxel to voxel: where it began and ended, how many it entered, why it ended, the
    state of the last (0 unless it is known), and what blocks the ray there, -1 for nothing."""

    first: Index
    last: Index
    entered: int
    stop: Stop
    state: int
    blocker: int = -1

    def in_words(self, states: VoxelStates, light: int) -> str:
        """All of it in a sentence or two."""
        i, j, k = self.first
        where = f"voxel {i}, {j}, {k}"
        if self.stop is Stop.HERE:
            side = states.level(light, self.first)
            block = f", with the whole block of {side} x {side} x {side} around it" if side > 1 else ", by itself"
            return f"{where[0].upper()}{where[1:]} is {STATE_NAMES[self.state]}{block}."
        others = self.entered - 1
        way = f"The {where} of the point is unknown. The walk towards the light "
        if self.stop is Stop.BLOCKED and not others:
            return f"{way}ended in it, at what blocks the ray."
        went = f"entered {others} more voxel{'s' * (others != 1)} and ended "
        x, y, z = self.last
        if self.stop is Stop.KNOWN:
            return f"{way}{went}in voxel {x}, {y}, {z}, which is {STATE_NAMES[self.state]}."
        if self.stop is Stop.BLOCKED:
            return f"{way}{went}in voxel {x}, {y}, {z}, at what blocks the ray."
        return f"{way}{went}{self.stop.value}: nothing static is in its way."


STATE_NAMES = {0: "unknown", FULL_SHADOW: "full", NON_SHADOW: "lit"}
"""What is known of a light in a voxel, in the words that certificates have: lit voxels are the "null" ones of Woo and
Amanatides."""


def blocker_in(
    rows: NDArray[np.float32], names: NDArray[np.int32], light: NDArray[np.float64], end: NDArray[np.float64]
) -> int:
    """Which of some triangles, rows (n, >= 9) by their names, the segment from a light (3,) to its end (3,) crosses; -1
    for none.  Names of no row are those of quadrics, which block nothing for certain."""
    way = end - light
    for name in names[names < len(rows)].tolist():
        a, e1, e2 = rows[name, :9].astype(np.float64).reshape(3, 3)
        normal, s = np.cross(e1, e2), light - a
        d, t = float(-way @ normal), float(s @ normal)
        if d < 0.0:
            sign, d, t = -1.0, -d, -t
        else:
            sign = 1.0
        u, v = sign * float(way @ np.cross(e2, s)), sign * float(way @ np.cross(s, e1))
        if d > 0.0 and u >= 0.0 and v >= 0.0 and u + v <= d and LIGHT_MARGIN * d < t < d:
            return int(name)
    return -1


def walked(
    states: VoxelStates,
    light: int,
    place: NDArray[np.float32],
    point: NDArray[np.float32],
    blocks: NDArray[np.float32],
    contents: tuple[NDArray[np.int32], NDArray[np.int32]],
) -> Walked | None:
    """How a shadow ray that ends at a point (3,) walks towards a light at place (3,); None outside of the grid.

    blocks (n, >= 9) are the rows of triangles, a corner and two edges first, and contents where the names of what lies
    in each voxel begin, and the names."""
    grid, (starts, names) = states.grid, contents
    shape, low = np.array(states.shape), np.array([grid.x, grid.y, grid.z])
    end, start = point.astype(np.float64), place.astype(np.float64)
    at, to = (end - low) * grid.per_unit, (start - low) * grid.per_unit
    index = np.floor(at).astype(np.int64)
    if not ((index >= 0) & (index < shape)).all():
        return None
    way = to - at
    step = np.where(way >= 0.0, 1, -1)
    first, entered = (int(index[0]), int(index[1]), int(index[2])), 1
    while True:
        here = (int(index[0]), int(index[1]), int(index[2]))
        number = (here[0] * grid.ny + here[1]) * grid.nz + here[2]
        state = int(states.states(light, np.array(number)))
        if state in (FULL_SHADOW, NON_SHADOW):
            return Walked(first, here, entered, Stop.HERE if entered == 1 else Stop.KNOWN, state)
        blocker = blocker_in(blocks, names[starts[number] : starts[number + 1]], start, end)
        if blocker >= 0:
            return Walked(first, here, entered, Stop.BLOCKED, 0, blocker)
        with np.errstate(all="ignore"):
            borders = np.where(way != 0.0, (index + (step > 0) - at) / way, np.inf)
        axis = int(np.argmin(borders))
        if borders[axis] >= 1.0:
            return Walked(first, here, entered, Stop.LIGHT, 0)
        index[axis] += step[axis]
        if not 0 <= index[axis] < shape[axis]:
            return Walked(first, here, entered, Stop.OUTSIDE, 0)
        entered += 1
