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

from tracer.geometry.boxes import interval
from tracer.geometry.kdtree.build import best_binned_split, clip_triangle, grown, split_cost
from tracer.geometry.shared_memory import add_shared, allocate
from tracer.runtime.kernels import inlined, subkernel
from tracer.simd import address_of, f32_at, i32_at
from tracer.simd.addresses import f64_at
from tracer.simd.records import I32, I64, Bytes, F32x2D, block_size, reading, writing

WIDE = 0.0625  # of a node's extent: groups that reach so far along any axis are opened before a split is chosen
WAITING = 2048  # room for groups and primitives that are still to be looked at while one is opened

NODES, BYTES = 0, 1  # of what is counted while a tree grows


class Header(NamedTuple):
    """What stands before references in memory: how many they are, the primitives in them, the level of their node, and
    the address of their source.  The node's box follows, six float64; then boxes, six float32 each, and the references,
    int32 each."""

    number: int
    weight: int
    level: int
    source: int


BOX = block_size(Header)
REFERENCES = BOX + 6 * 8
read_header, _write_header = reading(Header), writing(Header)


class Source(NamedTuple):
    """What a tree is built over: triangles (t, 9) and the boxes (q, 6) of quadrics, of which it holds some; groups (g,)
    of those (`Hierarchy`); touched (t + q,) uint8, what has been built; and counts (2,), NODES and BYTES."""

    triangles: F32x2D
    quadric_boxes: F32x2D
    group_boxes: F32x2D
    first: I32
    counts: I32
    weights: I32
    touched: Bytes
    grown: I64


source_at = reading(Source)


@inlined
def add_to(source, what, number):
    """Add to NODES or BYTES."""
    add_shared(address_of(source.grown) + 8 * what, np.int64(number))


class References(NamedTuple):
    """So many references: numbers (n,) int32 and boxes (n, 6) float32 or more, with the `weight` of primitives."""

    numbers: Any
    boxes: Any
    count: Any
    weight: Any


@inlined
def references_at(address):
    """The references at an address, to be read only."""
    header = read_header(address)
    n, boxes = header.number, address + REFERENCES
    numbers = carray(i32_at(boxes + 24 * n), (n,))
    return References(numbers, carray(f32_at(boxes), (n, 6)), n, header.weight)


@subkernel
def keep(references, box, level, source):
    """References in memory of their own, with what their node needs to be built: its address."""
    n = references.count
    address = allocate(size_of_references(n))
    _write_header(address, Header(n, references.weight, level, source))
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
            box[k], box[k + 3] = interval(source.triangles, number, k)
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


FEW = 64  # references; each face of their boxes is tried


@subkernel
def _cost_at(boxes, weights, n, box, axis, plane):
    """What a split costs; what lies flat in the plane counts below it."""
    lower, upper = np.int64(0), np.int64(0)
    for j in range(n):
        low, high = boxes[j, axis], boxes[j, axis + 3]
        lower += weights[j] if low < plane or low == high == plane else np.int64(0)
        upper += weights[j] if high > plane else np.int64(0)
    return split_cost(box, axis, np.float64(plane), lower, upper)


@subkernel
def _best_face(boxes, weights, n, box):
    """(cost, axis, plane) over all faces of boxes (n, 6) in a node's box (6,)."""
    best_cost, best_axis, best_plane = np.inf, -1, 0.0
    for axis in range(3):
        for i in range(2 * n):
            plane = boxes[i >> 1, axis + 3 * (i & 1)]
            if not box[axis] < plane < box[axis + 3]:
                continue
            cost = _cost_at(boxes, weights, n, box, axis, plane)
            if cost < best_cost:
                best_cost, best_axis, best_plane = cost, axis, np.float64(plane)
    return best_cost, best_axis, best_plane


@subkernel
def _best_bin(boxes, weights, n, box):
    """(cost, axis, plane) over evenly spaced planes, and the faces next to the best."""
    best_cost, best_axis, best_plane = best_binned_split(boxes, weights, 0, n, box)
    if best_axis < 0:
        return best_cost, best_axis, best_plane
    # Move the plane to the nearest face on either side, between which it cuts the same references.
    below, above = np.float32(box[best_axis]), np.float32(box[best_axis + 3])
    for i in range(n):
        low, high = boxes[i, best_axis], boxes[i, best_axis + 3]
        for face in (low, high):
            below = max(below, face) if face <= best_plane else below
            above = min(above, face) if face >= best_plane else above
    for face in (below, above):
        if box[best_axis] < face < box[best_axis + 3]:
            cost = _cost_at(boxes, weights, n, box, best_axis, face)
            if cost <= best_cost:
                best_cost, best_plane = cost, np.float64(face)
    return best_cost, best_axis, best_plane


@subkernel
def best_split(boxes, weights, n, box):
    """(cost, axis, plane) of the cheapest split of a node's box (6,) float64, in which are boxes (n, 6) of so many
    primitives each, weights (n,) int64; infinite, -1 and 0 where there is none."""
    if n > FEW:
        return _best_bin(boxes, weights, n, box)
    return _best_face(boxes, weights, n, box)
