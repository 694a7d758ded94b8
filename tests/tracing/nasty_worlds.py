"""Scenes made to be nasty to whatever is proved about shadows, each from a seed, and ways through them.

All is made around the unit cube, then turned, scaled from a thousandth to ten thousand times, and moved away from the
origin, so that float32 has few digits left for what matters.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
import trimesh

import tracer
from tests.tracing.random_worlds import MATERIALS
from tests.tracing.worlds import moved, quad, quadrics, scene
from tracer.scene.animation import Animation, Keys, TrackSet
from tracer.scene.model import CONE, SPHERE, Camera, Light, Quadrics

END = 4.0  # seconds that lights and objects move in


@dataclass(frozen=True)
class NastyWalk:
    """A scene from a seed, and time and camera of successive frames in it."""

    seed: int
    scene: tracer.Scene = field(repr=False)
    frames: tuple[tuple[float, Camera], ...]


class _Maker:
    """What scenes are put together of: triangles (3, 3) in the unit cube, over a floor at z = 0."""

    def __init__(self, rng: np.random.Generator) -> None:
        self.rng = rng

    def point(self) -> np.ndarray:
        return self.rng.uniform(0.05, 0.95, 3) * (1, 1, 0.6) + (0, 0, 0.02)

    def floor(self) -> list:
        """One square, or many with shared edges; sometimes a wall as well."""
        n = int(self.rng.choice([1, 1, 2, 5]))
        edge = np.linspace(-0.5, 1.5, n + 1)
        made = [
            t
            for i in range(n)
            for j in range(n)
            for t in quad(*((edge[i + x], edge[j + y], 0.0) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))))
        ]
        if self.rng.random() < 0.4:
            made += quad((-0.5, 1.5, 0.0), (1.5, 1.5, 0.0), (1.5, 1.5, 1.0), (-0.5, 1.5, 1.0))
        return made

    def plate(self) -> list:
        """A tessellated plate: only together do its triangles hide anything."""
        nx, ny = self.rng.integers(1, 5, 2)
        corner, size, tilt = self.point(), self.rng.uniform(0.1, 0.6, 2), self.rng.choice([0.0, 0.0, 0.3])
        steps = np.array(
            [[(size[0] * i / nx, size[1] * j / ny, tilt * i / nx) for j in range(ny + 1)] for i in range(nx + 1)]
        )
        at = corner + steps
        return [
            t
            for i in range(nx)
            for j in range(ny)
            for t in quad(at[i][j], at[i + 1][j], at[i + 1][j + 1], at[i][j + 1])
        ]

    def box(self) -> list:
        low = self.point()
        x, y, z = np.stack([low, low + self.rng.uniform(0.05, 0.3, 3)], 1)
        if self.rng.random() < 0.5:
            z = z - z[0]  # its lower side lies in the floor
        c = [np.array((x[i & 1], y[i >> 1 & 1], z[i >> 2])) for i in range(8)]
        sides = ((0, 1, 3, 2), (4, 5, 7, 6), (0, 1, 5, 4), (2, 3, 7, 6), (0, 2, 6, 4), (1, 3, 7, 5))
        return [t for s in sides for t in quad(*(c[i] for i in s))]

    def needles(self) -> list:
        """Slivers of all widths down to less than float32 can tell, some of them just above the floor."""
        made = []
        for _ in range(self.rng.integers(1, 8)):
            a, along = self.point(), self.rng.normal(size=3) * 0.4
            if self.rng.random() < 0.5:
                a[2], along[2] = 10.0 ** self.rng.uniform(-6, -1), 0.0
            width = 10.0 ** self.rng.uniform(-8, -2)
            made.append([a, a + along, a + along * self.rng.uniform(0.0, 1.0) + self.rng.normal(size=3) * width])
        return made

    def fan(self) -> list:
        """Triangles around a common corner, some of them turned over."""
        middle, n = self.point(), int(self.rng.integers(3, 9))
        angles = np.sort(self.rng.uniform(0, 2 * np.pi, n))
        rim = middle + 0.3 * np.stack([np.cos(angles), np.sin(angles), self.rng.normal(size=n) * 0.1], 1)
        return [[middle, *((rim[i], rim[i - 1])[:: self.rng.choice([-1, 1])])] for i in range(n)]

    def overlapping(self) -> list:
        """Triangles in one plane, on top of each other; the floor's, or one parallel to it."""
        z = self.rng.choice([0.0, 0.25])
        corners = self.rng.uniform(0, 1, (int(self.rng.integers(2, 6)), 3, 3))
        corners[:, :, 2] = z
        return list(corners)

    def near_floor(self) -> list:
        """Small ones, as far above the floor as its rays end, or a little more or less."""
        corners = self.point() + self.rng.normal(size=(4, 3, 3)) * 10.0 ** self.rng.uniform(-4, -1)
        corners[:, :, 2] = 2e-5 * self.rng.choice([0.1, 0.5, 1.0, 1.0, 2.0, 8.0], (4, 1)) * self.rng.uniform(0.9, 1.1)
        return list(corners)

    def degenerate(self) -> list:
        a, b = self.point(), self.point()
        return [[a, a, a], [a, b, b], [a, a + (b - a) * 0.5, b], [a, b, a + (b - a) * 3]]

    def loose(self) -> list:
        n = int(self.rng.integers(1, 20))
        size = 10.0 ** self.rng.uniform(-3, 0)
        return [self.point() + self.rng.normal(size=(3, 3)) * size for _ in range(n)]

    def triangles(self) -> np.ndarray:
        makers = [
            self.plate, self.box, self.needles, self.fan,
            self.overlapping, self.near_floor, self.degenerate, self.loose,
        ]  # fmt: skip
        made = self.floor()
        for k in self.rng.choice(len(makers), self.rng.integers(1, 5)):
            made += makers[k]()
        corners = np.array(made, np.float64).reshape(-1, 3, 3)
        if self.rng.random() < 0.5:
            twice = corners[self.rng.choice(len(corners), 3)]
            corners = np.concatenate([corners, twice, twice[:, [1, 2, 0]], twice[:, [0, 2, 1]]])
        return corners

    def round_ones(self, count: int) -> list[tuple]:
        """Spheres and cones (kind, to (3, 4), radii): flat, long, tiny, some that poke through the floor."""
        made = []
        for _ in range(count):
            size = 10.0 ** self.rng.uniform(-2.5, -0.5)
            to = np.concatenate([np.eye(3) * size, self.point()[:, None]], axis=1)
            if self.rng.random() < 0.5:
                to[:, :3] = np.linalg.qr(self.rng.normal(size=(3, 3)))[0] * size * 10.0 ** self.rng.uniform(-1, 0.3, 3)
            if self.rng.random() < 0.2:
                to[2, 3] = 0.0
            kind = SPHERE if self.rng.random() < 0.5 else CONE
            made.append((kind, to, (1.0, 1.0) if kind == SPHERE else (1.0, float(self.rng.choice([0.0, 0.4, 1.0])))))
        return made

    def light(self, corners: np.ndarray, round_ones: list[tuple]) -> np.ndarray:
        """Above all, far away, on a surface, at a corner, in a triangle's plane, or inside something."""
        kind = self.rng.choice(["above", "above", "far", "surface", "nearly", "corner", "plane", "inside", "anywhere"])
        a, b, c = corners[self.rng.integers(len(corners))]
        p, q = np.sort(self.rng.random(2))
        on = a + p * (b - a) + (1 - q) * (c - a)
        if kind == "above":
            return self.rng.uniform((-0.5, -0.5, 0.7), (1.5, 1.5, 2.0))
        if kind == "far":
            return self.rng.uniform((-1, -1, 0.2), (1, 1, 1)) * 10.0 ** self.rng.uniform(0.5, 3)
        if kind == "surface":
            return on
        if kind == "nearly":
            return on + self.rng.normal(size=3) * 10.0 ** self.rng.uniform(-7, -2)
        if kind == "corner":
            return a
        if kind == "plane":
            return a + (b - a) * self.rng.uniform(-3, 4) + (c - a) * self.rng.uniform(-3, 4)
        if kind == "inside" and round_ones:
            return np.array(round_ones[self.rng.integers(len(round_ones))][1][:, 3])
        return self.point()


