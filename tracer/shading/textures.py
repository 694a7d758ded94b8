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
from tracer.kernels import inlined, subkernel
from tracer.scene.model import Texture
from tracer.simd import (
    address_of,
    any_lane,
    as_i32,
    binary_logarithm,
    floor,
    gather_i32x16,
    maximum,
    minimum,
    select,
    to_f32,
    to_i32,
)

# Columns of a triangle's mapping: three corners' u and v, then how many texels of the texture's first level the
# triangle spans, twice, and, as the bits of int32, the number of that level.
SPANNED, FIRST_LEVEL = 6, 7
MAPPING_COLUMNS = 8
# Columns of a level: where it starts, its size, and how many levels of the texture come after it.
START, WIDTH, HEIGHT, REST = 0, 1, 2, 3
LEVEL_COLUMNS = 4
ZERO, HALF, ONE = np.float32(0), np.float32(0.5), np.float32(1)


def pack_textures(
    textures: tuple[Texture, ...],
) -> tuple[NDArray[np.uint32], NDArray[np.int32], NDArray[np.int32]]:
    """All levels of all textures: texels (any,) uint32, red in the lowest byte, then green and blue; levels
    (l, 4) int32; and the number of each texture's first level."""
    pieces: list[NDArray[np.uint32]] = [np.empty(0, np.uint32)]
    levels: list[tuple[int, int, int, int]] = []
    first_levels, start = [], 0
    for texture in textures:
        image = Image.fromarray(texture.pixels)
        count = max(image.size).bit_length()
        first_levels.append(len(levels))
        for rest in range(count - 1, -1, -1):
            red, green, blue = np.asarray(image, np.uint32).reshape(-1, 3).T
            pieces.append((red | green << 8 | blue << 16).astype(np.uint32))
            levels.append((start, *image.size, rest))
            start += len(pieces[-1])
            image = image.resize((max(1, image.width // 2), max(1, image.height // 2)), Image.Resampling.BOX)
    rows = (np.array(levels, np.int32).reshape(-1, LEVEL_COLUMNS), np.array(first_levels, np.int32))
    return np.concatenate(pieces), *rows


def mapping_rows(
    uvs: NDArray[np.float32], texture: NDArray[np.int32], levels: NDArray[np.int32], first_levels: NDArray[np.int32]
) -> NDArray[np.float32]:
    """Mappings (t, 8) of triangles, of their corners' uvs (t, 6) and texture (t,), -1 for none."""
    rows = aligned_rows(len(uvs), MAPPING_COLUMNS)
    rows[:, :SPANNED] = uvs
    rows[:, SPANNED:] = 0
    has = texture >= 0
    first = first_levels[texture[has]]
    u0, v0, u1, v1, u2, v2 = uvs[has].T
    with np.errstate(all="ignore"):  # coordinates may be anything, and so may what they span
        covered = np.abs((u1 - u0) * (v2 - v0) - (u2 - u0) * (v1 - v0))
    rows[has, SPANNED] = covered * (levels[first, WIDTH] * levels[first, HEIGHT]).astype(np.float32)
    rows.view(np.int32)[has, FIRST_LEVEL] = first
    return rows


@inlined
def _level(look, rows, column):
    return gather_i32x16(address_of(look.texture_levels) + 4 * column, rows << np.int32(2))


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
def _bilinear(look, rows, u, v):
    """(r, g, b) in 0 to 255 of one level each, repeating; v = 0 is the bottom of the picture."""
    width, height = _level(look, rows, WIDTH), _level(look, rows, HEIGHT)
    left, right, fx = _across(u, width)
    upper, lower, fy = _across(-v, height)
    texels, start = address_of(look.texels), _level(look, rows, START)
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
def texture_colors(look, first_level, u, v, covered):
    """(r, g, b) in 0 to 1 at (u, v) of textures, averaged over so many texels of their first level."""
    level = HALF * binary_logarithm(maximum(covered, ONE))
    rest = _level(look, first_level, REST)
    level = minimum(level, to_f32(rest))
    whole = to_i32(level)
    mix = level - to_f32(whole)  # 0 at the last level
    scale = np.float32(1 / 255)
    red, green, blue = _bilinear(look, first_level + whole, u, v)
    mixed = mix > ZERO
    if any_lane(mixed):
        r, g, b = _bilinear(look, first_level + whole + select(mixed, np.int32(1), np.int32(0)), u, v)
        red, green, blue = red + mix * (r - red), green + mix * (g - green), blue + mix * (b - blue)
    return scale * red, scale * green, scale * blue


@inlined
def first_levels(mapping):
    """Numbers of the first levels, from the columns of mappings."""
    return as_i32(mapping[FIRST_LEVEL])
