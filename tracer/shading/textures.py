"""Textures as pyramids, so that a distant one does not flicker.

Each texture is kept at full size and at every half of it down to one texel (Williams 1983).  How
large a pixel is on the surface, followed along the ray as a cone (Amanatides 1984), says which two
levels to mix.  What counts lies between the area of the cone's footprint, which leaves a floor seen at
a slant sharp but flickering, and the square of its longer axis, which blurs it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from tracer.geometry.memory import aligned_rows
from tracer.runtime.kernels import inlined, subkernel
from tracer.scene.model import Texture
from tracer.simd import (
    address_of,
    any_lane,
    as_i32,
    binary_logarithm,
    floor,
    gather_i32x16,
    load_columns,
    local_memory,
    maximum,
    minimum,
    select,
    store,
    to_f32,
    to_i32,
)

# Columns of a triangle's mapping: three corners' u and v, then how many texels of the texture's first level the
# triangle spans, twice, and, as the bits of int32, 32 times the number of that level and how many come after it.
SPANNED, LEVELS = 6, 7
MAPPING_COLUMNS = 8
# Columns of a level, int32: where it starts, its size, and the same of the level after it, if any, else its own.
START, WIDTH, HEIGHT, AFTER = 0, 1, 2, 4
LEVEL_COLUMNS = 8
ZERO, HALF, ONE = np.float32(0), np.float32(0.5), np.float32(1)


def pack_textures(
    textures: tuple[Texture, ...],
) -> tuple[NDArray[np.uint32], NDArray[np.int32], NDArray[np.int32]]:
    """All levels of all textures: texels (any,) uint32, red in the lowest byte, then green and blue; levels
    (l, 8) int32; and of each texture the number of its first level, 32 times, and how many come after it."""
    pieces: list[NDArray[np.uint32]] = [np.empty(0, np.uint32)]
    levels: list[tuple[int, ...]] = []
    numbers, start = [], 0
    for texture in textures:
        image = Image.fromarray(texture.pixels)
        count = max(image.size).bit_length()
        numbers.append(32 * len(levels) + count - 1)
        own = []
        for _ in range(count):
            red, green, blue = np.asarray(image, np.uint32).reshape(-1, 3).T
            pieces.append((red | green << 8 | blue << 16).astype(np.uint32))
            own.append((start, *image.size, 0))
            start += len(pieces[-1])
            image = image.resize((max(1, image.width // 2), max(1, image.height // 2)), Image.Resampling.BOX)
        levels += [level + after for level, after in zip(own, [*own[1:], own[-1]], strict=True)]
    rows = (np.array(levels, np.int32).reshape(-1, LEVEL_COLUMNS), np.array(numbers, np.int32))
    return np.concatenate(pieces), *rows


def mapping_rows(
    uvs: NDArray[np.float32], texture: NDArray[np.int32], levels: NDArray[np.int32], numbers: NDArray[np.int32]
) -> NDArray[np.float32]:
    """Mappings (t, 8) of triangles, of their corners' uvs (t, 6) and texture (t,), -1 for none."""
    rows = aligned_rows(len(uvs), MAPPING_COLUMNS)
    rows[:, :SPANNED] = uvs
    rows[:, SPANNED:] = 0
    has = texture >= 0
    number = numbers[texture[has]]
    u0, v0, u1, v1, u2, v2 = uvs[has].T
    with np.errstate(all="ignore"):  # coordinates may be anything, and so may what they span
        covered = np.abs((u1 - u0) * (v2 - v0) - (u2 - u0) * (v1 - v0))
    first = levels[number >> 5]
    rows[has, SPANNED] = covered * (first[:, WIDTH] * first[:, HEIGHT]).astype(np.float32)
    rows.view(np.int32)[has, LEVELS] = number
    return rows


@inlined
def _across(u, size):
    """The texels on both sides of u in a row of so many that repeats, and how far u is from the first to the second."""
    u = select(maximum(u, -u) < np.float32(1e9), u, ZERO)  # nothing is left behind the point, or NaN
    x = (u - floor(u)) * to_f32(size) - HALF
    below = floor(x)
    first = to_i32(below)
    second = first + np.int32(1)
    first = select(first < np.int32(0), first + size, first)
    return first, select(second >= size, second - size, second), x - below


@inlined
def _bilinear(shading, level, column, u, v):
    """(r, g, b) in 0 to 255 of one level each, described from `column` on; v = 0 is the bottom of the picture."""
    start, width, height = (
        as_i32(level[column + START]),
        as_i32(level[column + WIDTH]),
        as_i32(level[column + HEIGHT]),
    )
    left, right, fx = _across(u, width)
    upper, lower, fy = _across(-v, height)
    texels = address_of(shading.texels)
    upper, lower = start + upper * width, start + lower * width
    a, b = gather_i32x16(texels, upper + left), gather_i32x16(texels, upper + right)
    c, d = gather_i32x16(texels, lower + left), gather_i32x16(texels, lower + right)
    gx, gy = ONE - fx, ONE - fy
    wa, wb, wc, wd = gx * gy, fx * gy, gx * fy, fx * fy
    return (
        wa * _channel(a, 0) + wb * _channel(b, 0) + wc * _channel(c, 0) + wd * _channel(d, 0),
        wa * _channel(a, 8) + wb * _channel(b, 8) + wc * _channel(c, 8) + wd * _channel(d, 8),
        wa * _channel(a, 16) + wb * _channel(b, 16) + wc * _channel(c, 16) + wd * _channel(d, 16),
    )


@inlined
def _channel(texels, shift):
    return to_f32((texels >> np.int32(shift)) & np.int32(255))


@subkernel
def texture_colors(shading, mapping, u, v, covered):
    """(r, g, b) in 0 to 1 at (u, v) of textures, averaged over so many texels of their first level; mapping holds
    columns."""
    numbers = as_i32(mapping[LEVELS])
    size = HALF * binary_logarithm(maximum(covered, ONE))
    size = minimum(size, to_f32(numbers & np.int32(31)))
    whole = to_i32(size)
    mix = size - to_f32(whole)  # 0 at the last level
    rows = local_memory(64)
    store(rows, (numbers >> np.int32(5)) + whole)
    level = load_columns(address_of(shading.texture_levels), rows, LEVEL_COLUMNS)
    scale = np.float32(1 / 255)
    red, green, blue = _bilinear(shading, level, 0, u, v)
    if any_lane(mix > ZERO):
        r, g, b = _bilinear(shading, level, AFTER, u, v)
        red, green, blue = red + mix * (r - red), green + mix * (g - green), blue + mix * (b - blue)
    return scale * red, scale * green, scale * blue