def _placed(rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """A turn and scale (3, 3), and where the unit cube's corner goes."""
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0] if rng.random() < 0.5 else np.eye(3)
    scale = 10.0 ** (rng.choice([0.0, rng.uniform(-3, 4)]))
    move = rng.normal(size=3) * scale * rng.choice([0.0, 1.0, 30.0, 1000.0], p=(0.5, 0.2, 0.2, 0.1))
    return turn * scale, move


def _track(values: np.ndarray) -> TrackSet:
    n = len(values)
    return TrackSet(translation=Keys(np.linspace(-1.0, END + 1.0, n), np.asarray(values, np.float64), np.zeros((n, 3))))


def _lamps(places: np.ndarray, moves: bool) -> tuple[Light, ...]:
    tracks = ["jumps" if i == len(places) - 1 and moves else None for i in range(len(places))]
    return tuple(
        Light(f"light {i}", tuple(place), (0.6, 0.5, 0.7), track)
        for i, (place, track) in enumerate(zip(places.tolist(), tracks, strict=True))
    )


def nasty_walk(seed: int, lights: int = 0, frames: int = 5) -> NastyWalk:
    """A scene with one to three lights, if not told how many, the last of which may move now and then."""
    rng = np.random.default_rng(seed)
    make, (turn, move) = _Maker(rng), _placed(rng)
    scale = float(np.cbrt(abs(np.linalg.det(turn))))
    corners = make.triangles()
    balls = make.round_ones(int(rng.choice([0, 0, 1, 4])))
    lamps = np.array([make.light(corners, balls) for _ in range(lights or int(rng.integers(1, 4)))])
    placed = [
        (kind, np.concatenate([turn @ to[:, :3], (turn @ to[:, 3] + move)[:, None]], 1), r) for kind, to, r in balls
    ]
    dynamic, tracks = [], {"jumps": _track(rng.normal(size=(7, 3)) * scale * rng.choice([0, 0, 0.1], (7, 1)))}
    if rng.random() < 0.4:
        thing = moved("thing", (np.array(make.loose() + make.box())) @ turn.T + move, np.eye(4))
        dynamic = [replace(thing, chain=("drifts", np.eye(4)))]
        tracks["drifts"] = _track(rng.normal(size=(6, 3)) * scale * 0.1)
    made = scene(
        corners @ turn.T + move,
        _materials(rng, quadrics(placed)),
        dynamic=tuple(dynamic),
        materials=MATERIALS,
        animation=Animation(tracks),
        background=(0.2, 0.3, 0.4),
        time_range=(0.0, END),
    )
    static = made.objects[0].triangles
    static.material[:] = rng.choice(len(MATERIALS), len(static), p=(0.8, 0.1, 0.05, 0.05))
    made = replace(made, lights=_lamps(lamps @ turn.T + move, bool(rng.random() < 0.5)))
    return NastyWalk(seed, made, _way(rng, turn, move, frames))


