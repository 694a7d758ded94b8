"""Powers and logarithms of the vector library, against numpy."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

from tests.simd.kinds import (
    F32,
    N,
    compiled,
)
from tracer.simd import (
    address_of,
    binary_logarithm,
    floor,
    load_f32x16,
    power,
    store,
)


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
