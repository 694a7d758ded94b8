"""The shaft of shadow rays from a light to a cell: its corners, and planes that bound it.

A cell is a piece of a triangle's plane, as wide as where its rays may truly end: they end above the surface,
by no less than a part of the usual offset and no more than a bound, and look their cell up by coordinates that
are rounded.  So it is a prism, of six corners, and `lookup` sends no ray to it that ends elsewhere.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.culling.certified.error_bounds import EPSILON, cross, dot, length, row_of
from tracer.geometry.offsets import RAY_OFFSET
from tracer.kernels import inlined, subkernel

LOWEST = 0.5  # of RAY_OFFSET: what ends lower belongs to no cell
CORNERS = 6  # of a cell: three below and three above
PLANES = 4  # three through the light and an edge of the cell, and the cell's own


class Shaft(NamedTuple):
    """corners and directions from the light (3, CORNERS) float64, of which the first three are below and the others
    above; planes (PLANES, 4), normals and offsets, behind which it lies; box (6,) around it; reach (1,), the longest
    direction."""

    corners: NDArray[np.float64]
    directions: NDArray[np.float64]
    planes: NDArray[np.float64]
    box: NDArray[np.float64]
    reach: NDArray[np.float64]


def make_shaft() -> Shaft:
    return Shaft(np.zeros((3, CORNERS)), np.zeros((3, CORNERS)), np.zeros((PLANES, 4)), np.zeros(6), np.zeros(1))


@inlined
def slack_of(e1, e2, largest):
    """By how much (u, v) of a point over a triangle may be wrong in look-up, (du, dv), and its height above it.

    Of lookups in float32: a difference, a dot product and dual vectors that were rounded, no further from the corner
    than the edges are long; and a little of the scene's largest coordinate, for points beyond the edges."""
    l1, l2 = length(e1), length(e2)
    across = length(cross(e1, e2))
    far = 8 * EPSILON * (l1 + l2)
    at = far + 4 * EPSILON * largest
    return at * l2 / across + 4 * EPSILON, at * l1 / across + 4 * EPSILON, far


@inlined
def _corner(corners, k):
    return corners[0, k], corners[1, k], corners[2, k]


@inlined
def _least_coordinate(corners):
    """No point between the corners has a smaller largest coordinate."""
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
def put_cell(shaft, rows, i, side, u, v, size, highest, largest):
    """The corners of a cell of triangle i of rows (n, ROW), on its front for side 1 and on its back for -1.

    Its place in the triangle is (u, v), (u + size, v) and (u, v + size); highest is how far above rays end at
    most, largest the scene's largest coordinate.  False where it is too thin to tell above from below."""
    a, e1, e2 = row_of(rows, i)
    normal = cross(e1, e2)
    across = length(normal)
    if not across > 0.0:
        return False
    normal = side * normal[0] / across, side * normal[1] / across, side * normal[2] / across
    du, dv, wrong = slack_of(e1, e2, largest)
    way = 1.0 if size > 0.0 else -1.0
    dw = way * (du + dv + 4 * EPSILON)
    du, dv = way * du, way * dv
    u0, v0, u1, v1 = u - du, v - dv, u + size + dv + dw, v + size + du + dw
    for k in range(3):
        x = u1 if k == 1 else u0
        y = v1 if k == 2 else v0
        for axis in range(3):
            shaft.corners[axis, k] = a[axis] + x * e1[axis] + y * e2[axis]
    # Look-up goes by the largest coordinate of where rays end, which is not quite on the plane.
    lowest = 0.999 * LOWEST * RAY_OFFSET * _least_coordinate(shaft.corners) - wrong
    for axis in range(3):
        for k in range(3):
            at = shaft.corners[axis, k]
            shaft.corners[axis, k] = at + lowest * normal[axis]
            shaft.corners[axis, 3 + k] = at + (highest + wrong) * normal[axis]
        shaft.planes[3, axis] = -normal[axis]
    shaft.planes[3, 3] = -dot(normal, _corner(shaft.corners, 0))
    return True


@subkernel
def put_light(shaft, light):
    """Directions from a light to the corners of a cell, and all that bounds the shaft.

    False where the light is not clearly before the cell's plane."""
    longest = 0.0
    for k in range(CORNERS):
        square = 0.0
        for axis in range(3):
            d = shaft.corners[axis, k] - light[axis]
            shaft.directions[axis, k] = d
            square += d * d
        longest = max(longest, square)
    for axis in range(3):
        low = high = light[axis]
        for k in range(CORNERS):
            low, high = min(low, shaft.corners[axis, k]), max(high, shaft.corners[axis, k])
        shaft.box[axis], shaft.box[3 + axis] = low, high
    shaft.reach[0] = math.sqrt(longest)
    below = shaft.planes[3, 0], shaft.planes[3, 1], shaft.planes[3, 2]
    for k in range(3, CORNERS):  # the light must see the cell's plane from above, at more than a graze
        if not dot(below, _corner(shaft.directions, k)) > 1e-4 * shaft.reach[0]:
            return False
    for j in range(3):
        _put_side(shaft, light, j, (j + 1) % 3, (j + 2) % 3)
    return True


@inlined
def _put_side(shaft, light, i, j, opposite):
    """The plane through the light and the cell's edge from corner i to j."""
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
def meets_box(b, box):
    """Whether a box (6,) may meet a shaft."""
    for axis in range(3):
        if box[axis] > b.box[3 + axis] or box[3 + axis] < b.box[axis]:
            return False
    for k in range(PLANES):
        least = -b.planes[k, 3]
        for axis in range(3):
            n = b.planes[k, axis]
            least += n * (box[axis] if n > 0.0 else box[3 + axis])
        if least > 0.0:
            return False
    return True
