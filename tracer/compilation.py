"""Compiling, or loading from the cache, every kernel a frame needs, before a scene needs it.

A tiny scene is rendered phase by phase, and each phase named while its kernels are made ready.
"""

from __future__ import annotations

import threading
from pathlib import Path

import numpy as np

from tracer.culling.modes import word_type
from tracer.frame import Settings
from tracer.geometry.rays import ray_batch
from tracer.renderer import Renderer
from tracer.scene.animation import Animation
from tracer.scene.model import (
    Camera,
    Light,
    Material,
    Progress,
    Quadrics,
    Scene,
    SceneObject,
    Triangles,
    empty_quadrics,
)

_lock = threading.Lock()
_ready: set[type] = set()

# What is made ready, with about how much of the whole time it takes when compiled.
_SHARES = {
    "the kd-tree builder": 0.2,
    "ray traversal": 0.15,
    "occlusion testing": 0.05,
    "shading and shadow testing": 0.5,
    "mode setting": 0.02,
    "ray queries": 0.08,
}


def _tiny_scene(lights: int) -> Scene:
    """A triangle and a sphere that never move, and a triangle that could."""
    corners = np.array([[[-1, -1, 0], [1, -1, 0], [0, 1, 0]]], np.float32)
    normals = np.broadcast_to(np.array([0, 0, 1], np.float32), corners.shape)
    zero = np.zeros(1, np.int32)
    triangles = Triangles(corners, normals, np.zeros((1, 3, 2), np.float32), zero, zero - 1)
    sphere = Quadrics(zero, np.eye(4)[None, :3], np.ones((1, 2), np.float32), zero.astype(np.bool_), zero)
    return Scene(
        path=Path("warm-up"),
        objects=(
            SceneObject("static", triangles, sphere),
            SceneObject("dynamic", triangles, empty_quadrics(), (np.eye(4),)),
        ),
        materials=(Material(),),
        textures=(),
        lights=tuple(Light(f"light {i}", (0.0, 1.0, 5.0)) for i in range(lights)),
        camera=Camera((0.0, 0.0, 5.0), (0.0, 0.0, -1.0)),
        animation=Animation.empty(),
    )


def warm_up(progress: Progress | None = None, lights: int = 1) -> None:
    """Make every kernel ready for scenes with so many lights; at once where that has been done before.

    `progress` is told what is being compiled; what it raises (Cancelled) passes through.
    """
    with _lock:
        if word_type(lights) in _ready:
            return
        done = 0.0

        def report(name: str) -> None:
            nonlocal done
            if progress is not None:
                progress(f"compiling {name}", done)
            done += _SHARES[name]

        report("the kd-tree builder")
        # As many lights as make a word of that size, no more: each is traced.
        renderer = Renderer(_tiny_scene(1 if lights <= 15 else 16), Settings(width=4, height=4, threads=1))
        frame = renderer.begin(0.0)
        frame.place_objects_and_lights()
        for name, phase in (
            ("ray traversal", frame.trace_primary_rays),
            ("occlusion testing", frame.test_occlusion),
            ("shading and shadow testing", frame.shade),
            ("mode setting", frame.set_modes),
        ):
            report(name)
            phase()
        report("ray queries")
        rays = ray_batch([[0, 0, 5]], [[0, 0, -1]])
        renderer.world.closest_hits(rays, 1)
        renderer.world.any_hits(rays, 1)
        if progress is not None:
            progress("compiled", 1.0)
        _ready.add(word_type(lights))
