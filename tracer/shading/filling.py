"""Pixels that are not shaded yet, filled in from those that are.

Pixels are shaded in turns: each pixel of a block of 4 x 4 has its own, in the order of Bayer's matrix
(1973), so that the first turns, and any later run of 1, 2, 4 or 8, lie as evenly as can be.  A pixel
whose turn has not come asks its nearest shaded neighbours which part of their unshadowed light
arrives there and what they get by reflection and refraction, and believes those the most that lie on
the same surface: the same material and object, normals alike, in one plane (the guides of a joint bilateral
filter, Eisemann and Durand 2004).  Its own light, texture and highlight are exact; what is soft are
borders of shadows, and reflections.

What pixels know of each other lies in planes, one number of all pixels each.  In a row of blocks follow one
another, plane by plane, the pixels of each place in their blocks, side by side: so the neighbours of sixteen
pixels are sixteen in a row, and what is written of one block is not far apart.
"""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.geometry.memory import aligned_rows, borrowed
from tracer.geometry.rays import MISS
from tracer.kernels import inlined, kernel
from tracer.shading.primary import BLOCK
from tracer.simd import (
    address_of,
    as_i32,
    f32_at,
    f32x16,
    load_f32x16,
    local_memory,
    maximum,
    select,
    store_three,
)

TURNS = BLOCK * BLOCK
# The turn of each pixel of a block, row by row.
BAYER = np.array([[0, 8, 2, 10], [12, 4, 14, 6], [3, 11, 1, 9], [15, 7, 13, 5]])
NEIGHBOURS = 8
REACH = 5  # pixels: neighbours are sought that far to each side
MARGIN = 2  # blocks around the picture, which show nothing
DOUBT = np.float32(1e-3)  # what the word of another surface is worth
ZERO, ONE = np.float32(0), np.float32(1)

# Planes: the surface's number, as the bits of int32 (MISS for none); its normal; where it is, seen from the eye; the
# local light it has where nothing is in the way; what part of that arrives; and what mirrors and glass send besides.
SURFACE, NORMAL, POSITION, UNSHADOWED, ARRIVED, SENT, PLANES = 0, 1, 4, 7, 10, 13, 16


class Planes(NamedTuple):
    """values (n,) float32, of the pixels of a picture that is shaded in parts, or none where it is not, and `columns`
    in a row, one for each block and more.  A plane is TURNS * columns numbers after the one before it."""

    values: NDArray[np.float32]
    columns: int


NO_PLANES = Planes(np.empty(0, np.float32), 0)


