"""The two queries on a placed world: batches are cut into packets, and a packet is traced together or ray by ray.

The rays of a packet lie in vectors of sixteen.  Vectors whose rays head the same way go through the trees together, as
one group (`packet_tree`).  Each ray of the others goes its own way, for the nearest hits all at the same time
(`stream`), for any one after the other (`single_ray`).  The directions decide which.  A ray's answer does not depend on
the company it travels in, so that only time is at stake: to see how much, a world can be placed for
smaller packets.
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
from tracer.geometry.bvh8.placed import MOVING_TREE, read_world, tree_of, trees_asked
from tracer.geometry.bvh8.single_ray import ROOM, SINGLE_MEMORY, any_one_by_one
from tracer.geometry.bvh8.stream import STREAM_MEMORY, closest_in_stream
from tracer.geometry.queries import read_batch
from tracer.geometry.shared_memory import allocate, free
from tracer.runtime.kernels import inlined, native_callback
from tracer.simd import i64_at, load_i64, local_memory, lowest_bit, store


@inlined
def _closest_in_group(low, high, memory, group, tree, stack, count):
    """Nearest hits of a group of vectors in a tree; rays from one point share much of the work."""
    if _is_one_point(low, high):
        closest_in_tree(low, memory, group, tree, stack, count)
    else:
        closest_in_tree(None, memory, group, tree, stack, count)


@inlined
def _any_in_group(low, high, memory, group, tree, stack, occluder, count):
    """Whether the rays of a group meet anything in a tree; the block that the next group had better ask first."""
    if _is_one_point(low, high):
        return any_in_tree(low, memory, group, tree, stack, occluder, count)
    return any_in_tree(None, memory, group, tree, stack, occluder, count)


@inlined
def _is_one_point(low, high):
    return low[0] == high[0] and low[1] == high[1] and low[2] == high[2]


@inlined
def _trace(data, batch, first, last, counts, nearest):
    """Trace rays first to last - 1, for the nearest hits or else for any; the results go where the batch says.

    `nearest` is a constant, so that either query is compiled without the other."""
    memory, stack, count = local_memory(MEMORY), local_memory(STACK), i64_at(counts)
    alone = local_memory(SINGLE_MEMORY)
    stream = np.int64(0)  # half a megabyte, where it is wanted: more than the stack of some systems' threads can take
    which, world = read_batch(batch).which, read_world(data)
    trees, max_packet_size = world.trees if nearest else trees_asked(data, which), world.max_packet_size
    size = PACKET if max_packet_size == 1 else max_packet_size  # rays that go alone are read as many at a time
    occluders = local_memory(24)  # the last block met in each tree; block 0 is empty
    for number in range(3):
        store(occluders + 8 * number, np.int64(0))
    for start in range(first, last, size):
        # Read the packet, and see which of its vectors hold a ray to trace.
        n = min(size, last - start)
        vectors, low, high, finite = fill(memory, batch, start, n)
        todo, apart = open_vectors(memory, vectors), np.int64(0)
        while todo != 0:
            # Leave the first vector for later, or trace its rays one by one, if they have no direction in common.
            v = lowest_bit(todo)
            axis, way, together = lead_of(memory, v)
            if not (finite and together and max_packet_size > 1):
                if nearest:
                    apart |= np.int64(1) << v
                else:
                    any_one_by_one(memory, v, data, which, alone + ROOM, count)
                todo &= todo - 1
                continue
            # Send it through each tree, with all vectors that go the same way.
            group = group_of(memory, todo, axis, way)
            rest = trees
            while rest != 0:
                number = lowest_bit(rest)
                rest &= rest - 1
                tree = tree_of(data, number)
                if nearest:
                    _closest_in_group(low, high, memory, group, tree, stack, count)
                else:
                    occluder = load_i64(occluders + 8 * number)
                    occluder = _any_in_group(low, high, memory, group, tree, stack, occluder, count)
                    store(occluders + 8 * number, occluder)
                    if number != MOVING_TREE:
                        mark_static(memory, group.vectors)
            todo &= ~group.vectors
        if nearest and apart != 0:
            if stream == 0:
                stream = allocate(STREAM_MEMORY + 63)
            closest_in_stream(memory, apart, data, (stream + 63) & ~63, count)
        # Write the answers.
        if nearest:
            keep_hits(memory, batch, start, n)
        else:
            keep_blocked(memory, batch, start, n)
    if stream != 0:
        free(stream)


@native_callback
def closest(data, batch, first, last, counts):
    """Nearest hits of rays first to last - 1."""
    _trace(data, batch, first, last, counts, True)


@native_callback
def any_hit(data, batch, first, last, counts):
    """What of that which is asked for lies in the interval of rays first to last - 1."""
    _trace(data, batch, first, last, counts, False)
