"""Images as float arrays (h, w, 3) in 0..1, row 0 at the top: noise, colour ramps, soft edges, PPM and PNG."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from generate.mesh import Array

Colour = tuple[float, float, float]


def generator(seed: int) -> np.random.RandomState:
    """The legacy generator: its stream is frozen for all versions of NumPy."""
    return np.random.RandomState(seed)


def coordinates(width: int, height: int) -> tuple[Array, Array]:
    """Pixel centres: x rightwards and y downwards, each (h, w) in 0..1."""
    x, y = np.meshgrid((np.arange(width) + 0.5) / width, (np.arange(height) + 0.5) / height)
    return x, y


def noise(x: Array, y: Array, period: tuple[int, int], seed: int) -> Array:
    """Smooth value noise in 0..1 with one knot per unit, repeating after `period` units."""
    table = generator(seed).random_sample(period[::-1])
    i, j = np.floor(x).astype(int), np.floor(y).astype(int)
    u, v = x - i, y - j
    u, v = u * u * (3 - 2 * u), v * v * (3 - 2 * v)
    i0, j0 = i % period[0], j % period[1]
    i1, j1 = (i + 1) % period[0], (j + 1) % period[1]
    top = table[j0, i0] * (1 - u) + table[j0, i1] * u
    bottom = table[j1, i0] * (1 - u) + table[j1, i1] * u
    return top * (1 - v) + bottom * v


def clouds(x: Array, y: Array, period: tuple[int, int], seed: int, octaves: int = 4, gain: float = 0.5) -> Array:
    """Octaves of noise in about 0..1; tiles after `period` units."""
    total, weight, amount = np.zeros_like(x), 0.0, 1.0
    for k in range(octaves):
        scale = 2**k
        total += amount * noise(x * scale, y * scale, (period[0] * scale, period[1] * scale), seed + k)
        weight += amount
        amount *= gain
    return total / weight


def ramp(value: Array, stops: Sequence[tuple[float, Colour]]) -> Array:
    """Colours along a piecewise linear ramp."""
    at = [s for s, _ in stops]
    return np.stack([np.interp(value, at, [c[k] for _, c in stops]) for k in range(3)], axis=2)


def step(edge: float | Array, value: Array, softness: float) -> Array:
    """0 below the edge, 1 above it, smooth over `softness`."""
    t = np.clip((value - edge) / softness + 0.5, 0, 1)
    return t * t * (3 - 2 * t)


def paint(image: Array, mask: NDArray[np.floating], colour: Colour | Array) -> Array:
    """Colour laid over an image where the mask is 1."""
    return image + mask[..., None] * (np.asarray(colour) - image)


def to_bytes(image: Array) -> np.ndarray:
    return np.floor(np.clip(image, 0, 1) * 255 + 0.5 + 1e-7).astype(np.uint8)


def ppm(image: Array) -> bytes:
    pixels = to_bytes(image)
    return b"P6\n%d %d\n255\n" % (pixels.shape[1], pixels.shape[0]) + pixels.tobytes()


def png(image: Array) -> bytes:
    """An 8-bit PNG of (h, w, 3 or 4)."""
    pixels = to_bytes(image)
    height, width, channels = pixels.shape
    rows = b"".join(b"\0" + row.tobytes() for row in pixels)

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", width, height, 8, 6 if channels == 4 else 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b"")
