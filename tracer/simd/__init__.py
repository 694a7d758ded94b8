"""Vectors of the processor as values in kernels.

numba leaves loops to LLVM's vectorisers, which give up on most that matter.  Here a vector is a type
of its own: `f32x16` holds sixteen float32, lives in registers, and is added, compared and selected
like a number; a comparison gives a mask.  What is written is what runs, and reads like arithmetic:

    t = (load_f32x16(planes) - origin) * inverse          # a scalar stands for all lanes
    store(distances, select(t < nearest, t, nearest))

- `vectors`: the types, arithmetic, comparison, masks, selection, reduction;
- `addresses`: memory as integers, loading and storing;
- `rearranging`: packing lanes, gathering, rows of a table as columns, sorting columns;
- `bits`: counting and finding bits, and numbers as their bits;
- `functions`: what is made of these, a power or three rows at a time.

Lanes never touch each other, but in reductions.  `fma` rounds once where the processor can, else
twice; either way a lane computes exactly what a scalar does with the same operations.  LLVM splits
vectors that are wider than the processor's, so that everything runs everywhere.
"""

from tracer.simd.addresses import (
    address_of,
    call_native,
    f32_at,
    i32_at,
    i64_at,
    load_f32,
    load_f32x8,
    load_f32x16,
    load_f64x8,
    load_i32,
    load_i32x8,
    load_i32x16,
    load_i64,
    local_memory,
    mark,
    prefetch,
    store,
    store_bytes,
    store_where,
    u8_at,
)
from tracer.simd.bits import as_f32, as_i32, leading_zeros, lowest_bit, ones
from tracer.simd.functions import (
    binary_logarithm,
    floor,
    lanes_below,
    load_three,
    pack_three,
    power,
    size_of,
    store_three,
)
from tracer.simd.rearranging import (
    gather_f32x16,
    gather_i32x16,
    load_columns,
    load_spread_bytes16,
    pack,
    sort_columns,
)
from tracer.simd.vectors import (
    F32x8,
    F32x16,
    F64x8,
    I32x8,
    I32x16,
    Mask,
    Vector,
    all_lanes,
    any_lane,
    bits_of,
    f32x8,
    f32x16,
    fma,
    i32x8,
    i32x16,
    lane_numbers_x16,
    lane_of,
    largest,
    mask8,
    mask16,
    maximum,
    minimum,
    select,
    smallest,
    square_root,
    to_f32,
    to_i32,
)
