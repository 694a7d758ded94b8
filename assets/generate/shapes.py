"""The shapes that everything is made of: grids, boxes, turned and swept surfaces."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from generate.mesh import Array, Mesh, join, lattice, smooth_lattice

Point = Sequence[float]


def grid(origin: Point, right: Point, up: Point, columns: int = 1, rows: int = 1) -> Mesh:
    """A flat parallelogram cut into rows x columns quads, facing right x up; uv 0 to 1."""
    o, r, u = (np.asarray(a, np.float64) for a in (origin, right, up))
    s, t = np.meshgrid(np.linspace(0, 1, columns + 1), np.linspace(0, 1, rows + 1))
    points = o + s[..., None] * r + t[..., None] * u
    normal = np.cross(r, u) / np.linalg.norm(np.cross(r, u))
    return lattice(points, np.broadcast_to(normal, points.shape), np.stack([s, t], axis=2))


def flat_quad(corners: Sequence[Point]) -> Mesh:
    """Two triangles through four corners, counter-clockwise."""
    p = np.asarray(corners, np.float64)
    triangles = np.stack([p[[0, 1, 2]], p[[0, 2, 3]]])
    return Mesh(triangles, np.zeros_like(triangles), np.zeros((2, 3, 2))).flat()


def box(low: Point, high: Point) -> Mesh:
    """An axis-aligned box with sharp edges, 12 triangles."""
    (x0, y0, z0), (x1, y1, z1) = low, high
    dx, dy, dz = x1 - x0, y1 - y0, z1 - z0
    return join(
        [
            grid((x0, y0, z1), (dx, 0, 0), (0, dy, 0)),
            grid((x1, y0, z0), (-dx, 0, 0), (0, dy, 0)),
            grid((x1, y0, z1), (0, 0, -dz), (0, dy, 0)),
            grid((x0, y0, z0), (0, 0, dz), (0, dy, 0)),
            grid((x0, y1, z1), (dx, 0, 0), (0, 0, -dz)),
            grid((x0, y0, z0), (dx, 0, 0), (0, 0, dz)),
        ]
    )


def rounded_box(low: Point, high: Point, radius: float, steps: int = 1) -> Mesh:
    """A box whose edges and corners are rounded in `steps` facets with interpolated normals."""
    lo, hi = np.asarray(low, np.float64), np.asarray(high, np.float64)
    radius = min(radius, float((hi - lo).min()) / 2)
    core = (hi - lo) / 2 - radius
    quarter = np.linspace(0, math.pi / 2, steps + 1)
    # The sphere's octants pulled apart: each angle twice where two octants met.
    latitude = np.concatenate([quarter - math.pi / 2, quarter])
    rise = np.concatenate([-np.ones(steps + 1), np.ones(steps + 1)])
    longitude = np.concatenate([quarter + k * math.pi / 2 for k in range(4)] + [np.zeros(1)])
    sign_x = np.concatenate([np.full(steps + 1, s) for s in (1.0, -1.0, -1.0, 1.0)] + [np.ones(1)])
    sign_z = np.concatenate([np.full(steps + 1, s) for s in (1.0, 1.0, -1.0, -1.0)] + [np.ones(1)])
    shape = (len(latitude), len(longitude))
    normals = np.empty((*shape, 3))
    normals[..., 0] = np.outer(np.cos(latitude), np.cos(longitude))
    normals[..., 1] = np.sin(latitude)[:, None]
    normals[..., 2] = np.outer(np.cos(latitude), np.sin(longitude))
    signs = np.empty((*shape, 3))
    signs[..., 0], signs[..., 1], signs[..., 2] = sign_x, rise[:, None], sign_z
    points = (lo + hi) / 2 + signs * core + radius * normals
    side = lattice(points[::-1], normals[::-1], np.zeros((*shape, 2)))
    low_c, high_c = lo + radius, hi - radius
    width, depth = high_c[0] - low_c[0], high_c[2] - low_c[2]
    if min(width, depth) < 1e-9:
        return side
    caps = [
        grid((low_c[0], hi[1], high_c[2]), (width, 0, 0), (0, 0, -depth)),
        grid((low_c[0], lo[1], low_c[2]), (width, 0, 0), (0, 0, depth)),
    ]
    return join([side, *caps])


def lathe(profile: Sequence[tuple[float, float]], segments: int = 24, crease: float = 40.0) -> Mesh:
    """A profile of (radius, height) turned about the y axis.

    Bottom to top gives a surface seen from outside; corners sharper than `crease` degrees stay sharp.
    """
    p = np.asarray(profile, np.float64)
    direction = np.diff(p, axis=0)
    length = np.linalg.norm(direction, axis=1)
    outward = np.stack([direction[:, 1], -direction[:, 0]], axis=1) / length[:, None]
    starts, ends = outward.copy(), outward.copy()
    for i in range(len(outward) - 1):
        if float(outward[i] @ outward[i + 1]) > math.cos(math.radians(crease)):
            mean = outward[i] + outward[i + 1]
            ends[i] = starts[i + 1] = mean / np.linalg.norm(mean)
    height = np.concatenate([[0.0], np.cumsum(length)]) / length.sum()
    angle = np.linspace(0, 2 * math.pi, segments + 1)
    angle[-1] = 0.0
    cos, sin = np.cos(angle), np.sin(angle)
    u = np.linspace(1, 0, segments + 1)
    parts = []
    for i in range(len(outward)):
        radii, heights = p[i : i + 2, 0], p[i : i + 2, 1]
        turned = np.stack([starts[i], ends[i]])
        points = np.stack([np.outer(radii, cos), np.repeat(heights[:, None], len(u), 1), np.outer(radii, sin)], axis=2)
        normals = np.stack(
            [np.outer(turned[:, 0], cos), np.repeat(turned[:, 1:], len(u), 1), np.outer(turned[:, 0], sin)], axis=2
        )
        uvs = np.stack(np.broadcast_arrays(u[None, :], height[i : i + 2, None]), axis=2)
        parts.append(lattice(points[:, ::-1], normals[:, ::-1], uvs[:, ::-1]))
    return join(parts)


def curve(points: Sequence[Sequence[float]], samples: int) -> Array:
    """(samples, k) points of the Catmull-Rom curve through the given ones, evenly in parameter."""
    p = np.asarray(points, np.float64)
    p = np.concatenate([[2 * p[0] - p[1]], p, [2 * p[-1] - p[-2]]])
    s = np.linspace(0, len(p) - 3, samples)
    i = np.minimum(s.astype(int), len(p) - 4)
    t = (s - i)[:, None]
    a, b, c, d = p[i], p[i + 1], p[i + 2], p[i + 3]
    return 0.5 * (2 * b + (c - a) * t + (2 * a - 5 * b + 4 * c - d) * t**2 + (3 * b - a - 3 * c + d) * t**3)


def turned(points: Sequence[tuple[float, float]], samples: int, segments: int = 24) -> Mesh:
    """A lathe whose profile is a smooth curve through a few points."""
    profile = curve(points, samples)
    profile[:, 0] = np.maximum(profile[:, 0], 0.0)
    profile = thinned(profile, 0.006 * float(np.ptp(profile, axis=0).max()))
    return lathe([(float(r), float(y)) for r, y in profile], segments, crease=60.0)


def thinned(points: Array, tolerance: float) -> Array:
    """A polyline without the points that lie within `tolerance` of it (Douglas and Peucker)."""
    if len(points) < 3:
        return points
    span = points[-1] - points[0]
    offset = points - points[0]
    along = np.clip(offset @ span / max(float(span @ span), 1e-18), 0, 1)
    distance = np.linalg.norm(offset - along[:, None] * span, axis=1)
    far = int(distance.argmax())
    if distance[far] <= tolerance:
        return points[[0, -1]]
    return np.concatenate([thinned(points[: far + 1], tolerance)[:-1], thinned(points[far:], tolerance)])


def tube(path: Sequence[Point] | Array, radius: float | Sequence[float] | Array, segments: int = 8) -> Mesh:
    """A round rod along a path, with flat ends; a radius for each point of the path, or one."""
    p = np.asarray(path, np.float64)
    radii = np.broadcast_to(np.asarray(radius, np.float64), len(p))
    tangent = np.gradient(p, axis=0)
    tangent = tangent / np.linalg.norm(tangent, axis=1, keepdims=True)
    side = np.eye(3)[np.abs(tangent[0]).argmin()]
    sides = []
    for t in tangent:  # carry one side along, so that the tube does not twist
        side = side - t * float(side @ t)
        side = side / np.linalg.norm(side)
        sides.append(side)
    a = np.asarray(sides)
    b = np.cross(tangent, a)
    angle = np.linspace(0, 2 * math.pi, segments + 1)
    angle[-1] = 0.0
    ring = np.cos(angle)[None, :, None] * a[:, None] + np.sin(angle)[None, :, None] * b[:, None]
    points = p[:, None] + radii[:, None, None] * ring
    uvs = np.stack(np.meshgrid(np.linspace(0, 1, segments + 1), np.linspace(0, 1, len(p))), axis=2)
    parts = [lattice(points, ring, uvs)]
    for end, sign in ((0, -1.0), (-1, 1.0)):
        if radii[end] > 1e-9:
            rim = points[end] if sign > 0 else points[end][::-1]
            fan = np.stack([np.broadcast_to(p[end], rim[1:].shape), rim[:-1], rim[1:]], axis=1)
            normal = np.broadcast_to(sign * tangent[end], fan.shape)
            parts.append(Mesh(fan, normal, np.zeros((len(fan), 3, 2))))
    return join(parts)


def pillow(low: Point, high: Point, sharpness: float = 0.45, rows: int = 8, columns: int = 16) -> Mesh:
    """A superellipsoid that fills a box: a cushion."""
    lo, hi = np.asarray(low, np.float64), np.asarray(high, np.float64)
    latitude = np.linspace(-math.pi / 2, math.pi / 2, rows + 1)[:, None]
    longitude = np.linspace(0, 2 * math.pi, columns + 1)[None, ::-1]

    def power(value: Array, exponent: float) -> Array:
        value = np.where(np.abs(value) < 1e-12, 0.0, value)
        return np.sign(value) * np.abs(value) ** exponent

    direction = np.stack(
        np.broadcast_arrays(
            power(np.cos(latitude), sharpness) * power(np.cos(longitude), sharpness),
            power(np.sin(latitude), sharpness) * np.ones_like(longitude),
            power(np.cos(latitude), sharpness) * power(np.sin(longitude), sharpness),
        ),
        axis=2,
    )
    points = (lo + hi) / 2 + direction * (hi - lo) / 2
    gradient = power(direction, 2 / sharpness - 1) / (hi - lo)
    normals = gradient / np.maximum(np.linalg.norm(gradient, axis=2, keepdims=True), 1e-12)
    uvs = np.stack(np.meshgrid(np.linspace(0, 1, columns + 1), np.linspace(0, 1, rows + 1)), axis=2)
    return lattice(points, normals, uvs)


def sheet(points: Array) -> Mesh:
    """A curved surface through a lattice of points (rows, columns, 3), smooth, uv 0 to 1."""
    rows, columns = points.shape[:2]
    uvs = np.stack(np.meshgrid(np.linspace(0, 1, columns), np.linspace(0, 1, rows)), axis=2)
    return smooth_lattice(points, uvs)
