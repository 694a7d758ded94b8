"""Shafts: all shadow rays from a light that end in a prism, or in a box, with planes around them.

A shaft stands for all its rays, as in shaft culling (E. Haines and J. Wallace, "Shaft Culling for Efficient Ray-Traced
Radiosity", Eurographics Workshop on Rendering, 1991).  It is the part of a box that lies behind some planes: what lies
outside of the box, or before a plane, meets no ray.  The planes around a prism go through the light and the edges of
its triangle; those around a box through the light and edges of the box, two for each pair of axes from whose plane the
light sees the box from outside.  `beams` are the same for lights that are balls.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.runtime.kernels import inlined, subkernel
from tracer.simd import maximum, minimum
from tracer.visibility.error_bounds import ZERO, cross, dot, length

CORNERS = 6  # of a prism: three of its floor, then three of its ceiling
PRISM_PLANES = 4  # three through the light and an edge of the floor, then the floor
BOX_PLANES = 6  # two for each pair of axes


class Shaft(NamedTuple):
    """The rays from a light to a box.

    Attributes:
        planes: (k, 4) float64, outward unit normals and offsets: the shaft lies where normal . x <= offset.
        box: (6,) float64, the lower and upper corner around it, light included.
    """

    planes: NDArray[np.float64]
    box: NDArray[np.float64]


class PrismShaft(NamedTuple):
    """The rays from a light to a prism: a `Shaft`, once `put_light` has been called, with

    Attributes:
        corners: (3, CORNERS) float64, x, y and z of the prism's corners, floor first.
        directions: (3, CORNERS) float64, from the light to each of them.
        longest: (1,) float64, no less than the length of any ray.
        radius: (1,) float64, that of the ball in which the light is, around where it was put; 0 for a point.
    """

    planes: NDArray[np.float64]
    box: NDArray[np.float64]
    corners: NDArray[np.float64]
    directions: NDArray[np.float64]
    longest: NDArray[np.float64]
    radius: NDArray[np.float64]


@inlined
def make_shaft():
    """Memory for a shaft to a box."""
    return Shaft(np.zeros((BOX_PLANES, 4)), np.zeros(6))


def make_prism_shaft() -> PrismShaft:
    """Memory for a shaft to a prism."""
    corners = np.zeros((3, CORNERS)), np.zeros((3, CORNERS))
    return PrismShaft(np.zeros((PRISM_PLANES, 4)), np.zeros(6), *corners, np.zeros(1), np.zeros(1))


# --- what lies outside ------------------------------------------------------------------------------------


@inlined
def _plane(shaft, k):
    """The k-th plane's normal (3,) and offset, float32."""
    p = shaft.planes
    return (np.float32(p[k, 0]), np.float32(p[k, 1]), np.float32(p[k, 2])), np.float32(p[k, 3])


@inlined
def box_outside(shaft, low, high):
    """Whether boxes from `low` to `high`, three numbers or three vectors of lanes each, lie outside of a shaft.

    What is outside by less than float32 rounds planes by may be told to be so: boxes are to have room for that."""
    b = shaft.box
    outside = (low[0] > np.float32(b[3])) | (low[1] > np.float32(b[4])) | (low[2] > np.float32(b[5]))
    outside = outside | (high[0] < np.float32(b[0])) | (high[1] < np.float32(b[1])) | (high[2] < np.float32(b[2]))
    for k in range(len(shaft.planes)):
        n, offset = _plane(shaft, k)
        # Of each box the corner that is farthest behind the plane.
        x = low[0] if n[0] > ZERO else high[0]
        y = low[1] if n[1] > ZERO else high[1]
        z = low[2] if n[2] > ZERO else high[2]
        outside = outside | (x * n[0] + y * n[1] + z * n[2] > offset)
    return outside


@inlined
def triangle_outside(shaft, corner, e1, e2, radius):
    """Mask of the triangles, vectors of lanes, of which all within a radius around them lies outside of a shaft."""
    outside = radius < -radius
    for axis in range(3):
        first, second, b = e1[axis], e2[axis], shaft.box
        low, high = minimum(ZERO, minimum(first, second)), maximum(ZERO, maximum(first, second))
        outside = outside | (corner[axis] + low - radius > np.float32(b[3 + axis]))
        outside = outside | (corner[axis] + high + radius < np.float32(b[axis]))
    for k in range(len(shaft.planes)):
        n, offset = _plane(shaft, k)
        least = dot(corner, n) + minimum(ZERO, minimum(dot(e1, n), dot(e2, n)))
        outside = outside | (least - radius > offset)
    return outside


