"""References of a node that is not built yet: primitives, and groups that stand for what is in them.

A reference is an int32, the number of a primitive or ~ that of a group, with a box: that of what it stands for, within
the node.  Groups are opened where a plane cuts them; and where they are wide for their node, so that they say little
about where planes should be.  Which references a node gets depends on those of its parent alone, and never on who
builds it or when.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba import carray

from tracer.geometry.kdtree.build import clip_triangle, grown
from tracer.geometry.lazy_tree.shared_memory import allocate
from tracer.runtime.kernels import inlined, subkernel
from tracer.simd import f32_at, i32_at, load_i64, store
from tracer.simd.addresses import f64_at

WIDE = 0.0625  # of a node's extent: groups that reach so far along any axis are opened before a split is chosen
WAITING = 2048  # room for groups and primitives that are still to be looked at while one is opened

# A source, as kernels read it: int64 each.  Addresses of arrays, and what is counted while the tree is built.
(
    TRIANGLES, TRIANGLE_COUNT, QUADRIC_BOXES, QUADRIC_COUNT, GROUP_BOXES, GROUP_FIRST, GROUP_COUNTS, GROUP_WEIGHTS,
    GROUPS, TOUCHED, NODES, BYTES,
) = range(0, 96, 8)  # fmt: skip

# References in memory: how many, the primitives in them, the level of their node, the source; the node's box, six
# float64; boxes, six float32 each, and then the references, int32 each.
COUNT, WEIGHT, LEVEL, FROM, BOX, REFERENCES = 0, 8, 16, 24, 32, 80


class Source(NamedTuple):
    """What a tree is built over: triangles (t, 9) and the boxes (q, 6) of quadrics, float32, of which it holds some;
    and groups (g,) of those (`Hierarchy`)."""

    triangles: Any
    quadric_boxes: Any
    group_boxes: Any
    first: Any
    counts: Any
    weights: Any


class References(NamedTuple):
    """So many references: numbers (n,) int32 and boxes (n, 6) float32 or more, with the `weight` of primitives."""

    numbers: Any
    boxes: Any
    count: Any
    weight: Any


@inlined
def source_at(address):
    """The source whose table is at an address."""
    triangles, quadrics, groups = (
        load_i64(address + TRIANGLE_COUNT),
        load_i64(address + QUADRIC_COUNT),
        load_i64(address + GROUPS),
    )
    return Source(
        carray(f32_at(load_i64(address + TRIANGLES)), (triangles, 9)),
        carray(f32_at(load_i64(address + QUADRIC_BOXES)), (quadrics, 6)),
        carray(f32_at(load_i64(address + GROUP_BOXES)), (groups, 6)),
        carray(i32_at(load_i64(address + GROUP_FIRST)), (groups,)),
        carray(i32_at(load_i64(address + GROUP_COUNTS)), (groups,)),
        carray(i32_at(load_i64(address + GROUP_WEIGHTS)), (groups,)),
    )


@inlined
def references_at(address):
    """The references at an address, to be read only."""
    n = load_i64(address + COUNT)
    boxes = carray(f32_at(address + REFERENCES), (n, 6))
    return References(carray(i32_at(address + REFERENCES + 24 * n), (n,)), boxes, n, load_i64(address + WEIGHT))


@subkernel
def keep(references, box, level, source):
    """References in memory of their own, with what their node needs to be built: its address."""
    n = references.count
    address = allocate(REFERENCES + 28 * n)
    store(address + COUNT, np.int64(n))
    store(address + WEIGHT, np.int64(references.weight))
    store(address + LEVEL, np.int64(level))
    store(address + FROM, np.int64(source))
    corner, boxes, numbers = f64_at(address + BOX), f32_at(address + REFERENCES), i32_at(address + REFERENCES + 24 * n)
    for k in range(6):
        corner[k] = box[k]
    for i in range(n):
        numbers[i] = references.numbers[i]
        for k in range(6):
            boxes[6 * i + k] = references.boxes[i, k]
    return address


@inlined
def size_of_references(count):
    """The bytes of so many references in memory."""
    return REFERENCES + 28 * count


@subkernel
def _box_of(source, number, box):
    """Write the box (6,) float32 of a primitive or group."""
    if number < 0:
        for k in range(6):
            box[k] = source.group_boxes[~number, k]
    elif number < len(source.triangles):
        for k in range(3):
            a = source.triangles[number, k]
            b, c = a + source.triangles[number, k + 3], a + source.triangles[number, k + 6]
            box[k], box[k + 3] = min(a, min(b, c)), max(a, max(b, c))
    else:
        for k in range(6):
            box[k] = source.quadric_boxes[number - len(source.triangles), k]


@inlined
def weight_of(source, number):
    """How many primitives a reference stands for."""
    return np.int64(source.weights[~number]) if number < 0 else np.int64(1)


@subkernel
def _reaches(box, node, exactly):
    """Whether a box reaches into a node: what only touches it does not, but for what lies flat in its upper side; where
    not `exactly`, as for groups, it does."""
    for k in range(3):
        low, high = box[k], box[k + 3]
        if exactly:
            if not (high > node[k] and (low < node[k + 3] or (low == high and low == node[k + 3]))):
                return False
        elif not (high >= node[k] and low <= node[k + 3]):
            return False
    return True


@subkernel
def within(source, references, node, wide, everything):
    """The references that reach into a node's box (6,) float64, with their boxes in it.

    Groups are opened that a side of the node cuts; that reach farther than `wide` of its extent; and `everything`, all.
    """
    numbers, boxes = np.empty(max(64, references.count), np.int32), np.empty((max(64, references.count), 6), np.float32)
    waiting = np.empty(WAITING, np.int32)
    box, polygon, other = np.empty(6, np.float32), np.empty((12, 3)), np.empty((12, 3))
    count, weight = 0, np.int64(0)
    for i in range(references.count):
        waiting[0], left = references.numbers[i], 1
        given = True  # with a box of its own, not larger than that of what it stands for
        while left > 0:
            left -= 1
            number = waiting[left]
            if given:
                for k in range(6):
                    box[k] = references.boxes[i, k]
                given = False
            else:
                _box_of(source, number, box)
            if not _reaches(box, node, number >= 0):
                continue
            # Find out whether it lies in the node as a whole.
            inside, far = True, False
            for k in range(3):
                inside = inside and box[k] >= node[k] and box[k + 3] <= node[k + 3]
                far = far or box[k + 3] - box[k] > wide * (node[k + 3] - node[k])
            # Open a group that does not, or says too little.
            if number < 0 and (everything or far or not inside):
                group = ~number
                for child in range(source.counts[group]):
                    first = source.first[group]
                    waiting[left] = first + child if first >= 0 else ~(~first + child)
                    left += 1
                continue
            # Keep it, with its box in the node.
            if count == len(numbers):
                numbers, old = grown(numbers, count), boxes
                boxes = np.empty((len(numbers), 6), np.float32)
                for j in range(count):
                    for k in range(6):
                        boxes[j, k] = old[j, k]
            for k in range(3):
                boxes[count, k], boxes[count, k + 3] = (
                    max(box[k], np.float32(node[k])),
                    min(box[k + 3], np.float32(node[k + 3])),
                )
            if (
                not inside
                and number < len(source.triangles)
                and not clip_triangle(source.triangles, number, node, polygon, other, boxes, count)
            ):
                continue
            numbers[count] = number
            count += 1
            weight += weight_of(source, number)
    return References(numbers, boxes, count, weight)
