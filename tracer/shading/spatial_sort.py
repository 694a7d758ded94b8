"""Points sorted by where they lie, so that neighbours in a wave ask for light together.

Behind curved mirrors and glass, neighbouring pixels see places far apart.  In the order of a Z curve
through the box around them all (Morton 1966), near points come together again: their shadow rays share
packets whichever light they come from, and so do the rays that they send out.
"""

from __future__ import annotations

import numpy as np

from tracer.kernels import inlined, subkernel
from tracer.shading.wave import DIRECTION, HIT_ROWS, HIT_T, ORIGIN, T_MAX, T_MIN, room, row_of, wave_in
from tracer.simd import (
    gather_f32x16,
    i32_at,
    i32x16,
    lanes_below,
    largest,
    load_f32x16,
    load_i32x16,
    local_memory,
    mask16,
    maximum,
    minimum,
    select,
    smallest,
    store,
    to_i32,
)

CELLS = 16  # along each axis
BINS = CELLS**3
FEWEST = 128  # points of a wave that are worth sorting: fewer make one packet anyway


@inlined
def _coordinate(memory, axis, v):
    """One of the coordinates of the v-th vector of points."""
    at = row_of(memory, ORIGIN + axis) + 64 * v
    along = load_f32x16(row_of(memory, DIRECTION + axis) + 64 * v)
    return load_f32x16(at) + load_f32x16(row_of(memory, HIT_T) + 64 * v) * along


@inlined
def _spread_bits(x):
    """The four lowest bits of int32, two zeros between each and the next."""
    x = (x | (x << np.int32(4))) & np.int32(0xC3)
    return (x | (x << np.int32(2))) & np.int32(0x249)


@subkernel
def _put_keys(memory, n, keys):
    """The place of each of n points along the curve, from 0 to BINS - 1."""
    vectors = (n + 15) // 16
    for v in range(vectors):
        store(keys + 64 * v, i32x16(0))
    for axis in range(3):
        low = high = _coordinate(memory, axis, 0)
        for v in range(1, vectors):
            x = select(mask16(lanes_below(n, v)), _coordinate(memory, axis, v), low)
            low, high = minimum(low, x), maximum(high, x)
        start, end = smallest(low), largest(high)
        scale = np.float32(CELLS) / (end - start) if end > start else np.float32(0)
        for v in range(vectors):
            cell = maximum((_coordinate(memory, axis, v) - start) * scale, np.float32(0))
            cell = _spread_bits(to_i32(minimum(cell, np.float32(CELLS - 1))))
            store(keys + 64 * v, load_i32x16(keys + 64 * v) | (cell << np.int32(axis)))


@subkernel
def _put_order(keys, n, order):
    """The numbers of the n points in the order of their keys, equal ones in the order they had."""
    starts, key, place = i32_at(local_memory(4 * 4097)), i32_at(keys), i32_at(order)
    for b in range(BINS + 1):
        starts[b] = 0
    for i in range(n):
        starts[key[i] + 1] += 1
    for b in range(BINS):
        starts[b + 1] += starts[b]
    for i in range(n):
        b = key[i]
        place[starts[b]] = i
        starts[b] += 1
    for i in range(n, (n + 15) // 16 * 16):
        place[i] = 0


@subkernel
def sorted_by_position(wave, spare):
    """The wave with its points sorted, and the memory that is now to spare."""
    n, vectors = wave.size, (wave.size + 15) // 16
    if n <= FEWEST:
        return wave, spare
    target = room(spare, n)
    order = row_of(target, T_MAX)
    _put_keys(wave.memory, n, row_of(target, T_MIN))
    _put_order(row_of(target, T_MIN), n, order)
    for v in range(vectors):
        which = load_i32x16(order + 64 * v)
        for row in range(HIT_ROWS):
            store(row_of(target, row) + 64 * v, gather_f32x16(row_of(wave.memory, row), which))
    return wave_in(target, n), wave.memory