def flattened_walk(seed: int, frames: int = 4) -> NastyWalk:
    """Round and angular bodies that rest over a floor, under a transform that stretches or flattens them, turned."""
    rng = np.random.default_rng(seed)
    bodies = (
        lambda: trimesh.creation.icosphere(int(rng.integers(2, 4))),
        lambda: trimesh.creation.torus(1.0, 0.35),
        lambda: trimesh.creation.cylinder(0.7, 1.5),
        lambda: trimesh.creation.box((1.0, 1.4, 0.8)).subdivide().subdivide(),
    )
    corners = np.asarray(bodies[rng.integers(len(bodies))]().triangles)
    corners = np.concatenate([corners, corners * 0.4 + rng.normal(size=3)])
    turns = [np.linalg.qr(rng.normal(size=(3, 3)))[0] if rng.random() < 0.7 else np.eye(3) for _ in range(2)]
    axes = np.ones(3)
    axes[rng.integers(3)] = 10.0 ** rng.choice([rng.uniform(-6, 6), rng.uniform(-0.05, 0.05)], p=(0.8, 0.2))
    matrix, scale = np.eye(4), 10.0 ** rng.choice([0.0, 0.0, rng.uniform(-4, 4)])
    matrix[:3, :3] = turns[0] @ np.diag(axes) @ turns[1] * scale
    matrix[:3, 3] = rng.normal(size=3) * scale * rng.choice([0.0, 1.0, 30.0])
    thing = replace(moved("flat", corners, np.eye(4)), chain=("rests", matrix))
    placed = corners.reshape(-1, 3) @ matrix[:3, :3].T + matrix[:3, 3]
    middle, size = (placed.min(0) + placed.max(0)) / 2, float(np.linalg.norm(np.ptp(placed, axis=0))) / 2
    low = placed.min(0)[2] - 0.05 * size
    sides = ((-3, -3), (3, -3), (3, 3), (-3, 3))
    floor = quad(*((middle[0] + x * size, middle[1] + y * size, low) for x, y in sides))
    lights = [middle + size * rng.normal(size=3) * rng.choice([1.0, 3.0, 100.0]) for _ in range(3)]
    made = scene(
        floor,
        dynamic=(thing,),
        lights=lights,
        materials=MATERIALS,
        animation=Animation({"rests": _track(np.zeros((6, 3)))}),
        background=(0.2, 0.3, 0.4),
        time_range=(0.0, END),
    )
    made, way = replace(made, lights=tuple(replace(light, color=(0.5, 0.5, 0.5)) for light in made.lights)), []
    for number in range(frames):
        towards = rng.normal(size=3)
        towards /= np.linalg.norm(towards)
        place = middle - towards * size * rng.choice([1.2, 2.0, 5.0])
        way += 2 * [(float(number // 2), Camera(tuple(place.tolist()), tuple(towards.tolist()), (0.1, 0.2, 1.0)))]
    return NastyWalk(seed, made, tuple(way))


def with_lamps(walk: NastyWalk) -> NastyWalk:
    """The same walk by the light of lamps: points, thin ones, and some around all that they shine on."""
    rng = np.random.default_rng(walk.seed)
    size = float(np.ptp(walk.scene.objects[0].triangles.corners.reshape(-1, 3), axis=0).max())
    lamps = tuple(_lamp(rng, light, size) for light in walk.scene.lights)
    return replace(walk, scene=replace(walk.scene, lights=lamps))


def _lamp(rng: np.random.Generator, light: Light, size: float) -> Light:
    kind = str(rng.choice(["point", "sphere", "sphere", "rectangle", "dome"]))
    radius = float(size * 10.0 ** rng.uniform(-4, 0))
    edges = rng.normal(size=(2, 3)) * radius * rng.choice([1.0, 1.0, 1e-3, 0.0], (2, 1))
    if rng.random() < 0.5:
        edges *= rng.permuted(np.eye(3), axis=1)[:2]  # along axes
    top = rng.normal(size=3).tolist()
    shape = {
        "point": {},
        "sphere": {"radius": radius},
        "rectangle": {"edges": tuple(tuple(edge) for edge in edges.tolist())},
        "dome": {"radius": radius, "edges": (tuple(top),)},
    }[kind]
    samples = 1 if kind == "point" else int(rng.choice([1, 2, 4, 9, 16]))
    falloff = str(rng.choice(["none", "inverse square"]))
    return replace(light, kind=kind, samples=samples, falloff=falloff, **shape)


def _materials(rng: np.random.Generator, made: Quadrics) -> Quadrics:
    made.material[:] = rng.integers(len(MATERIALS), size=len(made))
    made.inside[:] = rng.random(len(made)) < 0.2
    return made


def _way(rng: np.random.Generator, turn: np.ndarray, move: np.ndarray, frames: int) -> tuple[tuple[float, Camera], ...]:
    """The camera drifts, stands still, draws close; time stops or goes on."""
    target = rng.uniform(0.2, 0.8, 3) * (1, 1, 0.2)
    place, time, made = target + rng.uniform((-1, -1, 0.05), (1, 1, 1.2)) * rng.choice([0.3, 1.5]), 0.0, []
    for _ in range(frames):
        camera = Camera(
            tuple((turn @ place + move).tolist()), tuple((turn @ (target - place)).tolist()), tuple(turn[:, 2].tolist())
        )
        made.append((time, camera))
        place = place + rng.normal(size=3) * rng.choice([0.0, 0.01, 0.1])
        if rng.random() < 0.2:
            place = target + (place - target) * 0.2
        time += float(rng.choice([0.0, 0.0, 0.5]))
    return tuple(made)


def static_part(made: tracer.Scene) -> tracer.Scene:
    """The same without what moves: what certificates speak of."""
    return replace(made, objects=made.objects[:1])
