"""Rays that end in a cell with few candidates: these are asked instead of the tree.

Each candidate's answer is taken where it is certain (`margins.verdict`).  One certain hit blocks the ray; where
all are certain to be missed nothing static does; any other ray is traced as if nothing were known.
"""

from __future__ import annotations

import numpy as np

from tracer.culling.certified.margins import SURE_HIT, UNSURE, verdict
from tracer.kernels import subkernel

FEW = 8  # candidates that rays ask, at most


@subkernel
def ask_candidates(certified, cell, number, light, point):
    """(verdict, tests made) of the candidates of a cell on a shadow ray from light `number` to a point (3,)."""
    cells = certified.cells
    count = np.int64(cells.count[cell, number])
    if count > certified.few:
        return UNSURE, 0
    start, result, triangles = np.int64(cells.start[cell, number]), 0, len(certified.rows)
    for k in range(start, start + count):
        i = np.int64(cells.names[k])
        found = UNSURE
        if i < triangles:
            found = verdict(certified.rows, i, np.float64(certified.blurs[i]), light, point)
        if found == SURE_HIT:
            return SURE_HIT, k - start + 1
        result = max(result, found)
    return result, count
