"""What hides a primitive: the occlusion test of §2.3 once more, pixel by pixel, for one primitive.

The kernel (`tracer.culling.occlusion`) keeps no more than that something is hidden.  Here the same tests say where, and
by what: each is the kernel's own source, run as plain Python, and so finds exactly what the frame has found.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.culling.cells import hits_unit
from tracer.geometry.as_python import as_python
from tracer.geometry.camera import Pinhole, primary_ray
from tracer.geometry.queries import Placed
from tracer.geometry.rays import MISS

_ray, _hits_unit = as_python(primary_ray), as_python(hits_unit)
_LEFT, _UPPER, _RIGHT, _LOWER = (-1, 0), (0, -1), (1, 0), (0, 1)

Pixel = tuple[int, int]
"""Column and row."""


class Seen(NamedTuple):
    """What the primary rays of a frame see: the world as it is placed for it, the rays, and at each pixel (h, w) the
    primitive and what of it carries modes, numbered from first (p + 1,) on (`tracer.culling.cells`); and whether the
    test goes both ways."""

    world: Placed
    rays: Pinhole
    primitives: NDArray[np.int32]
    units: NDArray[np.int32]
    first: NDArray[np.int32]
    symmetric: bool

    def meets(self, pixel: Pixel, primitive: int, unit: int) -> bool:
        """Whether the ray of a pixel meets a unit of a primitive, whatever lies in front of it."""
        with np.errstate(all="ignore"):
            return bool(_hits_unit(self.world, _ray(self.rays, *pixel), primitive, self.first, unit))


class OccludedBy(NamedTuple):
    """Where a unit is found to go on out of sight: at `pixel`, which sees `primitive` in front of it, MISS for nothing,
    beside a pixel that sees the unit; or at a pixel of the screen's edge, which sees the unit itself."""

    pixel: Pixel
    primitive: int
    at_edge: bool = False


class Reference(NamedTuple):
    """One of the two pixels that a pixel is compared with (Figure 3 of the paper), and the primitive that it sees.

    That is tested, against the ray of the pixel itself, unless both see the same, or the reference sees nothing; where
    the ray meets it, it is occluded there."""

    pixel: Pixel
    primitive: int
    tested: bool
    occluded: bool


def occluded_by(seen: Seen, unit: int, near: Pixel) -> OccludedBy | None:
    """Find where a unit is partially occluded, as near as can be to a pixel.

    Parameters
    ----------
    seen : Seen
        What the frame's primary rays see.
    unit : int
        The unit: a primitive, or a cell of one.
    near : (int, int)
        Column and row of the pixel.

    Returns
    -------
    OccludedBy or None
        Where it is, or None where no test finds it occluded.
    """
    (height, width), here = seen.primitives.shape, seen.units == unit
    rows, columns = np.nonzero(here)
    if not len(rows):
        return None
    primitive = int(seen.primitives[rows[0], columns[0]])
    found = []
    edge = (rows == 0) | (rows == height - 1) | (columns == 0) | (columns == width - 1)
    found += [OccludedBy((x, y), primitive, True) for x, y in zip(columns[edge].tolist(), rows[edge].tolist())]
    for dx, dy in (_RIGHT, _LOWER, *((_LEFT, _UPPER) if seen.symmetric else ())):
        x, y = columns + dx, rows + dy
        inside = (x >= 0) & (x < width) & (y >= 0) & (y < height)
        x, y = x[inside], y[inside]
        other = seen.primitives[y, x]
        differs = other != primitive
        pairs = zip(x[differs].tolist(), y[differs].tolist(), other[differs].tolist())
        found += [OccludedBy((x, y), number) for x, y, number in pairs]
    found.sort(key=lambda one: (one.pixel[0] - near[0]) ** 2 + (one.pixel[1] - near[1]) ** 2)
    return next((one for one in found if one.at_edge or seen.meets(one.pixel, primitive, unit)), None)


def references(seen: Seen, pixel: Pixel) -> tuple[Reference, ...]:
    """Compare a pixel with its left and its upper neighbour, as far as it has them."""
    x, y = pixel
    found = []
    for dx, dy in (_LEFT, _UPPER):
        if x + dx < 0 or y + dy < 0:
            continue
        at = y + dy, x + dx
        primitive, unit = int(seen.primitives[at]), int(seen.units[at])
        tested = primitive not in (MISS, int(seen.primitives[y, x]))
        found.append(Reference((x + dx, y + dy), primitive, tested, tested and seen.meets(pixel, primitive, unit)))
    return tuple(found)
