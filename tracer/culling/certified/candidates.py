"""Rays that end in a cell with few candidates: these are asked instead of the tree.

Each candidate's answer is taken where it is certain (`margins.verdict`).  One certain hit blocks the ray; where
all are certain to be missed nothing static does; any other ray is traced as if nothing were known.
"""

from __future__ import annotations

import numpy as np

from tracer.culling.certified.margins import SURE_HIT, SURE_MISS, UNSURE, verdict
from tracer.kernels import subkernel


@subkernel
def ask_candidates(names, first, count, rows, blurs, farthest, light, point):
    """(verdict, tests made) of candidates names[first : first + count] on a shadow ray from a light to a point, both
    (3,): triangles of rows (n, 9) with their blurs (n,), or quadrics, of which nothing is certain."""
    result = SURE_MISS
    for k in range(first, first + count):
        i, found = np.int64(names[k]), UNSURE
        if i < len(rows):
            found = verdict(rows, i, np.float64(blurs[i]), farthest, light, point)
        if found == SURE_HIT:
            return SURE_HIT, k - first + 1
        result = max(result, found)
    return result, count
