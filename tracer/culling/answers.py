"""What is known of the shadow rays of a wave's points to one light, and the memory that is worked in meanwhile."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.culling.certified.candidates import QUESTION_ROWS
from tracer.geometry.rays import Rays
from tracer.kernels import inlined


class Found(NamedTuple):
    """Words of n points: low and high (n,) int32, their halves, and whether these have been looked up, vector by
    vector."""

    low: NDArray[np.int32]
    high: NDArray[np.int32]
    looked_up: NDArray[np.int32]


class Answers(NamedTuple):
    """What is known of the shadow rays of n points to one light, as bits of int32, 16 points a number:
    which are due, which of those reach the light and, where knowledge asks to verify, which truly do.

    For asking: known, the words that culling goes by, and modes, those that rays teach, which may be the same; live,
    the bits of those to be traced, their rays, one after the other, and blocked, a byte for each ray. Of certified
    cells, over all lights: untried, the bits of points with a light of which nothing is known, and doubtful, of those
    with one of which only candidates are; asked (n,) int32, the points with candidates, one after the other, and after
    that the bits of those that what moves is asked about; questions (QUESTION_ROWS, n) float32, where the rays will
    lie. Of the cache: slots (n,) int32 of the points, and occluders (n,) int32 of the rays, one after the other. asks
    tells whether candidates are asked: where packets of rays from primary hits are traced for less, they are not."""

    due: NDArray[np.int32]
    lit: NDArray[np.int32]
    truth: NDArray[np.int32]
    known: Found
    modes: Found
    rays: Rays
    live: NDArray[np.int32]
    blocked: NDArray[np.float32]
    untried: NDArray[np.int32]
    doubtful: NDArray[np.int32]
    asked: NDArray[np.int32]
    questions: NDArray[np.float32]
    slots: NDArray[np.int32]
    occluders: NDArray[np.int32]
    asks: bool


# Rows of the memory that answers lie in, the first eight of which are the rays.
DUE_ROW, LIT_ROW, TRUTH_ROW, LOW_ROW, HIGH_ROW, LOOKED_UP_ROW, LIVE_ROW, BLOCKED_ROW = range(8, 16)
UNTRIED_ROW, DOUBTFUL_ROW, ASKED_ROW, SLOT_ROW, OCCLUDER_ROW = range(16, 21)
MODES_ROW, ANSWER_ROWS = 21, 24  # three rows like those from LOW_ROW on


@inlined
def _found_in(memory, row):
    return Found(memory[row].view(np.int32), memory[row + 1].view(np.int32), memory[row + 2].view(np.int32))


@inlined
def answers_in(memory, count, asks, apart):
    """Answers for `count` points, of which nothing has been looked up, in memory (ANSWER_ROWS, n) float32; `apart`
    where modes are other words than those that culling goes by."""
    for row in (LOOKED_UP_ROW, UNTRIED_ROW, DOUBTFUL_ROW, ANSWER_ROWS - 1):
        memory[row, : (count + 15) // 16] = 0
    return Answers(
        memory[DUE_ROW].view(np.int32),
        memory[LIT_ROW].view(np.int32),
        memory[TRUTH_ROW].view(np.int32),
        _found_in(memory, LOW_ROW),
        _found_in(memory, MODES_ROW if apart else LOW_ROW),
        Rays(memory[0:3], memory[3:6], memory[6], memory[7]),
        memory[LIVE_ROW].view(np.int32),
        memory[BLOCKED_ROW],
        memory[UNTRIED_ROW].view(np.int32),
        memory[DOUBTFUL_ROW].view(np.int32),
        memory[ASKED_ROW].view(np.int32),
        memory[:QUESTION_ROWS],
        memory[SLOT_ROW].view(np.int32),
        memory[OCCLUDER_ROW].view(np.int32),
        asks,
    )
