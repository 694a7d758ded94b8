"""Filling in pixels that are not shaded yet from those that are, and saying where the result is in doubt.

A pixel that is not shaded yet looks at the shaded pixels of its block and of the eight blocks around it.  It takes from
them which part of their unshadowed light arrives, and what they get by reflection and refraction.  Those count most
that are near and lie on the same surface: the same material and object, similar normals, one plane (the guides of a
joint bilateral filter, Eisemann and Durand 2004).  The pixel's own light, texture and highlight are exact; only the
borders of shadows and reflections are soft.

Where the neighbours disagree, or none lies on the pixel's surface, the pixel and its block are in doubt: there it is
worth shading more pixels than elsewhere (adaptive sampling, Mitchell 1987).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tracer.geometry.memory import without_refcount
from tracer.geometry.rays import MISS
from tracer.runtime.kernels import inlined, kernel
from tracer.shading.blocks import (
    BLOCK,
    EDGE,
    LOCAL,
    NORMAL,
    PLANE,
    POSITION,
    SENT,
    SURFACE,
    TURNS,
    UNSHADOWED,
    Planes,
    planes_at,
)
from tracer.simd import (
    address_of,
    as_i32,
    f32_at,
    f32x16,
    load_f32,
    load_f32x16,
    load_i32,
    local_memory,
    lowest_bit,
    maximum,
    minimum,
    ones,
    select,
    square_root,
    store,
    store_three,
)

AROUND = 9  # blocks: a pixel's own, in the middle, and those around it
SOFTNESS = 0.7  # of the distance between shaded pixels: the filter's width
LEAST = 2e-3  # a weight that is too small to ask for
STRANGER = np.float32(1e-3)  # what the word of another surface is worth
UNSEEN = np.float32(0.5)  # how much a pixel is in doubt of whose surface nothing is known
DARKNESS = np.float32(0.3)  # light against which differences count: of darker places less is seen
TINY = np.float32(1e-6)  # of light: less of it cannot be divided into parts
ZERO, ONE = np.float32(0), np.float32(1)


def _make_weights() -> tuple[NDArray[np.float32], NDArray[np.int64]]:
    """By how many pixels of a block are shaded, for each block around and each pixel there, what its word is worth by
    its distance to each pixel of the block; and the bits of those there that are worth asking."""
    y, x = np.divmod(np.arange(TURNS), BLOCK)
    down, across = np.divmod(np.arange(AROUND), 3)
    ys = BLOCK * (down - 1)[:, None] + y
    xs = BLOCK * (across - 1)[:, None] + x
    distances = (ys[:, :, None] - y) ** 2 + (xs[:, :, None] - x) ** 2
    apart = TURNS / np.maximum(np.arange(TURNS + 1), 0.5)  # on average; none is shaded in half of the blocks at least
    weights = np.exp(-distances / (SOFTNESS**2 * apart[:, None, None, None]))
    asked = (weights.max(axis=-1) > LEAST) << np.arange(TURNS)
    return np.ascontiguousarray(weights, np.float32), np.ascontiguousarray(asked.sum(axis=-1))


WEIGHTS, ASKED = _make_weights()


def fill_in(
    planes: Planes,
    shaded: NDArray[np.int32],
    wanted: NDArray[np.bool_],
    rows: tuple[int, int],
    spread: float,
    color: NDArray[np.float32],
    filled: NDArray[np.float32],
    doubt: NDArray[np.float32],
) -> None:
    """Fill in the blocks that are `wanted`, in rows of these from the first to one before the last.

    shaded (rows, columns) int32 and wanted, alike, are of all blocks with the edges; spread is the width of a pixel at
    distance 1.  What color (height, width, 3) has of pixels that are shaded goes into filled, alike, and the
    others are made from these; doubt, of all blocks, says how much their pixels are in doubt together."""
    _fill(planes, shaded, wanted, *rows, np.float32((4.0 * spread) ** 2), WEIGHTS, ASKED, color, filled, doubt)


def nearest(size: int, place: int) -> NDArray[np.intp]:
    """For each of so many pixels in a row the nearest inside that has this place in its block."""
    if place >= size:
        return np.full(size, size - 1)
    return np.minimum(np.arange(size) // BLOCK * BLOCK + place, (size - 1 - place) // BLOCK * BLOCK + place)


@inlined
def _plane(block, plane):
    return load_f32x16(block + PLANE * plane)


@inlined
def _three(block, plane):
    return _plane(block, plane), _plane(block, plane + 1), _plane(block, plane + 2)


@inlined
def _three_of(pixel, plane):
    """Three numbers of one pixel."""
    at = pixel + PLANE * plane
    return load_f32(at), load_f32(at + PLANE), load_f32(at + 2 * PLANE)


@inlined
def _likeness(normal, position, flatness, pixel):
    """How far sixteen pixels lie in the plane of another: 1 for the same, 0 for one at a right angle."""
    other, (x, y, z) = _three_of(pixel, NORMAL), _three_of(pixel, POSITION)
    cosine = maximum(normal[0] * other[0] + normal[1] * other[1] + normal[2] * other[2], ZERO)
    off = normal[0] * (x - position[0]) + normal[1] * (y - position[1]) + normal[2] * (z - position[2])
    like = cosine * cosine * maximum(ONE - off * off * flatness, ZERO)
    return like * like


@inlined
def _part(local, unshadowed, otherwise):
    """Which part of the light arrives; of what is black in this colour nobody can tell."""
    shines = unshadowed > TINY
    return select(shines, local / select(shines, unshadowed, f32x16(ONE)), otherwise)


@inlined
def _filled(planes, shaded, row, column, foot, weights, asked):
    """The light of a block's sixteen pixels, and how much each is in doubt."""
    block, count = planes_at(planes, row, column), ones(np.int64(shaded[row, column]))
    surface, normal, p = as_i32(_plane(block, SURFACE)), _three(block, NORMAL), _three(block, POSITION)
    full = _three(block, UNSHADOWED)
    flatness = ONE / ((p[0] * p[0] + p[1] * p[1] + p[2] * p[2]) * foot + np.float32(1e-30))
    bright = full[0] + full[1] + full[2]
    total = known = mean = square = l0 = l1 = l2 = u0 = u1 = u2 = s0 = s1 = s2 = f32x16(ZERO)
    for n in range(AROUND):
        r, c = row + n // 3 - 1, column + n % 3 - 1
        there = np.int64(shaded[r, c]) & asked[count, n]
        base, weight = planes_at(planes, r, c), address_of(weights) + PLANE * TURNS * (AROUND * count + n)
        while there != 0:
            lane = lowest_bit(there)
            there &= there - 1
            pixel = base + 4 * lane
            number = load_i32(pixel + PLANE * SURFACE)
            if number == MISS:
                continue
            near = load_f32x16(weight + PLANE * lane)
            like = select(surface == number, _likeness(normal, p, flatness, pixel), ZERO) * near
            w = like + STRANGER * near
            local, lit = _three_of(pixel, LOCAL), _three_of(pixel, UNSHADOWED)
            sent, most = _three_of(pixel, SENT), lit[0] + lit[1] + lit[2]
            arrived = (local[0] + local[1] + local[2]) / most if most > TINY else ONE
            light = bright * arrived + (sent[0] + sent[1] + sent[2])
            total, known = total + w, known + like
            mean, square = mean + w * light, square + w * light * light
            l0, l1, l2 = l0 + w * local[0], l1 + w * local[1], l2 + w * local[2]
            u0, u1, u2 = u0 + w * lit[0], u1 + w * lit[1], u2 + w * lit[2]
            s0, s1, s2 = s0 + w * sent[0], s1 + w * sent[1], s2 + w * sent[2]
    seen, estimated = surface > np.int32(MISS), total > ZERO
    scale = ONE / select(estimated, total, f32x16(ONE))
    mean, estimated = mean * scale, estimated & seen
    spread = square_root(maximum(square * scale - mean * mean, ZERO)) / (DARKNESS + mean)
    doubt = select(seen, spread + UNSEEN * (ONE - minimum(known * np.float32(4), ONE)), ZERO)
    arrived = _part(l0 + l1 + l2, u0 + u1 + u2, f32x16(ONE))
    return (
        select(estimated, full[0] * _part(l0, u0, arrived) + s0 * scale, full[0]),
        select(estimated, full[1] * _part(l1, u1, arrived) + s1 * scale, full[1]),
        select(estimated, full[2] * _part(l2, u2, arrived) + s2 * scale, full[2]),
    ), doubt


