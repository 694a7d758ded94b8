"""What a light sees, as a picture: the cube of its buffer unfolded, twice.

On the left each cell has the colour of what is known of it, on the right that of how far from the light all is in
shadow.  The cross is what somebody sees who stands at the light, y up, and looks around: in its middle row, from the
left, along +x, +z, -x and -z; above and below +z, up and down.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from tracer.culling.lightbuffer.cubes import Cube
from tracer.culling.lightbuffer.tell import full_depths, list_lengths
from tracer.culling.modes import ShadowMode
from viewer.output.overlays import with_legend
from viewer.state.palette import BACKGROUND, GREY, SHADOW_COLORS, Color, color_map
from viewer.util.numbers import count, percent
from viewer.views.legend import Entry, Legend, Scale

_CROSS = {(1, 0): "+x", (1, 1): "+z", (1, 2): "-x", (1, 3): "-z", (0, 1): "+y", (2, 1): "-y"}  # row and column
_GAP = 0.06  # of a face's side, between the crosses
READABLE = 256  # pixels of a face beside which there is room for a legend
NOTHING_THERE: Color = (0.93, 0.94, 0.96)
COVERED: Color = SHADOW_COLORS[ShadowMode.FULL_SHADOW]


EMPTY, ONE, FEW, MANY = "nothing there", "covered by one triangle", "candidates to test", "too many: traced"
"""What cells are called: nothing is in them; a triangle covers them, before which there is nothing; few candidates; and
too many."""


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


@dataclass(frozen=True, eq=False)  # arrays cannot be compared as one
class CubeSeen:
    """A cube as it is drawn: `lengths` (6, side, side) int32 of the lists of its cells, -1 where these are too long, or
    where only one triangle is there, which covers the cell (`covered`); and the distances at which full shadow begins,
    `depths` (6, side, side) float32, inf for nowhere."""

    lengths: NDArray[np.int32]
    depths: NDArray[np.float32]

    @property
    def covered(self) -> NDArray[np.bool_]:
        """(6, side, side): cells of one triangle that covers them, before which there is nothing."""
        return (self.lengths < 0) & np.isfinite(self.depths)

    @cached_property
    def counts(self) -> dict[str, int]:
        """How many cells have what, by what they are called."""
        masks = self.lengths == 0, self.covered, self.lengths > 0, (self.lengths < 0) & ~self.covered
        return {name: int(mask.sum()) for name, mask in zip((EMPTY, ONE, FEW, MANY), masks, strict=True)}

    @property
    def longest(self) -> int:
        """What has the last colour of the map of lengths: the longest list, 2 at least."""
        return max(2, int(self.lengths.max(initial=0)))

    @property
    def range(self) -> tuple[float, float]:
        """The least and the largest distance at which full shadow begins; 1 and 1 where it begins nowhere."""
        there = self.depths[np.isfinite(self.depths)]
        return (float(there.min()), float(there.max())) if len(there) else (1.0, 1.0)

    def list_colors(self) -> NDArray[np.float32]:
        """Return (6, side, side, 3): what is known of each cell."""
        found = color_map()[np.clip((self.lengths - 1) * 255 // (self.longest - 1), 0, 255)]
        for mask, color in ((self.lengths == 0, NOTHING_THERE), (self.lengths < 0, GREY), (self.covered, COVERED)):
            found[mask] = color
        return found

    def depth_colors(self) -> NDArray[np.float32]:
        """Return (6, side, side, 3): where full shadow begins, by the logarithms of distances; background for
        nowhere."""
        there, (least, most) = np.isfinite(self.depths), np.log(self.range)
        found = np.broadcast_to(np.array(BACKGROUND, np.float32), (*self.depths.shape, 3)).copy()
        places = np.round((np.log(self.depths[there]) - least) * (255.0 / max(most - least, 1e-6))).astype(int)
        found[there] = color_map()[np.clip(places, 0, 255)]
        return found

    def list_legend(self, light: str) -> Legend:
        """Return the legend of what is known of each cell."""
        cells = sum(self.counts.values())

        def entry(name: str, color: Color | None, meaning: str) -> Entry:
            number = self.counts[name]
            return Entry(name, color, (percent(number, cells),), f"{meaning}: {count(number)} cells")

        entries = (
            entry(EMPTY, NOTHING_THERE, "nothing is in the way of any ray in this direction"),
            entry(ONE, COVERED, "before it there is nothing, behind it all is in shadow"),
            entry(MANY, GREY, "so many candidates that rays are traced instead of tested against them"),
        )
        facts = (entry(FEW, None, "a list of primitives that rays are tested against"),)
        return Legend(
            f"What {light} sees: lists", ("cells",), entries, Scale("1", f"{self.longest}", "candidates"), facts
        )

    def depth_legend(self) -> Legend:
        """Return the legend of where full shadow begins."""
        near, far = self.range
        nowhere = percent(int(np.isinf(self.depths).sum()), self.depths.size)
        entries = (Entry("nowhere", BACKGROUND, (nowhere,), "nothing covers these cells"),)
        scale = Scale(f"{near:.3g}", f"{far:.3g}", f"{float(np.sqrt(near * far)):.3g}")
        return Legend("Full shadow begins at a distance of", ("cells",), entries, scale)


def seen(cube: Cube) -> CubeSeen:
    """Return what is drawn of a cube."""
    return CubeSeen(list_lengths(cube), full_depths(cube))


def cross_of(colors: NDArray[np.float32], enlarged: int = 1) -> NDArray[np.uint8]:
    """(3 side, 4 side, 3) uint8, or so many times as large: colours of cells, unfolded."""
    cross = np.round(np.clip(unfolded(colors, np.array(BACKGROUND, np.float32)), 0.0, 1.0) * 255.0).astype(np.uint8)
    return cross.repeat(enlarged, 0).repeat(enlarged, 1)


def picture_of(cube: Cube, light: str = "") -> NDArray[np.uint8]:
    """Return (h, w, 3) uint8, row 0 at the top: what is known of each cell, and beside it where shadow begins; a pixel
    for each cell, or, with the name of a light, large enough for legends.

    Cells with nothing in them are white, those that one triangle covers have the colour of FULL_SHADOW, those with few
    candidates colours from one to the most that any has, and others are grey.  Depths go from the nearest to the
    farthest, in their logarithms; where nothing covers a cell there is only the background."""
    drawn = seen(cube)
    enlarged = max(1, -(-READABLE // cube.side)) if light else 1
    left, right = (cross_of(colors, enlarged) for colors in (drawn.list_colors(), drawn.depth_colors()))
    side = 2 * left.shape[0] // 3
    for cross, legend in ((left, drawn.list_legend(light)), (right, drawn.depth_legend())):
        told = with_legend(np.ascontiguousarray(cross[side:, side:]), legend, (1.0, 1.0)) if light else None
        if told is not None:
            cross[side:, side:] = told  # there is no face in this corner
    background = np.round(np.array(BACKGROUND) * 255.0).astype(np.uint8)
    gap = np.broadcast_to(background, (left.shape[0], max(1, round(_GAP * left.shape[0] / 3)), 3))
    return np.concatenate([left, gap, right], axis=1)
