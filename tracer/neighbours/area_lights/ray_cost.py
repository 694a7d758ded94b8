"""What do a wave's shadow rays to a lamp cost?  A few of them are traced to find out.

Between rays from neighbouring points of a plain surface and those from points that mirrors show lies a factor of
twenty, and asking triangles is worth it where rays cost more.  Times of the clock would not repeat; steps and tests do.
"""

from __future__ import annotations

import math

import numpy as np

from tracer.culling.counters import STEPS, TESTS
from tracer.culling.shadow_testing import begin_at, pack_ways, shadow_rays
from tracer.culling.stages import vectors
from tracer.geometry.queries import EVERYTHING, any_hits
from tracer.runtime.kernels import subkernel

PACKET = 8  # vectors of points whose rays are traced together
SHARE = 512  # of all samples' rays, one in so many is traced, but no less than a packet
# Nanoseconds, about, of a ray in a packet, and of its steps and tests: at first each, then of the root of their number,
# as packets do much of the work once where rays part.
FOR_RAY, FOR_FEW, FOR_MANY = 8.0, 110.0, 70.0


@subkernel
def cost_of_rays(lamps, points, facing, batch, sample, samples, count, counts):
    """About how many nanoseconds does a shadow ray from a place `sample` (3,), one of so many `samples`, take?

    lamps is a `LampsView`, facing has bits of the points of each vector from which rays are due, and rays that are
    traced have their place in batch, a `ShadowBatch`.  They are asked again if need be, so that only their steps and
    tests count."""
    if lamps.ray_cost != 0:
        return np.int64(lamps.ray_cost)
    n, packets = 0, (vectors(count) + PACKET - 1) // PACKET
    taken = max(1, packets * samples // SHARE)
    step, first = max(1, packets // taken), packets
    for v in range(vectors(count)):
        if facing[v] != 0:
            first = min(first, v // PACKET)
        if v // PACKET >= first and (v // PACKET - first) % step == 0:
            n = pack_ways(points, sample, v, np.int64(facing[v]), batch, n)
    if n == 0:
        return np.int64(FOR_RAY)
    begin_at(sample, n, batch)
    traced = np.zeros(2, np.int64)
    any_hits(lamps, shadow_rays(batch), EVERYTHING, batch.blocked, 0, n, traced)
    counts[STEPS] += traced[0]
    counts[TESTS] += traced[1]
    each = (traced[0] + traced[1]) / n
    return np.int64(FOR_RAY + min(FOR_FEW * each, FOR_MANY * math.sqrt(each)))
