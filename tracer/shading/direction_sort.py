"""Rays sorted by where they point and where they start, so that neighbours in a wave travel together.

What a curved mirror sends out goes all ways.  Rays whose directions have the same signs are likelier to go
through a tree together; within an octant they keep their order, and so are near each other as well, unless
neighbours have parted long ago.  That shows where most vectors have rays of several octants.  Those of an
octant are then put in the order of a Z curve through the box around all origins.
"""

from __future__ import annotations

import numpy as np

from tracer.runtime.kernels import inlined, subkernel
from tracer.shading.sorting import cell_of, gather_rows, put_order, spread_bits
from tracer.shading.wave import DIRECTION, ORIGIN, RAY_ROWS, T_MAX, T_MIN, row_of
from tracer.simd import (
    as_i32,
    bits_of,
    f32x16,
    i32_at,
    i64_at,
    lane_of,
    lanes_below,
    largest,
    load_f32,
    load_f32x16,
    load_i32x16,
    local_memory,
    lowest_bit,
    mask16,
    maximum,
    minimum,
    ones,
    pack,
    select,
    smallest,
    store,
    store_where,
)

OCTANTS = 8
CELLS = 4  # along each axis: more gain less than counting them costs
BINS = OCTANTS * CELLS**3


@inlined
def _octants(memory, v):
    """Numbers of the octants of the v-th vector of rays: the signs of their directions as bits."""
    at, stride = row_of(memory, DIRECTION) + 64 * v, 4 * memory.shape[1]
    x, y, z = as_i32(load_f32x16(at)), as_i32(load_f32x16(at + stride)), as_i32(load_f32x16(at + 2 * stride))
    sign = np.int32(31)  # a shift by so many leaves -1 or 0
    return ((x >> sign) & np.int32(1)) | ((y >> sign) & np.int32(2)) | ((z >> sign) & np.int32(4))


@inlined
def _starts(memory, n, starts):
    """Where each octant's rays begin among n that are sorted; whether one octant has them all, and how many vectors
    have rays of several."""
    for octant in range(OCTANTS):
        starts[octant] = 0
    mixed = 0
    for v in range((n + 15) // 16):
        octants, there = _octants(memory, v), lanes_below(n, v)
        mixed += bits_of(octants == lane_of(octants, 0)) & there != there
        for octant in range(OCTANTS):
            starts[octant] += ones(bits_of(octants == np.int32(octant)) & there)
    before, alone = 0, False
    for octant in range(OCTANTS):
        count = starts[octant]
        alone |= count == n
        starts[octant] = before
        before += count
    return alone, mixed


@subkernel
def _put_keys(memory, n, keys):
    """The octants of n rays as keys, and below them the places of their origins along the curve."""
    vectors = (n + 15) // 16
    for v in range(vectors):
        store(keys + 64 * v, _octants(memory, v) * np.int32(CELLS**3))
    for axis in range(3):
        row = row_of(memory, ORIGIN + axis)
        low = high = f32x16(load_f32(row))
        for v in range(vectors):
            x = select(mask16(lanes_below(n, v)), load_f32x16(row + 64 * v), low)
            low, high = minimum(low, x), maximum(high, x)
        start, end = smallest(low), largest(high)
        scale = np.float32(CELLS) / (end - start) if end > start else np.float32(0)
        for v in range(vectors):
            cell = spread_bits(cell_of(load_f32x16(row + 64 * v), start, scale, CELLS))
            store(keys + 64 * v, load_i32x16(keys + 64 * v) | (cell << np.int32(axis)))


@subkernel
def _pack_octants(source, n, target, starts):
    """Put rays into the rows of `target`, octant by octant, in the order they have."""
    numbers = local_memory(64)
    for v in range((n + 15) // 16):
        octants, rest = _octants(source, v), lanes_below(n, v)
        store(numbers, octants)
        while rest != 0:
            octant = i32_at(numbers)[lowest_bit(rest)]
            these = bits_of(octants == octant) & rest
            rest &= ~these
            count, start = ones(these), starts[octant]
            taken, kept = mask16(these), mask16((np.int64(1) << count) - 1)
            starts[octant] = start + count
            for row in range(RAY_ROWS):
                ray = load_f32x16(row_of(source, row) + 64 * v)
                store_where(row_of(target, row) + 4 * start, pack(ray, taken), kept)


@subkernel
def sorted_by_direction(source, n, target):
    """Put the n rays in the rows of `source` into those of `target`, sorted, and say so; or leave them where one octant
    has them all, for then they go together as they are."""
    starts, keys, order = i64_at(local_memory(64)), row_of(target, T_MIN), row_of(target, T_MAX)
    alone, mixed = _starts(source, n, starts)
    if alone:
        return False
    if 2 * mixed >= (n + 15) // 16:
        _put_keys(source, n, keys)
        put_order(keys, n, BINS, order)
        gather_rows(source, target, RAY_ROWS, n, order)
    else:
        _pack_octants(source, n, target, starts)
    return True
