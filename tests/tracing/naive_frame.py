"""A naive twin of a whole frame: the paper's Figure 1, one ray at a time, with modes in lists.

What carries modes is a primitive, or a cell of it (tests/tracing/naive_cells.py).

It is told after the design, not after the tracer's sources: no tiles, no batches, no packed words, no
trees, no threads.  Each shadow ray's true answer is always at hand, and what culling would have said
is decided next to it.  Directions, surface points and ray ends are in float32, step by step as the
tracer computes them, since one bit more or less would let a ray pass an edge on its other side; for
the same reason rays meet primitives by the tracer's intersectors (tests/tracing/brute.py), dynamic
objects are where `World.place` puts them, and a picture's rays start from `pinhole`.  Colours are in
float64.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

import tracer
from tests.tracing import brute, naive, naive_cells
from tracer.culling.cells import first_units
from tracer.culling.modes import ShadowMode
from tracer.geometry.camera import Pinhole, pinhole
from tracer.scene.model import SPHERE, Camera

F = np.float32
MIN_WEIGHT = 1 / 256


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def unit(a):
    return a * (F(1) / np.sqrt(dot(a, a)))


@dataclass
class Ray:
    """A ray on its way: where it started, whereto, for which pixel (row, column), with which weight (3,)."""

    origin: np.ndarray
    direction: np.ndarray
    pixel: tuple[int, int]
    weight: np.ndarray


@dataclass
class Point:
    """What a ray met: place, geometric and shading normal towards the viewer, and how far off rays start."""

    primitive: int
    unit: int
    position: np.ndarray
    geometric: np.ndarray
    normal: np.ndarray
    offset: np.float32
    entering: bool

    def lifted(self, side: float) -> np.ndarray:
        """The point a little off the surface: on the viewer's side for 1, on the other for -1."""
        return self.position + F(side) * self.offset * self.geometric


@dataclass
class NaiveFrame:
    """What a frame shows and counts, named as in `tracer.Frame` and its statistics."""

    primitive: np.ndarray
    cell: np.ndarray
    color: np.ndarray
    reference: np.ndarray
    wrong: np.ndarray
    due: np.ndarray
    lit: np.ndarray
    words: list[int] = field(default_factory=list)
    pixel_count: list[int] = field(default_factory=list)
    highest_count: list[int] = field(default_factory=list)
    counts: Counter[str] = field(default_factory=Counter)