# --- around a prism ---------------------------------------------------------------------------------------


@inlined
def corner_of(corners, k):
    """The k-th corner, or direction to one."""
    return corners[0, k], corners[1, k], corners[2, k]


@subkernel
def put_light(shaft, light, radius):
    """Put a shaft that has a cell to a light, a point of a ball around light (3,): directions, box and side planes.

    False where the light is not clearly before the cell's plane, wherever it is."""
    # Find the directions to the corners, and the longest.
    longest = 0.0
    for k in range(CORNERS):
        square = 0.0
        for axis in range(3):
            d = shaft.corners[axis, k] - light[axis]
            shaft.directions[axis, k] = d
            square += d * d
        longest = max(longest, square)
    shaft.longest[0], shaft.radius[0] = math.sqrt(longest) + radius, radius

    # Bound light and corners by a box.
    for axis in range(3):
        low = high = light[axis]
        for k in range(CORNERS):
            low, high = min(low, shaft.corners[axis, k]), max(high, shaft.corners[axis, k])
        shaft.box[axis], shaft.box[3 + axis] = min(low, light[axis] - radius), max(high, light[axis] + radius)

    # Refuse a light that does not see the cell's plane from above, at more than a graze.
    below = shaft.planes[3, 0], shaft.planes[3, 1], shaft.planes[3, 2]
    for k in range(3, CORNERS):
        if not dot(below, corner_of(shaft.directions, k)) - radius > 1e-4 * shaft.longest[0]:
            return False
    for j in range(3):
        _put_side(shaft, light, j, (j + 1) % 3, (j + 2) % 3)
    return True


@inlined
def _tilted(n, first, second, radius):
    """The normal n of a plane through the light and two corners, in these directions, tilted about the line between
    them until all of a ball around the light is behind the plane; n itself where the ball reaches the line."""
    edge = second[0] - first[0], second[1] - first[1], second[2] - first[2]
    along = dot(first, edge) / dot(edge, edge)
    away = along * edge[0] - first[0], along * edge[1] - first[1], along * edge[2] - first[2]
    far = length(away)
    sine = radius / far
    if not sine < 1.0:
        return n
    cosine, part = math.sqrt(1.0 - sine * sine), sine / far
    return cosine * n[0] - part * away[0], cosine * n[1] - part * away[1], cosine * n[2] - part * away[2]


@inlined
def _put_side(shaft, light, i, j, opposite):
    """Put the plane through the light, or beside its ball, and the cell's edge from corner i to j, so far out that all
    lies behind it."""
    n = cross(corner_of(shaft.directions, i), corner_of(shaft.directions, j))
    ln = length(n)
    scale = 1.0 / ln if ln > 0.0 else 0.0
    if dot(n, corner_of(shaft.directions, opposite)) > 0.0:
        scale = -scale
    n, most = (n[0] * scale, n[1] * scale, n[2] * scale), shaft.radius[0]
    if most > 0.0:
        n = _tilted(n, corner_of(shaft.directions, i), corner_of(shaft.directions, j), most)
    for k in range(CORNERS):
        most = max(most, dot(n, corner_of(shaft.directions, k)))
    for axis in range(3):
        shaft.planes[i, axis] = n[axis]
    shaft.planes[i, 3] = dot(n, light) + most if ln > 0.0 else np.inf


# --- around a box -----------------------------------------------------------------------------------------


@inlined
def _put_upright(planes, k, i, j, nx, ny, offset):
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
        x, y = center[i] - light[i], center[j] - light[j]
        if abs(x) <= half and abs(y) <= half:
            _put_upright(shaft.planes, 2 * pair, i, j, 0.0, 0.0, 1.0)
            _put_upright(shaft.planes, 2 * pair + 1, i, j, 0.0, 0.0, 1.0)
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
            _put_upright(shaft.planes, 2 * pair + side, i, j, nx, ny, nx * light[i] + ny * light[j] + rounded)
