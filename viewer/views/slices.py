"""Slices through space: which voxel, or which part of a tree, each pixel sees in one, and what is known of that.

Of voxels, the slice is one layer of them, drawn as the plane through their middles; where something lies in front of
it, that is seen instead.  Through a tree it is drawn through everything: wherever a ray of the picture passes the tree
is built, so what waits is what lies behind something, and would never be seen if that hid the slice.
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
from tracer.geometry.tree_parts import NOWHERE, PartsAt, TreeParts, nothing_at
from viewer.state.draw_options import Slice
from viewer.views.paint import on_line

NO_VOXEL, VOXEL_LINE = 255, 4  # a code of no voxel, and a flag of the code of one that has its border at a pixel
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
    """Return the state (h, w) of the voxel that each pixel sees, with the flag VOXEL_LINE at its border; else NO_VOXEL.

    Borders of voxels are drawn where these are wide enough, else those of blocks, if these are."""
    seen = slice_seen(frame, states.grid, cut)
    there = seen.numbers >= 0
    codes = states.states(light, np.maximum(seen.numbers, 0).astype(np.int64))
    grid = states.grid
    i, rest = np.divmod(seen.numbers, grid.ny * grid.nz)
    blocks = (i // BLOCK * 1024 + rest // grid.nz // BLOCK) * 1024 + rest % grid.nz // BLOCK
    lines = np.where(seen.wide >= FEWEST, on_line(seen.numbers), on_line(np.where(there, blocks, -1)))
    codes[lines & (BLOCK * seen.wide >= FEWEST)] |= VOXEL_LINE
    return np.where(there, codes, np.uint8(NO_VOXEL))


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


LEVEL, WAITS, LINE, BORDER, HIDDEN = 0xFF, 0x100, 0x200, 0x400, 0x800  # of a code: a mask, and flags
NO_PART = 0xFFFF  # the code of no part
LAYERS = 100  # steps from one side of what most primitives are in to the other
SAMPLES = 128  # along each side of a slice, of which parts are counted
STRIPE = 4  # pixels: the width of the stripes of what waits


def layer_of(cut: Slice) -> int:
    """Which of the LAYERS a slice lies in."""
    return min(int(cut.at * LAYERS), LAYERS - 1)


def place_of(parts: TreeParts, cut: Slice) -> float:
    """Where the plane of a slice lies along its axis, in units of the scene: in the middle of its layer."""
    low, high = float(parts.extent[cut.axis]), float(parts.extent[cut.axis + 3])
    return low + (layer_of(cut) + 0.5) / LAYERS * (high - low)


class TreeSeen(NamedTuple):
    """Of each pixel (h, w), the part of the tree that it sees in a slice; whether something lies before it; and how
    many pixels wide the part is there."""

    parts: PartsAt
    hidden: NDArray[np.bool_]
    wide: NDArray[np.float32]


def tree_seen(frame: Frame, parts: TreeParts, cut: Slice) -> TreeSeen:
    """Which part of the tree each pixel sees in a slice; none once the tree is no more."""
    return _tree_seen(frame, parts, cut, slice(0, frame.width), slice(0, frame.height))


def _tree_seen(frame: Frame, parts: TreeParts, cut: Slice, columns: slice, rows: slice) -> TreeSeen:
    """The same of some pixels."""
    rays, depth = pinhole(frame.camera, frame.width, frame.height), frame.depth[rows, columns]
    x, y = (np.arange(side.start, side.stop, dtype=np.float32) for side in (columns, rows))
    points = np.empty((*depth.shape, 3), np.float32)
    with np.errstate(all="ignore"):
        ways = [rays.corner[k] + x * rays.column[k] + y[:, None] * rays.row[k] for k in range(3)]
        place = np.float32(place_of(parts, cut))
        t = np.where(ways[cut.axis] != 0.0, (place - np.float32(rays.origin[cut.axis])) / ways[cut.axis], np.nan)
        t = np.where(t > 0.0, t, np.nan).astype(np.float32)
        for k in range(3):
            points[..., k] = place + 0.0 * t if k == cut.axis else rays.origin[k] + t * ways[k]
        distance = t * np.sqrt(ways[0] * ways[0] + ways[1] * ways[1] + ways[2] * ways[2])
        found = parts.at(points.reshape(-1, 3), cut.axis) or nothing_at(t.size)
        shaped = PartsAt._make(column.reshape(depth.shape) for column in found)
        wide = np.where(shaped.numbers != NOWHERE, shaped.widths / (distance * rays.spread), np.float32(0.0))
        return TreeSeen(shaped, distance > depth, wide)


def tree_codes(frame: Frame, parts: TreeParts, cut: Slice) -> NDArray[np.uint16]:
    """(h, w) for each pixel the level of the part that it sees in a slice, with flags: that it WAITS, that a LINE
    between parts, or the BORDER of an object or a piece, is there, and that something lies before it, so that it would
    be HIDDEN; else NO_PART."""
    seen = tree_seen(frame, parts, cut)
    found, there = seen.parts, seen.parts.numbers != NOWHERE
    codes = found.levels.astype(np.uint16)
    codes[found.built == 0] |= WAITS
    codes[on_line(found.numbers) & (_least(seen.wide) >= FEWEST)] |= LINE
    codes[_in_company(on_line(found.owners))] |= BORDER
    codes[seen.hidden] |= HIDDEN
    return np.where(there, codes, np.uint16(NO_PART))


def _in_company(line: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Pixels of lines with two neighbours of lines at least: others are dots, as of a flat box that is far away."""
    padded = np.pad(line, 1)
    height, width = line.shape
    near = [padded[y : y + height, x : x + width] for y in range(3) for x in range(3) if (y, x) != (1, 1)]
    return line & (np.sum(near, axis=0, dtype=np.uint8) >= 2)


