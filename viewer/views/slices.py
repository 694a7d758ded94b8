"""What lies in a plane through space: where the ray of each pixel meets it, and what voxels and trees share of that."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.frame import EVERYWHERE, Frame, Region
from tracer.geometry.camera import pinhole

FEWEST = 6.0
"""Pixels that parts of space must be wide for their borders to be drawn."""


class Met(NamedTuple):
    """Where the ray of each pixel meets a plane: `points` (h, w, 3), not a number where it does not, and how far away
    that is; `behind` says that something lies before it, and `per_pixel` is how wide a pixel is there."""

    points: NDArray[np.float32]
    behind: NDArray[np.bool_]
    per_pixel: NDArray[np.float32]


def met(frame: Frame, axis: int, place: float, where: Region = EVERYWHERE) -> Met:
    """Find where the rays of a frame, or of some of its pixels, meet a plane across an axis."""
    rays, depth = pinhole(frame.camera, frame.width, frame.height), frame.depth[where]
    x, y = np.arange(frame.width, dtype=np.float32)[where[1]], np.arange(frame.height, dtype=np.float32)[where[0]]
    points, plane = np.empty((*depth.shape, 3), np.float32), np.float32(place)
    with np.errstate(all="ignore"):
        ways = [rays.corner[k] + x * rays.column[k] + y[:, None] * rays.row[k] for k in range(3)]
        t = np.where(ways[axis] != 0.0, (plane - np.float32(rays.origin[axis])) / ways[axis], np.nan)
        t = np.where(t > 0.0, t, np.nan).astype(np.float32)
        for k in range(3):
            points[..., k] = plane + 0.0 * t if k == axis else rays.origin[k] + t * ways[k]
        distance = t * np.sqrt(ways[0] * ways[0] + ways[1] * ways[1] + ways[2] * ways[2])
        return Met(points, distance >= depth, distance * rays.spread)


def wide_enough(width: NDArray[np.float32] | float, per_pixel: NDArray[np.float32]) -> NDArray[np.bool_]:
    """Find where parts of space of this width are large enough for their borders to be drawn."""
    with np.errstate(invalid="ignore"):
        found: NDArray[np.bool_] = width >= FEWEST * per_pixel
    return found
