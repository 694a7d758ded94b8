"""What pictures record of their rays besides light, pixel by pixel, where it is asked for."""

from __future__ import annotations

from tracer.culling.fate import CACHED, CANDIDATES, CULLED, DYNAMIC_ONLY, FACES_AWAY, FATE, MOVING_SHADOW, TRACED
from tracer.runtime.kernels import subkernel


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
def record_fates(wave, light, batch, pixels, buffers):
    """What became of the shadow rays of primary hits to a light: of its samples, the fate of that which asked most."""
    for i in range(wave.size):
        v, bit, moving = i >> 4, i & 15, 0
        fate = FACES_AWAY
        if (batch.due[v] >> bit) & 1:
            unblocked = (batch.unblocked[v] >> bit) & 1
            moving = MOVING_SHADOW if unblocked and not (batch.lit[v] >> bit) & 1 else 0
            if (batch.live[v] >> bit) & 1:
                fate = TRACED
            elif (batch.cached[v] >> bit) & 1:
                fate = CACHED
            elif (batch.candidates[v] >> bit) & 1:
                fate = CANDIDATES
            elif unblocked and not (batch.settled[v] >> bit) & 1:
                fate = DYNAMIC_ONLY
            else:
                fate = CULLED
        place = pixels.place[wave.pixel[i]]
        before = buffers.fates[place, light]
        buffers.fates[place, light] = max(before & FATE, fate) | (before & MOVING_SHADOW) | moving


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
