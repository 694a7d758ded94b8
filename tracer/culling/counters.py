"""What each worker counts, and where: one enumeration for kernels and for statistics."""

from __future__ import annotations

from enum import IntEnum

from tracer.culling.modes import MAX_CULLED_LIGHTS


class ShadowCounter(IntEnum):
    """Places of a worker's shadow counters; the first two are those that queries add to.

    Names in lower case are those of `tracer.statistics.ShadowCounts`.
    """

    TRAVERSAL_STEPS = 0
    INTERSECTION_TESTS = 1
    RAYS = 2
    DUE = 3
    CULLED = 4
    DYNAMIC_ONLY = 5
    CANDIDATES_ONLY = 6
    CACHE_HITS = 7
    WRONG = 8
    PASSED_OVER = 9


# numba takes plain numbers as constants
STEPS, TESTS, RAYS, DUE, CULLED, DYNAMIC_ONLY, CANDIDATES_ONLY, CACHE_HITS, WRONG, PASSED_OVER = (
    int(c) for c in ShadowCounter
)
# After these, three by light: rays that are due, and of those the ones that the paper's modes cull, and that they ask
# dynamic objects alone about.
BY_LIGHT = len(ShadowCounter)
SHADOW_COUNTERS = BY_LIGHT + 3 * MAX_CULLED_LIGHTS

# All of a worker's counters: steps, tests and rays of primary rays, then of secondary rays; then those of shadow rays.
PRIMARY, SECONDARY, SHADOW = 0, 3, 6
COUNTERS = SHADOW + SHADOW_COUNTERS