@kernel
def _fill(planes, shaded, wanted, first, last, foot, weights, asked, color, filled, doubt):
    planes, shaded, wanted = without_refcount(planes), without_refcount(shaded), without_refcount(wanted)
    color, filled, doubt = without_refcount(color), without_refcount(filled), without_refcount(doubt)
    height, width = color.shape[:2]
    memory = local_memory(256)
    channel = f32_at(memory)
    for row in range(first + EDGE, last + EDGE):
        for column in range(EDGE, planes.columns - EDGE):
            if not wanted[row, column]:
                continue
            bits = np.int64(shaded[row, column])
            light, in_doubt = _filled(planes, shaded, row, column, foot, weights, asked)
            store_three(memory, 64, light)
            store(memory + 192, in_doubt)
            doubts = ZERO
            y, x = BLOCK * (row - EDGE), BLOCK * (column - EDGE)
            for lane in range(TURNS):
                py, px = y + lane // BLOCK, x + lane % BLOCK
                if py >= height or px >= width:
                    continue
                if (bits >> lane) & 1:
                    for c in range(3):
                        filled[py, px, c] = color[py, px, c]
                else:
                    doubts += channel[48 + lane]
                    for c in range(3):
                        filled[py, px, c] = channel[16 * c + lane]
            doubt[row, column] = doubts
