"""What is known of shadow rays of lamps: for some points of a wave and all samples of a lamp, before any is traced.

Where nothing comes between, the lamp is seen as a whole; where all of it is hidden it is dark.  Of the points in
between, in the penumbra, each has a bit for each sample.  Only rays to samples of which nothing is certain are traced.
`find_lamp_answers` finds the answers, here they are kept and given.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.culling.shadow_testing import answer
from tracer.culling.stages import vectors
from tracer.runtime.kernels import subkernel
from tracer.simd import address_of, bits_of, load_i32x16, lowest_bit, ones
from tracer.simd.records import IntRow, Memory, Rows, row_count, rows_of
from tracer.visibility.area_light_tests import MOST_SAMPLES

WORDS = MOST_SAMPLES // 32  # with a bit for each sample


class LampAnswers(NamedTuple):
    """What is known of n points of a wave and a lamp, in rows.

    Attributes:
        open: bits of the points of which some ray may be due and nothing is known, sixteen points a number.
        full, lit: bits of those from which the lamp is hidden as a whole, and not at all.
        partly: bits of those with a bit for each sample.
        alone: bits of those between which and the lamp nothing comes that moves.
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
