"""Rays sorted by where they point, so that neighbours in a wave travel together.

What a curved mirror sends out goes all ways.  Rays whose directions have the same signs are likelier to go
through a tree together; within an octant they keep their order, and so are near each other as well.
"""

from __future__ import annotations

import numpy as np

from tracer.kernels import inlined, subkernel
from tracer.shading.wave import DIRECTION, RAY_ROWS, row_of
from tracer.simd import (
    as_i32,
    bits_of,
    i32_at,
    i64_at,
    lanes_below,
    load_f32x16,
    local_memory,
    lowest_bit,
    mask16,
    ones,
    pack,
    store,
    store_where,
)

OCTANTS = 8


@inlined
def _octants(memory, v):
    """Numbers of the octants of the v-th vector of rays: the signs of their directions as bits."""
    at, stride = row_of(memory, DIRECTION) + 64 * v, 4 * memory.shape[1]
    x, y, z = as_i32(load_f32x16(at)), as_i32(load_f32x16(at + stride)), as_i32(load_f32x16(at + 2 * stride))
    sign = np.int32(31)  # a shift by so many leaves -1 or 0
    return ((x >> sign) & np.int32(1)) | ((y >> sign) & np.int32(2)) | ((z >> sign) & np.int32(4))


@inlined
def _starts(memory, n, starts):
    """Where each octant's rays begin among n that are sorted; whether one octant has them all."""
    for octant in range(OCTANTS):
        starts[octant] = 0
    for v in range((n + 15) // 16):
        octants, there = _octants(memory, v), lanes_below(n, v)
        for octant in range(OCTANTS):
            starts[octant] += ones(bits_of(octants == np.int32(octant)) & there)
    before, alone = 0, False
    for octant in range(OCTANTS):
        count = starts[octant]
        alone |= count == n
        starts[octant] = before
        before += count
    return alone


@subkernel
def sorted_by_direction(source, n, target):
    """Put the n rays in the rows of `source` into those of `target`, octant by octant; whether there was need to."""
    starts, numbers = i64_at(local_memory(64)), local_memory(64)
    if _starts(source, n, starts):
        return False
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
    return True
