"""Surface points: what shading and shadow testing need to know of a batch of hits."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.geometry.intersect import quadric_normal
from tracer.kernels import inlined, subkernel
from tracer.shading.textures import texture_color

OFFSET = np.float32(2e-5)  # of the largest coordinate at hand: some 300 float32 roundings


class Points(NamedTuple):
    """n points: position, geometric normal (towards the viewer), shading normal (in the geometric one's
    half space) and texture colour, each (3, n) float32; offset (n,), how far above the surface rays
    start; unit and material (n,) int32; entering (n,), whether the ray came from outside."""

    position: NDArray[np.float32]
    geometric: NDArray[np.float32]
    normal: NDArray[np.float32]
    texture: NDArray[np.float32]
    offset: NDArray[np.float32]
    unit: NDArray[np.int32]
    material: NDArray[np.int32]
    entering: NDArray[np.bool_]


@inlined
def _empty_points(n):
    vectors = np.empty((4, 3, n), np.float32)
    return Points(
        vectors[0],
        vectors[1],
        vectors[2],
        vectors[3],
        np.empty(n, np.float32),
        np.empty(n, np.int32),
        np.empty(n, np.int32),
        np.empty(n, np.bool_),
    )


@inlined
def _store_unit(target, i, x, y, z):
    length = np.sqrt(x * x + y * y + z * z)
    scale = np.float32(1) / length if length > np.float32(0) else np.float32(0)
    target[0, i], target[1, i], target[2, i] = x * scale, y * scale, z * scale


@inlined
def _to_world(m, x, y, z):
    """A normal carried out of an object's space: by the transposed map into it (12,), of any length."""
    return m[0] * x + m[4] * y + m[8] * z, m[1] * x + m[5] * y + m[9] * z, m[2] * x + m[6] * y + m[10] * z


@subkernel
def _triangle_point(world, look, points, i, hits, rays, cone):
    """Geometric and shading normal, in world space, and the texture's colour under a cone of rays of that width."""
    primitive, u, v = hits.primitive[i], hits.u[i], hits.v[i]
    t, n, m = world.triangles[primitive], look.normals[primitive], world.to_object[world.object_of[primitive]]
    cx, cy, cz = t[4] * t[8] - t[5] * t[7], t[5] * t[6] - t[3] * t[8], t[3] * t[7] - t[4] * t[6]
    gx, gy, gz = _to_world(m, cx, cy, cz)
    _store_unit(points.geometric, i, gx, gy, gz)
    w = np.float32(1) - u - v
    nx, ny, nz = w * n[0] + u * n[3] + v * n[6], w * n[1] + u * n[4] + v * n[7], w * n[2] + u * n[5] + v * n[8]
    nx, ny, nz = _to_world(m, nx, ny, nz)
    if nx * nx + ny * ny + nz * nz < np.float32(1e-24):
        nx, ny, nz = gx, gy, gz
    _store_unit(points.normal, i, nx, ny, nz)
    if look.texture[primitive] >= 0:
        uv = look.uvs[primitive]
        s, r = w * uv[0] + u * uv[2] + v * uv[4], w * uv[1] + u * uv[3] + v * uv[5]
        covered = abs((uv[2] - uv[0]) * (uv[5] - uv[1]) - (uv[4] - uv[0]) * (uv[3] - uv[1]))
        g, d = points.geometric, rays.direction
        cosine = abs(g[0, i] * d[0, i] + g[1, i] * d[1, i] + g[2, i] * d[2, i])
        cosine = max(cosine, np.float32(1e-3))
        area = np.sqrt(cx * cx + cy * cy + cz * cz) * cosine * np.sqrt(cosine)
        footprint = cone * cone * covered / area if area > np.float32(0) else np.float32(0)
        red, green, blue = texture_color(look, look.texture[primitive], s, r, footprint)
        points.texture[0, i], points.texture[1, i], points.texture[2, i] = red, green, blue


@subkernel
def _quadric_point(world, points, i, primitive):
    m = world.to_object[world.object_of[primitive]]
    p = points.position
    x = m[0] * p[0, i] + m[1] * p[1, i] + m[2] * p[2, i] + m[3]
    y = m[4] * p[0, i] + m[5] * p[1, i] + m[6] * p[2, i] + m[7]
    z = m[8] * p[0, i] + m[9] * p[1, i] + m[10] * p[2, i] + m[11]
    nx, ny, nz = quadric_normal(world.quadrics, primitive - len(world.triangles), x, y, z)
    nx, ny, nz = _to_world(m, nx, ny, nz)
    _store_unit(points.geometric, i, nx, ny, nz)
    _store_unit(points.normal, i, nx, ny, nz)


@subkernel
def _face_viewer(points, rays, i):
    """Turn both normals to the side the ray came from, and note whether that was the outside."""
    g, n, d = points.geometric, points.normal, rays.direction
    points.entering[i] = g[0, i] * d[0, i] + g[1, i] * d[1, i] + g[2, i] * d[2, i] <= np.float32(0)
    if not points.entering[i]:
        for axis in range(3):
            g[axis, i] = -g[axis, i]
    if g[0, i] * n[0, i] + g[1, i] * n[1, i] + g[2, i] * n[2, i] < np.float32(0):
        for axis in range(3):
            n[axis, i] = -n[axis, i]


@subkernel
def points_at(world, look, rays, hits, reach, spread):
    """The surface points of a batch in which every ray hits something.

    reach (n,) float32 is how far each ray's ancestors came; spread is the width of a pixel at distance 1.
    """
    n = len(hits.t)
    points = _empty_points(n)
    for i in range(n):
        largest = hits.t[i]
        for axis in range(3):
            points.texture[axis, i] = np.float32(1)
            points.position[axis, i] = rays.origin[axis, i] + hits.t[i] * rays.direction[axis, i]
            largest = max(largest, abs(points.position[axis, i]))
        points.offset[i] = OFFSET * largest
        primitive = hits.primitive[i]
        points.unit[i], points.material[i] = primitive, look.material[primitive]
        if primitive < len(world.triangles):
            _triangle_point(world, look, points, i, hits, rays, spread * (reach[i] + hits.t[i]))
        else:
            _quadric_point(world, points, i, primitive)
        _face_viewer(points, rays, i)
    return points
