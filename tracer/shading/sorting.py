"""What sorting a wave takes: cells of a box in the order of a Z curve (Morton 1966), and sorting by counting."""

from __future__ import annotations

import numpy as np

from tracer.runtime.kernels import inlined, subkernel
from tracer.shading.wave import row_of
from tracer.simd import (
    gather_f32x16,
    i32_at,
    load_i32x16,
    local_memory,
    maximum,
    minimum,
    store,
    to_i32,
)

BINS = 4096  # the most there may be
STARTS = 4 * (BINS + 1)  # bytes


@inlined
def cell_of(x, low, scale, cells):
    """In which of so many cells numbers lie that are `low` at least; what is no number lies in the first."""
    return to_i32(minimum(maximum((x - low) * scale, np.float32(0)), np.float32(cells - 1)))


@inlined
def spread_bits(x):
    """The four lowest bits of int32, two zeros between each and the next."""
    x = (x | (x << np.int32(4))) & np.int32(0xC3)
    return (x | (x << np.int32(2))) & np.int32(0x249)


@subkernel
def put_order(keys, n, bins, order):
    """The numbers of n rays in the order of their keys, 0 to bins - 1, equal ones in the order they had; 0 in the rest
    of the last vector."""
    starts, key, place = i32_at(local_memory(STARTS)), i32_at(keys), i32_at(order)
    for b in range(bins + 1):
        starts[b] = 0
    for i in range(n):
        starts[key[i] + 1] += 1
    for b in range(bins):
        starts[b + 1] += starts[b]
    for i in range(n):
        b = key[i]
        place[starts[b]] = i
        starts[b] += 1
    for i in range(n, (n + 15) // 16 * 16):
        place[i] = 0


@inlined
def gather_rows(source, target, rows, n, order):
    """Copy so many rows of n rays from one memory to another, in an order."""
    for v in range((n + 15) // 16):
        which = load_i32x16(order + 64 * v)
        for row in range(rows):
            store(row_of(target, row) + 64 * v, gather_f32x16(row_of(source, row), which))
