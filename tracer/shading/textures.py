"""Textures as pyramids, so that a distant one does not flicker.

Each texture is kept at full size and at every half of it down to one texel (Williams 1983).  How
large a pixel is on the surface, followed along the ray as a cone (Amanatides 1984), says which two
levels to mix.  What counts lies between the area of the cone's footprint, which leaves a floor seen at
a slant sharp but flickering, and the square of its longer axis, which blurs it.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from tracer.kernels import inlined
from tracer.scene.model import Texture


def pack_textures(
    textures: tuple[Texture, ...],
) -> tuple[NDArray[np.uint8], NDArray[np.int64], NDArray[np.int64]]:
    """All levels of all textures: texels (any,) uint8; levels (l, 3) int64, where each starts, its width
    and its height; and table (k, 2) int64, the first level of each texture and how many it has."""
    pieces: list[NDArray[np.uint8]] = [np.empty(0, np.uint8)]
    levels: list[tuple[int, int, int]] = []
    table, start = [], 0
    for texture in textures:
        image = Image.fromarray(texture.pixels)
        count = max(image.size).bit_length()
        table.append((len(levels), count))
        for _ in range(count):
            pieces.append(np.asarray(image, np.uint8).reshape(-1))
            levels.append((start, *image.size))
            start += len(pieces[-1])
            image = image.resize((max(1, image.width // 2), max(1, image.height // 2)), Image.Resampling.BOX)
    rows = (np.array(levels, np.int64).reshape(-1, 3), np.array(table, np.int64).reshape(-1, 2))
    return np.concatenate(pieces), *rows


@inlined
def _around(i, n):
    """i modulo n, for -1 <= i <= n: a division would cost more than all the rest."""
    return i + n if i < 0 else (i - n if i >= n else i)


@inlined
def _bilinear(texels, start, width, height, u, v):
    """(r, g, b) in 0 to 255 of one level, repeating; v = 0 is the bottom of the picture."""
    if not (abs(u) < np.float32(1e9) and abs(v) < np.float32(1e9)):  # nothing is left behind the point, or NaN
        u, v = np.float32(0), np.float32(0)
    x, y = (u - math.floor(u)) * width - 0.5, (1.0 - (v - math.floor(v))) * height - 0.5
    x0, y0 = math.floor(x), math.floor(y)
    fx, fy = np.float32(x - x0), np.float32(y - y0)
    left, right = _around(x0, width), _around(x0 + 1, width)
    upper, lower = start + _around(y0, height) * width * 3, start + _around(y0 + 1, height) * width * 3
    a, b, c, d = upper + left * 3, upper + right * 3, lower + left * 3, lower + right * 3
    one = np.float32(1)
    wa, wb, wc, wd = (one - fx) * (one - fy), fx * (one - fy), (one - fx) * fy, fx * fy
    return (
        wa * texels[a] + wb * texels[b] + wc * texels[c] + wd * texels[d],
        wa * texels[a + 1] + wb * texels[b + 1] + wc * texels[c + 1] + wd * texels[d + 1],
        wa * texels[a + 2] + wb * texels[b + 2] + wc * texels[c + 2] + wd * texels[d + 2],
    )


@inlined
def texture_color(look, texture, u, v, footprint):
    """(r, g, b) in 0 to 1 at (u, v), averaged over a footprint: the part of the whole texture a pixel covers."""
    first, count = look.texture_table[texture, 0], look.texture_table[texture, 1]
    covered = footprint * np.float32(look.texture_levels[first, 1] * look.texture_levels[first, 2])
    level = np.float32(0.5) * np.log2(covered) if covered > np.float32(1) else np.float32(0)
    level = min(level, np.float32(count - 1))  # before it becomes an integer: it may be infinite
    whole = int(level)
    mix = level - np.float32(whole) if whole < count - 1 else np.float32(0)
    row = first + whole
    levels, scale = look.texture_levels, np.float32(1 / 255)
    red, green, blue = _bilinear(look.texels, levels[row, 0], levels[row, 1], levels[row, 2], u, v)
    if mix > np.float32(0):
        row += 1
        r, g, b = _bilinear(look.texels, levels[row, 0], levels[row, 1], levels[row, 2], u, v)
        red, green, blue = red + mix * (r - red), green + mix * (g - green), blue + mix * (b - blue)
    return scale * red, scale * green, scale * blue
