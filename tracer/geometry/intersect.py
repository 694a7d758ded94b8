"""One ray against a triangle, a sphere or a cone: the scalar tests, as the kd-tree makes them.

A triangle is stored as a corner and two edges (9 float32).  A quadric is stored as a canonical sphere or cone and the
affine map that takes the world there (16 float32), so that any transform fits both.  Memory is read through flat
pointers (`tracer.geometry.memory`).
"""

from __future__ import annotations

import math

import numpy as np

from tracer.geometry.rays import INFINITY, Ray
from tracer.runtime.kernels import inlined, subkernel
from tracer.scene.model import SPHERE

ZERO = np.float32(0)
ONE = np.float32(1)
NEAR = np.float32(1e-5)  # of the distance of a ray's origin: more than the error of t on triangles it does not graze

# Columns of a quadric's row; the map to canonical space fills the first 12.
KIND, R0, R1, INSIDE = 12, 13, 14, 15


@inlined
def hit_triangle(ray, triangles, i):
    """(t, u, v) of a ray on the i-th triangle, seen from both sides; t = inf for a miss.

    These are the triple products of Moeller and Trumbore (1997), with one normal for det and t, so that what lies just
    above a triangle is seen there.  For a ray in the triangle's plane they are noise; so a hit counts only near the
    triangle (`_is_near`)."""
    r = 9 * i
    e1x, e1y, e1z = triangles[r + 3], triangles[r + 4], triangles[r + 5]
    e2x, e2y, e2z = triangles[r + 6], triangles[r + 7], triangles[r + 8]
    nx, ny, nz = e1y * e2z - e1z * e2y, e1z * e2x - e1x * e2z, e1x * e2y - e1y * e2x
    det = -(ray.dx * nx + ray.dy * ny + ray.dz * nz)
    if det == ZERO:
        return INFINITY, ZERO, ZERO
    f = ONE / det
    sx, sy, sz = ray.ox - triangles[r], ray.oy - triangles[r + 1], ray.oz - triangles[r + 2]
    qx, qy, qz = sy * ray.dz - sz * ray.dy, sz * ray.dx - sx * ray.dz, sx * ray.dy - sy * ray.dx
    u = f * (e2x * qx + e2y * qy + e2z * qz)
    if not (u >= ZERO and u <= ONE):
        return INFINITY, ZERO, ZERO
    v = -f * (e1x * qx + e1y * qy + e1z * qz)
    if not (v >= ZERO and u + v <= ONE):
        return INFINITY, ZERO, ZERO
    t = f * (sx * nx + sy * ny + sz * nz)
    if not (t > ray.t_min and t < ray.t_max):
        return INFINITY, ZERO, ZERO
    near = _is_near(sx + t * ray.dx, sy + t * ray.dy, sz + t * ray.dz, abs(sx) + abs(sy) + abs(sz), triangles, r)
    return (t, u, v) if near else (INFINITY, ZERO, ZERO)


@inlined
def _is_near(x, y, z, away, triangles, r):
    """Whether a point, (x, y, z) from the triangle's corner, lies no further outside the triangle's box than that is
    wide, plus a little of the distance from the ray's origin, which is `away` from the corner."""
    x1, y1, z1, x2, y2, z2 = (triangles[r + 3], triangles[r + 4], triangles[r + 5],
                              triangles[r + 6], triangles[r + 7], triangles[r + 8])  # fmt: skip
    low_x, low_y, low_z = min(ZERO, min(x1, x2)), min(ZERO, min(y1, y2)), min(ZERO, min(z1, z2))
    high_x, high_y, high_z = max(ZERO, max(x1, x2)), max(ZERO, max(y1, y2)), max(ZERO, max(z1, z2))
    room = max(high_x - low_x, max(high_y - low_y, high_z - low_z)) + NEAR * away
    return (
        x >= low_x - room and x <= high_x + room
        and y >= low_y - room and y <= high_y + room
        and z >= low_z - room and z <= high_z + room
    )  # fmt: skip


