"""From triangles and boxes to a binary tree, by the surface area heuristic over bins (Wald 2007).

The items of a node lie together.  To split a node, its items are put into bins along each axis, by the centres of their
boxes.  The cheapest of all planes between bins is taken, and the items are copied, lower side first, to the same places
of a second array; its children's are copied back, and so on.  The cost of a side is counted in blocks of 8 triangles,
because a ray tests a block at once.  Leaves are smaller than blocks: which of them make one block is decided when the
tree is collapsed.

An item is eight float32: its lower corner, its upper corner *negated* (so that a box grows by one vector minimum), and,
as int32, its number and its weight: 1 for a triangle, 8 for what needs a leaf to itself.  A node is eight as well: its
box in the same form, then either WEIGHT 0 and the number of its upper child, or a leaf's weight and first item.  The
lower child follows its parent.  A tree over n items takes at most 2 n - 1 places.  The places of every subtree are set
aside in advance, so that any number of threads builds the same tree.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.geometry.boxes import interval
from tracer.geometry.building import CANCELLED
from tracer.geometry.wide_tree.topology import WIDTH
from tracer.runtime.kernels import inlined, kernel, subkernel
from tracer.simd import (
    address_of,
    f32x8,
    load_f32,
    load_f32x8,
    load_i32,
    load_i64,
    local_memory,
    maximum,
    minimum,
    store,
)

BINS, FEW = 16, 8  # so many items or fewer are put in as many bins
LEAF_WEIGHT = 2  # no more than that is not split, where nobody says otherwise
HUGE = np.float32(3e38)
TINY_EXTENT = np.float32(1e-30)  # centres closer together than this cannot be told apart
COSTS_SIZE, BINS_SIZE, WEIGHTS_SIZE = 4 * BINS, 96 * BINS, 24 * BINS  # bytes
ITEM = 32  # bytes of an item, a bin and a node
UPPER, NUMBER, WEIGHT = 12, 24, 28  # bytes into an item; a node has its upper child or first item at NUMBER
FIRST, LAST, NODE, DEPTH, SIDE = 0, 1, 2, 3, 4  # of a task: a range of items, its node, and the array they lie in


class Items(NamedTuple):
    """What a binary tree is built in.

    items (2, n + 1, 8) float32, twice the same places; order (n,) int32, numbers of items as leaves
    hold them; nodes (2 n, 8) float32.
    """

    items: NDArray[np.float32]
    order: NDArray[np.int32]
    nodes: NDArray[np.float32]


def make_items(count: int) -> Items:
    return Items(
        np.empty((2, count + 1, 8), np.float32), np.empty(count, np.int32), np.empty((2 * count, 8), np.float32)
    )


@inlined
def _put_side(item, axis, low, high):
    store(item + 4 * axis, low)
    store(item + UPPER + 4 * axis, -high)


@inlined
def _put_number(item, number, weight):
    store(item + NUMBER, np.int32(number))
    store(item + WEIGHT, np.int32(weight))


@kernel
def put_triangles(items, rows, first, last):
    """Triangles first to last - 1 of rows (t, 9), corner and two edges, become the items of those numbers."""
    for i in range(first, last):
        item = address_of(items.items) + ITEM * i
        for axis in range(3):
            low, high = interval(rows, i, axis)
            _put_side(item, axis, low, high)
        _put_number(item, i, 1)


@kernel
def put_boxes(items, boxes, first):
    """Boxes (n, 6) become items from `first` on, each of which will have a leaf to itself."""
    for i in range(len(boxes)):
        item = address_of(items.items) + ITEM * (first + i)
        for axis in range(3):
            _put_side(item, axis, boxes[i, axis], boxes[i, axis + 3])
        _put_number(item, first + i, WIDTH)


@subkernel
def half_area(box):
    """Half the surface of a box given as in an item, in float64."""
    x = np.float64(load_f32(box)) + load_f32(box + UPPER)
    y = np.float64(load_f32(box + 4)) + load_f32(box + UPPER + 4)
    z = np.float64(load_f32(box + 8)) + load_f32(box + UPPER + 8)
    return x * y + y * z + z * x


@subkernel
def _measure(first, last, node, low, high):
    """Weight of the items between two addresses.

    Their box goes to a node, the bounds of their centres, doubled, to low and high.
    """
    box, lower, upper, weight = f32x8(HUGE), f32x8(HUGE), f32x8(-HUGE), 0
    for item in range(first, last, ITEM):
        bounds = load_f32x8(item)
        centre = bounds - load_f32x8(item + UPPER)  # lower + upper; beyond the first three lanes nothing of use
        box = minimum(bounds, box)
        lower, upper = minimum(centre, lower), maximum(centre, upper)
        weight += load_i32(item + WEIGHT)
    store(node, box)
    store(low, lower)
    store(high, upper)
    return weight


@inlined
def _bin(item, axis, low, scale, count):
    """Which of so many bins an item belongs to; low is the axis's least centre, doubled."""
    centre = load_f32(item + 4 * axis) - load_f32(item + 4 * axis + UPPER)
    return min(max(int((centre - low) * scale), 0), count - 1)


@subkernel
def _fill_bins(first, last, low, scale, count, bins, weights):
    """Boxes and weights of the first `count` bins of all axes (3, BINS)."""
    for axis in range(3):
        for i in range(BINS * axis, BINS * axis + count):
            store(bins + ITEM * i, f32x8(HUGE))
            store(weights + 8 * i, 0)
    for item in range(first, last, ITEM):
        bounds, weight = load_f32x8(item), load_i32(item + WEIGHT)
        for axis in range(3):
            i = BINS * axis + _bin(item, axis, load_f32(low + 4 * axis), load_f32(scale + 4 * axis), count)
            store(bins + ITEM * i, minimum(bounds, load_f32x8(bins + ITEM * i)))
            store(weights + 8 * i, load_i64(weights + 8 * i) + weight)


