"""Functions of whole vectors, from the operations."""

from __future__ import annotations

import numpy as np

from tracer.runtime.kernels import inlined
from tracer.simd.addresses import address_of, load_f32x16, store
from tracer.simd.bits import as_f32, as_i32
from tracer.simd.rearranging import pack
from tracer.simd.vectors import fma, maximum, minimum, select, to_f32, to_i32

ONE, HALF = np.float32(1), np.float32(0.5)


@inlined
def binary_logarithm(x):
    """Logarithm to base 2 of sixteen normal, positive float32; to some 2e-7 of max(1, itself)."""
    bits = as_i32(x)
    exponent = to_f32((bits >> np.int32(23)) - np.int32(127))
    m = as_f32((bits & np.int32(0x7FFFFF)) | np.int32(0x3F800000))
    high = m > np.float32(1.41421356)
    m, exponent = select(high, m * HALF, m), select(high, exponent + ONE, exponent)
    s = (m - ONE) / (m + ONE)  # then ln m = 2 artanh s
    q = s * s
    series = fma(
        q, fma(q, fma(q, fma(q, np.float32(1 / 9), np.float32(1 / 7)), np.float32(0.2)), np.float32(1 / 3)), ONE
    )
    return fma(s * np.float32(2.885390082), series, exponent)


@inlined
def _exp2(x):
    """2 to the power of sixteen float32; 0 from -126 down, 2^127 at most."""
    x = minimum(x, np.float32(127))
    small = x <= np.float32(-126)
    x = maximum(x, np.float32(-126))
    whole = to_i32(x + select(x < np.float32(0), -HALF, HALF))
    f = (x - to_f32(whole)) * np.float32(0.69314718)
    series = fma(f, fma(f, fma(f, fma(f, fma(f, np.float32(1 / 720), np.float32(1 / 120)), np.float32(1 / 24)),
                               np.float32(1 / 6)), HALF), ONE)  # fmt: skip
    series = fma(f, series, ONE)
    return select(small, np.float32(0), series * as_f32((whole + np.int32(127)) << np.int32(23)))


@inlined
def power(x, y):
    """x to the power of y, sixteen float32 each, x >= 0 and y >= 0; 0 for what is below 2^-126, 1 where y is 0."""
    tiny = np.float32(1.1754944e-38)
    result = _exp2(maximum(y * binary_logarithm(maximum(x, tiny)), np.float32(-127)))
    result = select(x < tiny, np.float32(0), result)
    return select(y == np.float32(0), ONE, result)


@inlined
def floor(x):
    """The largest whole number that is no more, of sixteen float32 between -2^31 and 2^31."""
    towards_zero = to_f32(to_i32(x))
    return select(towards_zero > x, towards_zero - ONE, towards_zero)


@inlined
def load_three(rows, v):
    """The v-th vector of sixteen of each of three rows, (3, n) float32."""
    a, stride = address_of(rows) + 64 * v, 4 * rows.shape[1]
    return load_f32x16(a), load_f32x16(a + stride), load_f32x16(a + 2 * stride)


@inlined
def store_three(address, stride, a):
    """Write three vectors to an address and to those one and two strides (bytes) further on."""
    store(address, a[0])
    store(address + stride, a[1])
    store(address + 2 * stride, a[2])


@inlined
def pack_three(a, mask):
    """`pack` of three vectors."""
    return pack(a[0], mask), pack(a[1], mask), pack(a[2], mask)


@inlined
def size_of(a):
    """Sum of the absolute coordinates of three vectors."""
    return maximum(a[0], -a[0]) + maximum(a[1], -a[1]) + maximum(a[2], -a[2])


@inlined
def lanes_below(count, v):
    """Bits of those lanes of the v-th vector of sixteen that a row of `count` has."""
    rest = count - 16 * v
    return np.int64(0xFFFF) if rest >= 16 else (np.int64(1) << rest) - 1
