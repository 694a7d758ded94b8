"""Depth and shadow answers on the BART scenes, against Embree on the same triangles."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from embreex import rtcore_scene
from embreex.mesh_construction import TriangleMesh

import tracer
from tests.scenes import loaded
from tracer.geometry.camera import pinhole
from tracer.scene.deformation import deformed
from tracer.scene.model import Light, empty_quadrics

SIZE = 96
STRAY = 1  # of SIZE x SIZE rays, those that pass an edge so near that rounding decides


def triangles_alone(scene: tracer.Scene) -> tracer.Scene:
    """The scene without its spheres and cones, of which Embree would know nothing."""
    return replace(scene, objects=tuple(replace(item, quadrics=empty_quadrics()) for item in scene.objects))


def flattened(scene: tracer.Scene, time: float) -> tuple[np.ndarray, np.ndarray]:
    """All triangles that are there at a time, (n, 3, 3) in world space, and their numbers in the scene, (n,)."""
    parts, numbers = [], []
    for index, item in enumerate(scene.objects):
        if index == 0 or scene.animation.visible(item.chain, time):
            matrix = scene.animation.matrix(item.chain, time)
            corners = deformed(item.deformation, time)[0] if item.deformation else item.triangles.corners
            parts.append(corners.astype(np.float64) @ matrix[:3, :3].T + matrix[:3, 3])
            numbers.append(np.arange(scene.triangle_offsets[index], scene.triangle_offsets[index + 1]))
    return np.concatenate(parts), np.concatenate(numbers)


@dataclass
class Oracle:
    """Embree's answers to single rays."""

    triangles: np.ndarray

    def __post_init__(self) -> None:
        self._scene = rtcore_scene.EmbreeScene()
        self._mesh = TriangleMesh(self._scene, self.triangles.astype(np.float32))

    def trace(self, origins: np.ndarray, directions: np.ndarray, t_max: np.ndarray | None = None):
        """(t, triangle), inf and -1 for a miss."""
        limits = None if t_max is None else t_max.astype(np.float32)
        found = self._scene.run(origins.astype(np.float32), directions.astype(np.float32), dists=limits, output=1)
        triangle = np.asarray(found["primID"]).astype(np.int64)
        return np.where(triangle >= 0, found["tfar"], np.inf), triangle


@dataclass
class Seen:
    """What Embree sees through the pixels of a frame: depth (n,) and number (n,) of the triangle, inf and -1 for a
    miss; where that is and the unit normal towards the viewer, (n, 3)."""

    depth: np.ndarray
    primitive: np.ndarray
    point: np.ndarray
    normal: np.ndarray

    @staticmethod
    def through(frame: tracer.Frame, oracle: Oracle, numbers: np.ndarray) -> Seen:
        camera = pinhole(frame.camera, SIZE, SIZE)
        y, x = np.mgrid[:SIZE, :SIZE].reshape(2, -1, 1)
        directions = (camera.corner + x * camera.column + y * camera.row).astype(np.float64)
        directions /= np.linalg.norm(directions, axis=1, keepdims=True)
        t, triangle = oracle.trace(np.broadcast_to(camera.origin, directions.shape), directions)
        a, b, c = np.moveaxis(oracle.triangles[triangle], 1, 0)
        normals = np.cross(b - a, c - a)
        normals /= np.linalg.norm(normals, axis=1, keepdims=True) + 1e-300
        normals *= -np.sign((normals * directions).sum(1, keepdims=True))
        with np.errstate(invalid="ignore"):
            points = camera.origin + t[:, None] * directions
        return Seen(t, np.where(triangle >= 0, numbers[triangle], -1), points, normals)

    def above(self, which: np.ndarray) -> np.ndarray:
        """Points as far off the surface as the tracer's rays end and start."""
        farthest = np.maximum(self.depth[which, None], np.abs(self.point[which]).max(1, keepdims=True))
        return self.point[which] + 2e-5 * farthest * self.normal[which]


def same_distance(a: np.ndarray, b: np.ndarray, origins: np.ndarray) -> np.ndarray:
    """Both miss, or hit at the same distance: within 1 part in 10,000, and what float32 makes of the origin (n, 3)."""
    with np.errstate(invalid="ignore"):
        return (np.isinf(a) & np.isinf(b)) | (np.abs(a - b) <= 1e-4 * a + 5e-6 * np.abs(origins).max(1))


