"""The rays of a view, told anew in numpy from the scene's own arrays: what both contestants are asked.

Rays of a picture go tile by tile and along a Z curve inside a tile, so that any 16 in a row are
neighbours.  Surfaces and rays follow `tracer.shading`, written a second time.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tracer.culling.shadow_testing import LIGHT_MARGIN
from tracer.geometry.camera import pinhole
from tracer.geometry.rays import RAY_OFFSET, Hits, Rays, ray_batch
from tracer.scene.deformation import deformed
from tracer.scene.model import Camera, Scene, empty_quadrics
from tracer.shading.buffers import TILE

Vectors = NDArray[np.float32]


def without_quadrics(scene: Scene) -> Scene:
    """The scene's triangles alone, and light and motion as they were: all that Embree is given."""
    return replace(scene, objects=tuple(replace(item, quadrics=empty_quadrics()) for item in scene.objects))


@dataclass(frozen=True)
class Surfaces:
    """All t triangles of a scene at a moment, in world space: corners and corners' normals (t, 3, 3),
    geometric normals (t, 3), not of unit length, and whether each is there (t,) bool."""

    corners: Vectors
    normals: Vectors
    geometric: Vectors
    present: NDArray[np.bool_]

    @staticmethod
    def of(scene: Scene, time: float) -> Surfaces:
        parts = []
        for item in scene.objects:
            corners, normals = item.triangles.corners, item.triangles.normals
            if item.deformation is not None:
                corners, normals = deformed(item.deformation, time)
            corners = corners.astype(np.float64)
            across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
            matrix = scene.animation.matrix(item.chain, time)
            there = scene.animation.visible(item.chain, time) and abs(np.linalg.det(matrix[:3, :3])) > 0
            inverse = np.linalg.inv(matrix[:3, :3]) if there else np.eye(3)
            moved = corners @ matrix[:3, :3].T + matrix[:3, 3]
            parts.append((moved, normals @ inverse, across @ inverse, np.full(len(corners), there)))
        columns = [np.concatenate(column) for column in zip(*parts, strict=True)]
        return Surfaces(*(column.astype(np.float32) for column in columns[:3]), columns[3])

    def triangles(self) -> Vectors:
        """Corners (n, 3, 3) of those that are there."""
        return self.corners[self.present]


@dataclass(frozen=True)
class Points:
    """Where n rays hit: position, the direction they came in, geometric and shading normal on the viewer's
    side, (n, 3) float32; offset (n,), how far off the surface rays start; primitive (n,), and
    entering (n,) bool, whether the ray came from outside."""

    position: Vectors
    direction: Vectors
    geometric: Vectors
    normal: Vectors
    offset: Vectors
    primitive: NDArray[np.int32]
    entering: NDArray[np.bool_]

    def lifted(self, side: float = 1.0) -> Vectors:
        """Where rays start: off the surface on the viewer's side, or on the other for -1."""
        return self.position + np.float32(side) * self.offset[:, None] * self.geometric


def dot(a: NDArray, b: NDArray) -> NDArray:
    """(n, 1) of rows."""
    return (a * b).sum(axis=1, keepdims=True)


def unit(vectors: NDArray) -> NDArray:
    """Rows of length 1, or 0 where they were 0."""
    length = np.sqrt(dot(vectors, vectors))
    return np.divide(vectors, length, out=np.zeros_like(vectors), where=length > 0)


def points_of(surfaces: Surfaces, rays: Rays, hits: Hits) -> Points:
    """The points of those rays of a batch that hit anything, in the batch's order."""
    hit = hits.primitive >= 0
    primitive, t = hits.primitive[hit], hits.t[hit, None]
    origin, direction = rays.origin.T[hit], rays.direction.T[hit]
    position = origin + t * direction
    geometric = unit(surfaces.geometric[primitive])
    weights = np.stack([1 - hits.u[hit] - hits.v[hit], hits.u[hit], hits.v[hit]], axis=1)
    mixed = np.einsum("nc,ncx->nx", weights, surfaces.normals[primitive])
    normal = unit(np.where(dot(mixed, mixed) < 1e-24, geometric, mixed))
    entering = dot(geometric, direction) <= 0
    geometric = np.where(entering, geometric, -geometric)
    normal = np.where(dot(geometric, normal) < 0, -normal, normal)
    offset = np.float32(RAY_OFFSET) * np.maximum(t[:, 0], np.abs(position).max(axis=1, initial=0))
    return Points(position, direction, geometric, normal, offset, primitive, entering[:, 0])


def _z_curve(count: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Columns and rows of the first `count` places along it: the even and the odd bits of their numbers."""
    bits = np.arange(count)[:, None] >> np.arange(0, 2 * TILE.bit_length(), 2)
    powers = 1 << np.arange(TILE.bit_length())
    return (bits & 1) @ powers, (bits >> 1 & 1) @ powers


def primary_rays(camera: Camera, width: int, height: int) -> Rays:
    """Through all pixels' centres, of unit direction."""
    eye = pinhole(camera, width, height)
    column, row = _z_curve(TILE * TILE)
    x, y = (
        np.concatenate([place + start for start in starts])
        for place, starts in (
            (column, [left for _ in range(0, height, TILE) for left in range(0, width, TILE)]),
            (row, [top for top in range(0, height, TILE) for _ in range(0, width, TILE)]),
        )
    )
    inside = (x < width) & (y < height)
    x, y = (place[inside].astype(np.float32)[:, None] for place in (x, y))
    direction = unit(eye.corner + x * eye.column + y * eye.row)
    return ray_batch(np.broadcast_to(eye.origin, direction.shape), direction)


def shadow_rays(points: Points, light: Vectors) -> tuple[Rays, NDArray[np.bool_]]:
    """Rays from a light (3,) to a little above those points that face it; and (n,) which points do."""
    due = dot(points.geometric, light - points.position)[:, 0] > 0
    direction = points.lifted()[due] - light
    return ray_batch(np.broadcast_to(light, direction.shape), direction, LIGHT_MARGIN, 1.0), due


def reflected(points: Points) -> Vectors:
    """Directions mirrored at the shading normal."""
    return points.direction - 2 * dot(points.direction, points.normal) * points.normal


def mirror_rays(points: Points) -> Rays:
    """As if every surface were a mirror."""
    return ray_batch(points.lifted(), unit(reflected(points)))


def incoherent_rays(box: Vectors, count: int, seed: int) -> Rays:
    """From anywhere in a box (6,) to anywhere."""
    rng = np.random.default_rng(seed)
    return ray_batch(rng.uniform(box[:3], box[3:], (count, 3)), unit(rng.normal(size=(count, 3))))


def joined(batches: list[Rays]) -> Rays:
    """One batch after another."""
    empty = ray_batch(np.empty((0, 3)), np.empty((0, 3)))
    return Rays(*(np.concatenate(arrays, axis=-1) for arrays in zip(empty, *batches, strict=True)))