def make_planes(width: int, height: int) -> Planes:
    """Room for the planes of a picture, in which nothing is seen yet."""
    columns, rows = -(-width // BLOCK) + 2 * MARGIN, -(-height // BLOCK) + 2 * MARGIN
    columns = (-(-(columns + 16) // 16) | 1) * 16  # an odd number of lines of the cache, lest all rows meet in the same
    values = aligned_rows(rows, PLANES * TURNS * columns)
    values[:] = 0
    values.reshape(rows, PLANES, -1)[:, SURFACE].view(np.int32)[:] = MISS
    return Planes(values.reshape(-1), columns)


@inlined
def where(planes, x, y):
    """The number of a pixel in the first plane."""
    lane = (y & (BLOCK - 1)) * BLOCK + (x & (BLOCK - 1))
    return (PLANES * TURNS * (y // BLOCK + MARGIN) + lane) * planes.columns + x // BLOCK + MARGIN


class Neighbours(NamedTuple):
    """For each of the NEIGHBOURS nearest shaded pixels (rows) and each pixel of a block: dx and dy int32, from the
    pixel to the neighbour, and weight float32 by the distance; lanes are those that are shaded, as bits."""

    dx: NDArray[np.int32]
    dy: NDArray[np.int32]
    weight: NDArray[np.float32]
    lanes: int


def lanes_of(first: int, count: int) -> int:
    """The pixels of a block, as bits, whose turn is one of `count` from `first` on, around the end."""
    turns = (BAYER.reshape(-1) - first) % TURNS
    return int(sum(1 << lane for lane in range(TURNS) if turns[lane] < count))


@cache
def neighbours_of(lanes: int) -> Neighbours:
    """Where the nearest pixels that are shaded, `lanes` of each block, lie from each pixel of a block."""
    shaded = np.array([lanes >> lane & 1 for lane in range(TURNS)], bool).reshape(BLOCK, BLOCK)
    dx, dy = (np.zeros((NEIGHBOURS, TURNS), np.int32) for _ in range(2))
    weight = np.zeros((NEIGHBOURS, TURNS), np.float32)
    apart = (TURNS / max(1, int(shaded.sum()))) ** 0.5
    steps = [(y, x) for y in range(-REACH, REACH + 1) for x in range(-REACH, REACH + 1)]
    steps.sort(key=lambda step: step[0] ** 2 + step[1] ** 2)
    for lane in range(TURNS):
        y, x = divmod(lane, BLOCK)
        found = [step for step in steps if shaded[(y + step[0]) % BLOCK, (x + step[1]) % BLOCK]][:NEIGHBOURS]
        for n, (down, across) in enumerate(found):
            dx[n, lane], dy[n, lane] = across, down
            weight[n, lane] = np.exp(-(down**2 + across**2) / (0.7 * apart) ** 2)
    return Neighbours(dx, dy, weight, lanes)


def from_nearest(values: NDArray, lanes: int) -> NDArray:
    """values (height, width, ...) of which those of `lanes` of each block are known: a copy in which each other pixel
    has what is known of the nearest."""
    near, filled = neighbours_of(lanes), values.copy()
    for lane in range(TURNS):
        (y, x), size = divmod(lane, BLOCK), values.shape
        if not lanes >> lane & 1 and y < size[0] and x < size[1]:
            rows = _inside(np.arange(y, size[0], BLOCK) + near.dy[0, lane], size[0])
            columns = _inside(np.arange(x, size[1], BLOCK) + near.dx[0, lane], size[1])
            filled[y::BLOCK, x::BLOCK] = values[np.ix_(rows, columns)]
    return filled


def _inside(numbers: NDArray[np.intp], size: int) -> NDArray[np.intp]:
    """Rows or columns beyond the picture's edge, as the next ones inside of the same place in their blocks."""
    numbers = np.where(numbers < 0, numbers + BLOCK, numbers)
    numbers = np.where(numbers >= size, numbers - BLOCK, numbers)
    return np.clip(numbers, 0, size - 1)


@cache
def _shifts(lanes: int, columns: int) -> NDArray[np.int64]:
    """(NEIGHBOURS, TURNS) how much higher the number of a neighbour is in planes than that of the pixel."""
    near, (y, x) = neighbours_of(lanes), np.divmod(np.arange(TURNS), BLOCK)
    down, row = np.divmod(y + near.dy, BLOCK)
    across, column = np.divmod(x + near.dx, BLOCK)
    lane = (row * BLOCK + column - np.arange(TURNS)).astype(np.int64)
    return (PLANES * TURNS * down + lane) * columns + across


def fill_in(
    planes: Planes, lanes: int, rows: tuple[int, int], spread: float, width: int, color: NDArray[np.float32]
) -> None:
    """Fill the pixels that are not of `lanes` into color (height * width, 3), in rows of blocks from the first to one
    before the last; spread is the width of a pixel at distance 1."""
    shifts, foot = _shifts(lanes, planes.columns), np.float32((2.0 * spread) ** 2)
    _fill(planes, shifts, neighbours_of(lanes).weight, lanes, *rows, foot, width, color)


@inlined
def _load(planes, plane, at):
    return load_f32x16(address_of(planes.values) + 4 * (TURNS * planes.columns * plane + at))


@inlined
def _three(planes, plane, at):
    return _load(planes, plane, at), _load(planes, plane + 1, at), _load(planes, plane + 2, at)


@inlined
def _likeness(planes, surface, normal, position, foot, at):
    """How far sixteen pixels show the surface of sixteen others: 1 for the same in one plane, 0 for another."""
    other, (x, y, z) = _three(planes, NORMAL, at), _three(planes, POSITION, at)
    cosine = maximum(normal[0] * other[0] + normal[1] * other[1] + normal[2] * other[2], ZERO)
    off = normal[0] * (x - position[0]) + normal[1] * (y - position[1]) + normal[2] * (z - position[2])
    cosine = cosine * cosine
    cosine = cosine * cosine
    like = cosine * cosine * foot / (foot + off * off)
    return select(as_i32(_load(planes, SURFACE, at)) == surface, like, ZERO)


@inlined
def _filled(planes, shifts, weight, lane, at, foot):
    """The light of sixteen pixels from `at` on, which have this place in their blocks.  foot is the square of the
    width of a pixel at distance 1."""
    surface, normal = as_i32(_load(planes, SURFACE, at)), _three(planes, NORMAL, at)
    p = _three(planes, POSITION, at)
    foot = (p[0] * p[0] + p[1] * p[1] + p[2] * p[2]) * foot + np.float32(1e-30)
    total = a0 = a1 = a2 = s0 = s1 = s2 = f32x16(ZERO)
    for n in range(NEIGHBOURS):
        there = at + shifts[n, lane]
        like = _likeness(planes, surface, normal, p, foot, there)
        w = (like + DOUBT) * weight[n, lane]
        w = select(as_i32(_load(planes, SURFACE, there)) > np.int32(MISS), w, ZERO)
        arrived, sent = _three(planes, ARRIVED, there), _three(planes, SENT, there)
        total = total + w
        a0, a1, a2 = a0 + w * arrived[0], a1 + w * arrived[1], a2 + w * arrived[2]
        s0, s1, s2 = s0 + w * sent[0], s1 + w * sent[1], s2 + w * sent[2]
    full, known = _three(planes, UNSHADOWED, at), (total > ZERO) & (surface > np.int32(MISS))
    scale = ONE / select(known, total, f32x16(ONE))
    return (
        select(known, (full[0] * a0 + s0) * scale, full[0]),
        select(known, (full[1] * a1 + s1) * scale, full[1]),
        select(known, (full[2] * a2 + s2) * scale, full[2]),
    )


@kernel
def _fill(planes, shifts, weight, lanes, first_row, last_row, foot, width, color):
    planes, shifts, weight, color = borrowed(planes), borrowed(shifts), borrowed(weight), borrowed(color)
    height, memory = len(color) // width, local_memory(192)
    channel = f32_at(memory)
    for row in range(first_row, last_row):
        for lane in range(TURNS):
            y, left = BLOCK * row + lane // BLOCK, lane % BLOCK
            if (lanes >> lane) & 1 or y >= height or left >= width:
                continue
            count = (width - left + BLOCK - 1) // BLOCK
            for start in range(0, count, 16):
                at = where(planes, left + BLOCK * start, y)
                store_three(memory, 64, _filled(planes, shifts, weight, lane, at, foot))
                pixel = y * width + left + BLOCK * start
                for i in range(min(16, count - start)):
                    for c in range(3):
                        color[pixel + BLOCK * i, c] = channel[16 * c + i]
