"""Surface points: what shading and shadow testing need to know of a batch of hits."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.geometry.intersect import quadric_normal
from tracer.geometry.memory import pointer
from tracer.geometry.rays import padded
from tracer.kernels import inlined, subkernel
from tracer.shading.look import SPECULAR
from tracer.shading.textures import texture_color
from tracer.simd import (
    address_of,
    f32x16,
    load_f32x16,
    load_three,
    maximum,
    select,
    square_root,
    store,
    store_mask,
)

SHINE = 10  # row of a surface; before it those of a material
OFFSET = np.float32(2e-5)  # of the largest coordinate at hand: some 300 float32 roundings


class Points(NamedTuple):
    """n points: position, geometric normal (towards the viewer), shading normal (in the geometric one's
    half space) and texture colour, each (3, n) float32; surface (SHINE + 1, n), a material's columns and
    the largest of its specular colour; offset (n,), how far above the surface rays start; unit and
    material (n,) int32; entering (n,), whether the ray came from outside."""

    position: NDArray[np.float32]
    geometric: NDArray[np.float32]
    normal: NDArray[np.float32]
    texture: NDArray[np.float32]
    surface: NDArray[np.float32]
    offset: NDArray[np.float32]
    unit: NDArray[np.int32]
    material: NDArray[np.int32]
    entering: NDArray[np.bool_]


@inlined
def _empty_points(n):
    n = padded(n)
    vectors = np.empty((4, 3, n), np.float32)
    return Points(
        vectors[0],
        vectors[1],
        vectors[2],
        vectors[3],
        np.empty((SHINE + 1, n), np.float32),
        np.empty(n, np.float32),
        np.empty(n, np.int32),
        np.empty(n, np.int32),
        np.empty(n, np.bool_),
    )


class _Source(NamedTuple):
    """What points are made from, as pointers: passing arrays by the dozen costs more than a point."""

    triangles: Any
    normals: Any
    uvs: Any
    texture: Any
    to_object: Any
    object_of: Any


class _Raw(NamedTuple):
    """Rows of points under way: addresses of x; y and z follow at `stride`."""

    geometric: Any
    normal: Any
    texture: Any
    stride: Any


@inlined
def _store3(row, stride, i, x, y, z):
    store(row + 4 * i, x)
    store(row + stride + 4 * i, y)
    store(row + 2 * stride + 4 * i, z)


@inlined
def _to_world(m, a, x, y, z):
    """A normal carried out of an object's space: by the transposed map into it, at m[a:a + 12], of any length."""
    return (
        m[a] * x + m[a + 4] * y + m[a + 8] * z,
        m[a + 1] * x + m[a + 5] * y + m[a + 9] * z,
        m[a + 2] * x + m[a + 6] * y + m[a + 10] * z,
    )


@inlined
def _footprint(source, primitive, cx, cy, cz, cosine, cone):
    """Part of a texture that a cone of rays of that width covers; (cx, cy, cz) spans twice the triangle."""
    q = 6 * primitive
    uv = source.uvs
    covered = abs((uv[q + 2] - uv[q]) * (uv[q + 5] - uv[q + 1]) - (uv[q + 4] - uv[q]) * (uv[q + 3] - uv[q + 1]))
    cosine = max(cosine, np.float32(1e-3))
    area = np.sqrt(cx * cx + cy * cy + cz * cz) * cosine * np.sqrt(cosine)
    return cone * cone * covered / area if area > np.float32(0) else np.float32(0)


@inlined
def _triangle_point(source, look, raw, i, primitive, u, v, dx, dy, dz, cone):
    """Geometric and shading normal, in world space and of any length, and the texture's colour."""
    t, n, r = source.triangles, source.normals, 9 * primitive
    o = source.object_of[primitive]
    cx = t[r + 4] * t[r + 8] - t[r + 5] * t[r + 7]
    cy = t[r + 5] * t[r + 6] - t[r + 3] * t[r + 8]
    cz = t[r + 3] * t[r + 7] - t[r + 4] * t[r + 6]
    w = np.float32(1) - u - v
    nx = w * n[r] + u * n[r + 3] + v * n[r + 6]
    ny = w * n[r + 1] + u * n[r + 4] + v * n[r + 7]
    nz = w * n[r + 2] + u * n[r + 5] + v * n[r + 8]
    gx, gy, gz = cx, cy, cz
    if o != 0:
        gx, gy, gz = _to_world(source.to_object, 12 * o, cx, cy, cz)
        nx, ny, nz = _to_world(source.to_object, 12 * o, nx, ny, nz)
    if nx * nx + ny * ny + nz * nz < np.float32(1e-24):
        nx, ny, nz = gx, gy, gz
    _store3(raw.geometric, raw.stride, i, gx, gy, gz)
    _store3(raw.normal, raw.stride, i, nx, ny, nz)
    texture = source.texture[primitive]
    if texture < 0:
        return
    q, uv = 6 * primitive, source.uvs
    s, r = w * uv[q] + u * uv[q + 2] + v * uv[q + 4], w * uv[q + 1] + u * uv[q + 3] + v * uv[q + 5]
    length = np.sqrt(gx * gx + gy * gy + gz * gz)
    cosine = abs(gx * dx + gy * dy + gz * dz) / length if length > np.float32(0) else np.float32(0)
    footprint = _footprint(source, primitive, cx, cy, cz, cosine, cone)
    red, green, blue = texture_color(look, texture, s, r, footprint)
    _store3(raw.texture, raw.stride, i, red, green, blue)


