"""Cuts: for a block of 128 points, clusters that together are all lights, each with one light in its place.

A cut starts at the root, and its worst cluster is parted again and again, until none can be wrong by more than a given
part of what is estimated to arrive, at any point of the block, or the cut has as many clusters as it may.  One of the
parts keeps the representative of both, so that every ray that is traced counts for the cut at the end.  All points of
a block share a cut: rays from one light to all of them are one packet.

The bound of a cluster is taken at each point by itself, and the estimate too: so a block's cut is good enough for the
point that needs it most.
"""

from __future__ import annotations

import numpy as np

from tracer.culling.counters import CULLED, DUE, RAYS
from tracer.culling.shadow_testing import faces
from tracer.runtime.kernels import inlined, subkernel
from tracer.shading.lightcuts.block import DARK, POINTS, color_of, count_asked, is_dark, of_block, point_row, trace_rays
from tracer.shading.lightcuts.bounds import colored, greatest_light, mirrored_direction
from tracer.shading.lightcuts.drawn import ask_drawn
from tracer.shading.phong import fall_off, highlight, toward
from tracer.shading.points import DIFFUSE_ROW, EXPONENT_ROW, SHINE_ROW, SPECULAR_ROW
from tracer.shading.wave import row_of
from tracer.simd import (
    address_of,
    bits_of,
    f32x16,
    i32x16,
    lanes_below,
    largest,
    load_f32x16,
    load_spread_bytes16,
    load_three,
    mask16,
    maximum,
    ones,
    pack_three,
    select,
    store,
    store_three,
)

PASSES = 8  # over a cut, at most, in search of clusters that have become too coarse
ZERO = np.float32(0)


@inlined
def _kept(work, k, v, block):
    """Where a vector of the terms of the k-th representative lies; the specular ones are POINTS further on."""
    return address_of(work.kept) + 4 * (2 * POINTS * k + 16 * (v - block.first))


@subkernel
def ask_light(clusters, points, wave, block, light, k, work, counts):
    """Trace the rays from a light to the points of a block; the terms of those that it reaches become row k of
    `kept`."""
    place, row = clusters.samples[light], clusters.rows[clusters.owners[light]]
    stride, n, due = 4 * work.direction.shape[1], 0, np.int64(0)
    for v in range(block.first, block.last):
        faced = faces(points, place, v) & lanes_below(block.size, v)
        counts[DUE] += ones(faced)
        due += ones(faced)
        position, normal, way = (
            load_three(points.position, v),
            load_three(points.normal, v),
            load_three(wave.direction, v),
        )
        cosine, reached, mirrored, near = toward(place, position, normal, way, mask16(faced))
        shine, exponent = point_row(points, SHINE_ROW, v), point_row(points, EXPONENT_ROW, v)
        cosine, specular = fall_off(row, near, cosine, highlight(reached, shine, exponent, mirrored))
        at = _kept(work, k, v, block)
        store(at, select(reached, cosine, ZERO))
        store(at + 4 * POINTS, select(reached, specular, ZERO))
        x, y, z = load_three(points.lifted, v)
        direction = pack_three((x - place[0], y - place[1], z - place[2]), reached)
        store_three(address_of(work.direction) + 4 * n, stride, direction)
        count_asked(work, block, v, reached)
        n += ones(bits_of(reached))
    counts[RAYS] += n
    counts[CULLED] += due - n  # what faces away by its shading normal is dark anyway
    for at in range(0, 4 * n, 64):
        store_three(address_of(work.origin) + at, stride, (f32x16(place[0]), f32x16(place[1]), f32x16(place[2])))
    trace_rays(clusters, n, work, counts)
    n = 0
    for v in range(block.first, block.last):
        at = _kept(work, k, v, block)
        reached = load_f32x16(at) > ZERO
        blocked = load_spread_bytes16(address_of(work.blocked) + n, reached) > 0
        store(at, select(reached & ~blocked, load_f32x16(at), ZERO))
        store(at + 4 * POINTS, select(reached & ~blocked, load_f32x16(at + 4 * POINTS), ZERO))
        n += ones(bits_of(reached))


@subkernel
def add_to_estimate(points, block, k, color, work):
    """Add the k-th representative, in this colour, to the estimate."""
    for v in range(block.first, block.last):
        at, terms = of_block(work.estimate, v, block), _kept(work, k, v, block)
        diffuse, specular = load_f32x16(terms), load_f32x16(terms + 4 * POINTS)
        store(at, load_f32x16(at) + colored(points, color, diffuse, specular, v))


@subkernel
def error_of(clusters, points, block, k, work, adds):
    """The greatest part of the estimate that the k-th node of a cut may be wrong by at any point; 0 for a single light.

    Where it `adds`, the bound goes to that of the whole cut."""
    node, worst = np.int64(work.nodes[k]), f32x16(ZERO)
    if clusters.children[node] == 0:
        return ZERO
    box, color, falls = clusters.boxes[node], color_of(clusters.colors, node), clusters.falls[node] != 0
    for v in range(block.first, block.last):
        mirror = load_three(work.mirror, v - block.first)
        bound = greatest_light(points, mirror, box, color, falls, v)
        estimate = maximum(load_f32x16(of_block(work.estimate, v, block)), DARK)
        worst = maximum(worst, select(mask16(lanes_below(block.size, v)), bound / estimate, ZERO))
        if adds:
            at = of_block(work.bound, v, block)
            store(at, load_f32x16(at) + bound)
    return largest(worst)


# --- the nodes that may be parted, as a heap -------------------------------------------------------


