"""Depth and shadow answers on the BART scenes, against Embree on the same triangles."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from embreex import rtcore_scene
from embreex.mesh_construction import TriangleMesh

import tracer
from tracer.geometry.camera import pinhole
from tracer.scene.animation import deformed, light_positions

SIZE = 160


def flattened(scene: tracer.Scene, time: float) -> np.ndarray:
    """All triangles that are there at a time, (n, 3, 3) in world space."""
    parts = [scene.objects[0].triangles.corners.astype(np.float64)]
    for item in scene.objects[1:]:
        if scene.animation.visible(item.chain, time):
            matrix = scene.animation.matrix(item.chain, time)
            corners = deformed(item.deformation, time)[0] if item.deformation else item.triangles.corners
            parts.append(corners @ matrix[:3, :3].T + matrix[:3, 3])
    return np.concatenate(parts)


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


@pytest.mark.parametrize(
    "name, times",
    [
        ("kitchen/kitchen.aff", (0.5, 5.0, 10.0, 17.0)),
        ("robot/Robot.aff", (3.0, 20.0, 40.0)),
        ("museum/museum5.aff", (0.0, 2.0, 4.0)),
    ],
)
def test_depth_due_and_lit_agree_with_embree(bart: Path, name: str, times: tuple[float, ...]):
    scene = tracer.load_scene(bart / name)
    settings = tracer.Settings(width=SIZE, height=SIZE, depth=0, method="none", record_lights=True)
    renderer = tracer.Renderer(scene, settings)
    for time in times:
        frame = renderer.render(time)
        oracle = Oracle(flattened(scene, time))
        camera = pinhole(frame.camera, SIZE, SIZE)
        y, x = np.mgrid[:SIZE, :SIZE].reshape(2, -1, 1)
        directions = (camera.corner + x * camera.column + y * camera.row).astype(np.float64)
        directions /= np.linalg.norm(directions, axis=1, keepdims=True)
        origins = np.broadcast_to(camera.origin, directions.shape)
        t, triangle = oracle.trace(origins, directions)

        on_triangles = frame.primitive.reshape(-1) < scene.triangle_count  # Embree was given no cones
        depth = frame.depth.reshape(-1)
        with np.errstate(invalid="ignore"):
            same = (np.isinf(t) & np.isinf(depth)) | (np.abs(t - depth) <= 1e-3 * t)
        assert same[on_triangles].mean() >= 0.9995

        compared = on_triangles & same & (triangle >= 0)
        points = origins + t[:, None] * directions
        a, b, c = np.moveaxis(oracle.triangles[triangle], 1, 0)
        normals = np.cross(b - a, c - a)
        normals /= np.linalg.norm(normals, axis=1, keepdims=True) + 1e-300
        normals *= -np.sign((normals * directions).sum(1, keepdims=True))
        right = total = 0
        for light, position in enumerate(light_positions(scene, time)):
            due = compared & (((position - points) * normals).sum(1) > 0)
            assert (due == frame.due.reshape(len(t), -1)[:, light])[compared].mean() >= 0.998
            targets = points[due] + normals[due] * 1e-4 * np.maximum(1, np.abs(points[due]).max(1, keepdims=True))
            to_light = position - targets
            distance = np.linalg.norm(to_light, axis=1)
            blocked = oracle.trace(targets, to_light / distance[:, None], distance * (1 - 1e-4))[1] >= 0
            right += (blocked != frame.lit.reshape(len(t), -1)[due, light]).sum()
            total += due.sum()
        assert right / total >= 0.998
