"""The queries on a placed world: batches cut into packets, and these traced together or ray by ray.

Vectors of a packet whose rays head the same way go through the trees together, the others ray by ray.
Which is which their directions say; as a ray's answer does not depend on who it travels with, nothing
but time hangs on that.
"""

from __future__ import annotations

import numpy as np

from tracer.geometry.bvh8.packet import (
    MEMORY,
    PACKET,
    fill,
    keep_blocked,
    keep_hits,
    mark_static,
    open_vectors,
)
from tracer.geometry.bvh8.packet_group import group_of, lead_of
from tracer.geometry.bvh8.packet_tree import STACK, any_in_tree, closest_in_tree
from tracer.geometry.bvh8.placed import MOVING_TREE, TREES, tree_of, trees_asked
from tracer.geometry.bvh8.single_ray import SINGLE_MEMORY, any_one_by_one, closest_one_by_one
from tracer.geometry.queries import WHICH
from tracer.kernels import entry, inlined
from tracer.simd import i64_at, load_i64, local_memory, lowest_bit, store


@inlined
def _from_one_point(low, high):
    return low[0] == high[0] and low[1] == high[1] and low[2] == high[2]


@entry
def closest(data, batch, first, last, counts):
    """Nearest hits of rays first to last - 1."""
    memory, stack, count = local_memory(MEMORY), local_memory(STACK), i64_at(counts)
    single_stack = local_memory(SINGLE_MEMORY) + SINGLE_MEMORY - STACK
    trees = load_i64(data + TREES)
    for start in range(first, last, PACKET):
        n = min(PACKET, last - start)
        vectors, low, high, finite = fill(memory, batch, start, n)
        todo = open_vectors(memory, vectors)
        while todo != 0:
            v = lowest_bit(todo)
            axis, way, together = lead_of(memory, v)
            if not (finite and together):
                closest_one_by_one(memory, v, data, single_stack, count)
                todo &= todo - 1
                continue
            group = group_of(memory, todo, axis, way)
            rest = trees
            while rest != 0:
                tree = tree_of(data, lowest_bit(rest))
                rest &= rest - 1
                if _from_one_point(low, high):
                    closest_in_tree(low, memory, group, tree, stack, count)
                else:
                    closest_in_tree(None, memory, group, tree, stack, count)
            todo &= ~group.vectors
        keep_hits(memory, batch, start, n)


@entry
def any_hit(data, batch, first, last, counts):
    """What of that which is asked for lies in the interval of rays first to last - 1."""
    memory, stack, count = local_memory(MEMORY), local_memory(STACK), i64_at(counts)
    single_stack = local_memory(SINGLE_MEMORY) + SINGLE_MEMORY - STACK
    which = load_i64(batch + WHICH)
    trees = trees_asked(data, which)
    occluders = local_memory(24)  # the last block met in each tree; block 0 is empty
    for number in range(3):
        store(occluders + 8 * number, np.int64(0))
    for start in range(first, last, PACKET):
        n = min(PACKET, last - start)
        vectors, low, high, finite = fill(memory, batch, start, n)
        todo = open_vectors(memory, vectors)
        while todo != 0:
            v = lowest_bit(todo)
            axis, way, together = lead_of(memory, v)
            if not (finite and together):
                any_one_by_one(memory, v, data, which, single_stack, count)
                todo &= todo - 1
                continue
            group = group_of(memory, todo, axis, way)
            rest = trees
            while rest != 0:
                number = lowest_bit(rest)
                rest &= rest - 1
                tree = tree_of(data, number)
                occluder = load_i64(occluders + 8 * number)
                if _from_one_point(low, high):
                    occluder = any_in_tree(low, memory, group, tree, stack, occluder, count)
                else:
                    occluder = any_in_tree(None, memory, group, tree, stack, occluder, count)
                store(occluders + 8 * number, occluder)
                if number != MOVING_TREE:
                    mark_static(memory, group.vectors)
            todo &= ~group.vectors
        keep_blocked(memory, batch, start, n)