@inlined
def _blocks(weight):
    return (weight + (WIDTH - 1)) // WIDTH


@subkernel
def _best_plane(count, bins, weights):
    """(axis, bin): the cheapest split is above that bin of that axis; axis -1 where all centres are one."""
    best, best_axis, best_bin = np.inf, -1, 0
    upper_costs, side = local_memory(COSTS_SIZE), local_memory(ITEM)
    for axis in range(3):
        row, row_weights = bins + ITEM * BINS * axis, weights + 8 * BINS * axis
        box, upper = f32x8(HUGE), 0
        for i in range(count - 1, 0, -1):
            box, upper = minimum(load_f32x8(row + ITEM * i), box), upper + load_i64(row_weights + 8 * i)
            store(side, box)
            store(upper_costs + 4 * i, np.float32(half_area(side) * _blocks(upper) if upper > 0 else np.inf))
        box, lower = f32x8(HUGE), 0
        for i in range(count - 1):
            box, lower = minimum(load_f32x8(row + ITEM * i), box), lower + load_i64(row_weights + 8 * i)
            if lower > 0:
                store(side, box)
                cost = half_area(side) * _blocks(lower) + load_f32(upper_costs + 4 * (i + 1))
                if cost < best:
                    best, best_axis, best_bin = cost, axis, i
    return best_axis, best_bin


@subkernel
def _partition(first, last, axis, plane, low, scale, count, target):
    """Copy the items between two addresses to `target`, those of bins above `plane` to its end; how many are not."""
    lower, upper = target, target + last - first - ITEM
    origin, factor = load_f32(low + 4 * axis), load_f32(scale + 4 * axis)
    for item in range(first, last, ITEM):
        above = _bin(item, axis, origin, factor, count) > plane
        store(upper if above else lower, load_f32x8(item))
        lower += 0 if above else ITEM
        upper -= ITEM if above else 0
    return (lower - target) // ITEM


@subkernel
def _halve(first, last, target):
    """Copy the items in their order and return the number of the lower half, whole blocks where there are several."""
    for item in range(first, last, ITEM):
        store(target + item - first, load_f32x8(item))
    count = (last - first) // ITEM
    half = (count + 1) // 2
    return half if count <= WIDTH else _blocks(half) * WIDTH


@subkernel
def _levels(count):
    """How often so many items must be halved until each is by itself."""
    levels = 0
    while count > 1 << levels:
        levels += 1
    return levels


@subkernel
def _split(first, last, low, high, target, halving):
    """Sort items to both sides of a plane; how many are on the lower one."""
    scale, bins, weights = local_memory(ITEM), local_memory(BINS_SIZE), local_memory(WEIGHTS_SIZE)
    count = BINS if last - first > ITEM * FEW else FEW
    for axis in range(3):
        extent = load_f32(high + 4 * axis) - load_f32(low + 4 * axis)
        store(scale + 4 * axis, np.float32(count) / extent if extent > TINY_EXTENT else np.float32(0))
    if not halving:
        _fill_bins(first, last, low, scale, count, bins, weights)
        axis, plane = _best_plane(count, bins, weights)
        if axis >= 0:
            return _partition(first, last, axis, plane, low, scale, count, target)
    return _halve(first, last, target)


@subkernel
def _put_task(todo, i, first, last, node, depth, side):
    todo[i, FIRST], todo[i, LAST], todo[i, NODE], todo[i, DEPTH], todo[i, SIDE] = first, last, node, depth, side


@kernel
def grow(items, todo, pending, splits, max_depth, leaf_weight, control):
    """Build subtrees from the top of the stack `todo` (max_depth + 2, 5) int64; how many are left on it.

    What weighs no more than `leaf_weight` is not split.  Stops after so many splits, or when control[CANCELLED] is set.
    """
    nodes, order = address_of(items.nodes), address_of(items.order)
    sides = (address_of(items.items), address_of(items.items) + ITEM * items.items.shape[1])
    low, high = local_memory(ITEM), local_memory(ITEM)
    while pending > 0 and splits > 0 and control[CANCELLED] == 0:
        pending -= 1
        first, last, number = todo[pending, FIRST], todo[pending, LAST], todo[pending, NODE]
        depth, side = todo[pending, DEPTH], todo[pending, SIDE]
        source, node = sides[side], nodes + ITEM * number
        start, end = source + ITEM * first, source + ITEM * last
        # Find the box of the node's items and the bounds of their centres.
        weight = _measure(start, end, node, low, high)
        # Make a leaf of few items.
        if weight <= leaf_weight or last - first == 1:
            for i in range(first, last):
                store(order + 4 * i, load_i32(source + ITEM * i + NUMBER))
            store(node + NUMBER, np.int32(first))
            store(node + WEIGHT, np.int32(weight))
            continue
        # Split the others; where the tree would become too deep, in the middle.
        halving = depth + _levels(last - first) >= max_depth
        middle = first + _split(start, end, low, high, sides[1 - side] + ITEM * first, halving)
        upper = number + 2 * (middle - first)
        store(node + NUMBER, np.int32(upper))
        store(node + WEIGHT, np.int32(0))
        _put_task(todo, pending, middle, last, upper, depth + 1, 1 - side)
        _put_task(todo, pending + 1, first, middle, number + 1, depth + 1, 1 - side)
        pending += 2
        splits -= 1
    return pending
