"""All rays of a whole Whitted frame, wave by wave: what tracing alone would have to trace."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tests.bench.rays import (
    Points,
    Surfaces,
    Vectors,
    dot,
    joined,
    points_of,
    primary_rays,
    reflected,
    shadow_rays,
    unit,
)
from tracer.culling.modes import OcclusionMode, ShadowMode, has_shadow_mode, occlusion_mode, shadow_mode
from tracer.geometry.rays import Rays, ray_batch
from tracer.geometry.world import World
from tracer.scene.model import Camera
from tracer.shading.bounce import MIN_WEIGHT


@dataclass(frozen=True)
class FrameRays:
    """Rays that ask for closest hits, primary and secondary, and shadow rays due; and culled (shadow rays,)
    bool, which of those an algorithm with such modes would leave out."""

    primary: Rays
    secondary: Rays
    shadow: Rays
    culled: NDArray[np.bool_]


def frame_rays(
    world: World, time: float, camera: Camera, size: tuple[int, int], depth: int, words: NDArray | None = None
) -> FrameRays:
    """The rays of a frame of that size, with at most `depth` bounces, of a world of triangles that is
    placed at that time.  `words` are the modes as the last frame left them; without any, nothing is culled."""
    scene, surfaces = world.scene, Surfaces.of(world.scene, time)
    lights = scene.light_positions(time).astype(np.float32)
    material = np.concatenate([item.triangles.material for item in scene.objects])
    rows = [[*m.specular, m.transmission, m.ior] for m in scene.materials]
    materials = np.array(rows, np.float32)
    primary = rays = primary_rays(camera, *size)
    weight = np.ones((len(rays.t_min), 3), np.float32)
    secondary: list[Rays] = []
    shadow: list[Rays] = []
    culled: list[NDArray[np.bool_]] = []
    for bounce in range(depth + 1):
        hits = world.closest_hits(rays)
        weight = weight[hits.primitive >= 0]
        points = points_of(surfaces, rays, hits)
        for number, light in enumerate(lights):
            batch, due = shadow_rays(points, light)
            shadow.append(batch)
            culled.append(_culled(words, points.primitive[due], number))
        if bounce == depth or not len(weight):
            break
        rays, weight = _next_wave(points, weight, materials[material[points.primitive]])
        secondary.append(rays)
        if not len(weight):
            break
    return FrameRays(primary, joined(secondary), joined(shadow), np.concatenate([np.zeros(0, np.bool_), *culled]))


def _culled(words: NDArray | None, primitive: NDArray[np.int32], light: int) -> NDArray[np.bool_]:
    """Whether modes say of each primitive that it is wholly in the shadow of a light."""
    if words is None or not has_shadow_mode(words, light):
        return np.zeros(len(primitive), np.bool_)
    known = occlusion_mode(words[primitive]) == OcclusionMode.FULLY_RENDERED
    return known & (shadow_mode(words[primitive], light) == ShadowMode.FULL_SHADOW)


def _next_wave(points: Points, weight: Vectors, material: Vectors) -> tuple[Rays, Vectors]:
    """Refracted and reflected rays that count for enough, point by point, and their weights (n, 3)."""
    mirror, through, ior = material[:, :3], material[:, 3:4], material[:, 4:5]
    eta = np.where(points.entering[:, None], 1 / ior, ior)
    cosine = -dot(points.direction, points.normal)
    inside = 1 - eta * eta * (1 - cosine * cosine)
    passes = inside >= 0  # else total internal reflection, which takes the refracted ray's share
    bent = eta * points.direction + (eta * cosine - np.sqrt(np.maximum(inside, 0))) * points.normal
    scales = np.stack(
        [np.where(passes, through, 0) + np.zeros_like(mirror), mirror + np.where(passes, 0, through)], axis=1
    )
    weights = weight[:, None] * scales
    origins = np.stack([points.lifted(-1), points.lifted()], axis=1)
    directions = np.stack([bent, reflected(points)], axis=1)
    kept = (weights.max(axis=2) >= MIN_WEIGHT) & np.stack([through[:, 0] > 0, np.ones(len(through), np.bool_)], axis=1)
    return ray_batch(origins[kept], unit(directions[kept])), weights[kept]
