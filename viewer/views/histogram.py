"""How the exact values of a region lie."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from viewer.views.base import Values

BINS = 64


@dataclass(frozen=True)
class Histogram:
    """How often values lie where: `counts` (k, BINS) for each of k numbers, between `low` and `high`; and of each
    number the least, the largest and the mean.  `pixels` have a value, of so many."""

    counts: NDArray[np.int64]
    low: float
    high: float
    least: tuple[float, ...]
    largest: tuple[float, ...]
    mean: tuple[float, ...]
    pixels: int
    of: int


def histogram(values: Values, rows: slice, columns: slice) -> Histogram | None:
    """Of a region's values; None where no pixel of it has one."""
    known = values.known[rows, columns]
    numbers = values.numbers[rows, columns][known].astype(np.float64)
    numbers = numbers[np.isfinite(numbers).all(axis=-1)]
    if len(numbers) == 0:
        return None
    low, high = float(numbers.min()), float(numbers.max())
    if low == high or (numbers == np.rint(numbers)).all():
        low, high = low - 0.5, high + 0.5
    bins = min(BINS, round(high - low)) if (numbers == np.rint(numbers)).all() and high - low <= BINS else BINS
    counts = np.stack([np.histogram(column, bins, (low, high))[0] for column in numbers.T])
    return Histogram(
        counts,
        low,
        high,
        tuple(numbers.min(axis=0)),
        tuple(numbers.max(axis=0)),
        tuple(numbers.mean(axis=0)),
        len(numbers),
        known.size,
    )
