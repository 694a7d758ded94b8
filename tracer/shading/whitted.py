"""Whitted's recursive shading (1980), wave by wave over the rays of one tile.

A wave is a batch of rays that have hit something.  Each is shaded by all lights, with shadow testing
and shadow-mode setting, and sends out the reflected and refracted rays of the next wave, as long as
the weight with which they would count is at least MIN_WEIGHT (adaptive depth control, Hall and
Greenberg 1983).  A wave is as small as it can be: misses leave it at once.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.culling.shadow import RAYS, SHADOW_COUNTERS, answers_for, lifted, shadow_testing
from tracer.geometry.camera import primary_ray
from tracer.geometry.memory import borrowed
from tracer.geometry.queries import closest_hits
from tracer.geometry.rays import MISS, Hits, Rays, empty_hits, empty_rays, padded
from tracer.kernels import inlined, kernel, subkernel
from tracer.shading.look import IOR, SPECULAR, TRANSMISSION
from tracer.shading.phong import add_ambient, add_light
from tracer.shading.points import points_at

MIN_WEIGHT = np.float32(1 / 256)
ONE = np.float32(1)

# A worker's counters: primary steps, tests, rays; then secondary; then those of shadow rays.
PRIMARY, SECONDARY, SHADOW = 0, 3, 6
COUNTERS = SHADOW + SHADOW_COUNTERS


class Buffers(NamedTuple):
    """One picture: color and normal (height * width, 3), depth, u and v (height, width) float32,
    primitive (height, width) int32; due and lit (height * width, lights) bool, or without rows;
    reference like color and wrong (height * width,) int32, or without rows where nothing is verified."""

    color: NDArray[np.float32]
    normal: NDArray[np.float32]
    depth: NDArray[np.float32]
    primitive: NDArray[np.int32]
    u: NDArray[np.float32]
    v: NDArray[np.float32]
    due: NDArray[np.bool_]
    lit: NDArray[np.bool_]
    reference: NDArray[np.float32]
    wrong: NDArray[np.int32]


class Wave(NamedTuple):
    """`size` rays, in rows of n, whole vectors: what they hit, the pixel (n,) int32 they count for, with which
    weight (3, n) float32, and reach (n,) float32, the length of the path from the eye to where they start."""

    rays: Rays
    hits: Hits
    size: int
    pixel: NDArray[np.int32]
    weight: NDArray[np.float32]
    reach: NDArray[np.float32]


@inlined
def _empty_wave(n):
    m = padded(n)
    weight, reach = np.empty((3, m), np.float32), np.empty(m, np.float32)
    return Wave(empty_rays(n), empty_hits(n), n, np.empty(m, np.int32), weight, reach)


@inlined
def _store_ray(rays, i, origin, direction):
    for axis in range(3):
        rays.origin[axis, i] = origin[axis]
        rays.direction[axis, i] = direction[axis]
    rays.t_min[i], rays.t_max[i] = np.float32(0), np.float32(np.inf)


@inlined
def _pixel_of(tile, k):
    """Column and row of the k-th pixel of a tile (left, top, right, bottom)."""
    width = tile[2] - tile[0]
    return tile[0] + k % width, tile[1] + k // width


@kernel
def trace_primary(world, camera, tile, buffers, counts):
    """Primary rays of a tile: depth, primitive and barycentric weights into the buffers."""
    n = (tile[2] - tile[0]) * (tile[3] - tile[1])
    rays, hits = empty_rays(n), empty_hits(n)
    for k in range(n):
        x, y = _pixel_of(tile, k)
        ray = primary_ray(camera, x, y)
        _store_ray(rays, k, (ray.ox, ray.oy, ray.oz), (ray.dx, ray.dy, ray.dz))
    closest_hits(world, rays, hits, 0, n, counts[PRIMARY:])
    counts[PRIMARY + RAYS] += n
    for k in range(n):
        x, y = _pixel_of(tile, k)
        buffers.depth[y, x], buffers.primitive[y, x] = hits.t[k], hits.primitive[k]
        buffers.u[y, x], buffers.v[y, x] = hits.u[k], hits.v[k]


@subkernel
def _first_wave(camera, tile, buffers):
    """The tile's primary rays once more, with the hits that the buffers hold."""
    n, width = (tile[2] - tile[0]) * (tile[3] - tile[1]), buffers.primitive.shape[1]
    wave = _empty_wave(n)
    for k in range(n):
        x, y = _pixel_of(tile, k)
        ray = primary_ray(camera, x, y)
        _store_ray(wave.rays, k, (ray.ox, ray.oy, ray.oz), (ray.dx, ray.dy, ray.dz))
        wave.hits.t[k], wave.hits.primitive[k] = buffers.depth[y, x], buffers.primitive[y, x]
        wave.hits.u[k], wave.hits.v[k] = buffers.u[y, x], buffers.v[y, x]
        wave.pixel[k], wave.reach[k] = y * width + x, np.float32(0)
        for axis in range(3):
            wave.weight[axis, k] = ONE
            buffers.color[wave.pixel[k], axis], buffers.normal[wave.pixel[k], axis] = np.float32(0), np.float32(0)
    return wave