def _least(wide: NDArray[np.float32]) -> NDArray[np.float32]:
    """The least of a pixel and of its neighbours to the right and below: lines belong to both sides."""
    least = wide.copy()
    least[:, :-1] = np.minimum(least[:, :-1], wide[:, 1:])
    least[:-1] = np.minimum(least[:-1], wide[1:])
    return least


def share_built(parts: TreeParts, cut: Slice) -> float | None:
    """Which share of what a slice has of the tree is built, by SAMPLES x SAMPLES points; None where it has none."""
    steps = (np.arange(SAMPLES, dtype=np.float32) + np.float32(0.5)) / np.float32(SAMPLES)
    low, high = parts.extent[:3], parts.extent[3:]
    points = np.empty((SAMPLES, SAMPLES, 3), np.float32)
    one, other = (k for k in range(3) if k != cut.axis)
    points[..., cut.axis] = place_of(parts, cut)
    points[..., one] = low[one] + steps[:, None] * (high[one] - low[one])
    points[..., other] = low[other] + steps * (high[other] - low[other])
    found = parts.at(points.reshape(-1, 3), cut.axis)
    there = found.numbers != NOWHERE if found is not None else np.zeros(0, np.bool_)
    return float(found.built[there].mean()) if found is not None and there.any() else None


class PartSeen(NamedTuple):
    """What one pixel sees in a slice."""

    level: int
    built: bool
    held: int
    owner: int


def part_seen(frame: Frame, parts: TreeParts, cut: Slice, x: int, y: int) -> PartSeen | None:
    """The part that a pixel sees; None where it sees none."""
    found = _tree_seen(frame, parts, cut, slice(x, x + 1), slice(y, y + 1)).parts
    if found.numbers[0, 0] == NOWHERE:
        return None
    return PartSeen(int(found.levels[0, 0]), bool(found.built[0, 0]), int(found.held[0, 0]), int(found.owners[0, 0]))


def part_words(part: PartSeen | None, owner: str) -> tuple[str, ...]:
    """That in a few short lines, with the word for what owners are; a dash for no part."""
    if part is None:
        return ("-",)
    leaf = f"leaf of {part.held} primitive{'s' * (part.held != 1)}" if part.held else "empty leaf"
    what = "not built yet" if not part.built else "inner node" if part.held < 0 else leaf
    return (what, f"level {part.level}", *((f"{owner} {part.owner}",) if part.owner >= 0 else ()))
