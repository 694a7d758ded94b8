"""The prism of a cell: where its shadow rays may end.

Shadow rays start at the light and end a little above the surface: no lower than a part of the usual offset, no higher
than `SceneScale.max_height`.  They look their cell up by coordinates that are rounded.  So the cell is a prism, as wide
as where its rays may truly end.  No ray that ends outside the prism is led to the cell (`lookup`).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tracer.geometry.rays import RAY_OFFSET
from tracer.runtime.kernels import inlined, subkernel
from tracer.visibility.error_bounds import EPSILON, cross, dot, length, row_of
from tracer.visibility.shaft import corner_of

LOWEST = 0.5  # of RAY_OFFSET: a ray that ends lower belongs to no cell


class SceneScale(NamedTuple):
    """What the errors of float32 grow with.

    Attributes:
        max_height: how far above a surface a ray may end that has a cell, in units of the scene.
        max_coordinate: no coordinate of static geometry is larger, with room for what may come to rest.
    """

    max_height: float
    max_coordinate: float


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
    shaft.planes[3, 3] = -dot(normal, corner_of(shaft.corners, 0))
    return True
