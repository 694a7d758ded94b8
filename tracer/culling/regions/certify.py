"""Which lights is a region left with?  All but those that a blocker hides from every point of it.

The tree of lights is descended.  The blockers that may hide a node are those that part its centre from the centre of
the region; what hid the last nodes is tried first, since a wall hides many.
"""

from __future__ import annotations

import numpy as np

from tracer.culling.regions.hidden import box_of, hides
from tracer.geometry.memory import borrowed
from tracer.runtime.kernels import inlined, kernel, subkernel
from tracer.simd import address_of, bits_of, f32x16, load_f32x16, lowest_bit, maximum, minimum

TRIED = 12  # blockers, for a node and a region, at most
RECENT = 4  # blockers that are tried before any are looked for
FIRST_ROOM = 4096  # leaves, to begin with
STACK = 64  # nodes that wait on the way down: no tree of 2^31 lights is deeper

STEPS, TESTS = range(2)  # counters: nodes visited, proofs tried
COUNTERS = 2


@inlined
def _row(at, k, point):
    """The k-th row of sixteen frames, at an address, at a point: a coordinate in each."""
    at += 256 * k
    x, y, z = np.float32(point[0]), np.float32(point[1]), np.float32(point[2])
    return load_f32x16(at) * x + load_f32x16(at + 64) * y + load_f32x16(at + 128) * z + load_f32x16(at + 192)


@inlined
def _parting(filters, group, region, lights):
    """Bits of the blockers of a group that part the centre of the region from that of the lights."""
    at, a, b = address_of(filters[group]), lights[0], region[0]
    above, below = _row(at, 2, a), _row(at, 2, b)
    part = above / (above - below)
    u, v = _row(at, 0, a), _row(at, 1, a)
    u, v = u + part * (_row(at, 0, b) - u), v + part * (_row(at, 1, b) - v)
    inside = (u > load_f32x16(at + 768)) & (v > load_f32x16(at + 832))
    inside = inside & (u < load_f32x16(at + 896)) & (v < load_f32x16(at + 960))
    return bits_of(inside & (above * below < np.float32(0)))


@inlined
def _between(around, sixteen, region, lights):
    """Bits of the groups whose box the line between both centres meets."""
    at, enter, leave = address_of(around[sixteen]), f32x16(np.float32(0)), f32x16(np.float32(1))
    inside = f32x16(np.float32(0)) == np.float32(0)
    for axis in range(3):
        a, d = np.float32(lights[0][axis]), np.float32(region[0][axis] - lights[0][axis])
        low, high = load_f32x16(at + 64 * axis) - a, load_f32x16(at + 192 + 64 * axis) - a
        if d == np.float32(0):
            inside = inside & (low <= np.float32(0)) & (high >= np.float32(0))
        else:
            inverse = np.float32(1) / d
            one, other = low * inverse, high * inverse
            enter, leave = maximum(enter, minimum(one, other)), minimum(leave, maximum(one, other))
    return bits_of(inside & (enter <= leave))


@subkernel
def hider(blockers, longest_sure, region, lights, recent, counts):
    """The blocker that hides a box of lights from a region, -1 for none.  recent (RECENT,) int32 are tried first."""
    for k in range(RECENT):
        counts[TESTS] += 1
        if hides(blockers, recent[k], region, lights, longest_sure):
            return np.int64(recent[k])
    tried = 0
    for sixteen in range(len(blockers.around)):
        groups = _between(blockers.around, sixteen, region, lights)
        while groups != 0:
            group = 16 * sixteen + lowest_bit(groups)
            groups &= groups - 1
            bits = _parting(blockers.filters, group, region, lights)
            while bits != 0:
                number = 16 * group + lowest_bit(bits)
                bits &= bits - 1
                counts[TESTS] += 1
                if hides(blockers, number, region, lights, longest_sure):
                    for k in range(RECENT - 1, 0, -1):
                        recent[k] = recent[k - 1]
                    recent[0] = number
                    return np.int64(number)
                tried += 1
                if tried == TRIED:
                    return np.int64(-1)
    return np.int64(-1)


@kernel
def leaves_left(tree, blockers, longest_sure, regions, starts, leaves, counts):
    """The leaves of a `LightTree` whose lights may shine on each of regions (n, 6) float64, lower and upper corners.

    Nodes are descended from those that are known to matter: starts (n, 2) int64 are the first and the last + 1 of each
    region's in leaves (m,) int32.  Returns (ends (n,) int64, found (k,) int32): the leaves of one region after those of
    another.  blockers are `Blockers`; counts (COUNTERS,) int64 are added to."""
    tree, blockers = borrowed(tree), borrowed(blockers)
    stack, recent = np.empty(STACK, np.int32), np.zeros(RECENT, np.int32)
    ends, found, end = np.empty(len(regions), np.int64), np.empty(FIRST_ROOM, np.int32), np.int64(0)
    for i in range(len(regions)):
        region = box_of(regions, i)
        for k in range(starts[i, 0], starts[i, 1]):
            stack[0], pending = leaves[k], 1
            while pending > 0:
                pending -= 1
                node = np.int64(stack[pending])
                counts[STEPS] += 1
                if hider(blockers, longest_sure, region, box_of(tree.boxes, node), recent, counts) >= 0:
                    continue
                child = tree.children[node]
                if child != 0:
                    stack[pending], stack[pending + 1] = child, child + 1
                    pending += 2
                    continue
                if end == len(found):
                    longer = np.empty(2 * len(found), np.int32)
                    for j in range(end):
                        longer[j] = found[j]
                    found = longer
                found[end] = node
                end += 1
        ends[i] = end
    return ends, found[:end]


@kernel
def hidden_from(blockers, longest_sure, region, lights):
    """The blocker that hides a box of lights from a region, the first of boxes (1, 6) float64 each; -1 for none."""
    blockers, uncounted, recent = borrowed(blockers), np.zeros(COUNTERS, np.int64), np.zeros(RECENT, np.int32)
    return hider(blockers, longest_sure, box_of(region, 0), box_of(lights, 0), recent, uncounted)
