"""What do a wave's shadow rays to a lamp cost?  A few of them are traced to find out.

Between rays from neighbouring points of a plain surface and those from points that mirrors show lies a factor of
twenty, and asking triangles is worth it where rays cost more.  Times of the clock would not repeat; steps and tests do.
"""

from __future__ import annotations

import math

import numpy as np

from tracer.culling.counters import RAYS, STEPS, TESTS
from tracer.culling.shadow_testing import LIGHT_MARGIN, shadow_rays
from tracer.culling.stages import vectors
from tracer.geometry.queries import EVERYTHING, any_hits
from tracer.runtime.kernels import inlined, subkernel
from tracer.simd import lowest_bit

ONE = np.float32(1)
GROUP, EVERY = 8, 8  # vectors whose rays are traced, in each so many groups of such; the first of them with any
# Nanoseconds, about, of a ray in a packet, and of its steps and tests: at first each, then of the root of their number,
# as packets do much of the work once where rays part.
FOR_RAY, FOR_FEW, FOR_MANY = 8.0, 110.0, 70.0


@subkernel
def cost_of_rays(lamps, points, facing, batch, sample, count, counts):
    """About how many nanoseconds does a shadow ray from a place `sample` (3,) take?

    lamps is a `LampsView`, facing has bits of the points of each vector from which rays are due, and rays that are
    traced have their place in batch, a `ShadowBatch`."""
    if lamps.ray_cost != 0:
        return np.int64(lamps.ray_cost)
    n, taken, full = 0, 0, vectors(count)
    for v in range(full):
        if n == 0:
            taken = v % (GROUP * EVERY) // GROUP
        if v % (GROUP * EVERY) // GROUP != taken:
            continue
        some = np.int64(facing[v])
        while some != 0:
            i = 16 * v + lowest_bit(some)
            some &= some - 1
            for axis in range(3):
                batch.origin[axis, n] = sample[axis]
                batch.direction[axis, n] = points.lifted[axis, i] - sample[axis]
            batch.t_min[n], batch.t_max[n] = LIGHT_MARGIN, ONE
            n += 1
    if n == 0:
        return np.int64(FOR_RAY)
    traced = np.zeros(2, np.int64)
    any_hits(lamps, shadow_rays(batch), EVERYTHING, batch.blocked, 0, n, traced)
    counts[STEPS] += traced[0]
    counts[TESTS] += traced[1]
    counts[RAYS] += n
    return _nanoseconds((traced[0] + traced[1]) / n)


@inlined
def _nanoseconds(each):
    """Of a ray whose steps and tests are so many."""
    return np.int64(FOR_RAY + min(FOR_FEW * each, FOR_MANY * math.sqrt(each)))
