"""The rays of one pixel, followed as shading follows those of a tile, and told one by one.

What a ray hits and what it weighs never depends on the company in which it travels, and so the rays of a pixel are
those that it has in any picture.  Which of their shadow rays are lit is given: culling is another matter
(`tracer.methods.watching`).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.culling.shadow_batch import shadow_batch_in
from tracer.geometry.memory import borrowed
from tracer.kernels import kernel, subkernel
from tracer.shading.bounce import next_wave
from tracer.shading.buffers import pixels_in
from tracer.shading.phong import add_light
from tracer.shading.points import points_at
from tracer.shading.primary import primary_wave, read_hits
from tracer.shading.wave import accumulate, drop_misses, room, trace

# Columns of `numbers`, and of `names`.
RAY_ORIGIN, RAY_DIRECTION, RAY_WEIGHT, RAY_T, POSITION, GEOMETRIC, LIFTED = 0, 3, 6, 9, 10, 13, 16
NUMBER_COLUMNS = 19
BOUNCE, PARENT, PRIMITIVE = range(3)
NAME_COLUMNS = 3


class PixelRays(NamedTuple):
    """Up to n rays, bounce by bounce.

    numbers (n, NUMBER_COLUMNS) float32: origin, direction and weight of each, t of its hit, and of the point there the
    position, the geometric normal and where shadow rays end.  names (n, NAME_COLUMNS) int32: the bounce, the number of
    the ray that sent it, -1 for none, and the primitive that it hits, or MISS.  light (3, n) float64: what it brings
    to the pixel, which starts at 0; spare alike."""

    numbers: NDArray[np.float32]
    names: NDArray[np.int32]
    light: NDArray[np.float64]
    spare: NDArray[np.float64]


def pixel_rays(n: int) -> PixelRays:
    """Room for n rays."""
    numbers, names = np.zeros((n, NUMBER_COLUMNS), np.float32), np.full((n, NAME_COLUMNS), -1, np.int32)
    return PixelRays(numbers, names, np.zeros((3, n)), np.zeros((3, n)))


@kernel
def follow_pixel(world, shading, camera, tile, lanes, depth, buffers, lit, told, counts, space):
    """Follow the rays of a tile of one pixel, whose primary hit the buffers hold; how many there are.

    lit (n, samples) uint8 says to which samples of lights shadow rays of each ray's point get; without rows no light is
    added.  What there is no room for in `told` is not followed."""
    world, shading, told = borrowed(world), borrowed(shading), borrowed(told)
    buffers, space = borrowed(buffers), borrowed(space)
    place, spare = pixels_in(space.pixels).place, space.next
    wave = primary_wave(camera, tile, buffers.primitive.shape[1], lanes, space.wave, place)
    read_hits(wave, place, buffers)
    for i in range(wave.size):
        wave.pixel[i] = -1
    known = 0
    for bounce in range(depth + 1):
        first, known = known, known + wave.size
        if known > len(told.names):
            break
        _tell_rays(wave, bounce, first, told)
        wave = drop_misses(wave, shading.background, told.light, told.spare)
        if wave.size == 0:
            break
        points = points_at(world, shading, wave, space.points, camera.spread, False)
        _tell_points(wave, points, told)
        if len(lit) > 0:
            _add_lights(shading.lamps, wave, points, lit, space)
        accumulate(wave, points.light, told.light)
        if bounce == depth:
            break
        wave, spare = next_wave(points, wave, bounce, spare)
        if wave.size == 0:
            break
        trace(world, wave, counts)
    return known


@subkernel
def _tell_rays(wave, bounce, first, told):
    """Write down the rays of a wave, from row `first` on; each one's pixel becomes the number of its row."""
    for i in range(wave.size):
        row = first + i
        for axis in range(3):
            told.numbers[row, RAY_ORIGIN + axis] = wave.origin[axis, i]
            told.numbers[row, RAY_DIRECTION + axis] = wave.direction[axis, i]
            told.numbers[row, RAY_WEIGHT + axis] = wave.weight[axis, i]
        told.numbers[row, RAY_T] = wave.t[i]
        told.names[row, BOUNCE] = bounce
        told.names[row, PARENT] = wave.pixel[i]
        told.names[row, PRIMITIVE] = wave.primitive[i]
        wave.pixel[i] = row


@subkernel
def _tell_points(wave, points, told):
    """Write down the points of a wave's hits."""
    for i in range(wave.size):
        row = wave.pixel[i]
        for axis in range(3):
            told.numbers[row, POSITION + axis] = points.position[axis, i]
            told.numbers[row, GEOMETRIC + axis] = points.geometric[axis, i]
            told.numbers[row, LIFTED + axis] = points.lifted[axis, i]


@subkernel
def _add_lights(lamps, wave, points, lit, space):
    """Add the light of each sample to the points that it reaches."""
    batch = shadow_batch_in(room(space.shadows, wave.size))
    for light in range(len(lamps.places)):
        for sample in range(lamps.first[light], lamps.first[light + 1]):
            for v in range((wave.size + 15) // 16):
                batch.lit[v] = 0
            for i in range(wave.size):
                batch.lit[i >> 4] |= np.int32(lit[wave.pixel[i], sample]) << np.int32(i & 15)
            add_light(points, lamps, light, sample, batch.lit, wave, points.light)
