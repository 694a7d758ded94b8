"""What is known of shadow rays of lamps: for some points of a wave and all samples of a lamp, before any is traced.

Where nothing comes between, the lamp is seen as a whole; where all of it is hidden it is dark.  Of the points in
between, in the penumbra, each has a bit for each sample.  Only rays to samples of which nothing is certain are traced.
`find_lamp_answers` finds the answers, here they are kept and given; and so is what `recent_occluders` finds: which
samples are hidden from sixteen points.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.culling.shadow_testing import answer
from tracer.culling.stages import vectors
from tracer.runtime.kernels import inlined, subkernel
from tracer.simd import address_of, bits_of, load_i32, load_i32x16, lowest_bit, ones, store
from tracer.simd.records import IntRow, Memory, Rows, row_count, rows_of
from tracer.visibility.area_light_tests import MOST_SAMPLES
from tracer.visibility.error_bounds import LANES

WORDS = MOST_SAMPLES // 32  # with a bit for each sample
BITS = 4 * MOST_SAMPLES  # bytes: bits of sixteen points for each sample
NOTHING, SOME, ALL = range(3)  # of a lamp's samples are hidden from sixteen points, where they are due


class LampAnswers(NamedTuple):
    """What is known of n points of a wave and a lamp, in rows.

    Attributes:
        open: bits of the points of which some ray may be due and nothing is known, sixteen points a number.
        full, lit: bits of those from which the lamp is hidden as a whole, and not at all.
        partly: bits of those with a bit for each sample.
        alone: bits of those between which and the lamp no object comes of which nothing is known.
        blocked, unblocked: WORDS rows of these bits: samples that are hidden, and that are not.
    """

    memory: Memory
    open: IntRow
    full: IntRow
    lit: IntRow
    partly: IntRow
    alone: IntRow
    blocked: Annotated[NDArray[np.int32], Rows(WORDS, "int32")]
    unblocked: Annotated[NDArray[np.int32], Rows(WORDS, "int32")]


lamp_answers_in = rows_of(LampAnswers)
LAMP_ANSWER_ROWS = row_count(LampAnswers)


@subkernel
def answer_sample(answers, sample, count, batch, counts):
    """Answer the rays of `count` points to a lamp's sample, by what is known.  batch is a `ShadowBatch`."""
    blocked, unblocked = address_of(answers.blocked[sample >> 5]), address_of(answers.unblocked[sample >> 5])
    bit = np.int32(np.int64(1) << (sample & 31))
    for v in range(vectors(count)):
        if batch.live[v] == 0:
            continue
        full, lit, partly = np.int64(answers.full[v]), np.int64(answers.lit[v]), np.int64(answers.partly[v])
        if partly != 0:
            full |= partly & bits_of((load_i32x16(blocked + 64 * v) & bit) == bit)
            lit |= partly & bits_of((load_i32x16(unblocked + 64 * v) & bit) == bit)
        answer(batch, v, full, lit, counts)
        batch.settled[v] |= np.int64(batch.lit[v]) & np.int64(answers.alone[v])


@subkernel
def decided(answers, v, samples):
    """How many rays of a vector of points to a lamp's samples are known."""
    decided, partly = samples * ones(np.int64(answers.full[v] | answers.lit[v])), np.int64(answers.partly[v])
    while partly != 0:
        i = 16 * v + lowest_bit(partly)
        partly &= partly - 1
        for word in range((samples + 31) // 32):
            known = np.int64(answers.blocked[word, i] | answers.unblocked[word, i]) & 0xFFFFFFFF
            decided += ones(known & ((np.int64(1) << min(32, samples - 32 * word)) - 1))
    return decided


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
