"""Which of a lamp's samples does a triangle certainly hide from sixteen points?

The same functions, error bounds and rules as where one point is asked about sixteen samples (`seen_by_lamp`): here the
points are the lanes, and samples are taken one after the other.  Points that are shaded together are neighbours, so
that a triangle which hides much of a lamp from one hides much of it from all.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.culling.certified.error_bounds import INSIDE, LAMP, ONE, ZERO, scaled
from tracer.culling.certified.prepared_triangles import FIRM, HEIGHT, REACH, UNSURE, D, number_at, numbers_at
from tracer.culling.certified.seen_by_lamp import (
    AT_BEHIND,
    AT_D,
    AT_U,
    AT_V,
    BOUND_U,
    BOUND_V,
    BOUND_W,
    GRADIENT_U,
    GRADIENT_V,
    MOST_SAMPLES,
    PLACES,
)
from tracer.culling.shadow_testing import answer
from tracer.culling.stages import vectors
from tracer.runtime.kernels import inlined, subkernel
from tracer.simd import (
    address_of,
    bits_of,
    f32x16,
    fma,
    load_f32,
    load_f32x16,
    load_i32,
    load_i32x16,
    maximum,
    select,
    store,
)
from tracer.simd.records import IntRow, Memory, Rows, row_count, rows_of

LANES = 16
BITS = 4 * MOST_SAMPLES  # bytes: bits of sixteen points for each sample
NOTHING, SOME, ALL = range(3)  # of a lamp's samples are hidden from sixteen points, where they are due
_INSIDE, _LAMP = np.float32(INSIDE), np.float32(LAMP)


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
def _at(triangle, column):
    """A number of the prepared triangle at an address, in all lanes."""
    return f32x16(number_at(triangle, column))


@inlined
def _kept(kept, column):
    return load_f32x16(kept + 64 * column)


@inlined
def _three_kept(kept, column):
    return _kept(kept, column), _kept(kept, column + 1), _kept(kept, column + 2)


@inlined
def _further(at_centre, gradient, offset):
    """A linear function at a place that is off the centre of a lamp."""
    nearly = fma(gradient[1], f32x16(offset[1]), fma(gradient[2], f32x16(offset[2]), at_centre))
    return fma(gradient[0], f32x16(offset[0]), nearly)


@subkernel
def hide_samples(triangle, kept, can, samples, count, bits):
    """Join the points from which a triangle certainly hides each of `count` samples to `bits`, int32 for each sample at
    an address; the points from which all are hidden by now.

    The prepared triangle, what `ask_points` kept of it and of sixteen points, of which some `can` (bits) be certain of
    a hit, and samples, as `put_samples` put them, are at addresses."""
    firm, behind, every = number_at(triangle, FIRM), _kept(kept, AT_BEHIND), np.int64(0xFFFF)
    # Where the sign of T is not certain, D - T has that of D.
    side = f32x16(ONE) if firm > ZERO else select(behind >= ZERO, f32x16(ONE), f32x16(-ONE))
    u0, v0, d0 = side * _kept(kept, AT_U), side * _kept(kept, AT_V), side * _kept(kept, AT_D)
    w0 = d0 - u0 - v0
    to_u, to_v = scaled(_three_kept(kept, GRADIENT_U), side), scaled(_three_kept(kept, GRADIENT_V), side)
    n = numbers_at(triangle, D)
    of_d = -side * n[0], -side * n[1], -side * n[2]
    to_w = of_d[0] - to_u[0] - to_v[0], of_d[1] - to_u[1] - to_v[1], of_d[2] - to_u[2] - to_v[2]
    of_u, of_v, of_w = (
        _INSIDE * _kept(kept, BOUND_U),
        _INSIDE * _kept(kept, BOUND_V),
        _INSIDE * _kept(kept, BOUND_W),
    )
    least, reach, of_height = _at(triangle, HEIGHT), _at(triangle, REACH), _at(triangle, UNSURE)
    # Is the lamp so high above the triangle's plane, everywhere, that its height decides nothing?
    high = firm > ZERO and bits_of(least > _LAMP * (maximum(d0, -d0) + reach)) == 0xFFFF
    for k in range(count):
        at = samples + 4 * k
        offset = load_f32(at), load_f32(at + PLACES), load_f32(at + 2 * PLACES)
        inside = (_further(u0, to_u, offset) > of_u) & (_further(v0, to_v, offset) > of_v)
        inside = inside & (_further(w0, to_w, offset) > of_w)
        if not high:
            less = _further(f32x16(ZERO), of_d, offset)
            height = side * (least + reach) + less
            inside = inside & (height > of_height) & (height > _LAMP * (d0 + less))
        hit = np.int64(load_i32(bits + 4 * k)) | (np.int64(bits_of(inside)) & can)
        store(bits + 4 * k, np.int32(hit))
        every &= hit
    return every


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
