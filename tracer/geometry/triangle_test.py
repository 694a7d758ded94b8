"""The ray-triangle test of the vector kernels: any of its numbers may be scalars or vectors.

The same code tests one ray against eight triangles and sixteen rays against one triangle.  Every lane computes exactly
what a scalar would, so that an answer never depends on which rays are tested together.

In the 8-wide trees a hit counts only where the ray is inside the stored box of the triangle's block: at a t within the
box's interval.  Boxes are padded beyond the rounding of t, so that nothing is lost.  What a ray hits is then the same
whichever boxes were opened for its sake or another ray's: if it enters a block's box it enters all boxes around that
one (float32 subtraction and multiplication are monotone), and a block that was skipped for beginning behind the nearest
hit could only have held hits behind it.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from tracer.runtime.kernels import inlined
from tracer.simd import as_f32, as_i32, fma, select

ZERO = np.float32(0)
ONE = np.float32(1)
SIGN = np.int32(-0x80000000)
EDGE = np.float32(2e-6)  # of a triangle, by which it is larger: rays along a common edge must meet either side


class Triangle(NamedTuple):
    """A corner and two edges: scalars or vectors."""

    x: Any
    y: Any
    z: Any
    e1x: Any
    e1y: Any
    e1z: Any
    e2x: Any
    e2y: Any
    e2z: Any


@inlined
def dot(ax, ay, az, bx, by, bz):
    """The dot product of two vectors."""
    return fma(ax, bx, fma(ay, by, az * bz))


@inlined
def _cross(ax, ay, az, bx, by, bz):
    return fma(ay, bz, -(az * by)), fma(az, bx, -(ax * bz)), fma(ax, by, -(ay * bx))


class Terms(NamedTuple):
    """What Moeller and Trumbore's triple products (1997) take from origin and triangle alone, without the direction:
    common to all rays from one point."""

    nx: Any
    ny: Any
    nz: Any
    ax: Any
    ay: Any
    az: Any
    bx: Any
    by: Any
    bz: Any
    height: Any


@inlined
def terms_of(ox, oy, oz, triangle):
    """The terms of an origin and a triangle."""
    x, y, z, e1x, e1y, e1z, e2x, e2y, e2z = triangle
    nx, ny, nz = _cross(e1x, e1y, e1z, e2x, e2y, e2z)
    sx, sy, sz = ox - x, oy - y, oz - z
    ax, ay, az = _cross(sx, sy, sz, e2x, e2y, e2z)
    bx, by, bz = _cross(e1x, e1y, e1z, sx, sy, sz)
    return Terms(nx, ny, nz, ax, ay, az, bx, by, bz, -dot(sx, sy, sz, nx, ny, nz))


@inlined
def crossing(dx, dy, dz, m):
    """(whether the line crosses the triangle, sign, u area, v area, area); t area is sign ^ height."""
    det = dot(dx, dy, dz, m.nx, m.ny, m.nz)
    sign = as_i32(det) & SIGN
    area = as_f32(as_i32(det) ^ sign)
    u = as_f32(as_i32(dot(dx, dy, dz, m.ax, m.ay, m.az)) ^ sign)
    v = as_f32(as_i32(dot(dx, dy, dz, m.bx, m.by, m.bz)) ^ sign)
    edge = -EDGE * area
    return (u >= edge) & (v >= edge) & (u + v <= area - edge) & (area > ZERO), sign, u, v, area


@inlined
def _least_and_greatest(low, high, x, y, z):
    """Bounds of the dot product of (x, y, z) with any vector between low and high, in `dot`'s own arithmetic."""
    x_up, y_up, z_up = x > ZERO, y > ZERO, z > ZERO
    least = dot(select(x_up, low[0], high[0]), select(y_up, low[1], high[1]), select(z_up, low[2], high[2]), x, y, z)
    greatest = dot(select(x_up, high[0], low[0]), select(y_up, high[1], low[1]), select(z_up, high[2], low[2]), x, y, z)
    return least, greatest


@inlined
def towards(m):
    """The terms of triangles turned so that their normals point to the origin: ahead of a ray, areas are positive."""
    sign = as_i32(m.height) & SIGN
    return Terms(
        as_f32(as_i32(m.nx) ^ sign), as_f32(as_i32(m.ny) ^ sign), as_f32(as_i32(m.nz) ^ sign),
        as_f32(as_i32(m.ax) ^ sign), as_f32(as_i32(m.ay) ^ sign), as_f32(as_i32(m.az) ^ sign),
        as_f32(as_i32(m.bx) ^ sign), as_f32(as_i32(m.by) ^ sign), as_f32(as_i32(m.bz) ^ sign),
        as_f32(as_i32(m.height) ^ sign),
    )  # fmt: skip


@inlined
def crossing_ahead(dx, dy, dz, m):
    """(mask, u area, v area, area) of `crossing` for terms `towards` the origin, where t is not negative."""
    area = dot(dx, dy, dz, m.nx, m.ny, m.nz)
    u, v = dot(dx, dy, dz, m.ax, m.ay, m.az), dot(dx, dy, dz, m.bx, m.by, m.bz)
    edge = -EDGE * area
    return (u >= edge) & (v >= edge) & (u + v <= area - edge) & (area > ZERO), u, v, area


@inlined
def may_cross_ahead(low, high, m):
    """Mask of the triangles for which `crossing_ahead` may be true of some direction between low and high.

    Rounding is monotone, so bounds computed in the order of the exact test bound its results exactly.
    """
    _area, area = _least_and_greatest(low, high, m.nx, m.ny, m.nz)
    u0, u1 = _least_and_greatest(low, high, m.ax, m.ay, m.az)
    v0, v1 = _least_and_greatest(low, high, m.bx, m.by, m.bz)
    edge = -EDGE * area
    return (area > ZERO) & (u1 >= edge) & (v1 >= edge) & (u0 + v0 <= area - edge)