@inlined
def _copy_ray(source, i, target, k):
    """Ray i of one wave, with its hit, becomes ray k of another."""
    for axis in range(3):
        target.rays.origin[axis, k] = source.rays.origin[axis, i]
        target.rays.direction[axis, k] = source.rays.direction[axis, i]
        target.weight[axis, k] = source.weight[axis, i]
    target.rays.t_min[k], target.rays.t_max[k] = source.rays.t_min[i], source.rays.t_max[i]
    target.hits.t[k], target.hits.primitive[k] = source.hits.t[i], source.hits.primitive[i]
    target.hits.u[k], target.hits.v[k] = source.hits.u[i], source.hits.v[i]
    target.pixel[k], target.reach[k] = source.pixel[i], source.reach[i]


@inlined
def _counted(wave, n):
    """The first n rays of a wave."""
    return Wave(wave.rays, wave.hits, n, wave.pixel, wave.weight, wave.reach)


@subkernel
def _without_misses(wave, look, buffers):
    """The wave's rays that hit; the others bring home the background."""
    n = 0
    for i in range(wave.size):
        if wave.hits.primitive[i] == MISS:
            for c in range(3):
                light = wave.weight[c, i] * look.background[c]
                buffers.color[wave.pixel[i], c] += light
                if len(buffers.reference) > 0:
                    buffers.reference[wave.pixel[i], c] += light
            continue
        if n < i:
            _copy_ray(wave, i, wave, n)
        n += 1
    return _counted(wave, n)


@inlined
def _reflected(d, n):
    """Direction d mirrored at a surface of unit normal n."""
    s = np.float32(-2) * (d[0] * n[0] + d[1] * n[1] + d[2] * n[2])
    return d[0] + s * n[0], d[1] + s * n[1], d[2] + s * n[2]


@inlined
def _refracted(d, n, eta):
    """(whether, direction) of Snell's law, n against d; not so under total internal reflection."""
    cosine = -(d[0] * n[0] + d[1] * n[1] + d[2] * n[2])
    k = ONE - eta * eta * (ONE - cosine * cosine)
    if k < np.float32(0):
        return False, (d[0], d[1], d[2])
    s = eta * cosine - np.sqrt(k)
    return True, (eta * d[0] + s * n[0], eta * d[1] + s * n[1], eta * d[2] + s * n[2])


@inlined
def _send(wave, n, origin, direction, pixel, reach, weight, scale):
    """Add a ray to the next wave unless it would count too little; the wave's new length."""
    r, g, b = weight[0] * scale[0], weight[1] * scale[1], weight[2] * scale[2]
    if max(r, max(g, b)) < MIN_WEIGHT:
        return n
    length = np.sqrt(direction[0] ** 2 + direction[1] ** 2 + direction[2] ** 2)
    _store_ray(wave.rays, n, origin, (direction[0] / length, direction[1] / length, direction[2] / length))
    wave.pixel[n], wave.reach[n] = pixel, reach
    wave.weight[0, n], wave.weight[1, n], wave.weight[2, n] = r, g, b
    return n + 1


