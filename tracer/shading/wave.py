"""Waves: batches of rays on their way, in rows of whole vectors, and what becomes of them between bounces."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tracer.geometry.queries import closest_hits
from tracer.geometry.rays import INFINITY, MISS, Hits, Rays, padded
from tracer.runtime.kernels import inlined, subkernel
from tracer.simd import (
    address_of,
    bits_of,
    f32x16,
    i32x16,
    lanes_below,
    load_f32x16,
    load_i32x16,
    lowest_bit,
    mask16,
    ones,
    pack,
    store,
)
from tracer.simd.records import IntRow, Memory, Row, Row3, row_count, row_number, rows_of

ZERO = np.float32(0)


class Wave(NamedTuple):
    """`size` rays, in rows of `memory` (WAVE_ROWS, n): origin and direction (3, n); the pixel (n,) int32 of their tile
    that they count for, and with which weight (3, n); path_length (n,) from the eye to where they start; what they hit,
    t, u, v and primitive (n,); and the interval of t.

    Lanes past the size, to the end of its vector, are rays that mean nothing but can be computed with."""

    memory: Memory
    origin: Row3
    direction: Row3
    weight: Row3
    path_length: Row
    pixel: IntRow
    t: Row
    u: Row
    v: Row
    primitive: IntRow
    t_min: Row
    t_max: Row
    size: int


wave_in = rows_of(Wave)
WAVE_ROWS = row_count(Wave)
ORIGIN, DIRECTION, WEIGHT, PATH_LENGTH, PIXEL, HIT_T, HIT_U, HIT_V, HIT_PRIMITIVE, T_MIN, T_MAX = (
    row_number(Wave, field)
    for field in (
        "origin", "direction", "weight", "path_length", "pixel", "t", "u", "v", "primitive", "t_min", "t_max",
    )
)  # fmt: skip
RAY_ROWS, HIT_ROWS = HIT_T, T_MIN  # the first rows: of a ray on its way, and with what it hit


@inlined
def room(memory, n):
    """Memory of as many rows as this, for n rays and a vector to spare: this, where it will do."""
    return memory if memory.shape[1] >= padded(n) + 16 else np.empty((memory.shape[0], padded(n) + 16), np.float32)


@inlined
def row_of(memory, row):
    """Address of a row."""
    return address_of(memory) + 4 * memory.shape[1] * row


@inlined
def trace(world, wave, counts):
    """Ask for a wave's nearest hits, from its rays' origins on."""
    t_min, t_max = row_of(wave.memory, T_MIN), row_of(wave.memory, T_MAX)
    for at in range(0, 4 * wave.size, 64):
        store(t_min + at, f32x16(ZERO))
        store(t_max + at, f32x16(INFINITY))
    rays = Rays(wave.origin, wave.direction, wave.t_min, wave.t_max)
    closest_hits(world, rays, Hits(wave.t, wave.primitive, wave.u, wave.v), 0, wave.size, counts)


@subkernel
def drop_misses(wave, background, light, reference):
    """The wave's rays that hit; those that miss add the background (3,) to light and reference (3, pixels)."""
    n, start, stride = 0, address_of(wave.memory), 4 * wave.memory.shape[1]
    for v in range((wave.size + 15) // 16):
        there = lanes_below(wave.size, v)
        hit = bits_of(load_i32x16(row_of(wave.memory, HIT_PRIMITIVE) + 64 * v) > np.int32(MISS)) & there
        missed = there & ~hit
        while missed != 0:
            i = 16 * v + lowest_bit(missed)
            missed &= missed - 1
            for c in range(3):
                coming = wave.weight[c, i] * background[c]
                light[c, wave.pixel[i]] += coming
                reference[c, wave.pixel[i]] += coming
        if n < 16 * v or hit != 0xFFFF:
            for row in range(HIT_ROWS):
                store(start + stride * row + 4 * n, pack(load_f32x16(start + stride * row + 64 * v), mask16(hit)))
        n += ones(hit)
    # Lanes past the end look up a primitive too: any will do.
    store(row_of(wave.memory, HIT_PRIMITIVE) + 4 * n, i32x16(0))
    return wave_in(wave.memory, n)


@subkernel
def accumulate(wave, from_points, light):
    """Add what comes from a wave's points, (3, n), to the light (3, pixels) of their pixels."""
    for c in range(3):
        weight, coming = row_of(wave.memory, WEIGHT + c), row_of(from_points, c)
        for at in range(0, 4 * wave.size, 64):
            store(coming + at, load_f32x16(weight + at) * load_f32x16(coming + at))
    for i in range(wave.size):
        pixel = wave.pixel[i]
        for c in range(3):
            light[c, pixel] += from_points[c, i]