@subkernel
def _push(work, size, k):
    """Add the k-th node of the cut to a heap of this size."""
    at = size
    while at > 0:
        parent = (at - 1) // 2
        if not work.keys[k] > work.keys[work.heap[parent]]:
            break
        work.heap[at] = work.heap[parent]
        at = parent
    work.heap[at] = k


@subkernel
def _pop(work, size):
    """Take the worst node out of a heap of this size."""
    worst, last, at = work.heap[0], work.heap[size - 1], 0
    while True:
        child = 2 * at + 1
        if child >= size - 1:
            break
        if child + 1 < size - 1 and work.keys[work.heap[child + 1]] > work.keys[work.heap[child]]:
            child += 1
        if not work.keys[work.heap[child]] > work.keys[last]:
            break
        work.heap[at] = work.heap[child]
        at = child
    work.heap[at] = last
    return np.int64(worst)


@subkernel
def begin_block(points, wave, block, work):
    """Nothing but ambient light is known to arrive yet."""
    for v in range(block.first, block.last):
        r, g, b = load_three(points.light, v)
        store(of_block(work.asked, v, block), i32x16(0))
        store(of_block(work.estimate, v, block), r + g + b)
        mirror = mirrored_direction(load_three(points.normal, v), load_three(wave.direction, v))
        store_three(of_block(work.mirror, v, block), 4 * work.mirror.shape[1], mirror)


@subkernel
def _start(clusters, draws, points, wave, place, block, node, k, work, counts):
    """Let a node be the k-th of the cut."""
    work.nodes[k] = node
    if len(draws.order) > 0:
        ask_drawn(clusters, draws, points, wave, place, block, k, k, node, node, node, work, counts)
    else:
        ask_light(clusters, points, wave, block, clusters.reps[node], k, work, counts)
        add_to_estimate(points, block, k, color_of(clusters.colors, node), work)


@subkernel
def _part(clusters, draws, points, wave, place, block, k, count, work, counts):
    """Part the k-th node of a cut of `count` nodes; whether there is one more now."""
    node = np.int64(work.nodes[k])
    child = np.int64(clusters.children[node])
    if len(draws.order) > 0:
        work.nodes[k], work.nodes[count] = child, child + 1
        ask_drawn(clusters, draws, points, wave, place, block, k, count, node, child, child + 1, work, counts)
        return True
    # One of the children has the node's representative.
    other = child + 1 if clusters.reps[child] == clusters.reps[node] else child
    child = child + 1 if other == child else child
    r, g, b = color_of(clusters.colors, node)
    cr, cg, cb = color_of(clusters.colors, child)
    work.nodes[k] = child
    add_to_estimate(points, block, k, (cr - r, cg - g, cb - b), work)
    if is_dark(clusters.colors, other):
        return False
    _start(clusters, draws, points, wave, place, block, other, count, work, counts)
    return True


@subkernel
def refine(clusters, draws, points, wave, place, block, error, limit, work, counts):
    """Find a cut of up to `limit` nodes, none of which may be wrong by more than the part `error`; how many it has.

    place (n,) int32 are the pixels of the tile in the picture, for representatives that are drawn."""
    begin_block(points, wave, block, work)
    count, size, child = 0, 0, np.int64(clusters.children[0])
    both = child != 0 and clusters.falls[child] != clusters.falls[child + 1] and limit > 1
    for node in range(child if both else 0, child + 2 if both else 1):
        if not is_dark(clusters.colors, node):
            _start(clusters, draws, points, wave, place, block, node, count, work, counts)
            count += 1
    for _ in range(PASSES):
        for v in range(block.first, block.last):
            store(of_block(work.bound, v, block), f32x16(ZERO))
        for k in range(count):
            work.keys[k] = error_of(clusters, points, block, k, work, True)
            if work.keys[k] > error:
                _push(work, size, k)
                size += 1
        if size == 0 or count >= limit:
            break
        while size > 0 and count < limit:
            k = _pop(work, size)
            size -= 1
            added = _part(clusters, draws, points, wave, place, block, k, count, work, counts)
            work.keys[k] = error_of(clusters, points, block, k, work, False)
            if work.keys[k] > error:
                _push(work, size, k)
                size += 1
            if added:
                work.keys[count] = error_of(clusters, points, block, count, work, False)
                if work.keys[count] > error:
                    _push(work, size, count)
                    size += 1
                count += 1
        size = 0
    return count


@subkernel
def sort_by_light(clusters, work, count):
    """The numbers of a cut's nodes in the order of their lights, in the memory of the heap (Shell 1959)."""
    for k in range(count):
        work.heap[k] = k
    gap = count // 2
    while gap > 0:
        for k in range(gap, count):
            moved, at = work.heap[k], k
            light = clusters.reps[work.nodes[moved]]
            while at >= gap and clusters.reps[work.nodes[work.heap[at - gap]]] > light:
                work.heap[at] = work.heap[at - gap]
                at -= gap
            work.heap[at] = moved
        gap //= 2


@subkernel
def shade_block(clusters, points, block, count, work):
    """Add what the nodes of a cut send to the light of a block's points, in the order of lights."""
    sort_by_light(clusters, work, count)
    for v in range(block.first, block.last):
        for c in range(3):
            at = row_of(points.light, c) + 64 * v
            light = load_f32x16(at)
            diffuse, specular = point_row(points, DIFFUSE_ROW + c, v), point_row(points, SPECULAR_ROW + c, v)
            for nth in range(count):
                k = np.int64(work.heap[nth])
                terms, color = _kept(work, k, v, block), clusters.colors[work.nodes[k], c]
                local = diffuse * load_f32x16(terms) + specular * load_f32x16(terms + 4 * POINTS)
                light = light + color * local
            store(at, light)
