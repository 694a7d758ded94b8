"""The shaft of a cell: all shadow rays from a light that end in it, with planes around them.

A light is a point or a lamp of many samples, which lie in a box: then the shaft is what lies between that box and the
cell.

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
from tracer.geometry.offsets import RAY_OFFSET
from tracer.kernels import inlined, subkernel

LOWEST = 0.5  # of RAY_OFFSET: a ray that ends lower belongs to no cell
CORNERS = 6  # of a cell: three of its floor, then three of its ceiling
LAMP_CORNERS = 8  # of the box around a lamp's samples
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
        lamp: (LAMP_CORNERS, 3) float32, the corners of the light: its place where it is a point.
        used: (1,) int64, how many these are, 1 for a point.
        directions: (3, LAMP_CORNERS * CORNERS) float64, from each of them to each corner of the prism.
        planes: (PLANES, 4) float64, outward unit normals and offsets: the shaft lies where normal . x <= offset.
        box: (6,) float64, the lower and upper corner around it, light included.
        longest: (1,) float64, the length of the longest direction.
    """

    corners: NDArray[np.float64]
    lamp: NDArray[np.float32]
    used: NDArray[np.int64]
    directions: NDArray[np.float64]
    planes: NDArray[np.float64]
    box: NDArray[np.float64]
    longest: NDArray[np.float64]


def make_shaft() -> Shaft:
    """Memory for a shaft."""
    return Shaft(
        corners=np.zeros((3, CORNERS)),
        lamp=np.zeros((LAMP_CORNERS, 3), np.float32),
        used=np.zeros(1, np.int64),
        directions=np.zeros((3, LAMP_CORNERS * CORNERS)),
        planes=np.zeros((PLANES, 4)),
        box=np.zeros(6),
        longest=np.zeros(1),
    )


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


@inlined
def is_point(corners):
    """Whether the corners (LAMP_CORNERS, 3) of a light are all in one place."""
    one = True
    for axis in range(3):
        one &= corners[0, axis] == corners[LAMP_CORNERS - 1, axis]  # opposite corners of a box
    return one


@subkernel
def put_light(shaft, lamp):
    """Put a shaft that has a cell to a light with corners lamp (LAMP_CORNERS, 3) float32.

    That is directions, box and side planes.  False where the light is not clearly before the cell's plane."""
    used = 1 if is_point(lamp) else LAMP_CORNERS
    shaft.used[0] = used

    # Find the directions to the corners, and the longest.
    longest = 0.0
    for j in range(used):
        for axis in range(3):
            shaft.lamp[j, axis] = lamp[j, axis]
        for k in range(CORNERS):
            square = 0.0
            for axis in range(3):
                d = shaft.corners[axis, k] - np.float64(lamp[j, axis])
                shaft.directions[axis, CORNERS * j + k] = d
                square += d * d
            longest = max(longest, square)
    shaft.longest[0] = math.sqrt(longest)

    # Bound light and corners by a box.
    for axis in range(3):
        low = high = np.float64(lamp[0, axis])
        for j in range(1, used):
            low, high = min(low, np.float64(lamp[j, axis])), max(high, np.float64(lamp[j, axis]))
        for k in range(CORNERS):
            low, high = min(low, shaft.corners[axis, k]), max(high, shaft.corners[axis, k])
        shaft.box[axis], shaft.box[3 + axis] = low, high

    # Refuse a light that does not see the cell's plane from above, at more than a graze.
    below = shaft.planes[3, 0], shaft.planes[3, 1], shaft.planes[3, 2]
    for j in range(used):
        for k in range(3, CORNERS):
            if not dot(below, _corner(shaft.directions, CORNERS * j + k)) > 1e-4 * shaft.longest[0]:
                return False
    for j in range(3):
        _put_side(shaft, used, j, (j + 1) % 3, (j + 2) % 3)
    return True


@inlined
def _put_side(shaft, used, i, j, opposite):
    """Put the plane through a corner of the light and the cell's edge from corner i to j, so far out that all lies
    behind it; through that corner for which this is the least."""
    best = np.inf
    for axis in range(3):
        shaft.planes[i, axis] = 0.0
    shaft.planes[i, 3] = np.inf
    for corner in range(used):
        first = CORNERS * corner
        n = cross(_corner(shaft.directions, first + i), _corner(shaft.directions, first + j))
        ln = length(n)
        if not ln > 0.0:
            continue
        scale = 1.0 / ln
        if dot(n, _corner(shaft.directions, first + opposite)) > 0.0:
            scale = -scale
        n = n[0] * scale, n[1] * scale, n[2] * scale
        most = 0.0
        for k in range(CORNERS):
            most = max(most, dot(n, _corner(shaft.directions, first + k)))
        light = np.float64(shaft.lamp[corner, 0]), np.float64(shaft.lamp[corner, 1]), np.float64(shaft.lamp[corner, 2])
        for other in range(used):
            x, y, z = (
                np.float64(shaft.lamp[other, 0]) - light[0],
                np.float64(shaft.lamp[other, 1]) - light[1],
                np.float64(shaft.lamp[other, 2]) - light[2],
            )
            most = max(most, dot(n, (x, y, z)))
        if most < best:
            best = most
            for axis in range(3):
                shaft.planes[i, axis] = n[axis]
            shaft.planes[i, 3] = dot(n, light) + most


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
