"""The shaft of a cell: all shadow rays from a light that end in it, with planes around them.

Shadow rays start at the light and end a little above the surface: no lower than a part of the usual offset, no higher
than `SceneScale.max_height`.  They look their cell up by coordinates that are rounded.  So the cell is a prism, as wide
as where its rays may truly end, and a shaft is what lies between the light and the six corners of that prism.  No ray
that ends outside the prism is led to the cell (`lookup`).

A shaft stands for all its rays, as in shaft culling (E. Haines and J. Wallace, "Shaft Culling for Efficient Ray-Traced
Radiosity", Eurographics Workshop on Rendering, 1991).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.culling.certified.error_bounds import EPSILON, cross, dot, length, row_of
from tracer.geometry.rays import RAY_OFFSET
from tracer.runtime.kernels import inlined, subkernel

LOWEST = 0.5  # of RAY_OFFSET: a ray that ends lower belongs to no cell
CORNERS = 6  # of a cell: three of its floor, then three of its ceiling
PLANES = 4  # around a shaft: three through the light and an edge of the cell, then the cell's floor


class SceneScale(NamedTuple):
    """What the errors of float32 grow with.

    Attributes:
        max_height: how far above a surface a ray may end that has a cell, in units of the scene.
        max_coordinate: no coordinate of static geometry is larger, with room for what may come to rest.
    """

    max_height: float
    max_coordinate: float


class Shaft(NamedTuple):
    """A cell and, once `put_light` has been called, a light.

    Attributes:
        corners: (3, CORNERS) float64, x, y and z of the prism's corners, floor first.
        directions: (3, CORNERS) float64, from the light to each of them.
        planes: (PLANES, 4) float64, outward unit normals and offsets: the shaft lies where normal . x <= offset.
        box: (6,) float64, the lower and upper corner around it, light included.
        longest: (1,) float64, the length of the longest direction.
    """

    corners: NDArray[np.float64]
    directions: NDArray[np.float64]
    planes: NDArray[np.float64]
    box: NDArray[np.float64]
    longest: NDArray[np.float64]


def make_shaft() -> Shaft:
    """Memory for a shaft."""
    return Shaft(np.zeros((3, CORNERS)), np.zeros((3, CORNERS)), np.zeros((PLANES, 4)), np.zeros(6), np.zeros(1))


@inlined
def slack_of(e1, e2, max_coordinate):
    """By how much the coordinates of a point may be wrong in look-up: (du, dv, height).

    e1 and e2 are the triangle's edges; u and v are barycentric, the height is above the triangle.  Look-up works in
    float32: a difference, a dot product and dual vectors that were rounded, at points no further from the corner than
    the edges are long; and points beyond the edges add a little of the largest coordinate."""
    l1, l2 = length(e1), length(e2)
    across = length(cross(e1, e2))
    far = 8 * EPSILON * (l1 + l2)
    at = far + 4 * EPSILON * max_coordinate
    return at * l2 / across + 4 * EPSILON, at * l1 / across + 4 * EPSILON, far


@inlined
def _corner(corners, k):
    """The k-th corner, or direction to one."""
    return corners[0, k], corners[1, k], corners[2, k]


@inlined
def _least_coordinate(corners):
    """A number that the largest coordinate of any point between the corners is no smaller than."""
    least = 0.0
    for axis in range(3):
        low, high = np.inf, -np.inf
        for k in range(3):
            low, high = min(low, corners[axis, k]), max(high, corners[axis, k])
        if low > 0.0:
            least = max(least, low)
        elif high < 0.0:
            least = max(least, -high)
    return least


@subkernel
def put_cell(shaft, rows, i, side, u, v, size, scale):
    """Put a shaft's corners and floor to a cell; False where the triangle is too thin to tell above from below.

    The cell belongs to triangle i of rows (n, ROW), to its front for side 1 and to its back for -1; its corners are
    (u, v), (u + size, v) and (u, v + size).  scale is a `SceneScale`."""
    a, e1, e2 = row_of(rows, i)
    normal = cross(e1, e2)
    across = length(normal)
    if not across > 0.0:
        return False
    normal = side * normal[0] / across, side * normal[1] / across, side * normal[2] / across

    # Widen the cell by what look-up may mistake coordinates by.
    du, dv, wrong = slack_of(e1, e2, scale.max_coordinate)
    way = 1.0 if size > 0.0 else -1.0
    dw = way * (du + dv + 4 * EPSILON)
    du, dv = way * du, way * dv
    u0, v0, u1, v1 = u - du, v - dv, u + size + dv + dw, v + size + du + dw
    for k in range(3):
        x = u1 if k == 1 else u0
        y = v1 if k == 2 else v0
        for axis in range(3):
            shaft.corners[axis, k] = a[axis] + x * e1[axis] + y * e2[axis]

    # Raise the floor to where the lowest rays end.  Look-up goes by the largest coordinate of where they end, which is
    # not quite on the plane.
    lowest = 0.999 * LOWEST * RAY_OFFSET * _least_coordinate(shaft.corners) - wrong
    for axis in range(3):
        for k in range(3):
            at = shaft.corners[axis, k]
            shaft.corners[axis, k] = at + lowest * normal[axis]
            shaft.corners[axis, 3 + k] = at + (scale.max_height + wrong) * normal[axis]
        shaft.planes[3, axis] = -normal[axis]
    shaft.planes[3, 3] = -dot(normal, _corner(shaft.corners, 0))
    return True


@subkernel
def put_light(shaft, light):
    """Put a shaft that has a cell to a light (3,): directions, box and side planes.

    False where the light is not clearly before the cell's plane."""
    # Find the directions to the corners, and the longest.
    longest = 0.0
    for k in range(CORNERS):
        square = 0.0
        for axis in range(3):
            d = shaft.corners[axis, k] - light[axis]
            shaft.directions[axis, k] = d
            square += d * d
        longest = max(longest, square)
    shaft.longest[0] = math.sqrt(longest)

    # Bound light and corners by a box.
    for axis in range(3):
        low = high = light[axis]
        for k in range(CORNERS):
            low, high = min(low, shaft.corners[axis, k]), max(high, shaft.corners[axis, k])
        shaft.box[axis], shaft.box[3 + axis] = low, high

    # Refuse a light that does not see the cell's plane from above, at more than a graze.
    below = shaft.planes[3, 0], shaft.planes[3, 1], shaft.planes[3, 2]
    for k in range(3, CORNERS):
        if not dot(below, _corner(shaft.directions, k)) > 1e-4 * shaft.longest[0]:
            return False
    for j in range(3):
        _put_side(shaft, light, j, (j + 1) % 3, (j + 2) % 3)
    return True


