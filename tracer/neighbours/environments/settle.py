"""What is proved of cells and a light: that it is hidden from all of a cell, lights all of it, or what may block it.

A cell begins with what the cell around it is left with (`tracer.visibility.box_candidates`).
"""

from __future__ import annotations

import numpy as np

from tracer.geometry.memory import without_refcount
from tracer.neighbours.environments.octree import HIDDEN, LIT, UNKNOWN
from tracer.runtime.kernels import kernel
from tracer.visibility.box_candidates import MOST, come_between, forget_occluders, make_scratch
from tracer.visibility.budget import CERTIFICATES
from tracer.visibility.error_bounds import LANES


@kernel
def settle(o, light, boxes, above, names, codes, found, counts):
    """Find the codes (n,) int32 of cells in boxes (n, 6) for a `Light`; above (n,) are those of the cells around them.

    Where blockers are left, the code is their number, and they are in found (n, MOST) int32: more than MOST are not
    named and make UNKNOWN.  names (m,) are those of the cells around.  o are `Occluders`.  counts (COUNTERS,) int64
    are added to."""
    o, scratch, met = without_refcount(o), make_scratch(), np.zeros(MOST + 2 * LANES, np.int32)
    for i in range(len(boxes)):
        code = above[i]
        if code in (HIDDEN, LIT):
            codes[i] = code
            continue
        given, start = np.int64(MOST + 1), np.int64(0)
        if code > 0:
            given, start = np.int64(names[code]), np.int64(code) + 1
        half = 0.5 * (boxes[i, 3] - boxes[i, 0])
        middle = boxes[i, 0] + half, boxes[i, 1] + half, boxes[i, 2] + half
        forget_occluders(scratch)
        counts[CERTIFICATES] += 1
        count = come_between(o, light, scratch, middle, half, names[start:], given, met, counts)
        codes[i] = UNKNOWN if count > MOST else (HIDDEN if count < 0 else count)
        for k in range(max(0, min(count, MOST))):
            if count <= MOST:
                found[i, k] = met[k]
