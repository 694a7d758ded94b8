"""Which of a lamp's samples are hidden from a wave's points: kept for sixteen points at a time, and given to rays."""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.culling.shadow_testing import answer
from tracer.culling.stages import vectors
from tracer.runtime.kernels import inlined, subkernel
from tracer.simd import (
    address_of,
    load_i32,
    load_i32x16,
    store,
)
from tracer.simd.records import IntRow, Memory, Rows, row_count, rows_of
from tracer.visibility.area_light_tests import (
    MOST_SAMPLES,
)

LANES = 16
BITS = 4 * MOST_SAMPLES  # bytes: bits of sixteen points for each sample
NOTHING, SOME, ALL = range(3)  # of a lamp's samples are hidden from sixteen points, where they are due


class HiddenSamples(NamedTuple):
    """What is known of n points of a wave and a lamp, in rows.

    For sixteen points a number in `some` says of which samples it is known that they are hidden: NOTHING, SOME or ALL.
    For SOME, `bits` has the points from which a sample is hidden: sixteen samples a row, those of a vector of points
    side by side."""

    memory: Memory
    some: IntRow
    bits: Annotated[NDArray[np.int32], Rows(MOST_SAMPLES // LANES, "int32")]


hidden_samples_in = rows_of(HiddenSamples)
HIDDEN_SAMPLE_ROWS = row_count(HiddenSamples)


@inlined
def keep_bits(hidden, v, full, bits, count):
    """Keep the `bits` of `count` samples, at an address, for a vector of points, with those from which the lamp is
    hidden in full."""
    for first in range(0, count, LANES):
        at = address_of(hidden.bits[first // LANES]) + 64 * v
        store(at, load_i32x16(bits + 4 * first) | np.int32(full))


@subkernel
def answer_hidden(hidden, sample, count, batch, counts):
    """Answer those rays of `count` points to a lamp's sample that are certainly blocked.  batch is a `ShadowBatch`."""
    at = address_of(hidden.bits[sample // LANES]) + 4 * (sample % LANES)
    for v in range(vectors(count)):
        if batch.live[v] != 0 and hidden.some[v] != NOTHING:
            full = np.int64(load_i32(at + 64 * v)) if hidden.some[v] == SOME else np.int64(batch.live[v])
            answer(batch, v, full, np.int64(0), counts)