@inlined
def transform_ray(ray, maps, i, stride):
    """A ray under the i-th affine map, 12 numbers row by row.

    The direction is not normalised, so that t stays the same."""
    m = stride * i
    return Ray(
        maps[m] * ray.ox + maps[m + 1] * ray.oy + maps[m + 2] * ray.oz + maps[m + 3],
        maps[m + 4] * ray.ox + maps[m + 5] * ray.oy + maps[m + 6] * ray.oz + maps[m + 7],
        maps[m + 8] * ray.ox + maps[m + 9] * ray.oy + maps[m + 10] * ray.oz + maps[m + 11],
        maps[m] * ray.dx + maps[m + 1] * ray.dy + maps[m + 2] * ray.dz,
        maps[m + 4] * ray.dx + maps[m + 5] * ray.dy + maps[m + 6] * ray.dz,
        maps[m + 8] * ray.dx + maps[m + 9] * ray.dy + maps[m + 10] * ray.dz,
        ray.t_min,
        ray.t_max,
    )


@inlined
def _cone_root(a, half_b, c, z, dz, ray):
    """Smallest valid root of a t^2 + 2 half_b t + c with 0 <= z + t dz <= 1; inf where there is none."""
    if a == 0.0:
        first = second = -0.5 * c / half_b if half_b != 0.0 else np.inf
    else:
        discriminant = half_b * half_b - a * c
        if not discriminant >= 0.0:
            return np.inf
        q = -(half_b + math.copysign(math.sqrt(discriminant), half_b))
        first = q / a
        second = c / q if q != 0.0 else first
    for t in (min(first, second), max(first, second)):
        if ray.t_min < t < ray.t_max and z + t * dz >= 0.0 and z + t * dz <= 1.0:
            return t
    return np.inf


@subkernel
def hit_quadric(ray, quadrics, i):
    """t of a ray on the i-th quadric, inf for a miss.  In float64: quadrics are few, and roots cancel."""
    q = 16 * i
    r = transform_ray(ray, quadrics, i, 16)
    ox, oy, oz = np.float64(r.ox), np.float64(r.oy), np.float64(r.oz)
    dx, dy, dz = np.float64(r.dx), np.float64(r.dy), np.float64(r.dz)
    if quadrics[q + KIND] == SPHERE:
        # Measured from the point nearest the centre, where b vanishes and nothing cancels.
        a = dx * dx + dy * dy + dz * dz
        closest = -(ox * dx + oy * dy + oz * dz) / a
        ox, oy, oz = ox + closest * dx, oy + closest * dy, oz + closest * dz
        room = 1.0 - (ox * ox + oy * oy + oz * oz)
        if not room >= 0.0:
            return INFINITY
        half = math.sqrt(room / a)
        for t in (closest - half, closest + half):
            if ray.t_min < t < ray.t_max:
                return np.float32(t)
        return INFINITY
    slope = np.float64(quadrics[q + R1]) - np.float64(quadrics[q + R0])
    radius, dr = np.float64(quadrics[q + R0]) + slope * oz, slope * dz
    a = dx * dx + dy * dy - dr * dr
    half_b = ox * dx + oy * dy - radius * dr
    c = ox * ox + oy * oy - radius * radius
    return np.float32(_cone_root(a, half_b, c, oz, dz, r))


@inlined
def quadric_normal(quadrics, i, x, y, z):
    """Outward normal, in the space where row i of quadrics (n, 16) starts and of any length, at (x, y, z)."""
    q = quadrics[i]
    cx = q[0] * x + q[1] * y + q[2] * z + q[3]
    cy = q[4] * x + q[5] * y + q[6] * z + q[7]
    cz = q[8] * x + q[9] * y + q[10] * z + q[11]
    if q[KIND] != SPHERE:
        slope = q[R1] - q[R0]
        cz = -slope * (q[R0] + slope * cz)
    sign = -ONE if q[INSIDE] != ZERO else ONE
    return (
        sign * (cx * q[0] + cy * q[4] + cz * q[8]),
        sign * (cx * q[1] + cy * q[5] + cz * q[9]),
        sign * (cx * q[2] + cy * q[6] + cz * q[10]),
    )
