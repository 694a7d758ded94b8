"""From a binary tree to one of up to eight children a node, at the least expected cost.

A subtree may take one or more of the eight slots of a node above it.  Its cost in so many slots follows from the costs
of its two children in fewer, so that the cheapest way is found from the leaves up (Ylitie, Karras, Laine 2017).
Neighbouring leaves are joined to one block where that pays.
"""

from __future__ import annotations

import numpy as np

from tracer.geometry.wide_tree.binary import ITEM, NUMBER, WEIGHT, half_area
from tracer.geometry.wide_tree.topology import VACANT, WIDTH
from tracer.runtime.kernels import inlined, kernel, subkernel
from tracer.simd import address_of, load_i32, store

# Expected cost of a node and of a leaf to a ray that enters it, and of each triangle in a leaf.
NODE_COST, LEAF_COST, TRIANGLE_COST = 1.0, 0.5, 0.1
ONE_LEAF = 1  # in a plan: all below becomes one leaf where it has one slot
SHARE_BITS = 3  # in a plan, from bit SHARE_BITS * slots on: how many of these the lower child gets


@inlined
def _weight(node):
    """Weight of a leaf; of an inner node 0 or, once planned, the plan's complement."""
    return np.int64(load_i32(node + WEIGHT))


@inlined
def _share(plan, slots):
    return (plan >> (SHARE_BITS * slots)) & (WIDTH - 1)


@inlined
def _leaf_cost(area, weight):
    return area * (LEAF_COST + TRIANGLE_COST * weight)


@subkernel
def _plan_node(area, weight, lower, upper, result):
    """The plan of a node, and its costs in 1 to 7 slots, from those of its children."""
    plan = 0
    for slots in range(2, WIDTH + 1):
        result[slots] = np.inf
        for share in range(max(1, slots + 1 - WIDTH), min(slots, WIDTH)):
            cost = lower[share] + upper[slots - share]
            if cost < result[slots]:
                result[slots], best = cost, share
        plan |= best << (SHARE_BITS * slots)
    result[1] = NODE_COST * area + result[WIDTH]
    if weight <= WIDTH and _leaf_cost(area, weight) <= result[1]:
        result[1] = _leaf_cost(area, weight)
        plan |= ONE_LEAF
    for slots in range(2, WIDTH):
        if result[slots - 1] <= result[slots]:
            result[slots] = result[slots - 1]
            plan &= ~((WIDTH - 1) << (SHARE_BITS * slots))
    return plan


@kernel
def plan(binary, levels):
    """Write into every inner node of a binary tree how it is best divided among 1 to 8 slots.

    `levels` bounds the tree's depth.  A share of 0 means that one slot less is as good.
    """
    nodes = address_of(binary)
    costs, weights, result = np.empty((levels + 1, WIDTH)), np.empty(levels + 1, np.int64), np.empty(WIDTH + 1)
    stack = np.empty((2 * levels + 2, 2), np.int64)
    stack[0, 0], stack[0, 1] = 0, 0
    pending, done = 1, 0
    while pending > 0:
        pending -= 1
        number, children_done = stack[pending, 0], stack[pending, 1]
        node = nodes + ITEM * number
        # Price a leaf; come back to an inner node once both its children are priced.
        if _weight(node) > 0:
            weights[done], costs[done] = _weight(node), _leaf_cost(half_area(node), _weight(node))
            done += 1
        elif not children_done:
            stack[pending, 1] = 1
            stack[pending + 1, 0], stack[pending + 1, 1] = load_i32(node + NUMBER), 0
            stack[pending + 2, 0], stack[pending + 2, 1] = number + 1, 0
            pending += 3
        else:
            # Plan an inner node from the costs of its children.
            done -= 1
            weights[done - 1] += weights[done]
            planned = _plan_node(half_area(node), weights[done - 1], costs[done - 1], costs[done], result)
            store(node + WEIGHT, np.int32(~planned))
            for slots in range(1, WIDTH):
                costs[done - 1, slots] = result[slots]


@subkernel
def _children(nodes, root, found):
    """The descendants of a binary node that its plan makes children of a node of 8; how many."""
    found[0, 0], found[0, 1] = root, WIDTH
    count, i = 1, 0
    while i < count:
        number, slots = found[i, 0], found[i, 1]
        node = nodes + ITEM * number
        if _weight(node) > 0 or slots == 1:
            i += 1
            continue
        share = _share(~_weight(node), slots)
        if share == 0:
            found[i, 1] = slots - 1
        else:
            found[i, 0], found[i, 1] = number + 1, share
            found[count, 0], found[count, 1] = load_i32(node + NUMBER), slots - share
            count += 1
    return count


@subkernel
def _as_leaf(nodes, number):
    """First item and weight of a subtree that is to be one leaf."""
    node = nodes + ITEM * number
    while _weight(node) <= 0:
        node += ITEM
    first = load_i32(node + NUMBER)
    node = nodes + ITEM * number
    while _weight(node) <= 0:
        node = nodes + ITEM * load_i32(node + NUMBER)
    return first, load_i32(node + NUMBER) + _weight(node) - first


@kernel
def collapse(binary, children, leaves, levels):
    """Fill children and leaves, both with room for as many as there are items; (nodes, leaves) that were filled.

    `binary` are the nodes of a planned tree of at least one item, `levels` bounds its depth.
    """
    nodes = address_of(binary)
    found, stack = np.empty((WIDTH, 2), np.int64), np.empty((WIDTH * levels + WIDTH, 2), np.int64)
    stack[0, 0], stack[0, 1] = 0, -1
    node_count, leaf_count, pending = 0, 0, 1
    while pending > 0:
        pending -= 1
        node, node_count = node_count, node_count + 1
        if stack[pending, 1] >= 0:
            children[stack[pending, 1] // WIDTH, stack[pending, 1] % WIDTH] = node
        count = _children(nodes, stack[pending, 0], found)
        children[node] = VACANT
        for i in range(count - 1, -1, -1):
            weight = _weight(nodes + ITEM * found[i, 0])
            if weight > 0 or ~weight & ONE_LEAF:
                leaves[leaf_count, 0], leaves[leaf_count, 1] = _as_leaf(nodes, found[i, 0])
                children[node, i] = ~leaf_count
                leaf_count += 1
            else:
                stack[pending, 0], stack[pending, 1] = found[i, 0], WIDTH * node + i
                pending += 1
    return node_count, leaf_count
