"""The vector library's arithmetic, operation by operation, against numpy."""

from __future__ import annotations

import numpy as np
import pytest
from numba.core.registry import cpu_target

from tests.simd.kinds import (
    F32,
    I32,
    Kind,
    N,
    compiled,
    numbers,
    of_each_kind,
    of_floats,
    of_integers,
    row_of,
    same,
)
from tracer import simd
from tracer.simd import (
    address_of,
    all_lanes,
    any_lane,
    as_f32,
    as_i32,
    bits_of,
    fma,
    lane_of,
    largest,
    load_f64x8,
    maximum,
    minimum,
    select,
    smallest,
    square_root,
    store,
    store_bytes,
    to_f32,
    to_i32,
)


@of_each_kind
def test_sums_differences_and_products(kind: Kind):
    load, lanes = kind.load, kind.lanes

    @compiled
    def run(a, b, scalar, out):
        row = 4 * len(a)
        for i in range(0, len(a), lanes):
            x, y, o = load(address_of(a) + 4 * i), load(address_of(b) + 4 * i), address_of(out) + 4 * i
            store(o, x + y)
            store(o + row, x - y)
            store(o + 2 * row, x * y)
            store(o + 3 * row, -x)
            store(o + 4 * row, x + scalar)
            store(o + 5 * row, scalar - x)
            store(o + 6 * row, 3 * x)
            store(o + 7 * row, minimum(x, y))
            store(o + 8 * row, maximum(x, y))
            store(o + 9 * row, minimum(x, scalar))
            store(o + 10 * row, maximum(scalar, x))

    a, b, s = numbers(1, kind.dtype), numbers(2, kind.dtype), kind.dtype(7)
    out = row_of(a, 11)
    run(a, b, s, out)
    with np.errstate(all="ignore"):
        expected = [a + b, a - b, a * b, -a, a + s, s - a, kind.dtype(3) * a]
    expected += [np.where(a < b, a, b), np.where(a > b, a, b), np.where(a < s, a, s), np.where(s > a, s, a)]
    for i, (found, right) in enumerate(zip(out, expected, strict=True)):
        assert same(found, right), i


@of_floats
def test_quotients_and_square_roots(kind: Kind):
    load, lanes = kind.load, kind.lanes

    @compiled
    def run(a, b, out):
        row = 4 * len(a)
        for i in range(0, len(a), lanes):
            x, y, o = load(address_of(a) + 4 * i), load(address_of(b) + 4 * i), address_of(out) + 4 * i
            store(o, x / y)
            store(o + row, 1 / x)
            store(o + 2 * row, x / 0.5)
            store(o + 3 * row, square_root(x))
            for k in range(lanes):
                store(o + 4 * row + 4 * k, square_root(a[i + k]))

    a, b = numbers(3), numbers(4)
    out = row_of(a, 5)
    run(a, b, out)
    with np.errstate(all="ignore"):
        for found, right in zip(out, (a / b, F32(1) / a, a / F32(0.5), np.sqrt(a), np.sqrt(a)), strict=True):
            assert same(found, right)


def rounds_once() -> bool:
    """Whether what numba compiles for has a fused multiply-add."""
    _, name, features = cpu_target.target_context.codegen().magic_tuple()
    return "+fma" in features or name in ("haswell", "skylake-avx512")


@of_floats
def test_fma_rounds_once_where_the_processor_can_else_twice(kind: Kind):
    load, lanes = kind.load, kind.lanes

    @compiled
    def run(a, b, c, scalar, out):
        row = 4 * len(a)
        for i in range(0, len(a), lanes):
            x, y, z = load(address_of(a) + 4 * i), load(address_of(b) + 4 * i), load(address_of(c) + 4 * i)
            o = address_of(out) + 4 * i
            store(o, fma(x, y, z))
            store(o + row, fma(x, scalar, z))
            store(o + 2 * row, x * y + z)
            for k in range(lanes):
                store(o + 3 * row + 4 * k, fma(a[i + k], b[i + k], c[i + k]))

    rng = np.random.default_rng(5)
    a, b = rng.normal(size=(2, N)).astype(F32)
    c = (-a * b + rng.normal(size=N) * 1e-6).astype(F32)  # so that what is rounded away shows
    out, s = row_of(a, 4), F32(1.1)
    run(a, b, c, s, out)
    twice = a * b + c

    def once(x, y, z):
        return (x.astype(np.longdouble) * y + z).astype(F32)

    assert (once(a, b, c) != twice).mean() > 0.5
    assert same(out[0], once(a, b, c) if rounds_once() else twice)
    assert same(out[1], once(a, s, c) if rounds_once() else a * s + c)
    assert same(out[2], twice)  # what is not asked for is not fused
    assert same(out[3], out[0])


@of_each_kind
def test_comparisons(kind: Kind):
    """None is true of what is no number."""
    load, lanes = kind.load, kind.lanes

    @compiled
    def run(a, b, scalar, out):
        row = len(a)
        for i in range(0, len(a), lanes):
            x, y, o = load(address_of(a) + 4 * i), load(address_of(b) + 4 * i), address_of(out) + i
            store_bytes(o, x < y)
            store_bytes(o + row, x <= y)
            store_bytes(o + 2 * row, x > y)
            store_bytes(o + 3 * row, x >= y)
            store_bytes(o + 4 * row, x == y)
            store_bytes(o + 5 * row, x < scalar)
            store_bytes(o + 6 * row, scalar >= x)
            store_bytes(o + 7 * row, x == 0)

    a, b, s = numbers(6, kind.dtype), numbers(7, kind.dtype), kind.dtype(1)
    out = row_of(a, 8, np.uint8)
    run(a, b, s, out)
    expected = [a < b, a <= b, a > b, a >= b, a == b, a < s, s >= a, a == 0]
    for found, right in zip(out, expected, strict=True):
        assert np.array_equal(found, right) and 0 < right.sum() < N


