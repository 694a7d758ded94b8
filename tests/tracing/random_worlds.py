"""Random scenes that have some of everything, and ways through them, for hypothesis."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np
from hypothesis import Phase, settings
from hypothesis import strategies as st

import tracer
from tests.sweeps import examples
from tests.tracing.worlds import affine, quad, quadrics, random_corners, scene, triangles
from tracer.scene.animation import Animation, Keys, TrackSet
from tracer.scene.deformation import Deformation
from tracer.scene.model import CONE, SPHERE, Camera, Light, Material, Quadrics, SceneObject, Triangles, empty_quadrics

END = 3.0  # seconds: everything that moves does so from 0 to END
MATERIALS = (
    Material("grey", ambient=(0.1, 0.1, 0.1), diffuse=(0.8, 0.7, 0.6)),
    Material("mirror", diffuse=(0.2, 0.2, 0.2), specular=(0.7, 0.6, 0.5), exponent=20.0),
    Material("glass", diffuse=(0.1, 0.1, 0.1), specular=(0.1, 0.1, 0.1), exponent=5.0, transmission=0.8, ior=1.5),
    Material("dull", specular=(1 / 15, 0.0, 0.0)),  # 1/15 and 1/225 are traced, 1/3375 is not
)


def quickly(usual: int, shrink: bool = False) -> Callable:
    """Hypothesis, so many examples, or many more by `make test-all`, the same in every run.

    To shrink a scene that fails takes minutes, and is not asked for."""
    phases = set(Phase) - (set() if shrink else {Phase.shrink, Phase.explain})
    return settings(max_examples=examples(usual), deadline=None, derandomize=True, database=None, phases=phases)


@dataclass(frozen=True)
class Walk:
    """A scene, and time and camera of successive frames in it."""

    scene: tracer.Scene = field(repr=False)
    frames: tuple[tuple[float, Camera], ...]


def _shiny(rng: np.random.Generator, corners: np.ndarray) -> Triangles:
    """Triangles of random materials; their normals at the corners lean away from the flat one."""
    made = triangles(corners)
    normals = made.normals + rng.normal(size=made.normals.shape) * 0.1
    made.normals[:] = normals / np.linalg.norm(normals, axis=2, keepdims=True)
    made.material[:] = rng.choice(len(MATERIALS), len(corners), p=(0.7, 0.1, 0.1, 0.1))
    return made


def _round(rng: np.random.Generator, count: int) -> Quadrics:
    """Spheres, squashed and turned, and cones, some of them cylinders, some seen from inside."""
    rows = []
    for _ in range(count):
        place = affine(rng.uniform(0.05, 0.3), rng.random(3))
        place[:, :3] = place[:, :3] @ (np.eye(3) + rng.normal(size=(3, 3)) * 0.2)
        if rng.random() < 0.5:
            rows.append((SPHERE, place, (1.0, 1.0)))
        else:
            top = float(rng.choice([0.0, 0.4, 1.0]))
            rows.append((CONE, place, (1.0, top)))
    made = quadrics(rows)
    made.material[:] = rng.integers(len(MATERIALS), size=count)
    made.inside[:] = rng.random(count) < 0.2
    return made


def _keys(values: np.ndarray) -> Keys:
    n = len(values)
    return Keys(np.linspace(-1.0, END + 1.0, n), np.asarray(values, np.float64), np.zeros((n, 3)))


def _tracks(rng: np.random.Generator, rotates: bool, hides: bool) -> TrackSet:
    return TrackSet(
        translation=_keys(rng.normal(size=(6, 3)) * 0.15),
        rotation=_keys(np.concatenate([rng.normal(size=(6, 3)), rng.uniform(0, 90, (6, 1))], 1)) if rotates else None,
        visibility=np.array([[1.0, 0.0], [2.0, 1.0]]) if hides else None,
    )


def _deforming(rng: np.random.Generator, count: int) -> SceneObject:
    keys = [_shiny(rng, random_corners(rng, count, 0.15)) for _ in range(3)]
    deformation = Deformation(
        np.tile(np.array([0.0, 1.0, END]), (count, 1)),
        np.stack([k.corners for k in keys], axis=1),
        np.stack([k.normals for k in keys], axis=1),
    )
    return SceneObject("jelly", keys[0], empty_quadrics(), deformation=deformation)


def _moving(rng: np.random.Generator, index: int, count: int, round_ones: int, hides: bool) -> SceneObject:
    turn = np.eye(4)
    turn[:3, :3] = np.linalg.qr(rng.normal(size=(3, 3)))[0] * rng.uniform(0.5, 1.2)
    turn[:3, 3] = 0.5 - turn[:3, :3] @ np.full(3, 0.5) + rng.normal(size=3) * 0.1
    parts = _shiny(rng, random_corners(rng, count, 0.25)), _round(rng, round_ones)
    return SceneObject(f"object {index}", *parts, (f"track {index}", turn))


def _room() -> list:
    """A floor of 3 x 3 squares under the unit cube, and a roof over a third of it."""
    edge = np.linspace(-0.4, 1.4, 4)
    cells = [(*x, *y, -0.05) for x in pairwise(edge) for y in pairwise(edge)] + [(-0.4, 0.3, -0.4, 1.4, 1.2)]
    return [t for a, b, c, d, z in cells for t in quad((a, c, z), (b, c, z), (b, d, z), (a, d, z))]


@st.composite
def scenes(draw: st.DrawFn, lights: int = 3) -> tracer.Scene:
    """Scenes in the unit cube: a floor and a roof; slivers, duplicates and flat triangles; spheres and cones; static,
    moving, vanishing and deforming objects; lights, of which every third moves in the first second of three."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    flat, moving = draw(st.integers(0, 24)), rng.integers(3)
    objects = [_moving(rng, i, rng.integers(9), rng.integers(3), i == 1) for i in range(moving)]
    tracks = {f"track {i}": _tracks(rng, i == 0, i == 1) for i in range(moving)}
    if draw(st.booleans()):
        objects.append(_deforming(rng, draw(st.integers(1, 5))))
    places = rng.uniform(-1.5, 2.5, (lights, 3)) * (1, 1, 0.4) + (0, 0, 2)
    lamps = [
        Light(f"light {i}", tuple(place), tuple(rng.uniform(0.2, 1.0, 3)), "lamp" if i % 3 == 2 else None)
        for i, place in enumerate(places.tolist())
    ]
    there_and_on = np.array([[0, 0, 0], [0, 0, 0], [0.3, 0, 0], [0.3, 0, 0]], np.float64)
    tracks["lamp"] = TrackSet(translation=Keys(np.arange(-1.0, 3.0), there_and_on, np.zeros((4, 3))))
    loose = random_corners(rng, flat, draw(st.sampled_from([0.04, 0.2])))
    made = scene(
        np.concatenate([np.asarray(_room(), np.float32), loose]),
        _round(rng, rng.integers(5)),
        dynamic=tuple(objects),
        materials=MATERIALS,
        animation=Animation(tracks),
        background=(0.2, 0.3, 0.4),
        time_range=(0.0, END),
    )
    static = made.objects[0].triangles
    static.material[20:] = rng.choice(len(MATERIALS), flat, p=(0.7, 0.1, 0.1, 0.1))
    return replace(made, lights=tuple(lamps))


@st.composite
def walks(draw: st.DrawFn, lights: int = 3) -> Walk:
    """Scenes, with three to six frames: the camera drifts, and may draw close or stand still; time may stop."""
    made = draw(scenes(lights))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    place = np.array([0.5, 0.5, 0.5]) + rng.normal(size=3) * (1, 1, 0.3) + (2.5, 0.0, 1.2)
    frames, time = [], 0.0
    for _ in range(draw(st.integers(3, 6))):
        step = draw(st.sampled_from(["stand", "drift", "drift", "close"]))
        if step == "drift":
            place = place + rng.normal(size=3) * 0.05
        elif step == "close":
            place = 0.5 + (place - 0.5) * 0.45
        frames.append((time, Camera(tuple(place), tuple(0.5 - place), (0.0, 0.0, 1.0), 45.0)))
        time += draw(st.sampled_from([0.0, 0.4, 1.0]))
    return Walk(made, tuple(frames))
