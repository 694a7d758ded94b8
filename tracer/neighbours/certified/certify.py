"""Certify one cell for one light: LIT, FULL, CANDIDATES, or nothing yet.

Primitives that may come between are taken from the cell that this one is a part of or, where that had too many, from
the tree.  Those that are certain to be missed are passed over (`classify`).  Nothing left: LIT.  One that is certain to
be hit: FULL.  Several that hide the cell together: FULL as well (`fused`).  Else the rest are CANDIDATES.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.neighbours.certified.cells import CANDIDATES, FULL, LIT, SETTLED, TOO_MANY
from tracer.runtime.kernels import subkernel
from tracer.visibility.budget import CERTIFICATES
from tracer.visibility.classify import FUNCTIONS, PrismQuestion
from tracer.visibility.error_bounds import LANES
from tracer.visibility.fused import PIECES, VERTICES, fuse
from tracer.visibility.search import HIDDEN, find_candidates
from tracer.visibility.shaft import PrismShaft, make_prism_shaft

MOST = 48  # candidates that a cell keeps for its parts


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

    shaft: PrismShaft
    found: NDArray[np.int32]
    parts: NDArray[np.float32]
    lanes: NDArray[np.int64]
    pieces: NDArray[np.float64]
    vertices: NDArray[np.int64]
    spare: NDArray[np.float64]


def make_scratch() -> Scratch:
    """Memory for one worker."""
    return Scratch(
        make_prism_shaft(),
        np.zeros(MOST + LANES, np.int32),
        np.zeros((FUNCTIONS, 3, LANES), np.float32),
        np.zeros(LANES, np.int64),
        np.zeros((PIECES, VERTICES, 3)),
        np.zeros(PIECES, np.int64),
        np.zeros((2, VERTICES, 3)),
    )


@subkernel
def certify(s, o, number, light, given, given_count, few, counts):
    """Certify the cell and light that s.shaft was put to: (state, how many primitives it names).

    s.found begins with these.  o are the `Occluders`, number that of the light, light (3,) its position.  Candidates
    are those of `given` (given_count,) int32 where there are no more than MOST, else they come from the tree.  More
    than MOST make CANDIDATES of TOO_MANY, which are not named.  As few as `few`, which rays will test, are SETTLED
    besides.  counts (COUNTERS,) int64 are added to."""
    counts[CERTIFICATES] += 1
    question = PrismQuestion(o, number, light, s.shaft)
    count = find_candidates(question, given, given_count, s.found, MOST, counts)
    if count == HIDDEN:
        return FULL, 1
    if count == 0:
        return LIT, 0
    if count > MOST:
        return CANDIDATES, TOO_MANY
    fused = fuse(s, o, light, count)
    if fused > 0:
        return FULL, fused
    return CANDIDATES, count + (SETTLED if count <= few else 0)