class NaiveRenderer:
    """Renders frames of a scene, and remembers the modes of every unit from one to the next."""

    def __init__(self, scene: tracer.Scene, settings: tracer.Settings) -> None:
        self.scene, self.settings = scene, settings
        self.world = tracer.World(scene)
        self.static = np.array([scene.object_of(p) == 0 for p in range(scene.primitive_count)], np.bool_)
        self.first = np.arange(scene.primitive_count + 1)
        if settings.method == "cells":
            self.first = first_units(self.world.placed.triangles, self.world.object_of)
        self.by_modes = settings.method != "none"
        self.modes = naive.Modes(np.repeat(~self.static, np.diff(self.first)), len(scene.lights))
        self.lamps: np.ndarray | None = None

    def render(self, time: float, camera: Camera, shaded: np.ndarray | None = None) -> NaiveFrame:
        """The next frame: the phases of the paper's Figure 1; of `shaded` pixels (height, width), or of all."""
        self._place(time)
        rays = self._primary_rays(pinhole(camera, self.settings.width, self.settings.height))
        met = self._meet([r.origin for r in rays], [r.direction for r in rays])
        frame = self._blank(met)
        hidden = self._test_occlusion(frame, met) if self.by_modes else set()
        shaded = np.ones(frame.cell.shape, np.bool_) if shaded is None else shaded
        learnt = self._shade(frame, rays, met, shaded)
        frame.pixel_count = [int((frame.cell == unit).sum()) for unit in range(self.first[-1])]
        of_shaded = [int((frame.cell[shaded] == unit).sum()) for unit in range(self.first[-1])]
        if self.by_modes:
            self.modes.end_frame(hidden, frame.pixel_count, of_shaded, learnt, self.settings.zoom_factor)
        frame.words, frame.highest_count = self.modes.words(), list(self.modes.highest)
        return frame

    def _place(self, time: float) -> None:
        """Where objects and lights are now; what is known of a light that moved is forgotten."""
        self.world.place(time)
        self.there = brute.primitives_there(self.scene, time)
        before, self.lamps = self.lamps, self.scene.light_positions(time).astype(F)
        if before is not None:
            for light in np.flatnonzero((before != self.lamps).any(axis=1)):
                self.modes.forget(int(light))

    def _primary_rays(self, camera: Pinhole) -> list[Ray]:
        pixels = [(y, x) for y in range(self.settings.height) for x in range(self.settings.width)]
        straight = [(camera.corner + F(x) * camera.column + F(y) * camera.row) for y, x in pixels]
        return [Ray(camera.origin, unit(d), pixel, np.ones(3, F)) for d, pixel in zip(straight, pixels, strict=True)]

    def _meet(self, origins, directions, t_min=0.0, t_max=np.inf) -> brute.Meetings:
        shape = (-1, 3)
        rays = tracer.RayBatch(np.reshape(origins, shape), np.reshape(directions, shape), t_min, t_max)
        return brute.meet_all(self.world, rays, self.there)

    def _unit(self, met: brute.Meetings, ray: int, primitive: int) -> int:
        """What carries the modes of the place where a ray meets a primitive."""
        start, end = self.first[primitive], self.first[primitive + 1]
        return int(start) + naive_cells.cell_of(int(end - start), met.u[ray, primitive], met.v[ray, primitive])

    def _blank(self, met: brute.Meetings) -> NaiveFrame:
        primitives = met.closest()
        units = [-1 if p < 0 else self._unit(met, i, p) for i, p in enumerate(primitives.tolist())]
        shape, lights = (self.settings.height, self.settings.width), len(self.scene.lights)
        seen = primitives.reshape(shape), np.array(units).reshape(shape)
        light = np.zeros((*shape, 3)), np.zeros((*shape, 3)), np.zeros(shape, np.int32)
        return NaiveFrame(*seen, *light, *(np.zeros((*shape, lights), np.bool_) for _ in range(2)))

    def _test_occlusion(self, frame: NaiveFrame, met: brute.Meetings) -> set[int]:
        """§2.3"""
        width = self.settings.width

        def hits(x: int, y: int, primitive: int, unit: int) -> bool:
            ray = y * width + x
            return bool(np.isfinite(met.t[ray, primitive])) and self._unit(met, ray, primitive) == unit

        hidden, frame.counts["occlusion_tests"] = naive.hidden_units(
            frame.primitive, frame.cell, hits, self.settings.symmetric
        )
        return hidden

    def _shade(
        self, frame: NaiveFrame, rays: list[Ray], met: brute.Meetings, chosen: np.ndarray
    ) -> list[tuple[int, int, int]]:
        """Whitted's recursion, all rays of a bounce together; what shadow rays taught: (unit, light, mode)."""
        learnt: list[tuple[int, int, int]] = []
        for bounce in range(self.settings.depth + 1):
            if bounce > 0:
                frame.counts["secondary"] += len(rays)
                met = self._meet([r.origin for r in rays], [r.direction for r in rays])
            else:
                frame.counts["primary"] += len(rays)
            shaded = []
            for i, (ray, primitive) in enumerate(zip(rays, met.closest().tolist(), strict=True)):
                if not chosen[ray.pixel]:
                    continue
                if primitive < 0:
                    for picture in (frame.color, frame.reference):
                        picture[ray.pixel] += ray.weight * np.array(self.scene.background)
                else:
                    where = met.t[i, primitive], met.u[i, primitive], met.v[i, primitive]
                    shaded.append((ray, self._point(ray, primitive, self._unit(met, i, primitive), *where)))
            self._light(frame, shaded, bounce == 0, learnt)
            rays = [ray for pair in shaded for ray in self._onwards(*pair)]
        return learnt

    def _point(self, ray: Ray, primitive: int, unit_: int, t: np.float32, u: np.float32, v: np.float32) -> Point:
        world, place = self.world, self.world.placed.to_object[self.scene.object_of(primitive)].reshape(3, 4)
        position = ray.origin + t * ray.direction

        def outwards(n):
            return place[0, :3] * n[0] + place[1, :3] * n[1] + place[2, :3] * n[2]

        if primitive < self.scene.triangle_count:
            a, b = world.placed.triangles[primitive][3:6], world.placed.triangles[primitive][6:9]
            across = np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])
            geometric = unit(outwards(across))
            corners = world.normals[primitive].reshape(3, 3)
            normal = unit(outwards((F(1) - u - v) * corners[0] + u * corners[1] + v * corners[2]))
        else:
            row = world.placed.quadrics[primitive - self.scene.triangle_count]
            inside = place[:, 0] * position[0] + place[:, 1] * position[1] + place[:, 2] * position[2] + place[:, 3]
            geometric = normal = unit(outwards(_quadric_normal(row, inside)))
        entering = bool(dot(geometric, ray.direction) <= 0)
        geometric = geometric if entering else -geometric
        normal = normal if entering else -normal
        normal = -normal if dot(geometric, normal) < 0 else normal
        offset = F(2e-5) * max(t, *np.abs(position))
        return Point(primitive, unit_, position, geometric, normal, offset, entering)

    def _light(self, frame: NaiveFrame, shaded: list[tuple[Ray, Point]], first: bool, learnt: list) -> None:
        """Local light of all points, with shadow testing (§2.5) and shadow-mode setting (§2.4)."""
        for ray, point in shaded:
            material = self.scene.material_of(point.primitive)
            for picture in (frame.color, frame.reference):
                picture[ray.pixel] += ray.weight * np.array(material.ambient) * np.array(self.scene.ambient)
        for light, lamp in enumerate(self.lamps):
            due = [pair for pair in shaded if dot(pair[1].geometric, lamp - pair[1].position) > 0]
            ends = [point.lifted(1) - lamp for _, point in due]
            met = self._meet([lamp] * len(due), ends, 1e-5, 1.0)
            truths = zip(met.any_of(self.static), met.any_of(~self.static), strict=True)
            for (ray, point), (static, dynamic) in zip(due, truths, strict=True):
                lit = self._shadow_test(frame, point.unit, light, bool(static), bool(dynamic), learnt)
                right = not (static or dynamic)
                phong = _phong(
                    ray, point, lamp, self.scene.lights[light].color, self.scene.material_of(point.primitive)
                )
                frame.color[ray.pixel] += phong * lit
                frame.reference[ray.pixel] += phong * right
                frame.wrong[ray.pixel] += lit != right
                if first:
                    frame.due[ray.pixel][light], frame.lit[ray.pixel][light] = True, lit

    def _shadow_test(self, frame, unit: int, light: int, static: bool, dynamic: bool, learnt: list) -> bool:
        """Whether a light is thought to reach a unit, given what static and dynamic objects really do."""
        frame.counts["due"] += 1
        known = self.modes.known(unit, light) if self.by_modes else ShadowMode.INIT
        if known == ShadowMode.FULL_SHADOW:
            frame.counts["culled"] += 1
            lit = False
        elif known == ShadowMode.NON_SHADOW:
            frame.counts["dynamic_only"] += 1
            frame.counts["rays"] += len(self.scene.objects) > 1  # without dynamic objects there is nobody to ask
            lit = not dynamic
        else:
            frame.counts["rays"] += 1
            learnt.append((unit, light, ShadowMode.FULL_SHADOW if static else ShadowMode.NON_SHADOW))
            lit = not static and not dynamic
        frame.counts["wrong"] += lit == (static or dynamic)
        return lit

    def _onwards(self, ray: Ray, point: Point) -> Iterator[Ray]:
        """The reflected and the refracted ray, as long as they count for enough."""
        material, d, n = self.scene.material_of(point.primitive), ray.direction, point.normal
        mirror, through = np.array(material.specular, F), F(material.transmission)
        sent = []
        if through > 0:
            eta = F(1) / F(material.ior) if point.entering else F(material.ior)
            cosine = -dot(d, n)
            inside = F(1) - eta * eta * (F(1) - cosine * cosine)
            if inside < 0:
                mirror = mirror + through
            else:
                bent = eta * d + (eta * cosine - np.sqrt(inside)) * n
                sent.append((point.lifted(-1), bent, np.full(3, through)))
        sent.append((point.lifted(1), d + F(-2) * dot(d, n) * n, mirror))
        for origin, direction, scale in sent:
            weight = ray.weight * scale
            if weight.max() >= MIN_WEIGHT:
                yield Ray(origin, direction / np.sqrt(dot(direction, direction)), ray.pixel, weight)