MOMENTS = pytest.mark.parametrize(
    "name, times",
    [
        ("kitchen/kitchen.aff", (0.5, 5.0, 17.0)),
        ("robot/Robot.aff", (3.0, 20.0, 41.3)),  # at 40 s a column of pixels lies in a kerb: rounding decides there
        ("museum/museum5.aff", (0.0, 2.0, 4.0)),
    ],
)


def lay_in_plane(corners: np.ndarray, points: np.ndarray) -> np.ndarray:
    """(n,) whether points (n, 3) lie in the planes of triangles (n, 3, 3), within 1 part in 10,000."""
    a, b, c = np.moveaxis(corners, 1, 0)
    normal = np.cross(b - a, c - a)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    return np.abs(((points - a) * normal).sum(1)) <= 1e-4 * np.maximum(1.0, np.abs(points).max(1))


@MOMENTS
def test_depth_primitive_due_and_lit_agree_with_embree(bart: Path, name: str, times: tuple[float, ...]):
    """What each pixel sees, and, for every light, whether its shadow ray is due and what it meets."""
    scene = triangles_alone(loaded(bart / name))
    # A lamp near where the viewer will be: Robot's only light is above the roof of its city, which is all in shadow.
    x, y, z = scene.camera_at(times[-1]).position
    lamp = Light("lamp", (x + 0.31, y + 0.43, z - 0.23))
    scene = replace(scene, lights=(*scene.lights, lamp))
    settings = tracer.Settings(width=SIZE, height=SIZE, depth=0, method="none", record_lights=True)
    renderer = tracer.Renderer(scene, settings)
    in_part = 0
    for time in times:
        frame = renderer.render(time)
        triangles, numbers = flattened(scene, time)
        oracle = Oracle(triangles)
        seen = Seen.through(frame, oracle, numbers)
        near = same_distance(seen.depth, frame.depth.reshape(-1), np.array([frame.camera.position]))
        assert (~near).sum() <= STRAY, f"depth at {time} s"
        hit = near & (seen.primitive >= 0)
        # Of triangles in one place rounding picks one; so may it here and there, but only of those.
        other = hit & (seen.primitive != frame.primitive.reshape(-1))
        assert other.mean() < 0.005
        rows = np.searchsorted(numbers, frame.primitive.reshape(-1)[other])
        assert lay_in_plane(triangles[rows], seen.point[other]).all()
        for light, position in enumerate(scene.light_positions(time)):
            due = hit & (((position - seen.point) * seen.normal).sum(1) > 0)
            assert (due != frame.due.reshape(len(hit), -1)[:, light])[hit].sum() <= STRAY, f"{light} due at {time} s"
            towards = seen.above(due) - position
            t, _ = oracle.trace(np.broadcast_to(position, towards.shape), towards, np.ones(len(towards)))
            wrong = np.isfinite(t) == frame.lit.reshape(len(hit), -1)[due, light]
            assert wrong.sum() <= STRAY, f"light {light} at {time} s"
            in_part += 0.05 < np.isfinite(t).mean() < 0.95
    assert in_part > 0, "nothing was part in light and part in shadow"


@MOMENTS
def test_rays_from_surfaces_agree_with_embree(bart: Path, name: str, times: tuple[float, ...]):
    """The rays of bounces: from what is seen, in all directions, each to the nearest hit, and for any up to a limit."""
    scene = triangles_alone(loaded(bart / name))
    renderer = tracer.Renderer(scene, tracer.Settings(width=SIZE, height=SIZE, depth=0, method="none"))
    rng = np.random.default_rng(7)
    for time in times[1:]:
        frame = renderer.render(time)
        triangles, numbers = flattened(scene, time)
        oracle = Oracle(triangles)
        seen = Seen.through(frame, oracle, numbers)
        hit = seen.primitive >= 0
        origins = seen.above(hit)
        directions = rng.normal(size=origins.shape)
        directions *= np.sign((directions * seen.normal[hit]).sum(1, keepdims=True))
        directions /= np.linalg.norm(directions, axis=1, keepdims=True)
        t, _ = oracle.trace(origins, directions)
        hits = renderer.world.closest_hits(tracer.RayBatch(origins, directions))
        assert (~same_distance(t, hits.t, origins)).sum() <= STRAY, f"at {time} s"
        limits = rng.uniform(0.2, 1.8, len(t)) * np.where(np.isinf(t), 1.0, t)
        blocked = renderer.world.any_hits(tracer.RayBatch(origins, directions, 0.0, limits))
        _, found = oracle.trace(origins, directions, limits)
        assert 0.1 < blocked.mean() < 0.9
        assert (blocked != (found >= 0)).sum() <= STRAY, f"up to a limit, at {time} s"
