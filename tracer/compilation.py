"""Compiling, or loading from the cache, every kernel a frame needs, before a scene needs it.

A tiny scene is rendered phase by phase, and each phase named while its kernels are made ready.
"""

from __future__ import annotations

import threading
from pathlib import Path

import numpy as np

from tracer.culling.modes import word_type
from tracer.frame import Settings
from tracer.geometry.world import STRUCTURES
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
_ready: set[tuple[type, str]] = set()

# What is made ready, with about how much of the whole time it takes when compiled.
_SHARES = {
    "the builder": 0.25,
    "nearest hits": 0.2,
    "shadow rays": 0.2,
    "primary rays": 0.05,
    "occlusion testing": 0.05,
    "shading and shadow testing": 0.23,
    "mode setting": 0.02,
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


def warm_up(progress: Progress | None = None, lights: int = 1, accelerator: str = "bvh8") -> None:
    """Make every kernel ready for scenes with so many lights; at once where that has been done before.

    `progress` is told what is being compiled; what it raises (Cancelled) passes through.
    """
    with _lock:
        if (word_type(lights), accelerator) in _ready:
            return
        done = 0.0

        def report(name: str) -> None:
            nonlocal done
            if progress is not None:
                progress(f"compiling {name}", done)
            done += _SHARES[name]

        structure = STRUCTURES[accelerator]
        report("nearest hits")
        structure.closest.compile()
        report("shadow rays")
        structure.any_hit.compile()
        report("the builder")
        # As many lights as make a word of that size, no more: each is traced.
        scene = _tiny_scene(1 if lights <= 15 else 16)
        renderer = Renderer(scene, Settings(width=4, height=4, threads=1, accelerator=accelerator))
        frame = renderer.begin(0.0)
        frame.place_objects_and_lights()
        for name, phase in (
            ("primary rays", frame.trace_primary_rays),
            ("occlusion testing", frame.test_occlusion),
            ("shading and shadow testing", frame.shade),
            ("mode setting", frame.set_modes),
        ):
            report(name)
            phase()
        if progress is not None:
            progress("compiled", 1.0)
        _ready.add((word_type(lights), accelerator))