@subkernel
def _next_wave(points, look, wave):
    """Reflected rays, scaled by the specular colour, and refracted ones, scaled by the transmission."""
    out = _empty_wave(2 * wave.size)
    n = 0
    for i in range(wave.size):
        material = look.materials[points.material[i]]
        d = (wave.rays.direction[0, i], wave.rays.direction[1, i], wave.rays.direction[2, i])
        normal = (points.normal[0, i], points.normal[1, i], points.normal[2, i])
        weight = (wave.weight[0, i], wave.weight[1, i], wave.weight[2, i])
        above = lifted(points.position, points.geometric, points.offset[i], i)
        mirror = (material[SPECULAR], material[SPECULAR + 1], material[SPECULAR + 2])
        through, reach = material[TRANSMISSION], wave.reach[i] + wave.hits.t[i]
        if through > np.float32(0):
            eta = ONE / material[IOR] if points.entering[i] else material[IOR]
            passes, direction = _refracted(d, normal, eta)
            if passes:
                below = lifted(points.position, points.geometric, -points.offset[i], i)
                n = _send(out, n, below, direction, wave.pixel[i], reach, weight, (through, through, through))
            else:  # total internal reflection takes the refracted ray's share
                mirror = (mirror[0] + through, mirror[1] + through, mirror[2] + through)
        n = _send(out, n, above, _reflected(d, normal), wave.pixel[i], reach, weight, mirror)
    return _counted(out, n)


@subkernel
def _bring_home(wave, light, color):
    """Add what came from a wave's points, (3, n), to their pixels."""
    for i in range(wave.size):
        for c in range(3):
            color[wave.pixel[i], c] += wave.weight[c, i] * light[c, i]


@subkernel
def _shade(world, look, wave, points, knowledge, first, buffers, counts):
    """Local light of a wave, with shadow testing for every light; `first` for the wave of primary rays."""
    light = np.zeros(points.position.shape, np.float32)
    reference = np.zeros((3, points.position.shape[1] if knowledge.verify else 0), np.float32)
    answers = answers_for(points, wave.size, knowledge)
    add_ambient(points, look, light)
    add_ambient(points, look, reference)
    for number in range(len(look.lights)):
        shadow_testing(world, points, wave.size, look.lights[number], number, knowledge, answers, counts[SHADOW:])
        add_light(points, look, number, answers.lit, wave.rays, light)
        if knowledge.verify:
            add_light(points, look, number, answers.truth, wave.rays, reference)
            _note_wrong(wave, answers, buffers.wrong)
        if first and len(buffers.due) > 0:
            _record(wave, number, answers, buffers)
    _bring_home(wave, light, buffers.color)
    if knowledge.verify:
        _bring_home(wave, reference, buffers.reference)
    if first:
        for i in range(wave.size):
            for axis in range(3):
                buffers.normal[wave.pixel[i], axis] = points.normal[axis, i]


@subkernel
def _note_wrong(wave, answers, wrong):
    for i in range(wave.size):
        wrong[wave.pixel[i]] += ((answers.lit[i >> 4] ^ answers.truth[i >> 4]) >> (i & 15)) & 1


@subkernel
def _record(wave, number, answers, buffers):
    """Which shadow rays of primary hits are due, and their answers."""
    for i in range(wave.size):
        buffers.due[wave.pixel[i], number] = (answers.due[i >> 4] >> (i & 15)) & 1
        buffers.lit[wave.pixel[i], number] = (answers.lit[i >> 4] >> (i & 15)) & 1


@kernel
def shade_tile(world, look, camera, tile, depth, knowledge, buffers, counts):
    """Shade a tile whose primary hits the buffers hold, with at most `depth` bounces."""
    world, look, knowledge, buffers = borrowed(world), borrowed(look), borrowed(knowledge), borrowed(buffers)
    wave = _without_misses(_first_wave(camera, tile, buffers), look, buffers)
    for bounce in range(depth + 1):
        points = points_at(world, look, wave.size, wave.rays, wave.hits, wave.reach, camera.spread)
        _shade(world, look, wave, points, knowledge, bounce == 0, buffers, counts)
        if bounce == depth:
            break
        wave = _next_wave(points, look, wave)
        n = wave.size
        if n == 0:
            break
        closest_hits(world, wave.rays, wave.hits, 0, n, counts[SECONDARY:])
        counts[SECONDARY + RAYS] += n
        wave = _without_misses(wave, look, buffers)
        if wave.size == 0:
            break
