"""A hall with hundreds of lights."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import tracer
from tests.tracing.shades import floor, going, kite, roof
from tests.tracing.worlds import quad, scene
from tracer.scene.animation import Animation
from tracer.scene.lights import Light
from tracer.scene.model import Camera, Material

LIGHTS = 300
MATERIALS = (
    Material(diffuse=(0.6, 0.5, 0.4), specular=(0.3, 0.3, 0.3), exponent=20.0),
    Material(diffuse=(0.2, 0.3, 0.5), specular=(0.5, 0.4, 0.3), exponent=90.0),
)


def lights_of(seed: int, count: int, falloff: str | None = None, track: str | None = None) -> tuple[Light, ...]:
    """Coloured lights in clumps over a floor, some with samples, some of which fall off."""
    rng = np.random.default_rng(seed)
    middles = rng.uniform((-4, -4, 1.0), (4, 4, 5.0), (9, 3))
    made = []
    for i in range(count):
        place = tuple((middles[rng.integers(9)] + rng.normal(size=3) * 0.3).tolist())
        lamp = {"kind": "rectangle", "edges": ((0.2, 0.0, 0.0), (0.0, 0.2, 0.0)), "samples": 4} if i % 10 == 0 else {}
        falls = falloff or ("none" if i % 7 == 0 else "inverse square")
        color = tuple((rng.random(3) * (0.02 if falls == "none" else 0.1)).tolist())
        made.append(Light(f"light {i}", place, color, track if i % 3 == 0 else None, falloff=falls, **lamp))
    return tuple(made)


def hall(seed: int = 1, count: int = LIGHTS, **extra) -> tracer.Scene:
    """A floor with roofs over it and a wall, lit by many lights; a kite that comes and goes."""
    static = floor() + roof(1.2, 1.0) + quad((-3, 1, 0), (3, 1, 0), (3, 1, 3), (-3, 1, 3))
    made = scene(
        static,
        dynamic=(kite("goes", 0.8, 0.5),),
        materials=MATERIALS,
        camera=Camera((0.0, -9.0, 5.0), (0.0, 9.0, -4.5), (0.0, 0.0, 1.0), 45.0),
        animation=Animation({"goes": going([(0.0, -1.5), (2.0, 1.5)]), "swings": going([(0.0, 0.0), (2.0, 1.0)])}),
        ambient=(0.1, 0.1, 0.1),
    )
    made.objects[0].triangles.material[::3] = 1
    return replace(made, **({"lights": lights_of(seed, count)} | extra))
