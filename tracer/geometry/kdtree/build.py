"""Building a kd-tree by the surface area heuristic.

A node's references lie on top of a pool that works as a stack.  To split a node, its references are popped, the
upper child's are pushed and then the lower child's, whose whole subtree is built before the upper child is on
top again.  Large nodes choose among 32 planes an axis by counting (Popov et al. 2006),
small ones sweep over every face of their boxes (MacDonald and Booth 1990).  A triangle that
straddles the plane is clipped to each side, so that its box there is exact (Wald and Havran 2006).
"""

from __future__ import annotations

import math

import numpy as np

from tracer.geometry.boxes import NO_BOX
from tracer.geometry.building import CANCELLED, DONE
from tracer.geometry.kdtree.tree import LEAF, MAX_DEPTH, Trees
from tracer.runtime.kernels import kernel, subkernel
from tracer.simd import as_i32

TRAVERSAL_COST = 1.0
INTERSECTION_COST = 0.8  # measured: below 1.4 a third fewer nodes, built faster, and frames no slower
EMPTY_BONUS = 0.8  # a split that cuts off empty space costs this much of its estimate
BINS = 32
SWEEP_BELOW = 48  # references; below it every plane is tried


@subkernel
def split_cost(box, axis, plane, lower, upper):
    """Expected cost of a ray in `box` (6,) when split, with so many references on either side."""
    b, c = (axis + 1) % 3, (axis + 2) % 3
    across, along = box[b + 3] - box[b], box[c + 3] - box[c]
    side, rest = across * along, across + along
    area = side + (box[axis + 3] - box[axis]) * rest
    lower_area = side + (plane - box[axis]) * rest
    upper_area = side + (box[axis + 3] - plane) * rest
    cost = TRAVERSAL_COST + INTERSECTION_COST * (lower_area * lower + upper_area * upper) / area
    return cost * EMPTY_BONUS if lower == 0 or upper == 0 else cost


@subkernel
def best_binned_split(boxes, weights, first, last, box):
    """(cost, axis, plane) over evenly spaced planes; counts are exact, from where boxes start and end.

    weights (n,) int64 say how many each box counts for; None for one each."""
    total = np.int64(last - first)
    if weights is not None:
        total = np.int64(0)
        for i in range(first, last):
            total += weights[i]
    best_cost, best_axis, best_plane = np.inf, -1, 0.0
    starts, ends = np.empty(BINS, np.int64), np.empty(BINS, np.int64)
    for axis in range(3):
        low, extent = box[axis], box[axis + 3] - box[axis]
        if not extent > 0.0:
            continue
        for b in range(BINS):
            starts[b], ends[b] = 0, 0
        scale = BINS / extent
        for i in range(first, last):
            weight = np.int64(1)
            if weights is not None:
                weight = weights[i]
            starts[min(max(int((boxes[i, axis] - low) * scale), 0), BINS - 1)] += weight
            ends[min(max(int((boxes[i, axis + 3] - low) * scale), 0), BINS - 1)] += weight
        lower, upper = np.int64(0), total
        for b in range(1, BINS):
            lower += starts[b - 1]
            upper -= ends[b - 1]
            plane = np.float64(np.float32(low + b * extent / BINS))
            if low < plane < box[axis + 3]:
                cost = split_cost(box, axis, plane, lower, upper)
                if cost < best_cost:
                    best_cost, best_axis, best_plane = cost, axis, plane
    return best_cost, best_axis, best_plane


@subkernel
def _insertion_sort(values, n):
    for i in range(1, n):
        x, j = values[i], i - 1
        while j >= 0 and values[j] > x:
            values[j + 1] = values[j]
            j -= 1
        values[j + 1] = x


@subkernel
def _best_swept_split(boxes, first, last, box):
    """(cost, axis, plane) over every face of the references' boxes; flat ones in a plane count below it."""
    best_cost, best_axis, best_plane = np.inf, -1, 0.0
    n = last - first
    starts, ends, flats = (
        np.empty(SWEEP_BELOW, np.float32),
        np.empty(SWEEP_BELOW, np.float32),
        np.empty(SWEEP_BELOW, np.float32),
    )
    for axis in range(3):
        flat_count = 0
        for i in range(n):
            starts[i], ends[i] = boxes[first + i, axis], boxes[first + i, axis + 3]
            if starts[i] == ends[i]:
                flats[flat_count] = starts[i]
                flat_count += 1
        _insertion_sort(starts, n)
        _insertion_sort(ends, n)
        _insertion_sort(flats, flat_count)
        begun, ended, flat = 0, 0, 0
        while ended < n:
            plane = starts[begun] if begun < n and starts[begun] < ends[ended] else ends[ended]
            lower = begun
            while begun < n and starts[begun] == plane:
                begun += 1
            while ended < n and ends[ended] == plane:
                ended += 1
            while flat < flat_count and flats[flat] <= plane:
                lower += flats[flat] == plane
                flat += 1
            if box[axis] < plane < box[axis + 3]:
                cost = split_cost(box, axis, np.float64(plane), lower, n - ended)
                if cost < best_cost:
                    best_cost, best_axis, best_plane = cost, axis, np.float64(plane)
    return best_cost, best_axis, best_plane


