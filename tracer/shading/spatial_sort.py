"""Points sorted by where they lie, so that neighbours in a wave ask for light together.

Behind curved mirrors and glass, neighbouring pixels see places far apart.  In the order of a Z curve
through the box around them all, near points come together again: their shadow rays share
packets whichever light they come from, and so do the rays that they send out.
"""

from __future__ import annotations

import numpy as np

from tracer.runtime.kernels import inlined, subkernel
from tracer.shading.sorting import cell_of, gather_rows, put_order, spread_bits
from tracer.shading.wave import DIRECTION, HIT_ROWS, HIT_T, ORIGIN, T_MAX, T_MIN, room, row_of, wave_in
from tracer.simd import (
    i32x16,
    lanes_below,
    largest,
    load_f32x16,
    load_i32x16,
    mask16,
    maximum,
    minimum,
    select,
    smallest,
    store,
)

CELLS = 16  # along each axis
FEWEST = 128  # points of a wave that are worth sorting: fewer make one packet anyway


@inlined
def _coordinate(memory, axis, v):
    """One of the coordinates of the v-th vector of points."""
    at = row_of(memory, ORIGIN + axis) + 64 * v
    along = load_f32x16(row_of(memory, DIRECTION + axis) + 64 * v)
    return load_f32x16(at) + load_f32x16(row_of(memory, HIT_T) + 64 * v) * along


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
            cell = spread_bits(cell_of(_coordinate(memory, axis, v), start, scale, CELLS))
            store(keys + 64 * v, load_i32x16(keys + 64 * v) | (cell << np.int32(axis)))


@subkernel
def sorted_by_position(wave, spare):
    """The wave with its points sorted, and the memory that is now to spare."""
    n = wave.size
    if n <= FEWEST:
        return wave, spare
    target = room(spare, n)
    order = row_of(target, T_MAX)
    _put_keys(wave.memory, n, row_of(target, T_MIN))
    put_order(row_of(target, T_MIN), n, CELLS**3, order)
    gather_rows(wave.memory, target, HIT_ROWS, n, order)
    return wave_in(target, n), wave.memory
