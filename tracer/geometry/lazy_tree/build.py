"""Building a node of a tree when the first ray arrives (Hunt, Mark, Fussell 2007).

A node of many primitives is split once, and its children wait for rays of their own.  A node of few gets its whole
subtree, by the same rules as any kd-tree (`tracer.geometry.kdtree.build`).  Whoever claims a node builds it; who comes
meanwhile waits, which is short, as groups stand for most of what is in large nodes.
"""

from __future__ import annotations

import numpy as np
from numba import carray

from tracer.geometry.kdtree.build import INTERSECTION_COST, build_over
from tracer.geometry.lazy_tree.node import DEPTH, FIRST, HEADER, NODE, SUBTREE, Node, Subtree
from tracer.geometry.lazy_tree.references import (
    BOX,
    BYTES,
    NODES,
    WIDE,
    References,
    add_to,
    best_split,
    keep,
    read_header,
    references_at,
    size_of_references,
    source_at,
    weight_of,
    within,
)
from tracer.geometry.shared_memory import CLAIMED, UNBUILT, allocate, exchange, free, publish, read_shared
from tracer.runtime.kernels import kernel, native_callback, subkernel
from tracer.simd import as_i32, call_native, i32_at, load_i64, store
from tracer.simd.addresses import f64_at
from tracer.simd.records import writing

FEW = 64  # primitives whose whole subtree is built at once
PATIENCE = 64  # looks at a claimed node before another thread is let go on
_write_node, _write_subtree = writing(Node), writing(Subtree)


@subkernel
def _grow_subtree(source, found, box):
    """The subtree of primitives in memory of its own: its address, how many nodes it has, and its bytes."""
    n = found.count
    # Let triangles come first, as the builder wants them.
    numbers, boxes, flat = np.empty(n, np.int32), np.empty((n, 6), np.float32), 0
    for i in range(n):
        flat += found.numbers[i] < len(source.triangles)
    triangles = np.empty((flat, 9), np.float32)
    next_flat, next_round = 0, flat
    for i in range(n):
        number = found.numbers[i]
        if number < len(source.triangles):
            place, next_flat = next_flat, next_flat + 1
            for k in range(9):
                triangles[place, k] = source.triangles[number, k]
        else:
            place, next_round = next_round, next_round + 1
        numbers[place] = number
        for k in range(6):
            boxes[place, k] = found.boxes[i, k]
        source.touched[number] = 1
    words, items = build_over(boxes, box, triangles, np.zeros(2, np.int64))
    # Copy it to where it stays.
    size = HEADER + 4 * (len(words) + len(items))
    address = allocate(size)
    _write_subtree(address, Subtree(len(words), len(items)))
    to_words, to_items = i32_at(address + HEADER), i32_at(address + HEADER + 4 * len(words))
    for i in range(len(words)):
        to_words[i] = words[i]
    for i in range(len(items)):
        to_items[i] = numbers[items[i]]
    return address, len(words) // 2, size


@subkernel
def _unbuilt(node, references, box, level, source):
    """Write a node that waits for its first ray."""
    _write_node(node, Node(CLAIMED, 0, keep(references, box, level, source), 0))
    publish(node, UNBUILT)


@subkernel
def _split(node, source, table, wide, box, level):
    """Split a node in two that wait for rays; False where no split pays."""
    n, total = wide.count, wide.weight
    if level >= DEPTH or n == 0:
        return False
    weights = np.empty(n, np.int64)
    for i in range(n):
        weights[i] = weight_of(source, wide.numbers[i])
    cost, axis, plane = best_split(wide.boxes, weights, n, box)
    if not cost < INTERSECTION_COST * total:
        return False
    lower_box, upper_box = box.copy(), box.copy()
    lower_box[axis + 3] = upper_box[axis] = plane
    lower = within(source, wide, lower_box, np.inf, False)
    upper = within(source, wide, upper_box, np.inf, False)
    if lower.weight >= total and upper.weight >= total:
        return False
    children = allocate(2 * NODE)
    _unbuilt(children, lower, lower_box, level + 1, table)
    _unbuilt(children + NODE, upper, upper_box, level + 1, table)
    _write_node(node, Node(CLAIMED, as_i32(np.float32(plane)), children, children + NODE))
    add_to(source, NODES, 1)
    add_to(source, BYTES, size_of_references(lower.count) + size_of_references(upper.count) + 2 * NODE)
    publish(node, np.int64(axis))
    return True


@native_callback
def open_node(node, pause, _a, _b, _c):
    """Build the node at an address, or wait until whoever claimed it has built it.

    `pause` is the address of what lets another thread go on, or 0 where a system has nothing for it."""
    if not exchange(node, UNBUILT, CLAIMED):
        looks = 0
        while read_shared(node) == CLAIMED:
            looks += 1
            if looks % PATIENCE == 0 and pause != 0:
                call_native(pause, 0, 0, 0, 0, 0)
        return
    address = load_i64(node + FIRST)
    header, given = read_header(address), references_at(address)
    source = source_at(header.source)
    box = carray(f64_at(address + BOX), (6,)).copy()
    # Split it if it has many primitives and a split pays; else build all of it.
    done = False
    if given.weight > FEW:
        wide = within(source, given, box, WIDE, False)
        done = _split(node, source, header.source, wide, box, header.level)
    if not done:
        found = within(source, given, box, np.inf, True)
        subtree, nodes, size = _grow_subtree(source, found, box)
        store(node + FIRST, subtree)
        add_to(source, NODES, nodes)
        add_to(source, BYTES, size)
        publish(node, SUBTREE)
    add_to(source, BYTES, -size_of_references(given.count))
    free(address)


@kernel
def new_root(bounds, numbers, boxes, weight, table):
    """The address of a tree's root, which waits for its first ray: its box (6,) float64, references (n,) int32 with
    boxes (n, 6) float32 that stand for so many primitives, and the address of its source."""
    root = allocate(NODE)
    _unbuilt(root, References(numbers, boxes, len(numbers), weight), bounds, 0, table)
    add_to(source_at(table), BYTES, size_of_references(len(numbers)) + NODE)
    return root


@native_callback
def free_tree(root, _a, _b, _c, _d):
    """Free all memory of a tree."""
    waiting, pairs = np.empty(4 * DEPTH, np.int64), np.empty(4 * DEPTH, np.int64)
    waiting[0], pairs[0], left = root, root, 1
    while left > 0:
        # Copy a node, whose memory goes with the second of a pair.
        left -= 1
        node, pair = waiting[left], pairs[left]
        word, first = load_i64(node), load_i64(node + FIRST)
        if pair != 0:
            free(pair)
        if 0 <= word < SUBTREE:
            waiting[left], pairs[left] = first + NODE, first
            waiting[left + 1], pairs[left + 1] = first, np.int64(0)
            left += 2
        else:
            free(first)
