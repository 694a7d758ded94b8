"""Primary rays: through pixel centres, row 0 at the top, vertical field of view."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.geometry.rays import INFINITY, Ray
from tracer.runtime.kernels import inlined
from tracer.scene.model import Camera
from tracer.simd import square_root


class Pinhole(NamedTuple):
    """A camera for a picture of a given size: its position, the direction through the picture's upper left corner, and
    the steps from there to the next column and the next row, (3,) float32 each; and spread, the width of a pixel at
    distance 1."""

    origin: NDArray[np.float32]
    corner: NDArray[np.float32]
    column: NDArray[np.float32]
    row: NDArray[np.float32]
    spread: np.float32


def pinhole(camera: Camera, width: int, height: int, shift: tuple[float, float] = (0.5, 0.5)) -> Pinhole:
    """The rays of a picture; `shift` is where in a pixel they pass, in pixels from its upper left corner."""
    right, up, forward = camera.basis()
    step = 2.0 * math.tan(math.radians(camera.angle) / 2.0) / height
    corner = forward + step * ((shift[0] - 0.5 * width) * right - (shift[1] - 0.5 * height) * up)
    vectors = np.stack([camera.position, corner, step * right, -step * up]).astype(np.float32)
    return Pinhole(vectors[0], vectors[1], vectors[2], vectors[3], np.float32(step))


@inlined
def primary_direction(camera, x, y):
    """Unit direction of the ray of the pixel in column x and row y, float32 or vectors of them."""
    dx = camera.corner[0] + x * camera.column[0] + y * camera.row[0]
    dy = camera.corner[1] + x * camera.column[1] + y * camera.row[1]
    dz = camera.corner[2] + x * camera.column[2] + y * camera.row[2]
    scale = np.float32(1) / square_root(dx * dx + dy * dy + dz * dz)
    return dx * scale, dy * scale, dz * scale


@inlined
def primary_ray(camera, x, y):
    """The ray of pixel (x, y), of unit direction."""
    dx, dy, dz = primary_direction(camera, np.float32(x), np.float32(y))
    return Ray(camera.origin[0], camera.origin[1], camera.origin[2], dx, dy, dz, np.float32(0), INFINITY)
