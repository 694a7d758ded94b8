"""The vector library, operation by operation, against numpy.

These tests run on whatever processor numba compiles for; test_processors.py runs them for older ones.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

import numba
import numpy as np
import pytest
from numba.core.registry import cpu_target

from tracer import simd
from tracer.simd import (
    address_of,
    all_lanes,
    any_lane,
    as_f32,
    as_i32,
    binary_logarithm,
    bits_of,
    f32_at,
    floor,
    fma,
    gather_f32x16,
    gather_i32x16,
    i32_at,
    i64_at,
    lane_numbers_x16,
    lane_of,
    lanes_below,
    largest,
    leading_zeros,
    load_columns,
    load_f32,
    load_f32x16,
    load_f64x8,
    load_i32,
    load_i64,
    load_spread_bytes16,
    load_three,
    local_memory,
    lowest_bit,
    mask8,
    mask16,
    maximum,
    minimum,
    ones,
    pack,
    pack_three,
    power,
    select,
    smallest,
    square_root,
    store,
    store_bytes,
    store_three,
    store_where,
    to_f32,
    to_i32,
    u8_at,
)

F32, I32 = np.float32, np.int32
N = 16 * 60  # lanes of which each test has so many


class Kind(NamedTuple):
    """A vector type: how it is loaded and splat, its mask from bits, and what its lanes are."""

    name: str
    load: Any
    splat: Any
    mask: Any
    lanes: int
    dtype: type


KINDS = [
    Kind(name, getattr(simd, f"load_{name}"), getattr(simd, name), mask, lanes, dtype)
    for name, mask, lanes, dtype in (
        ("f32x8", mask8, 8, F32), ("f32x16", mask16, 16, F32), ("i32x8", mask8, 8, I32), ("i32x16", mask16, 16, I32),
    )
]  # fmt: skip
of_each_kind = pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.name)
of_floats = pytest.mark.parametrize("kind", KINDS[:2], ids=lambda kind: kind.name)
of_integers = pytest.mark.parametrize("kind", KINDS[2:], ids=lambda kind: kind.name)


def compiled(function: Callable) -> Any:
    return numba.njit(error_model="numpy")(function)


def numbers(seed: int, dtype: type = F32, n: int = N) -> np.ndarray:
    """Of all sizes; of floats some are infinite, zero of either sign, denormal or no numbers."""
    rng = np.random.default_rng(seed)
    if dtype is I32:
        values = rng.integers(-(2**31), 2**31, n).astype(I32)
        values[: n // 3] = rng.integers(-3, 4, n // 3)
        return rng.permutation(values)
    values = (rng.normal(size=n) * 10.0 ** rng.uniform(-12, 12, n)).astype(F32)
    values[: n // 3] = rng.integers(-3, 4, n // 3)
    odd = np.array([np.inf, -np.inf, np.nan, 0.0, -0.0, 1e-42, -1e-42, 3e38, -3e38], F32)
    values[n // 3 : n // 2] = rng.choice(odd, n // 2 - n // 3)
    return rng.permutation(values)


def same(found: np.ndarray, expected: np.ndarray) -> bool:
    """The same bits, or neither a number."""
    assert found.dtype == expected.dtype and found.shape == expected.shape
    if found.dtype != F32:
        return np.array_equal(found, expected)
    return bool(((found.view(I32) == expected.view(I32)) | (np.isnan(found) & np.isnan(expected))).all())


def row_of(a: np.ndarray, rows: int, dtype: type | None = None) -> np.ndarray:
    """Room for so many results of a's length."""
    return np.full((rows, len(a)), 99, dtype or a.dtype)


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
def test_select_takes_vectors_and_scalars(kind: Kind):
    load, lanes, mask = kind.load, kind.lanes, kind.mask

    @compiled
    def run(a, b, bits, scalar, out):
        row = 4 * len(a)
        for i in range(0, len(a), lanes):
            x, y, o = load(address_of(a) + 4 * i), load(address_of(b) + 4 * i), address_of(out) + 4 * i
            m = mask(bits[i // lanes])
            store(o, select(m, x, y))
            store(o + row, select(m, x, scalar))
            store(o + 2 * row, select(m, scalar, y))
            store(o + 3 * row, select(m, scalar, scalar))
            store(o + 4 * row, select(m, 1, y))

    a, b, s = numbers(11, kind.dtype), numbers(12, kind.dtype), kind.dtype(-5)
    truths = np.random.default_rng(13).random(N) < 0.5
    bits = np.array([int(row @ (1 << np.arange(kind.lanes))) for row in truths.reshape(-1, kind.lanes)])
    bits |= 5 << 40  # what lies above the lanes does not count
    out = row_of(a, 5)
    run(a, b, bits, s, out)
    one = kind.dtype(1)
    expected = [(a, b), (a, s), (s, b), (s, s), (one, b)]
    for found, (yes, no) in zip(out, expected, strict=True):
        assert same(found, np.where(truths, yes, no).astype(kind.dtype))


@pytest.mark.parametrize("lanes, mask", [(8, mask8), (16, mask16)])
def test_masks(lanes: int, mask: Any):
    @compiled
    def run(a, b, out, any_all):
        for i in range(len(a)):
            x, y = mask(a[i]), mask(b[i])
            out[0, i], out[1, i], out[2, i], out[3, i] = bits_of(x), bits_of(x & y), bits_of(x | y), bits_of(~x)
            any_all[0, i], any_all[1, i] = any_lane(x), all_lanes(x)

    full = (1 << lanes) - 1
    a, b = np.random.default_rng(14).integers(0, full + 1, (2, 200))
    a[:20], a[20:40], a[40] = 0, full, -1
    out, any_all = np.zeros((4, 200), np.int64), np.zeros((2, 200), np.bool_)
    run(a, b, out, any_all)
    a &= full
    for found, right in zip(out, (a, a & b, a | b, full - a), strict=True):
        assert np.array_equal(found, right)
    assert np.array_equal(any_all, [a != 0, a == full])


def test_masks_and_bytes_in_memory():
    @compiled
    def run(source, bytes_, bools):
        for i in range(0, len(source), 16):
            x = simd.load_i32x16(address_of(source) + 4 * i)
            store_bytes(address_of(bytes_) + i + 3, x + 0x7F00)
            store_bytes(address_of(bools) + i + 3, x < 100)

    source = np.random.default_rng(15).integers(0, 256, N).astype(np.int32)
    bytes_, bools = (np.full(N + 8, 9, np.uint8) for _ in range(2))
    run(source, bytes_, bools)
    for written, right in ((bytes_, source), (bools, source < 100)):
        assert np.array_equal(written[3:-5], right)
        assert (written[:3] == 9).all() and (written[-5:] == 9).all()


@of_each_kind
def test_reductions_and_single_lanes(kind: Kind):
    load, lanes = kind.load, kind.lanes

    @compiled
    def run(a, low, high, single):
        for i in range(len(low)):
            x = load(address_of(a) + 4 * lanes * i)
            low[i], high[i] = smallest(x), largest(x)
            for k in range(lanes):
                single[i, k] = lane_of(x, k)

    a = numbers(16, kind.dtype)
    a[a != a] = 0
    a[: kind.lanes] = np.arange(kind.lanes)
    rows = a.reshape(-1, kind.lanes)
    low, high, single = (np.zeros(s, kind.dtype) for s in (len(rows), len(rows), rows.shape))
    run(a, low, high, single)
    assert np.array_equal(low, rows.min(axis=1)) and np.array_equal(high, rows.max(axis=1))
    assert same(single, rows)


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


def test_bits_of_single_numbers():
    @compiled
    def run(a, floats, out, back):
        for i in range(len(a)):
            out[0, i], out[1, i], out[2, i] = lowest_bit(a[i]), leading_zeros(a[i]), ones(a[i])
            out[3, i] = as_i32(floats[i])
            back[i] = as_f32(out[3, i])

    rng = np.random.default_rng(19)
    a = rng.integers(-(2**63), 2**63 - 1, 300) >> rng.integers(0, 64, 300)
    a[:64] = np.int64(1) << np.arange(64)
    a[64:66] = 0, -1
    floats = numbers(20, F32, 300)
    out, back = np.zeros((4, 300), np.int64), np.zeros(300, F32)
    run(a, floats, out, back)
    words = [f"{int(x) & (2**64 - 1):064b}" for x in a]
    assert out[0].tolist() == [64 - len(w.rstrip("0")) if "1" in w else 64 for w in words]
    assert out[1].tolist() == [w.find("1") if "1" in w else 64 for w in words]
    assert out[2].tolist() == [w.count("1") for w in words]
    assert np.array_equal(out[3], floats.view(I32))
    assert np.array_equal(back.view(I32), floats.view(I32))


@of_each_kind
@pytest.mark.parametrize("first", [0, 1, 3, 5])
def test_vectors_need_no_alignment(kind: Kind, first: int):
    a = np.zeros(N + 16, kind.dtype)
    start = -a.ctypes.data % 64 // 4 + first
    a[:] = numbers(21, kind.dtype, len(a))
    target = np.full(N + 40, 77, kind.dtype)
    count = N - 32
    _copying(kind)(a[start : start + count], target[first:])
    assert same(target[first : first + count], a[start : start + count])
    assert (target[:first] == 77).all() and (target[first + count :] == 77).all()


@cache
def _copying(kind: Kind) -> Any:
    load, lanes = kind.load, kind.lanes

    @compiled
    def run(source, target):
        for i in range(0, len(source), lanes):
            store(address_of(target) + 4 * i, load(address_of(source) + 4 * i))

    return run


@of_each_kind
def test_a_masked_store_leaves_the_other_lanes_memory_alone(kind: Kind):
    load, lanes, mask = kind.load, kind.lanes, kind.mask

    @compiled
    def run(a, bits, target):
        for i in range(0, len(a), lanes):
            store_where(address_of(target) + 4 * i, load(address_of(a) + 4 * i), mask(bits[i // lanes]))

    a, truths = numbers(22, kind.dtype), np.random.default_rng(23).random(N) < 0.4
    bits = np.array([int(row @ (1 << np.arange(kind.lanes))) for row in truths.reshape(-1, kind.lanes)])
    memory = numbers(24, kind.dtype, N + 10)
    before = memory.copy()
    run(a, bits, memory[5 : N + 5])
    assert same(memory[5 : N + 5], np.where(truths, a, before[5 : N + 5]))
    assert same(memory[:5], before[:5]) and same(memory[N + 5 :], before[N + 5 :])


@of_each_kind
def test_packed_lanes_keep_their_order(kind: Kind):
    load, mask, lanes = kind.load, kind.mask, kind.lanes

    @compiled
    def run(a, bits, out):
        n = 0
        for v in range(len(bits)):
            store(address_of(out) + 4 * n, pack(load(address_of(a) + 4 * lanes * v), mask(bits[v])))
            n += ones(bits[v])
        return n

    a = numbers(25, kind.dtype)
    bits = np.random.default_rng(26).integers(0, 1 << lanes, len(a) // lanes)
    bits[:3] = 0, (1 << lanes) - 1, 1 << (lanes - 1)
    kept = np.array([int(b) >> lane & 1 for b in bits for lane in range(lanes)], np.bool_)
    out = np.zeros(len(a) + lanes, kind.dtype)
    assert run(a, bits, out) == kept.sum()
    assert same(out[: kept.sum()], a[kept])


def test_bytes_are_spread_over_the_lanes_of_a_mask():
    @compiled
    def run(source, bits, out):
        n = 0
        for v in range(len(bits)):
            store(address_of(out) + 64 * v, load_spread_bytes16(address_of(source) + n, mask16(bits[v])))
            n += ones(bits[v])

    rng = np.random.default_rng(33)
    bits = rng.integers(0, 1 << 16, 50)
    bits[:3] = 0, 0xFFFF, 0x8000
    where = (bits[:, None] >> np.arange(16) & 1).astype(np.bool_)
    source = rng.integers(0, 256, where.sum()).astype(np.uint8)
    right, out = np.zeros(where.shape, np.int32), np.full(where.shape, 7, np.int32)
    right[where] = source
    run(source, bits, out)
    assert np.array_equal(out, right)


@pytest.mark.parametrize("gather, dtype", [(gather_f32x16, F32), (gather_i32x16, I32)])
def test_gathered_numbers(gather: Any, dtype: type):
    load = simd.load_i32x16

    @compiled
    def run(a, places, out):
        for at in range(0, 4 * len(out), 64):
            store(address_of(out) + at, gather(address_of(a), load(address_of(places) + at)))

    a, out = numbers(27, dtype, 70), np.zeros(N, dtype)
    places = np.random.default_rng(28).integers(0, len(a), N).astype(I32)
    places[:16] = [0, 69] * 8
    run(a, places, out)
    assert same(out, a[places])


@pytest.mark.parametrize("columns", [8, 16])
def test_rows_of_a_table_become_columns(columns: int):
    @compiled
    def run(table, numbers, out):
        for v in range(len(numbers) // 16):
            loaded = load_columns(address_of(table), address_of(numbers) + 64 * v, columns)
            for c in range(columns):
                store(address_of(out) + 4 * (len(numbers) * c + 16 * v), loaded[c])

    table = numbers(29, F32, 50 * columns).reshape(50, columns)
    chosen = np.random.default_rng(30).integers(0, len(table), N).astype(I32)
    chosen[:16] = range(34, 50)
    out = np.zeros((columns, N), F32)
    run(table, chosen, out)
    assert same(out, table[chosen].T.copy())


def test_single_numbers_in_memory():
    @compiled
    def run(floats, integers, longs, octets, out):
        f, i, k, u = f32_at(address_of(floats)), i32_at(address_of(integers)), i64_at(address_of(longs)), octets
        out[0] = load_f32(address_of(floats) + 4) + f[2]
        out[1] = load_i32(address_of(integers) + 4) + i[2]
        out[2] = load_i64(address_of(longs) + 8) + k[2]
        out[3] = u8_at(address_of(u))[3]
        f[0], i[0], k[0] = 5.5, -5, 1 << 40
        store(address_of(floats) + 12, np.float32(2.25))
        store(address_of(integers) + 12, np.int32(-9))
        store(address_of(longs) + 24, -(np.int64(1) << 50))
        u8_at(address_of(u))[0] = 200

    floats, integers, longs = np.arange(5, dtype=F32), np.arange(5, dtype=I32), np.arange(5, dtype=np.int64)
    octets, out = np.array([1, 2, 3, 250, 4], np.uint8), np.zeros(4)
    run(floats, integers, longs, octets, out)
    assert out.tolist() == [3, 3, 3, 250]
    assert floats.tolist() == [5.5, 1, 2, 2.25, 4]
    assert integers.tolist() == [-5, 1, 2, -9, 4]
    assert longs.tolist() == [1 << 40, 1, 2, -(1 << 50), 4]
    assert octets.tolist() == [200, 2, 3, 250, 4]


def test_local_memory_is_aligned_and_each_ones_own():
    @compiled
    def fill(depth, out):
        a, b = local_memory(192), local_memory(64)
        for i in range(12):
            store(a + 16 * i, np.int64(100 * depth + i))
        for i in range(8):
            store(b + 8 * i, np.int64(-1))
        if depth > 0:
            fill(depth - 1, out)
        out[depth, 12], out[depth, 13] = a % 64, b % 64
        for i in range(12):
            out[depth, i] = load_i64(a + 16 * i)

    out = np.zeros((4, 14), np.int64)
    fill(3, out)
    assert out.tolist() == [[*range(100 * d, 100 * d + 12), 0, 0] for d in range(4)]


def test_numbers_of_lanes_and_rows_of_three():
    @compiled
    def run(rows, out, numbers):
        for v in range(rows.shape[1] // 16):
            x, y, z = load_three(rows, v)
            store(address_of(out) + 64 * v, x + 2 * y + 4 * z)
        store(address_of(numbers), lane_numbers_x16())

    rows = np.random.default_rng(25).integers(-99, 99, (3, 64)).astype(F32)
    out, lanes = np.zeros(64, F32), np.zeros(16, I32)
    run(rows, out, lanes)
    assert np.array_equal(out, rows[0] + 2 * rows[1] + 4 * rows[2])
    assert lanes.tolist() == list(range(16))


@pytest.mark.parametrize("count", [0, 1, 15, 16, 33])
def test_three_rows_are_packed_together_up_to_their_end(count: int):
    @compiled
    def run(rows, count, out):
        n, stride = 0, 4 * out.shape[1]
        for v in range((count + 15) // 16):
            there = lanes_below(count, v)
            store_three(address_of(out) + 4 * n, stride, pack_three(load_three(rows, v), mask16(there & 0x5FFF)))
            n += ones(there & 0x5FFF)
        return n

    rows, out = numbers(31, F32, 3 * 48).reshape(3, 48), np.zeros((3, 64), F32)
    kept = [i for i in range(count) if i % 16 not in (13, 15)]
    assert run(rows, count, out) == len(kept)
    assert same(out[:, : len(kept)], rows[:, kept])


def test_whole_numbers_that_are_no_more_and_logarithms():
    @compiled
    def run(x, below, y, logarithm):
        for at in range(0, 4 * len(x), 64):
            store(address_of(below) + at, floor(load_f32x16(address_of(x) + at)))
            store(address_of(logarithm) + at, binary_logarithm(load_f32x16(address_of(y) + at)))

    rng = np.random.default_rng(32)
    x = (rng.normal(size=N) * 10.0 ** rng.uniform(-3, 8, N)).astype(F32)
    x[: N // 3] = rng.integers(-9, 9, N // 3)
    x[N // 3 : N // 2] = np.nextafter(x[: N // 2 - N // 3], F32(-np.inf))
    y = (10.0 ** rng.uniform(-37, 38, N)).astype(F32)
    y[:32] = 2.0 ** np.arange(-16, 16)
    below, logarithm = np.zeros(N, F32), np.zeros(N, F32)
    run(x, below, y, logarithm)
    assert np.array_equal(below, np.floor(x))
    right = np.log2(y.astype(np.float64))
    assert (np.abs(logarithm - right) < 3e-7 * np.maximum(1, np.abs(right))).all()
    assert np.array_equal(logarithm[:32], np.arange(-16, 16))


@cache
def _powers() -> Any:
    @compiled
    def run(x, y, out):
        for i in range(0, len(x), 16):
            at = 4 * i
            store(address_of(out) + at, power(load_f32x16(address_of(x) + at), load_f32x16(address_of(y) + at)))

    return run


def powers(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    out = np.zeros(len(x), F32)
    _powers()(x.astype(F32), y.astype(F32), out)
    return out


@pytest.mark.parametrize(
    "low, high, most",
    [(0.0, 1.0, 300.0), (0.99, 1.0, 5000.0), (1.0, 1.01, 5000.0), (0.0, 1000.0, 10.0), (1e-30, 1e-20, 1.5)],
)
def test_power_is_nearly_that_of_float64(low: float, high: float, most: float):
    rng = np.random.default_rng(26)
    x, y = rng.uniform(low, high, 32000).astype(F32), rng.uniform(0, most, 32000).astype(F32)
    exact = x.astype(np.float64) ** y.astype(np.float64)
    found = powers(x, y)
    with np.errstate(divide="ignore"):
        size = np.abs(np.log2(exact))
    usual = size < 120
    assert usual.mean() > 0.2
    error = np.abs(found[usual] / exact[usual] - 1)
    assert (error <= 6e-7 + 3e-7 * np.maximum(y, size)[usual]).all(), error.max()
    assert (found[exact < 2.0**-127] == 0).all()
    assert (found[exact > 2.0**127] >= 2.0**126.9).all()


def test_powers_that_need_no_computing():
    y = np.array([0, 0.3, 1, 2, 50, 1e6, 3e38, 1e-30] * 2, F32)
    assert powers(np.zeros(16), y).tolist() == (y == 0).tolist()
    assert powers(np.full(16, 1e-40), y).tolist() == (y == 0).tolist()  # below what is normal
    assert powers(np.ones(16), y).tolist() == [1] * 16
    assert powers(np.array([0, 1e-45, 1e-30, 0.5, 1, 7, 1e30, 3e38] * 2), np.zeros(16)).tolist() == [1] * 16
    x = np.array([2.0, 4.0, 0.5, 0.25] * 4)
    assert np.allclose(powers(x, np.full(16, 3.0)), x**3, rtol=1e-6)
    assert np.isfinite(powers(np.full(16, 3e38), y)).all()