@subkernel
def _quadric_point(world, points, i, primitive):
    m = world.to_object[world.object_of[primitive]]
    p = points.position
    x = m[0] * p[0, i] + m[1] * p[1, i] + m[2] * p[2, i] + m[3]
    y = m[4] * p[0, i] + m[5] * p[1, i] + m[6] * p[2, i] + m[7]
    z = m[8] * p[0, i] + m[9] * p[1, i] + m[10] * p[2, i] + m[11]
    nx, ny, nz = quadric_normal(world.quadrics, primitive - len(world.triangles), x, y, z)
    nx, ny, nz = _to_world(pointer(world.to_object), 12 * world.object_of[primitive], nx, ny, nz)
    for rows in (points.geometric, points.normal):
        rows[0, i], rows[1, i], rows[2, i] = nx, ny, nz


@inlined
def _unit(x, y, z):
    length = square_root(x * x + y * y + z * z)
    scale = select(length > np.float32(0), np.float32(1) / length, np.float32(0))
    return x * scale, y * scale, z * scale


@inlined
def _store_vector(rows, v, x, y, z):
    a, stride = address_of(rows) + 64 * v, 4 * rows.shape[1]
    store(a, x)
    store(a + stride, y)
    store(a + 2 * stride, z)


@subkernel
def _place(points, rays, hits):
    """Where the points are, how far off rays start there, and white where nothing else is known."""
    white = f32x16(np.float32(1))
    for v in range(len(points.offset) // 16):
        ox, oy, oz = load_three(rays.origin, v)
        dx, dy, dz = load_three(rays.direction, v)
        t = load_f32x16(address_of(hits.t) + 64 * v)
        x, y, z = ox + t * dx, oy + t * dy, oz + t * dz
        _store_vector(points.position, v, x, y, z)
        _store_vector(points.texture, v, white, white, white)
        largest = maximum(t, maximum(maximum(x, -x), maximum(maximum(y, -y), maximum(z, -z))))
        store(address_of(points.offset) + 64 * v, OFFSET * largest)


@subkernel
def _face_viewer(points, rays):
    """Make normals unit vectors on the side the ray came from, and note whether that was the outside."""
    for v in range(len(points.offset) // 16):
        gx, gy, gz = load_three(points.geometric, v)
        nx, ny, nz = load_three(points.normal, v)
        dx, dy, dz = load_three(rays.direction, v)
        gx, gy, gz = _unit(gx, gy, gz)
        nx, ny, nz = _unit(nx, ny, nz)
        entering = gx * dx + gy * dy + gz * dz <= np.float32(0)
        store_mask(address_of(points.entering) + 16 * v, entering)
        gx, gy, gz = select(entering, gx, -gx), select(entering, gy, -gy), select(entering, gz, -gz)
        behind = gx * nx + gy * ny + gz * nz < np.float32(0)
        _store_vector(points.geometric, v, gx, gy, gz)
        _store_vector(points.normal, v, select(behind, -nx, nx), select(behind, -ny, ny), select(behind, -nz, nz))


@subkernel
def _surfaces(points, look, n):
    """The points' materials, row by row."""
    columns = look.materials.shape[1]
    materials, surface = pointer(look.materials), pointer(points.surface)
    stride = points.surface.shape[1]
    for i in range(n):
        m = columns * points.material[i]
        for row in range(SHINE):
            surface[row * stride + i] = materials[m + row]
        highlight = max(materials[m + SPECULAR], max(materials[m + SPECULAR + 1], materials[m + SPECULAR + 2]))
        surface[SHINE * stride + i] = highlight


@subkernel
def points_at(world, look, n, rays, hits, reach, spread):
    """The surface points of a batch of n rays each of which hits something.

    reach (n,) float32 is how far each ray's ancestors came; spread is the width of a pixel at distance 1.
    """
    points = _empty_points(n)
    _place(points, rays, hits)
    source = _Source(
        pointer(world.triangles), pointer(look.normals), pointer(look.uvs), pointer(look.texture),
        pointer(world.to_object), pointer(world.object_of),
    )  # fmt: skip
    stride = 4 * points.position.shape[1]
    raw = _Raw(address_of(points.geometric), address_of(points.normal), address_of(points.texture), stride)
    hit_t, hit_primitive, hit_u, hit_v = pointer(hits.t), pointer(hits.primitive), pointer(hits.u), pointer(hits.v)
    d, m, come, material = pointer(rays.direction), rays.direction.shape[1], pointer(reach), pointer(look.material)
    for i in range(n):
        primitive = hit_primitive[i]
        points.unit[i], points.material[i] = primitive, material[primitive]
        if primitive < len(world.triangles):
            cone = spread * (come[i] + hit_t[i])
            _triangle_point(source, look, raw, i, primitive, hit_u[i], hit_v[i], d[i], d[m + i], d[2 * m + i], cone)
        else:
            _quadric_point(world, points, i, primitive)
    _face_viewer(points, rays)
    _surfaces(points, look, n)
    return points
