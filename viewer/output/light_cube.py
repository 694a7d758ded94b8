"""What a light sees, as a picture: the cube of its buffer unfolded, twice.

On the left each cell has the colour of what is known of it, on the right that of how far from the light all is in
shadow.  The cross is what somebody sees who stands at the light, y up, and looks around: in its middle row, from the
left, along +x, +z, -x and -z; above and below +z, up and down.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.culling.lightbuffer.cubes import Cube
from tracer.culling.lightbuffer.tell import full_depths, list_lengths
from viewer.state.views import BACKGROUND, GREY, SHADOW_COLORS, ShadowMode, color_map

_CROSS = {(1, 0): "+x", (1, 1): "+z", (1, 2): "-x", (1, 3): "-z", (0, 1): "+y", (2, 1): "-y"}  # row and column
_GAP = 0.06  # of a face's side, between the crosses


class CellCounts(NamedTuple):
    """How many cells of a cube have nothing in them; a triangle that covers them, before which there is nothing; few
    candidates; and too many."""

    empty: int
    covered: int
    few: int
    many: int

    @property
    def cells(self) -> int:
        return sum(self)


def _ways(face: str, side: int) -> NDArray[np.float64]:
    """(side, side, 3), where each cell of a face leads, as it is seen from the light: row 0 at the top."""
    middle = (np.arange(side) + 0.5) * (2.0 / side) - 1.0
    up, right = np.meshgrid(-middle, middle, indexing="ij")
    one = np.ones_like(up)
    return np.stack(
        {
            "+x": (one, up, right),
            "+z": (-right, up, one),
            "-x": (-one, up, -right),
            "-z": (right, up, -one),
            "+y": (-right, one, -up),
            "-y": (-right, -one, up),
        }[face],
        axis=-1,
    )


def unfolded(cells: NDArray, empty: NDArray) -> NDArray:
    """(3 side, 4 side, ...), the cells (6, side, side, ...) of a cube as a cross, `empty` where there are none."""
    side = cells.shape[1]
    cross = np.broadcast_to(empty, (3 * side, 4 * side, *cells.shape[3:])).copy()
    for (row, column), face in _CROSS.items():
        ways = _ways(face, side)
        axis = "xyz".index(face[1])
        across, along = (((ways[..., k] + 1.0) * (0.5 * side)).astype(int) for k in range(3) if k != axis)
        cross[row * side : (row + 1) * side, column * side : (column + 1) * side] = cells[
            2 * axis + (face[0] == "-"), along, across
        ]
    return cross


def counts_of(cube: Cube) -> CellCounts:
    """How many cells have what."""
    lengths, covered = list_lengths(cube), np.isfinite(full_depths(cube))
    alone = (lengths < 0) & covered
    return CellCounts(
        int((lengths == 0).sum()), int(alone.sum()), int((lengths > 0).sum()), int(((lengths < 0) & ~covered).sum())
    )


def picture_of(cube: Cube) -> NDArray[np.uint8]:
    """(h, w, 3) uint8, row 0 at the top: what is known of each cell, and beside it where shadow begins.

    Cells with nothing in them have the colour of NON_SHADOW, those that one triangle covers that of FULL_SHADOW, those
    with few candidates colours from one on, and others are grey.  Depths go from the nearest to the farthest, in their
    logarithms; where nothing covers a cell there is only the background."""
    lengths, depths = list_lengths(cube), full_depths(cube)
    colors, background = color_map(), np.array(BACKGROUND, np.float32)
    longest = max(2, int(lengths.max()))
    steps = np.clip((lengths - 1) * 255 // (longest - 1), 0, 255)
    known = colors[steps]
    known[lengths == 0] = SHADOW_COLORS[ShadowMode.NON_SHADOW]
    known[lengths < 0] = GREY
    known[(lengths < 0) & np.isfinite(depths)] = SHADOW_COLORS[ShadowMode.FULL_SHADOW]
    far = np.broadcast_to(background, known.shape).copy()
    there = np.isfinite(depths)
    if there.any():
        logarithms = np.log(depths[there])
        least, most = float(logarithms.min()), float(logarithms.max())
        far[there] = colors[np.round((logarithms - least) * (255.0 / max(most - least, 1e-6))).astype(int)]
    crosses = [unfolded(cells, background) for cells in (known, far)]
    gap = np.broadcast_to(background, (crosses[0].shape[0], max(1, round(_GAP * cube.side)), 3))
    whole = np.concatenate([crosses[0], gap, crosses[1]], axis=1)
    return np.round(np.clip(whole, 0.0, 1.0) * 255.0).astype(np.uint8)
