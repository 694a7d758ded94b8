"""What pictures record of their rays besides light, pixel by pixel, where it is asked for."""

from __future__ import annotations

from tracer.kernels import subkernel


@subkernel
def record_normals(wave, points, pixels, buffers):
    """The shading normals of primary hits."""
    for i in range(wave.size):
        for axis in range(3):
            buffers.normal[pixels.place[wave.pixel[i]], axis] = points.normal[axis, i]


@subkernel
def record_lights(wave, light, batch, pixels, buffers):
    """How many shadow rays of primary hits to a light's samples are due, and how many reach it."""
    for i in range(wave.size):
        place = pixels.place[wave.pixel[i]]
        buffers.asked[place, light] += (batch.due[i >> 4] >> (i & 15)) & 1
        buffers.reached[place, light] += (batch.lit[i >> 4] >> (i & 15)) & 1


@subkernel
def count_rays(wave, pixels, buffers):
    """Count the rays of a wave at their pixels."""
    if len(buffers.cost) > 0:
        for i in range(wave.size):
            buffers.cost[pixels.place[wave.pixel[i]]] += 1


@subkernel
def count_shadow_rays(wave, batch, pixels, buffers, traced):
    """Count the shadow rays that are due, those that asked static geometry, and those that need not: all of them,
    where the method has not `traced` these."""
    for i in range(wave.size):
        place = pixels.place[wave.pixel[i]]
        due, live = batch.due[i >> 4] >> (i & 15), (batch.live[i >> 4] >> (i & 15)) if traced else 0
        buffers.saved[place] += due & ~live & 1
        buffers.cost[place] += live & 1
        buffers.due_rays[place] += due & 1


@subkernel
def count_wrong(wave, batch, pixels, wrong):
    """Count the answers that differ from the truth."""
    for i in range(wave.size):
        wrong[pixels.place[wave.pixel[i]]] += ((batch.lit[i >> 4] ^ batch.truth[i >> 4]) >> (i & 15)) & 1
