"""Find what may come between a light and a receiver: the candidates that are neither certain to hide it nor to miss it.

They are looked for among those of a larger receiver that this one is a part of or, where that had too many, in the
occluders' tree.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba.extending import overload

from tracer.geometry.wide_tree.topology import WIDTH
from tracer.runtime.kernels import subkernel
from tracer.simd import (
    address_of,
    i32_at,
    lanes_below,
    load_i32x16,
    local_memory,
    lowest_bit,
    mask16,
    ones,
    pack,
    store,
)
from tracer.visibility.budget import TESTS
from tracer.visibility.error_bounds import LANES
from tracer.visibility.tree_walk import WALK, begin_walk, walk_on

HIDDEN = -1  # instead of how many candidates: one hides the whole receiver
WAITING = 4 * (LANES + WIDTH)  # bytes: one leaf more than are classified together


def classify(question, numbers):
    """Bits of the primitives, sixteen numbers at an address, that every ray is certain to hit, and of those that none
    hits: numba takes what is declared by `classifies` for the question's type."""
    raise NotImplementedError


def classifies(question: type, subkernel: Any) -> None:
    """Let a subkernel (question, numbers) be what `classify` calls for questions, NamedTuples, of a type."""

    @overload(classify, inline="always")
    def _choose(asked, numbers):
        if getattr(asked, "instance_class", None) is question:
            return lambda asked, numbers: subkernel(asked, numbers)
        return None


@subkernel
def _join(question, numbers, n, found, count, most, counts):
    """Classify n <= 16 primitives, their numbers at an address; those that may come between join the `count` found.

    How many there are then, or HIDDEN where one hides the whole receiver: then it alone is found."""
    counts[TESTS] += n
    hit, missed = classify(question, numbers)
    there = lanes_below(n, 0)
    hit &= there
    if hit != 0:
        found[0] = i32_at(numbers)[lowest_bit(hit)]
        return np.int64(HIDDEN)
    kept = there & ~missed
    store(address_of(found) + 4 * min(count, most), pack(load_i32x16(numbers), mask16(kept)))
    return count + ones(kept)


@subkernel
def _in_list(question, given, given_count, found, most, counts):
    """Find candidates among given (given_count,) int32."""
    count, numbers = np.int64(0), local_memory(64)
    for first in range(0, given_count, LANES):
        for k in range(LANES):
            i32_at(numbers)[k] = given[min(first + k, given_count - 1)]
        n = min(LANES, given_count - first)
        count = _join(question, numbers, n, found, count, most, counts)
        if count < 0:
            break
    return count


@subkernel
def _in_tree(question, found, most, counts):
    """Find candidates in the occluders' tree."""
    count, n = np.int64(0), np.int64(0)
    walk, waiting = begin_walk(local_memory(WALK)), local_memory(WAITING)
    numbers = i32_at(waiting)
    for k in range(LANES + WIDTH):
        numbers[k] = 0
    while True:
        n = walk_on(walk, question.occluders, question.number, question.shaft, numbers, n, LANES, counts)
        if n > 0:
            count = _join(question, waiting, min(n, LANES), found, count, most, counts)
        if n < LANES or count < 0 or count > most:
            return count
        n -= LANES
        for k in range(n):
            numbers[k] = numbers[LANES + k]


@subkernel
def find_candidates(question, given, given_count, found, most, counts):
    """Find what may come between, into found (most + LANES,) int32: how many, more than `most` for too many, or HIDDEN.

    A question names the `Occluders`, the light's number there, and the shaft from the light to the receiver.
    Candidates are among given (given_count,) int32, or anywhere where that is more than `most`."""
    if given_count <= most:
        return _in_list(question, given, given_count, found, most, counts)
    return _in_tree(question, found, most, counts)
