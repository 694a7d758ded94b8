"""Lanes of vectors: chosen, masked, reduced and packed, against numpy."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from tests.simd.kinds import (
    F32,
    I32,
    Kind,
    N,
    compiled,
    numbers,
    of_each_kind,
    row_of,
    same,
)
from tracer.simd import (
    address_of,
    all_lanes,
    any_lane,
    as_f32,
    as_i32,
    bits_of,
    lane_numbers_x16,
    lane_of,
    lanes_below,
    largest,
    leading_zeros,
    load_spread_bytes16,
    load_three,
    lowest_bit,
    mask8,
    mask16,
    ones,
    pack,
    pack_three,
    select,
    smallest,
    store,
    store_three,
)


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


def test_three_rows_are_packed_together_up_to_their_end():
    @compiled
    def run(rows, count, out):
        n, stride = 0, 4 * out.shape[1]
        for v in range((count + 15) // 16):
            there = lanes_below(count, v)
            store_three(address_of(out) + 4 * n, stride, pack_three(load_three(rows, v), mask16(there & 0x5FFF)))
            n += ones(there & 0x5FFF)
        return n

    for count in (0, 1, 15, 16, 33):
        rows, out = numbers(31, F32, 3 * 48).reshape(3, 48), np.zeros((3, 64), F32)
        kept = [i for i in range(count) if i % 16 not in (13, 15)]
        assert run(rows, count, out) == len(kept)
        assert same(out[:, : len(kept)], rows[:, kept])


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