@of_integers
def test_shifts_and_bits_of_integers(kind: Kind):
    load, lanes = kind.load, kind.lanes

    @compiled
    def run(a, b, shift, out):
        row = 4 * len(a)
        for i in range(0, len(a), lanes):
            x, y, o = load(address_of(a) + 4 * i), load(address_of(b) + 4 * i), address_of(out) + 4 * i
            s = load(address_of(shift) + 4 * i)
            store(o, x << s)
            store(o + row, x >> s)
            store(o + 2 * row, x << 3)
            store(o + 3 * row, x >> np.int32(31))
            store(o + 4 * row, x & y)
            store(o + 5 * row, x | y)
            store(o + 6 * row, x ^ y)
            store(o + 7 * row, x & np.int32(-0x80000000))

    a, b, shift = numbers(8, I32), numbers(9, I32), np.random.default_rng(10).integers(0, 32, N).astype(I32)
    out = row_of(a, 8)
    run(a, b, shift, out)
    expected = [a << shift, a >> shift, a << 3, a >> 31, a & b, a | b, a ^ b, a & I32(-0x80000000)]
    for found, right in zip(out, expected, strict=True):
        assert same(found, right)


@of_each_kind
def test_scalars_stand_for_all_lanes(kind: Kind):
    splat, lanes = kind.splat, kind.lanes

    @compiled
    def run(scalar, out):
        store(address_of(out), splat(scalar))
        store(address_of(out) + 4 * lanes, splat(2))

    out = np.zeros(2 * lanes, kind.dtype)
    for scalar in (kind.dtype(-7), -7, np.float64(0.1)) if kind.dtype is F32 else (kind.dtype(-7), -7):
        run(scalar, out)
        assert same(out, np.repeat(np.array([scalar, 2], kind.dtype), lanes))


def test_vectors_of_float64():
    """They do what others do, in twice as many bits, at any address."""

    @compiled
    def run(a, b, scalar, out, truths, single):
        row = 8 * len(a)
        for i in range(0, len(a), 8):
            x, y, o = load_f64x8(address_of(a) + 8 * i), load_f64x8(address_of(b) + 8 * i), address_of(out) + 8 * i
            store(o, x + y)
            store(o + row, x - scalar)
            store(o + 2 * row, scalar * x)
            store(o + 3 * row, x / y)
            store(o + 4 * row, -x)
            store(o + 5 * row, select(x > y, x, y))
            for k, truth in enumerate((x < y, x >= scalar, x == y, x > -1.0)):
                told = truths[k, i // 8]
                told[0], told[1], told[2] = bits_of(truth), any_lane(truth), all_lanes(truth)
            for k in range(8):
                single[i + k] = lane_of(x, k) + (largest(x) - smallest(x))

    rng = np.random.default_rng(31)
    a, b = (rng.normal(size=(2, N + 1)) * 10.0 ** rng.uniform(-200, 200, N + 1))[:, 1:]
    a[:320], b[:320] = rng.integers(-2, 3, (2, 320))
    a[:8] = 1.0
    s, out, truths, single = 0.1, np.zeros((6, N)), np.zeros((4, N // 8, 3), np.int64), np.zeros(N)
    with np.errstate(all="ignore"):
        run(a, b, s, out, truths, single)
        for found, right in zip(out, (a + b, a - s, s * a, a / b, -a, np.where(a > b, a, b)), strict=True):
            assert np.array_equal(found, right, equal_nan=True)
    for found, right in zip(truths, (a < b, a >= s, a == b, a > -1.0), strict=True):
        rows = right.reshape(-1, 8)
        assert np.array_equal(found, np.stack([rows @ (1 << np.arange(8)), rows.any(1), rows.all(1)], 1))
    rows = a.reshape(-1, 8)
    assert np.array_equal(single, (rows + (rows.max(1) - rows.min(1))[:, None]).ravel())


@pytest.mark.parametrize("lanes", [8, 16])
def test_conversions(lanes: int):
    load_f, load_i = (getattr(simd, f"load_{t}32x{lanes}") for t in "fi")

    @compiled
    def run(floats, integers, to_float, to_integer, float_bits, bits_float):
        for i in range(0, len(floats), lanes):
            at = 4 * i
            x, k = load_f(address_of(floats) + at), load_i(address_of(integers) + at)
            store(address_of(to_integer) + at, to_i32(x))
            store(address_of(to_float) + at, to_f32(k))
            store(address_of(float_bits) + at, as_i32(x))
            store(address_of(bits_float) + at, as_f32(k))

    rng = np.random.default_rng(17)
    floats = np.concatenate([rng.uniform(-(2.0**31), 2.0**31 - 200, N // 2), rng.integers(-9, 9, N // 2) / 2]).astype(
        F32
    )
    integers = numbers(18, I32)
    integers[:4] = [2**31 - 1, -(2**31), 2**24 + 1, 2**24 + 3]
    results = [np.zeros(N, dtype) for dtype in (F32, I32, I32, F32)]
    run(floats, integers, *results)
    expected = [integers.astype(F32), np.trunc(floats).astype(I32), floats.view(I32), integers.view(F32)]
    for found, right in zip(results, expected, strict=True):
        assert np.array_equal(found.view(I32), right.view(I32))