def _quadric_normal(row: np.ndarray, point: np.ndarray) -> np.ndarray:
    """Outwards, of any length: the gradient of the canonical surface, carried back; row (16,) as in the world."""
    to_canonical = row[:12].reshape(3, 4)
    x, y, z = (m[0] * point[0] + m[1] * point[1] + m[2] * point[2] + m[3] for m in to_canonical)
    kind, r0, r1, from_inside = row[12:]
    if kind != SPHERE:
        slope = r1 - r0
        z = -slope * (r0 + slope * z)
    sign = F(-1) if from_inside else F(1)
    return sign * (x * to_canonical[0, :3] + y * to_canonical[1, :3] + z * to_canonical[2, :3])


def _phong(ray: Ray, point: Point, lamp: np.ndarray, color, material) -> np.ndarray:
    """Diffuse and specular light of an unblocked lamp, weighted for the pixel, (3,) float64."""
    n, d = point.normal.astype(float), ray.direction.astype(float)
    towards = lamp.astype(float) - point.position
    towards /= np.linalg.norm(towards)
    if not n @ towards > 0:
        return np.zeros(3)
    mirrored = towards - 2 * (n @ towards) * n
    highlight = max(0.0, mirrored @ d) ** material.exponent
    local = np.array(material.diffuse) * (n @ towards) + np.array(material.specular) * highlight
    return ray.weight * np.array(color) * local
