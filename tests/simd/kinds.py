"""The kinds of vectors, and numbers to try them on."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numba
import numpy as np
import pytest

from tests.sweeps import cases
from tracer import simd
from tracer.simd import (
    mask8,
    mask16,
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


def of(kinds: list[Kind]) -> pytest.MarkDecorator:
    return pytest.mark.parametrize("kind", kinds, ids=lambda kind: kind.name)


# In every run each type of numbers and each number of lanes once: compiling a test for a kind is all its time.
of_each_kind = of(cases([KINDS[0], KINDS[3]], KINDS))
of_floats = of(cases(KINDS[1:2], KINDS[:2]))
of_integers = of(cases(KINDS[2:3], KINDS[2:]))


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
