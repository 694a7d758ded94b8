"""Certify one cell for one light: LIT, FULL, CANDIDATES, or nothing yet.

Primitives that may come between are taken from the cell that this one is a part of or, where that had too many, from
the tree.  Those that are certain to be missed are passed over (`classify`).  Nothing left: LIT.  One that is certain to
be hit: FULL.  Several that hide the cell together: FULL as well (`fused`).  Else the rest are CANDIDATES.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.culling.certified.cells import CANDIDATES, FULL, LIT, SETTLED, TOO_MANY
from tracer.culling.certified.classify import FUNCTIONS, classify_occluders
from tracer.culling.certified.error_bounds import LANES
from tracer.culling.certified.fused import PIECES, VERTICES, fuse
from tracer.culling.certified.shaft import Shaft, make_shaft
from tracer.culling.certified.tree_walk import WALK, begin_walk, walk_on
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

WAITING = 4 * (LANES + WIDTH)  # bytes: one leaf more than are classified together
MOST = 48  # candidates that a cell keeps for its parts

STEPS, TESTS, CERTIFICATES = range(3)  # counters
COUNTERS = 3


class Scratch(NamedTuple):
    """What a worker certifies in.

    Attributes:
        shaft: of the cell and light at hand.
        found: (MOST + LANES,) int32, primitives that may come between.
        parts: (FUNCTIONS, 3, LANES) float32, functions of fused occluders at the cell's corners.
        lanes: (LANES,) int64, which of `found` these are.
        pieces: (PIECES, VERTICES, 3) float64, polygons in barycentric coordinates.
        vertices: (PIECES,) int64, how many corners each has.
        spare: (2, VERTICES, 3) float64, memory for two polygons.
    """

    shaft: Shaft
    found: NDArray[np.int32]
    parts: NDArray[np.float32]
    lanes: NDArray[np.int64]
    pieces: NDArray[np.float64]
    vertices: NDArray[np.int64]
    spare: NDArray[np.float64]


def make_scratch() -> Scratch:
    """Memory for one worker."""
    return Scratch(
        make_shaft(),
        np.zeros(MOST + LANES, np.int32),
        np.zeros((FUNCTIONS, 3, LANES), np.float32),
        np.zeros(LANES, np.int64),
        np.zeros((PIECES, VERTICES, 3)),
        np.zeros(PIECES, np.int64),
        np.zeros((2, VERTICES, 3)),
    )


@subkernel
def _meet(s, o, light, numbers, n, count, counts):
    """Classify n <= 16 primitives, their numbers at an address; those that may come between join the `count` found.

    How many there are then, or -1 where one hides the whole cell: then it alone is found."""
    counts[TESTS] += n
    hit, missed = classify_occluders(o.rows, numbers, o.farthest, light, s.shaft)
    there = lanes_below(n, 0)
    hit &= there
    if hit != 0:
        s.found[0] = i32_at(numbers)[lowest_bit(hit)]
        return -1
    kept = there & ~missed
    store(address_of(s.found) + 4 * min(count, MOST), pack(load_i32x16(numbers), mask16(kept)))
    return count + ones(kept)


@subkernel
def _from_list(s, o, light, given, given_count, counts):
    """Find primitives among given (given_count,) int32; how many, or -1 as `_meet` says."""
    count, numbers = np.int64(0), local_memory(64)
    for first in range(0, given_count, LANES):
        for k in range(LANES):
            i32_at(numbers)[k] = given[min(first + k, given_count - 1)]
        count = _meet(s, o, light, numbers, min(LANES, given_count - first), count, counts)
        if count < 0:
            return count
    return count


@subkernel
def _from_tree(s, o, number, light, counts):
    """Find primitives in the tree of light `number`; how many, -1 as `_meet` says, or more than MOST for too many."""
    count, n = np.int64(0), np.int64(0)
    walk, waiting = begin_walk(local_memory(WALK)), local_memory(WAITING)
    numbers = i32_at(waiting)
    for k in range(LANES + WIDTH):
        numbers[k] = 0
    while True:
        n = walk_on(walk, o, number, s.shaft, numbers, n, LANES, counts)
        if n > 0:
            count = _meet(s, o, light, waiting, min(n, LANES), count, counts)
        if n < LANES or count < 0 or count > MOST:
            return count
        n -= LANES
        for k in range(n):
            numbers[k] = numbers[LANES + k]


@subkernel
def certify(s, o, number, light, given, given_count, few, counts):
    """Certify the cell and light that s.shaft was put to: (state, how many primitives it names).

    s.found begins with these.  o are the `Occluders`, number that of the light, light (3,) its position.  Candidates
    are those of `given` (given_count,) int32 where there are no more than MOST, else they come from the tree.  More
    than MOST make CANDIDATES of TOO_MANY, which are not named.  As few as `few`, which rays will test, are SETTLED
    besides.  counts (COUNTERS,) int64 are added to."""
    counts[CERTIFICATES] += 1
    if given_count <= MOST:
        count = _from_list(s, o, light, given, given_count, counts)
    else:
        count = _from_tree(s, o, number, light, counts)
    if count < 0:
        return FULL, 1
    if count == 0:
        return LIT, 0
    if count > MOST:
        return CANDIDATES, TOO_MANY
    fused = fuse(s, o, light, count)
    if fused > 0:
        return FULL, fused
    return CANDIDATES, count + (SETTLED if count <= few else 0)
