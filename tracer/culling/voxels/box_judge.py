"""Sixteen primitives against all rays from a light into a box, at once.

The functions U, V, D - U - V and D - T of `tracer.culling.certified.error_bounds` are linear in where a ray ends.  So
over a box their extremes are their values at its centre and, to either side, the sum of its half sides times their
gradient.  Triangles come as the columns of their rows in light space (`tracer.culling.certified.light_space`).
"""

from __future__ import annotations

import numpy as np

from tracer.culling.certified.error_bounds import ENLARGED, EPSILON, INSIDE, SMALL, ZERO
from tracer.culling.certified.light_space import BEHIND, CORNER, FARTHEST, OF_U, OF_V, D, U, V
from tracer.runtime.kernels import inlined
from tracer.simd import maximum

_INSIDE, _ENLARGED = np.float32(INSIDE), np.float32(2.5 * (ENLARGED + 7 * EPSILON))
_NEAR, _LONGEST, _AT = np.float32(19), np.float32(11), np.float32(2)


@inlined
def _change(x, y, z, half):
    """By how much a function with this gradient may differ from its value at the centre."""
    return half[0] * maximum(x, -x) + half[1] * maximum(y, -y) + half[2] * maximum(z, -z)


@inlined
def judge_box(t, light, center, half, longest):
    """Masks of the triangles that every ray from light (3,) into the box around center (3,) with half sides (3,) is
    certain to hit, and of those that none hits before it leaves the box, all float32.  Rays may go on beyond the box,
    until they are `longest`."""
    x, y, z = center[0] - light[0], center[1] - light[1], center[2] - light[2]
    ax, ay, az = center[0] - t[CORNER], center[1] - t[CORNER + 1], center[2] - t[CORNER + 2]
    # Sums of coordinates are no less than lengths.
    across = half[0] + half[1] + half[2]
    far = abs(x) + abs(y) + abs(z) + across
    near = maximum(ax, -ax) + maximum(ay, -ay) + maximum(az, -az) + across
    at = abs(center[0]) + abs(center[1]) + abs(center[2]) + across

    # Find the least and the greatest of each function.
    ux, uy, uz, vx, vy, vz = t[U], t[U + 1], t[U + 2], t[V], t[V + 1], t[V + 2]
    dx, dy, dz = t[D], t[D + 1], t[D + 2]
    wx, wy, wz = dx - ux - vx, dy - uy - vy, dz - uz - vz
    u, v, d = ux * x + uy * y + uz * z, vx * x + vy * y + vz * z, dx * x + dy * y + dz * z
    w, behind = d - u - v, dx * ax + dy * ay + dz * az
    ru, rv, rw = _change(ux, uy, uz, half), _change(vx, vy, vz, half), _change(wx, wy, wz, half)
    rd = _change(dx, dy, dz, half)

    # Compare them with what they may be wrong by.
    of_d = _ENLARGED * (maximum(d, -d) + rd) + SMALL
    of_u, of_v, of_w = t[OF_U] * far + of_d, t[OF_V] * far + of_d, (t[OF_U] + t[OF_V]) * far + of_d
    of_behind = t[BEHIND] * (_NEAR * near + _LONGEST * far + _AT * at) + SMALL
    hit = (t[FARTHEST] > longest) & (behind - rd > of_behind)
    hit = hit & (u - ru > _INSIDE * of_u) & (v - rv > _INSIDE * of_v) & (w - rw > _INSIDE * of_w)
    missed = (u + ru < -of_u) | (v + rv < -of_v) | (w + rw < -of_w) | (behind + rd < -of_behind)
    return hit, missed & (t[FARTHEST] >= ZERO)