@subkernel
def _clip_below(polygon, n, axis, plane, sign, out):
    """Part of a convex polygon (n corners) where sign * (x[axis] - plane) <= 0 (Sutherland and Hodgman 1974)."""
    kept = 0
    for i in range(n):
        j = i + 1 if i + 1 < n else 0
        a, b = sign * (polygon[i, axis] - plane), sign * (polygon[j, axis] - plane)
        if a <= 0.0:
            for k in range(3):
                out[kept, k] = polygon[i, k]
            kept += 1
        if (a < 0.0 and b > 0.0) or (a > 0.0 and b < 0.0):
            t = a / (a - b)
            for k in range(3):
                out[kept, k] = polygon[i, k] + t * (polygon[j, k] - polygon[i, k])
            out[kept, axis] = plane
            kept += 1
    return kept


@subkernel
def clip_triangle(triangles, i, box, polygon, other, result, row):
    """Bounds of a triangle's part inside box, into a row of result (n, 6) float32; False where none is left.

    Bounds are rounded outwards by more than the clipping errs, and never leave the box.
    """
    for k in range(3):
        polygon[0, k] = triangles[i, k]
        polygon[1, k] = np.float64(triangles[i, k]) + triangles[i, k + 3]
        polygon[2, k] = np.float64(triangles[i, k]) + triangles[i, k + 6]
    n = 3
    for axis in range(3):
        n = _clip_below(polygon, n, axis, box[axis], -1.0, other)
        n = _clip_below(other, n, axis, box[axis + 3], 1.0, polygon)
    if n == 0:
        return False
    for k in range(3):
        low, high = np.inf, -np.inf
        for j in range(n):
            low, high = min(low, polygon[j, k]), max(high, polygon[j, k])
        if low < high:
            slack = 1e-6 * max(abs(low), abs(high))
            low, high = low - slack, high + slack
        result[row, k] = max(np.float32(low), np.float32(box[k]))
        result[row, k + 3] = min(np.float32(high), np.float32(box[k + 3]))
    return True


@subkernel
def _copy(prims, boxes, first, count, to_prims, to_boxes, to_first):
    """Copy `count` references."""
    for i in range(count):
        to_prims[to_first + i] = prims[first + i]
        for k in range(6):
            to_boxes[to_first + i, k] = boxes[first + i, k]


@subkernel
def grown(array, used):
    """A copy of numbers (n,) int32 with twice the room."""
    larger = np.empty(2 * len(array), np.int32)
    for i in range(used):
        larger[i] = array[i]
    return larger


@subkernel
def _partition(prims, boxes, first, last, box, axis, plane, triangles, side_prims, side_boxes, upper):
    """Copy the references on one side of a plane, clipped to it; how many they are."""
    count = 0
    side, polygon, other = np.empty(6), np.empty((12, 3)), np.empty((12, 3))
    for k in range(6):
        side[k] = box[k]
    side[axis if upper else axis + 3] = plane
    for i in range(first, last):
        low, high = boxes[i, axis], boxes[i, axis + 3]
        inside = high > plane if upper else (low < plane or (low == plane and high == plane))
        if not inside:
            continue
        _copy(prims, boxes, i, 1, side_prims, side_boxes, count)
        if low < plane and high > plane:
            side_boxes[count, axis if upper else axis + 3] = plane
            if prims[i] < len(triangles) and not clip_triangle(
                triangles, prims[i], side, polygon, other, side_boxes, count
            ):
                continue
        count += 1
    return count


@subkernel
def _best_split(boxes, first, last, box):
    if last - first > SWEEP_BELOW:
        return best_binned_split(boxes, None, first, last, box)
    return _best_swept_split(boxes, first, last, box)


