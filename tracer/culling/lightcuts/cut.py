"""Cuts: for a block of 128 points, clusters that together are all lights, each with one light in its place.

A cut starts at the root, and its worst cluster is parted again and again, until none can be wrong by more than a given
part of what is estimated to arrive, at any point of the block, or the cut has as many clusters as it may.  One of the
parts keeps the representative of both, so that every ray that is traced counts for the cut at the end.  All points of
a block share a cut: rays from one light to all of them are one packet.

The bound of a cluster is taken at each point by itself, and the estimate too: so a block's cut is good enough for the
point that needs it most.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tracer.culling.counters import CULLED, DUE, RAYS
from tracer.culling.lightcuts.bounds import colored, greatest_light, mirrored_direction
from tracer.culling.shadow_testing import faces
from tracer.geometry.queries import EVERYTHING, any_hits
from tracer.geometry.rays import Rays
from tracer.kernels import inlined, subkernel
from tracer.shading.phong import fall_off, highlight, toward
from tracer.shading.points import DIFFUSE_ROW, EXPONENT_ROW, SHINE_ROW, SPECULAR_ROW
from tracer.shading.wave import row_of
from tracer.simd import (
    address_of,
    bits_of,
    f32x16,
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
from tracer.simd.records import F32, I32, Bytes, F32x2D

BLOCK = 8  # vectors of sixteen points
POINTS = 16 * BLOCK
ROOM = POINTS + 16  # rays of a block, and a vector to spare
DARK = np.float32(3 / 64)  # sum of three channels: of what is darker, errors are parts of this
PASSES = 8  # over a cut, at most, in search of clusters that have become too coarse
ZERO = np.float32(0)


class Clusters(NamedTuple):
    """The tree, as in `CutTree`, with the samples (l, 3) and the rows (lamps, 4) of lamps, and the query of the
    structure that rays are asked of (`tracer.geometry.queries`)."""

    boxes: F32x2D
    colors: F32x2D
    children: I32
    reps: I32
    falls: Bytes
    owners: I32
    samples: F32x2D
    rows: F32x2D
    any_hit: int
    data: int


class CutWork(NamedTuple):
    """Memory of one worker for one block and cuts of up to m nodes.

    origin and direction (3, ROOM), t_min and t_max (ROOM,), blocked (ROOM,): a packet of rays.  kept (m, 2 POINTS): the
    diffuse and the specular term of each representative at each point that it reaches.  mirror (3, POINTS).  estimate
    and bound (POINTS,): the sum over the channels of what arrives at each point, and by what it may be wrong.  nodes,
    heap, keys and tells (m,): the cut, those of its nodes that may be parted, the worst first, by what part of the
    estimate each is wrong, and at which vector."""

    origin: F32x2D
    direction: F32x2D
    t_min: F32
    t_max: F32
    blocked: Bytes
    kept: F32x2D
    mirror: F32x2D
    estimate: F32
    bound: F32
    nodes: I32
    heap: I32
    keys: F32
    tells: I32


class Block(NamedTuple):
    """Vectors `first` to `last` - 1 of the points of a wave, of which there are `count`."""

    first: int
    last: int
    count: int


@inlined
def _kept(work, k, v, block):
    """Where a vector of the terms of the k-th representative lies; the specular ones are POINTS further on."""
    return address_of(work.kept) + 4 * (2 * POINTS * k + 16 * (v - block.first))


@inlined
def _of_block(row, v, block):
    return address_of(row) + 64 * (v - block.first)


@inlined
def color_of(colors, node):
    """The colour of a cluster."""
    return colors[node, 0], colors[node, 1], colors[node, 2]


@subkernel
def ask_light(clusters, points, wave, block, light, k, work, counts):
    """Trace the rays from a light to the points of a block; the terms of those that it reaches become row k of
    `kept`."""
    place, row = clusters.samples[light], clusters.rows[clusters.owners[light]]
    stride, n, due = 4 * work.direction.shape[1], 0, np.int64(0)
    for v in range(block.first, block.last):
        faced = faces(points, place, v) & lanes_below(block.count, v)
        counts[DUE] += ones(faced)
        due += ones(faced)
        position, normal, way = (
            load_three(points.position, v),
            load_three(points.normal, v),
            load_three(wave.direction, v),
        )
        cosine, reached, mirrored, near = toward(place, position, normal, way, mask16(faced))
        shine, exponent = _point(points, SHINE_ROW, v), _point(points, EXPONENT_ROW, v)
        cosine, specular = fall_off(row, near, cosine, highlight(reached, shine, exponent, mirrored))
        at = _kept(work, k, v, block)
        store(at, select(reached, cosine, ZERO))
        store(at + 4 * POINTS, select(reached, specular, ZERO))
        x, y, z = load_three(points.lifted, v)
        direction = pack_three((x - place[0], y - place[1], z - place[2]), reached)
        store_three(address_of(work.direction) + 4 * n, stride, direction)
        n += ones(bits_of(reached))
    counts[RAYS] += n
    counts[CULLED] += due - n  # what faces away by its shading normal is dark anyway
    if n == 0:
        return
    for at in range(0, 4 * n, 64):
        store_three(address_of(work.origin) + at, stride, (f32x16(place[0]), f32x16(place[1]), f32x16(place[2])))
    rays = Rays(work.origin, work.direction, work.t_min, work.t_max)
    any_hits(clusters, rays, EVERYTHING, work.blocked, 0, n, counts)
    n = 0
    for v in range(block.first, block.last):
        at = _kept(work, k, v, block)
        reached = load_f32x16(at) > ZERO
        blocked = load_spread_bytes16(address_of(work.blocked) + n, reached) > 0
        store(at, select(reached & ~blocked, load_f32x16(at), ZERO))
        store(at + 4 * POINTS, select(reached & ~blocked, load_f32x16(at + 4 * POINTS), ZERO))
        n += ones(bits_of(reached))


@inlined
def _point(points, row, v):
    return load_f32x16(row_of(points.memory, row) + 64 * v)


@subkernel
def add_to_estimate(points, block, k, color, work):
    """Add the k-th representative, in this colour, to the estimate."""
    for v in range(block.first, block.last):
        at, terms = _of_block(work.estimate, v, block), _kept(work, k, v, block)
        diffuse, specular = load_f32x16(terms), load_f32x16(terms + 4 * POINTS)
        store(at, load_f32x16(at) + colored(points, color, diffuse, specular, v))


@inlined
def _worst_of(clusters, points, block, node, v, work, adds):
    """The greatest part of the estimate that a cluster may be wrong by at any point of a vector."""
    mirror = load_three(work.mirror, v - block.first)
    color, falls = color_of(clusters.colors, node), clusters.falls[node] != 0
    bound = greatest_light(points, mirror, clusters.boxes[node], color, falls, v)
    if adds:
        at = _of_block(work.bound, v, block)
        store(at, load_f32x16(at) + bound)
    estimate = maximum(load_f32x16(_of_block(work.estimate, v, block)), DARK)
    return largest(select(mask16(lanes_below(block.count, v)), bound / estimate, ZERO))


@subkernel
def is_coarse(clusters, points, block, k, error, work):
    """Whether the k-th node of a cut may be wrong by more than the part `error` at any point, with that as its key.

    One vector tells: that which has told of the node that it is a part of is asked first."""
    node, many = np.int64(work.nodes[k]), block.last - block.first
    if clusters.children[node] == 0:
        return False
    for n in range(many):
        v = block.first + (work.tells[k] + n) % many
        worst = _worst_of(clusters, points, block, node, v, work, False)
        if worst > error:
            work.keys[k], work.tells[k] = worst, v - block.first
            return True
    return False


@subkernel
def error_of(clusters, points, block, k, work):
    """The greatest part of the estimate that the k-th node of a cut may be wrong by at any point; 0 for a single light.
    Its bound goes to that of the whole cut."""
    node, most = np.int64(work.nodes[k]), ZERO
    if clusters.children[node] == 0:
        return most
    for v in range(block.first, block.last):
        worst = _worst_of(clusters, points, block, node, v, work, True)
        if worst > most:
            most, work.tells[k] = worst, v - block.first
    return most


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
        store(_of_block(work.estimate, v, block), r + g + b)
        mirror = mirrored_direction(load_three(points.normal, v), load_three(wave.direction, v))
        store_three(_of_block(work.mirror, v, block), 4 * work.mirror.shape[1], mirror)


@inlined
def is_dark(colors, node):
    """Whether nothing of a cluster shines."""
    return colors[node, 0] == ZERO and colors[node, 1] == ZERO and colors[node, 2] == ZERO


@subkernel
def refine(clusters, points, wave, block, error, limit, work, counts):
    """Find a cut of up to `limit` nodes, none of which may be wrong by more than the part `error`; how many it has."""
    begin_block(points, wave, block, work)
    count, size, root = 0, 0, 0
    child = np.int64(clusters.children[0])
    both = child != 0 and clusters.falls[child] != clusters.falls[child + 1]
    for k in range(2 if both else 1):
        node = child + k if both else root
        if is_dark(clusters.colors, node):
            continue
        work.nodes[count] = node
        ask_light(clusters, points, wave, block, clusters.reps[node], count, work, counts)
        add_to_estimate(points, block, count, color_of(clusters.colors, node), work)
        count += 1
    for _ in range(PASSES):
        for v in range(block.first, block.last):
            store(_of_block(work.bound, v, block), f32x16(ZERO))
        for k in range(count):
            work.keys[k] = error_of(clusters, points, block, k, work)
            if work.keys[k] > error:
                _push(work, size, k)
                size += 1
        if size == 0 or count >= limit:
            break
        while size > 0 and count < limit:
            k = _pop(work, size)
            size -= 1
            node = np.int64(work.nodes[k])
            # Part it: one of its children has its representative.
            child = np.int64(clusters.children[node])
            other = child + 1 if clusters.reps[child] == clusters.reps[node] else child
            child = child + 1 if other == child else child
            r, g, b = color_of(clusters.colors, node)
            cr, cg, cb = color_of(clusters.colors, child)
            work.nodes[k] = child
            add_to_estimate(points, block, k, (cr - r, cg - g, cb - b), work)
            added = not is_dark(clusters.colors, other)
            if added:
                work.nodes[count] = other
                ask_light(clusters, points, wave, block, clusters.reps[other], count, work, counts)
                add_to_estimate(points, block, count, color_of(clusters.colors, other), work)
                count += 1
            if is_coarse(clusters, points, block, k, error, work):
                _push(work, size, k)
                size += 1
            if added:
                work.tells[count - 1] = work.tells[k]
                if is_coarse(clusters, points, block, count - 1, error, work):
                    _push(work, size, count - 1)
                    size += 1
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
            diffuse, specular = _point(points, DIFFUSE_ROW + c, v), _point(points, SPECULAR_ROW + c, v)
            for nth in range(count):
                k = np.int64(work.heap[nth])
                terms, color = _kept(work, k, v, block), clusters.colors[work.nodes[k], c]
                local = diffuse * load_f32x16(terms) + specular * load_f32x16(terms + 4 * POINTS)
                light = light + color * local
            store(at, light)
