"""What a light sees: the cube of its buffer unfolded, by what is known of its cells, or by how far from the light all
is in shadow.

The cross is what somebody sees who stands at the light, y up, and looks around: in its middle row, from the left, along
+x, +z, -x and -z; above and below +z, up and down."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tracer.culling.modes import ShadowMode
from tracer.neighbours.lightbuffer.cubes import Cube
from tracer.neighbours.lightbuffer.tell import full_depths, list_lengths
from viewer.state.palette import BACKGROUND, GREY, LIGHT, SHADOW, Color, color_map
from viewer.util.numbers import count, percent
from viewer.views.legend import Entry, Legend, Scale

_CROSS = {(1, 0): "+x", (1, 1): "+z", (1, 2): "-x", (1, 3): "-z", (0, 1): "+y", (2, 1): "-y"}  # row and column
NOTHING_THERE: Color = LIGHT
COVERED: Color = SHADOW[ShadowMode.FULL_SHADOW].color


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
class Unfolded:
    """A cube as a picture (3 side, 4 side, 3) uint8, row 0 at the top, which can become a texture, and its legend."""

    picture: NDArray[np.uint8]
    legend: Legend

    def pixels(self, height: int = 0) -> NDArray[np.uint8]:
        return self.picture

    thumbnail = pixels


def by_lists(cube: Cube, light: str) -> Unfolded:
    """Unfold what is known of the cells of a light: nothing is in them, one triangle covers them, before which there is
    nothing, or they list candidates, by how many; too many of these are not listed."""
    lengths = list_lengths(cube)
    covered = (lengths < 0) & np.isfinite(full_depths(cube))
    longest = max(2, int(lengths.max(initial=0)))
    colors = color_map()[np.clip((lengths - 1) * 255 // (longest - 1), 0, 255)]

    def entry(name: str, cells: NDArray[np.bool_], color: Color | None, meaning: str) -> Entry:
        if color is not None:
            colors[cells] = color
        number = int(cells.sum())
        return Entry(name, color, (percent(number, cells.size),), f"{meaning}: {count(number)} cells")

    nothing = "nothing is in the way of any ray in this direction"
    before = "before it there is nothing, behind it all is in shadow"
    traced = "so many candidates that rays are traced instead of tested against them"
    entries = (
        entry("nothing there", lengths == 0, NOTHING_THERE, nothing),
        entry("covered by one triangle", covered, COVERED, before),
        entry("too many: traced", (lengths < 0) & ~covered, GREY, traced),
    )
    facts = (entry("candidates to test", lengths > 0, None, "a list of primitives that rays are tested against"),)
    scale = Scale("1", f"{longest}", "candidates")
    return Unfolded(_cross_of(colors), Legend(f"What {light} sees: lists", ("cells",), entries, scale, facts))


def by_depths(cube: Cube) -> Unfolded:
    """Unfold the distances at which full shadow begins, by their logarithms; background where it begins nowhere."""
    depths = full_depths(cube)
    there = np.isfinite(depths)
    near, far = (float(depths[there].min()), float(depths[there].max())) if there.any() else (1.0, 1.0)
    colors = np.broadcast_to(np.array(BACKGROUND, np.float32), (*depths.shape, 3)).copy()
    places = (np.log(depths[there]) - np.log(near)) * (255.0 / max(np.log(far) - np.log(near), 1e-6))
    colors[there] = color_map()[np.clip(np.round(places).astype(int), 0, 255)]
    nowhere = percent(int((~there).sum()), depths.size)
    entries = (Entry("nowhere", BACKGROUND, (nowhere,), "nothing covers these cells"),)
    scale = Scale(f"{near:.3g}", f"{far:.3g}", f"{float(np.sqrt(near * far)):.3g}")
    return Unfolded(_cross_of(colors), Legend("Full shadow begins at a distance of", ("cells",), entries, scale))


def _cross_of(colors: NDArray[np.float32]) -> NDArray[np.uint8]:
    return np.round(np.clip(unfolded(colors, np.array(BACKGROUND, np.float32)), 0.0, 1.0) * 255.0).astype(np.uint8)