@subkernel
def build_over(boxes, bounds, triangles, control):
    """Words (2 nodes,) int32 and items of a tree over boxes (n, 6); reference i is triangle i where there is one."""
    n = len(boxes)
    max_depth = min(int(8 + 1.5 * math.log2(max(n, 1))), MAX_DEPTH)
    words, items = np.empty(4 * n + 32, np.int32), np.empty(2 * n + 16, np.int32)
    prims, pool = np.empty(2 * n + 16, np.int32), np.empty((2 * n + 16, 6), np.float32)
    _copy(np.arange(n, dtype=np.int32), boxes, 0, n, prims, pool, 0)
    sides = np.empty(2 * n, np.int32)
    lower_prims, upper_prims = sides[:n], sides[n:]
    lower_boxes, upper_boxes = np.empty((n, 6), np.float32), np.empty((n, 6), np.float32)
    # Subtrees still to build, as on the pool: references, depth, the parent whose upper child it is, and box.
    todo, todo_box, box = np.empty((MAX_DEPTH + 4, 3), np.int64), np.empty((MAX_DEPTH + 4, 6)), np.empty(6)
    todo[0, 0], todo[0, 1], todo[0, 2] = n, 0, -1
    for k in range(6):
        todo_box[0, k] = bounds[k]
    pending, top, node_count, item_count = 1, n, 0, 0
    while pending > 0 and control[CANCELLED] == 0:
        # Take the next subtree, whose references are on top of the pool, and number its root.
        pending -= 1
        count, depth, parent = todo[pending, 0], todo[pending, 1], todo[pending, 2]
        for k in range(6):
            box[k] = todo_box[pending, k]
        first = top - count
        if 2 * node_count == len(words):
            words = grown(words, 2 * node_count)
        if parent >= 0:
            words[2 * parent + 1] |= node_count << 2
        node, node_count = node_count, node_count + 1
        # Look for the cheapest split; copy the references to its two sides if it costs less than a leaf.
        cost, axis, plane = np.inf, -1, 0.0
        if count > 1 and depth < max_depth:
            cost, axis, plane = _best_split(pool, first, top, box)
        lower, upper = 0, 0
        if cost < INTERSECTION_COST * count:
            lower = _partition(prims, pool, first, top, box, axis, plane, triangles, lower_prims, lower_boxes, False)
            upper = _partition(prims, pool, first, top, box, axis, plane, triangles, upper_prims, upper_boxes, True)
        # Make a leaf where no split pays.
        if lower + upper == 0 or (lower == count and upper == count):
            while item_count + count > len(items):
                items = grown(items, item_count)
            words[2 * node], words[2 * node + 1] = item_count, count << 2 | LEAF
            for i in range(count):
                items[item_count + i] = prims[first + i]
            item_count += count
            control[DONE] += count
            top = first
            continue
        # Push the upper child's references and then the lower child's, which is built next.
        while first + lower + upper > len(prims):
            prims, old = grown(prims, first), pool
            pool = np.empty((len(prims), 6), np.float32)
            _copy(prims, old, 0, first, prims, pool, 0)
        _copy(upper_prims, upper_boxes, 0, upper, prims, pool, first)
        _copy(lower_prims, lower_boxes, 0, lower, prims, pool, first + upper)
        top = first + upper + lower
        for k in range(6):
            todo_box[pending, k], todo_box[pending + 1, k] = box[k], box[k]
        todo[pending, 0], todo[pending, 1], todo[pending, 2] = upper, depth + 1, node
        todo_box[pending, axis] = plane
        todo[pending + 1, 0], todo[pending + 1, 1], todo[pending + 1, 2] = lower, depth + 1, -1
        todo_box[pending + 1, axis + 3] = plane
        pending += 2
        words[2 * node], words[2 * node + 1] = as_i32(np.float32(plane)), axis
    return words[: 2 * node_count], items[:item_count]


@kernel
def _build(boxes, bounds, triangles, control):
    return build_over(boxes, bounds, triangles, control)


def bounds_of(boxes: np.ndarray) -> np.ndarray:
    """Box (6,) float32 around boxes (n, 6), a little larger; an inverted one where there are none."""
    if not len(boxes):
        return NO_BOX.copy()
    lower, upper = boxes[:, :3].min(0), boxes[:, 3:].max(0)
    slack = 1e-5 * np.maximum(np.abs(lower), np.abs(upper)).max() + 1e-30
    return np.concatenate([lower - slack, upper + slack]).astype(np.float32)


def build_tree(boxes: np.ndarray, triangles: np.ndarray, control: np.ndarray | None = None) -> tuple[Trees, np.ndarray]:
    """A tree over boxes (n, 6) float32, and the box (6,) around it; items are numbers 0 to n - 1.

    The first len(triangles) boxes are those of triangles (rows of corner and two edges), which are
    clipped where a plane cuts them.  `control` (2,) int64: the build stops early, with a tree that
    is of no use, once control[CANCELLED] is set, and counts finished references in control[DONE].
    """
    control = np.zeros(2, np.int64) if control is None else control
    bounds = bounds_of(boxes)
    words, items = (a.copy() for a in _build(boxes, bounds.astype(np.float64), triangles, control))
    return Trees(words, words.view(np.float32), items), bounds
