"""What casts shadows in small scenes: a floor, roofs over it, and kites that come and go."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from tests.tracing.worlds import quad, scene, triangles
from tracer.scene.animation import Keys, TrackSet
from tracer.scene.model import Camera, SceneObject, empty_quadrics

BEHIND = Camera((0.0, -12.0, 4.0), (0.0, 12.0, -4.0), (0.0, 0.0, 1.0), 40.0)


def floor(n: int = 8) -> list:
    """A floor of n x n squares in z = 0, all of it in the picture of the default camera."""
    edge = np.linspace(-3, 3, n + 1)
    return [
        t
        for x0, x1 in pairwise(edge)
        for y0, y1 in pairwise(edge)
        for t in quad((x0, y0, 0), (x1, y0, 0), (x1, y1, 0), (x0, y1, 0))
    ]


def roof(z: float, half: float) -> list:
    return quad((-half, -half, z), (half, -half, z), (half, half, z), (-half, half, z))


def shadow_scene(**extra):
    """A floor lit from above, a roof between the light and its middle; seen from the side, below the roof."""
    return scene(floor() + roof(6.0, 1.0), lights=[(0.0, 0.0, 20.0)], camera=BEHIND, **extra)


def going(stops: list[tuple[float, float]]) -> TrackSet:
    """Along x, from place to place: (time, x), straight in between; bit for bit still where x stays the same."""
    stops = [stops[0], *stops, stops[-1]]
    values = np.array([[x, 0.0, 0.0] for _, x in stops])
    return TrackSet(
        translation=Keys(np.array([t for t, _ in stops]), values, np.tile([1.0, 0.0, 0.0], (len(stops), 1)))
    )


def kite(name: str, z: float = 5.0, half: float = 0.6, hidden: tuple = ()) -> SceneObject:
    return SceneObject(name, triangles(roof(z, half)), empty_quadrics(), (name,))


GOING = (0.0, 0.3, 0.6, 0.9, 1.2, 1.5, 1.8, 2.1, 2.4, 2.7, 2.7, 0.9, 0.9, 0.9, 3.0)
MIDDLES = np.asarray(floor()).mean(axis=1)
