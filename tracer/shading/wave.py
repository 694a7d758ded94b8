"""Waves: batches of rays on their way, in rows of whole vectors, and what becomes of them between bounces."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.geometry.queries import closest_hits
from tracer.geometry.rays import INFINITY, MISS, Hits, Rays, padded
from tracer.kernels import inlined, subkernel
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

# Rows of a wave's memory: MOVING of a ray on its way, MOVED with what it hit, which change places with it.
ORIGIN, DIRECTION, WEIGHT, REACH, PIXEL, MOVING = 0, 3, 6, 9, 10, 11
HIT_T, HIT_U, HIT_V, HIT_PRIMITIVE, MOVED = 11, 12, 13, 14, 15
T_MIN, T_MAX = 15, 16
WAVE_ROWS = 17
ZERO = np.float32(0)


class Wave(NamedTuple):
    """`size` rays in rows of `memory` (WAVE_ROWS, n): what they hit, the pixel (n,) int32 of their tile that they
    count for, with which weight (3, n), and reach (n,), the length of the path from the eye to where they start.

    Lanes past the size, to the end of its vector, are rays that mean nothing but can be computed with."""

    memory: NDArray[np.float32]
    rays: Rays
    hits: Hits
    pixel: NDArray[np.int32]
    weight: NDArray[np.float32]
    reach: NDArray[np.float32]
    size: int


@inlined
def room(memory, n):
    """Memory of as many rows as this, for n rays and a vector to spare: this, where it will do."""
    return memory if memory.shape[1] >= padded(n) + 16 else np.empty((memory.shape[0], padded(n) + 16), np.float32)


@inlined
def wave_in(memory, size):
    """A wave of so many rays, whose rows the caller has filled, or will."""
    return Wave(
        memory,
        Rays(memory[ORIGIN:DIRECTION], memory[DIRECTION:WEIGHT], memory[T_MIN], memory[T_MAX]),
        Hits(memory[HIT_T], memory[HIT_PRIMITIVE].view(np.int32), memory[HIT_U], memory[HIT_V]),
        memory[PIXEL].view(np.int32),
        memory[WEIGHT:REACH],
        memory[REACH],
        size,
    )


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
    closest_hits(world, wave.rays, wave.hits, 0, wave.size, counts)


@subkernel
def without_misses(wave, background, light, reference):
    """The wave's rays that hit; the others bring the background (3,) home, to light and reference (3, pixels)."""
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
            for row in range(MOVED):
                store(start + stride * row + 4 * n, pack(load_f32x16(start + stride * row + 64 * v), mask16(hit)))
        n += ones(hit)
    # Lanes past the end look up a primitive too: any will do.
    store(row_of(wave.memory, HIT_PRIMITIVE) + 4 * n, i32x16(0))
    return wave_in(wave.memory, n)


@subkernel
def bring_home(wave, from_points, light):
    """Add what comes from a wave's points, (3, n), to the light (3, pixels) of their pixels."""
    for c in range(3):
        weight, coming = row_of(wave.memory, WEIGHT + c), row_of(from_points, c)
        for at in range(0, 4 * wave.size, 64):
            store(coming + at, load_f32x16(weight + at) * load_f32x16(coming + at))
    for i in range(wave.size):
        pixel = wave.pixel[i]
        for c in range(3):
            light[c, pixel] += from_points[c, i]