@inlined
def _put_side(shaft, light, i, j, opposite):
    """Put the plane through the light and the cell's edge from corner i to j, so far out that all lies behind it."""
    n = cross(_corner(shaft.directions, i), _corner(shaft.directions, j))
    ln = length(n)
    scale = 1.0 / ln if ln > 0.0 else 0.0
    if dot(n, _corner(shaft.directions, opposite)) > 0.0:
        scale = -scale
    n = n[0] * scale, n[1] * scale, n[2] * scale
    most = 0.0
    for k in range(CORNERS):
        most = max(most, dot(n, _corner(shaft.directions, k)))
    for axis in range(3):
        shaft.planes[i, axis] = n[axis]
    shaft.planes[i, 3] = dot(n, light) + most if ln > 0.0 else np.inf


@subkernel
def meets_box(shaft, box):
    """Whether a box (6,), lower and upper corner, may meet a shaft."""
    for axis in range(3):
        if box[axis] > shaft.box[3 + axis] or box[3 + axis] < shaft.box[axis]:
            return False
    for k in range(PLANES):
        least = -shaft.planes[k, 3]
        for axis in range(3):
            n = shaft.planes[k, axis]
            least += n * (box[axis] if n > 0.0 else box[3 + axis])
        if least > 0.0:
            return False
    return True
