"""A slice through what a method keeps of space: which voxel each pixel sees in it, and what is known of that.

The slice is one layer of voxels, drawn as the plane through their middles.  Where something lies in front of it, that
is seen instead.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.culling.voxels.grid import BLOCK, VoxelGrid
from tracer.culling.voxels.tell import STATE_NAMES, VoxelStates, index_of
from tracer.frame import Frame
from tracer.geometry.camera import pinhole
from viewer.state.draw_options import Slice
from viewer.views.paint import on_line

NOTHING, LINE = 255, 4  # a code of no voxel, and a flag of the code of one that has its border at a pixel
STATE = 3  # a mask of codes
FEWEST = 6.0  # pixels that voxels, or blocks of them, must be wide for their borders to be drawn


def middle_of(grid: VoxelGrid, cut: Slice) -> float:
    """Where the plane of a slice lies along its axis, in units of the scene."""
    return float((grid.x, grid.y, grid.z)[cut.axis] + (cut.layer((grid.nx, grid.ny, grid.nz)) + 0.5) * grid.side)


@dataclass(frozen=True, eq=False)  # arrays cannot be compared as one
class SliceSeen:
    """Of each pixel (h, w): the number of the voxel that it sees in a slice, int32, -1 where it sees none; and how many
    pixels wide that voxel is there."""

    numbers: NDArray[np.int32]
    wide: NDArray[np.float32]


def slice_seen(frame: Frame, grid: VoxelGrid, cut: Slice) -> SliceSeen:
    """Which voxel of a slice each pixel sees."""
    rays = pinhole(frame.camera, frame.width, frame.height)
    x, y = np.arange(frame.width, dtype=np.float32), np.arange(frame.height, dtype=np.float32)[:, None]
    ways = [rays.corner[k] + x * rays.column[k] + y * rays.row[k] for k in range(3)]
    sides, low = (grid.nx, grid.ny, grid.nz), (grid.x, grid.y, grid.z)
    with np.errstate(all="ignore"):
        t = np.float32(middle_of(grid, cut) - float(rays.origin[cut.axis])) / ways[cut.axis]
        distance = t * np.sqrt(ways[0] * ways[0] + ways[1] * ways[1] + ways[2] * ways[2])
        seen = (t > 0.0) & (distance < frame.depth)
        numbers = np.zeros(frame.primitive.shape, np.int32)
        for k in range(3):
            if k == cut.axis:
                place = np.full(numbers.shape, cut.layer(sides), np.int32)
            else:
                along = (rays.origin[k] - np.float32(low[k]) + t * ways[k]) * np.float32(grid.per_unit)
                seen &= (along >= 0.0) & (along < sides[k])
                place = np.where(seen, along, 0.0).astype(np.int32)
            numbers = numbers * sides[k] + place
        wide = np.float32(grid.side) / (distance * rays.spread)
    return SliceSeen(np.where(seen, numbers, np.int32(-1)), np.where(seen, wide, np.float32(0.0)).astype(np.float32))


def slice_codes(frame: Frame, states: VoxelStates, light: int, cut: Slice) -> NDArray[np.uint8]:
    """(h, w) the state of the voxel that each pixel sees in a slice, with the flag LINE at its border; else NOTHING.

    Borders of voxels are drawn where these are wide enough, else those of blocks, if these are."""
    seen = slice_seen(frame, states.grid, cut)
    there = seen.numbers >= 0
    codes = states.states(light, np.maximum(seen.numbers, 0).astype(np.int64))
    grid = states.grid
    i, rest = np.divmod(seen.numbers, grid.ny * grid.nz)
    blocks = (i // BLOCK * 1024 + rest // grid.nz // BLOCK) * 1024 + rest % grid.nz // BLOCK
    lines = np.where(seen.wide >= FEWEST, on_line(seen.numbers), on_line(np.where(there, blocks, -1)))
    codes[lines & (BLOCK * seen.wide >= FEWEST)] |= LINE
    return np.where(there, codes, np.uint8(NOTHING))


class VoxelSeen(NamedTuple):
    """A voxel: its place along x, y and z, its state for a light, the side of the largest block around it that has this
    state, and whether anything static lies in it."""

    place: tuple[int, int, int]
    state: int
    level: int
    occupied: bool


def voxel_seen(states: VoxelStates, light: int, number: int) -> VoxelSeen:
    """What is known of a voxel, by its number."""
    index = index_of(states.grid, number)
    state = int(states.states(light, np.array(number)))
    return VoxelSeen(index, state, states.level(light, index), bool(states.words[number] & states.words.dtype.type(1)))


def voxel_words(frame: Frame, states: VoxelStates, light: int, cut: Slice, x: int, y: int) -> tuple[str, ...]:
    """What a pixel sees in a slice: the voxel, and what is known of it; a dash where it sees none."""
    number = int(slice_seen(frame, states.grid, cut).numbers[y, x])
    if number < 0:
        return ("-",)
    index = index_of(states.grid, number)
    state = int(states.states(light, np.array(number)))
    return "{}, {}, {}".format(*index), STATE_NAMES[state]
