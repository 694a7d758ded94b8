"""The upper nodes of the tree of a frame: splits at the borders of objects, and below them what never moves.

Objects are where they are now, so these nodes are made for each frame.  There are few: an object counts as a whole.
Where none reaches to, the smallest node of what never moves hangs that holds all of it there.  Which that is does not
depend on what rays have asked: nodes on the way to it are built.
"""

from __future__ import annotations

import math

import numpy as np

from tracer.geometry.kdtree.build import INTERSECTION_COST, TRAVERSAL_COST, split_cost
from tracer.geometry.lazy_tree.node import (
    DEPTH,
    FIRST,
    LOWER_MOVES,
    NODE,
    OBJECTS,
    PLANE,
    SECOND,
    SUBTREE,
    UPPER_MOVES,
    word_of,
)
from tracer.geometry.lazy_tree.references import best_split
from tracer.runtime.kernels import kernel, subkernel
from tracer.simd import address_of, as_i32, load_f32, load_i64

EACH = 8  # what an object costs that a ray must look for, in tests
BORDER = 4.0  # what a plane at an object's border costs: below both sides the same nodes are entered again


@subkernel
def _smallest(node, box, building):
    """The smallest node below this one that holds all of a box (6,) float64."""
    while True:
        axis = word_of(node, building)
        if axis >= SUBTREE:
            return node
        plane = load_f32(node + PLANE)
        if box[axis + 3] <= plane:
            node = load_i64(node + FIRST)
        elif box[axis] >= plane:
            node = load_i64(node + SECOND)
        else:
            return node


@subkernel
def _twice(rows, used):
    """A copy of rows (n, k) int64 with twice the room."""
    larger = np.empty((2 * len(rows), rows.shape[1]), np.int64)
    larger[:used] = rows[:used]
    return larger


@kernel
def raise_over(boxes, objects, moves, bounds, below, building):
    """Nodes (n, 4) int64 over objects (m,) int32 with boxes (m, 6) float32, inside bounds (6,) float64; the lists of
    objects, int32, that they lead to; and whether anything moves below the first.

    moves (m,) bool tells which do not rest; `below` is the address of the tree of what never moves."""
    m = len(boxes)
    most = min(int(10 + 2 * math.log2(max(m, 1))), DEPTH - 1)
    nodes, count = np.empty((64, 4), np.int64), 1  # children as numbers from 0 on, or ~ the address of what never moves
    listed, pool = np.empty(4 * m + 64, np.int32), np.empty((4 * m + 64, 1), np.int64)
    listed_count, top = 0, m
    todo, todo_box = np.empty((DEPTH + 4, 4), np.int64), np.empty((DEPTH + 4, 6))
    for i in range(m):
        pool[i, 0] = i
    todo[0, 0], todo[0, 1], todo[0, 2], todo[0, 3] = m, 0, 0, below
    todo_box[0] = bounds
    pending = 1
    inside, weights = np.empty((m, 6), np.float32), np.full(m, EACH, np.int64)
    moving = np.zeros(64, np.bool_)
    while pending > 0:
        # Take the next node; its objects are on top of the pool.
        pending -= 1
        n, level, node, static = todo[pending, 0], todo[pending, 1], todo[pending, 2], todo[pending, 3]
        box = todo_box[pending].copy()
        first = top - n
        for i in range(n):
            for k in range(3):
                inside[i, k] = max(boxes[pool[first + i, 0], k], np.float32(box[k]))
                inside[i, k + 3] = min(boxes[pool[first + i, 0], k + 3], np.float32(box[k + 3]))
        cost, axis, plane = np.inf, -1, 0.0
        if level < most:
            cost, axis, plane = best_split(inside[:n], weights, n, box)
            cost += BORDER
            # A plane of what never moves costs nothing, as rays would meet it anyway.
            own = word_of(static, building)
            if own < SUBTREE:
                its_plane = np.float64(load_f32(static + PLANE))
                lower, upper = np.int64(0), np.int64(0)
                for i in range(n):
                    low, high = inside[i, own], inside[i, own + 3]
                    lower += EACH if low < its_plane or low == high == its_plane else 0
                    upper += EACH if high > its_plane else 0
                its_cost = split_cost(box, own, its_plane, lower, upper) - TRAVERSAL_COST
                if its_cost < cost:
                    cost, axis, plane = its_cost, own, its_plane
        if not cost < INTERSECTION_COST * EACH * n:
            # End with a list of objects, beside what never moves.
            while listed_count + n + 1 > len(listed):
                listed = np.concatenate((listed, listed))
            nodes[node, 0], nodes[node, 1], nodes[node, 2], nodes[node, 3] = OBJECTS, 0, ~static, listed_count
            listed[listed_count] = n
            for i in range(n):
                listed[listed_count + 1 + i] = objects[pool[first + i, 0]]
                moving[node] |= moves[pool[first + i, 0]]
            listed_count += n + 1
            top = first
            continue
        # Split: a side without objects ends at what never moves, the other is gone on with.
        while count + 2 > len(nodes):
            nodes, old = _twice(nodes, count), moving
            moving = np.zeros(len(nodes), np.bool_)
            moving[: len(old)] = old
        nodes[node, 0], nodes[node, 1] = axis, as_i32(np.float32(plane))
        taken = pool[first:top, 0].copy()
        top = first
        for side in range(1, -1, -1):
            half, reached = box.copy(), 0
            half[axis if side else axis + 3] = plane
            while top + n > len(pool):
                pool = _twice(pool, top)
            for i in range(n):
                low, high = inside[i, axis], inside[i, axis + 3]
                if high > plane if side else (low < plane or low == high == plane):
                    pool[top + reached, 0] = taken[i]
                    reached += 1
            smallest = _smallest(static, half, building)
            if reached == 0:
                nodes[node, 2 + side] = ~smallest
                continue
            nodes[node, 2 + side] = count
            todo[pending, 0], todo[pending, 1], todo[pending, 2], todo[pending, 3] = reached, level + 1, count, smallest
            todo_box[pending] = half
            count, pending, top = count + 1, pending + 1, top + reached
    # Say where things move, children first, and turn numbers into addresses.
    result, lists = nodes[:count].copy(), listed[: max(1, listed_count)].copy()
    start = address_of(result)
    for node in range(count - 1, -1, -1):
        if result[node, 0] == OBJECTS:
            result[node, 2] = ~result[node, 2]
            result[node, 3] = address_of(lists) + 4 * result[node, 3]
            continue
        for side in range(2):
            child = result[node, 2 + side]
            if child >= 0 and moving[child]:
                moving[node] = True
                result[node, 0] |= UPPER_MOVES if side else LOWER_MOVES
            result[node, 2 + side] = start + NODE * child if child >= 0 else ~child
    return result, lists, moving[0]
