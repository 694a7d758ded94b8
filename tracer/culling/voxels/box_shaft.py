"""All shadow rays from a light that end in a box, and the planes around them.

The planes go through the light and edges of the box (E. Haines and J. Wallace, "Shaft Culling for Efficient Ray-Traced
Radiosity", Eurographics Workshop on Rendering, 1991): with the box's sides axis by axis, these are two for each pair of
axes from whose plane the light sees the box from outside.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.runtime.kernels import inlined, subkernel

PLANES = 6


class BoxShaft(NamedTuple):
    """What `put_box` makes, read like a `tracer.culling.certified.shaft.Shaft`.

    Attributes:
        planes: (PLANES, 4) float64, outward normals and offsets: the shaft lies where normal . x <= offset.
        box: (6,) float64, the lower and upper corner around light and box.
    """

    planes: NDArray[np.float64]
    box: NDArray[np.float64]


@inlined
def make_box_shaft():
    """Memory for a shaft."""
    return BoxShaft(np.zeros((PLANES, 4)), np.zeros(6))


@inlined
def _put_plane(planes, k, i, j, nx, ny, offset):
    """Put a plane along the third axis, with its normal along axes i and j."""
    for axis in range(3):
        planes[k, axis] = 0.0
    planes[k, i], planes[k, j], planes[k, 3] = nx, ny, offset


@subkernel
def put_box(shaft, light, center, half, rounded):
    """Put a shaft between light (3,) and the cube around center (3,) with half sides `half`; its planes are further out
    by `rounded`, in units of the scene."""
    for axis in range(3):
        shaft.box[axis] = min(light[axis], center[axis] - half) - rounded
        shaft.box[3 + axis] = max(light[axis], center[axis] + half) + rounded
    for pair in range(3):
        i, j = (1, 2) if pair == 0 else ((2, 0) if pair == 1 else (0, 1))
        li, lj = light[0], light[0]
        ci, cj = center[0], center[0]
        for axis in range(3):
            if axis == i:
                li, ci = light[axis], center[axis]
            if axis == j:
                lj, cj = light[axis], center[axis]
        x, y = ci - li, cj - lj
        if abs(x) <= half and abs(y) <= half:
            _put_plane(shaft.planes, 2 * pair, i, j, 0.0, 0.0, 1.0)
            _put_plane(shaft.planes, 2 * pair + 1, i, j, 0.0, 0.0, 1.0)
            continue
        # The corners farthest to the left and to the right, as seen from the light.
        left = right = 0
        for k in range(1, 4):
            kx, ky = x + (half if k & 1 else -half), y + (half if k & 2 else -half)
            lx, ly = x + (half if left & 1 else -half), y + (half if left & 2 else -half)
            rx, ry = x + (half if right & 1 else -half), y + (half if right & 2 else -half)
            if lx * ky - ly * kx > 0.0:
                left = k
            if rx * ky - ry * kx < 0.0:
                right = k
        for side in range(2):
            corner = left if side == 0 else right
            px, py = x + (half if corner & 1 else -half), y + (half if corner & 2 else -half)
            nx, ny = (-py, px) if side == 0 else (py, -px)
            size = math.sqrt(nx * nx + ny * ny)
            if size > 0.0:
                nx, ny = nx / size, ny / size
            _put_plane(shaft.planes, 2 * pair + side, i, j, nx, ny, nx * li + ny * lj + rounded)
