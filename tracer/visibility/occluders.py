"""The tree of static primitives that may come between a light and a cell: 8-wide, with boxes that know a light.

Its shape is made once.  For each light every triangle's box is enlarged by how far from it float32 may still report a
hit (`error_bounds`), its error radius, and the boxes above follow.  Of a triangle in whose plane the light lies, as far
as float32 can tell, that is all of the box in which the structure reports hits.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.geometry.boxes import interval
from tracer.geometry.memory import without_refcount
from tracer.geometry.wide_tree.build import build_topology
from tracer.geometry.wide_tree.topology import VACANT, WIDTH, Topology
from tracer.runtime.kernels import inlined, kernel, subkernel
from tracer.simd import address_of, f32x16, i32x16, lane_numbers_x16, local_memory, maximum, minimum, select, store
from tracer.simd.records import I32, F32x2D, F32x3D, I32x2D
from tracer.visibility.error_bounds import (
    BOX,
    LANES,
    REPORTED,
    TWO,
    ZERO,
    SureHitLength,
    bounds,
    factors_of,
    rows_at,
    seen_from,
)
from tracer.visibility.light_space import put_light_space

BOXES = 6 * WIDTH  # float32 of a node: lower x of its eight children, then lower y and so on
BLOCK = 9 * WIDTH  # float32 of a leaf: corner and two edges of its triangles, x of all eight, then y and so on
NONE = -1  # instead of a primitive's number
STACK = 64 * 8 * 8  # bytes: nodes that wait on the deepest way down
FAR = np.float32(3e37)
DIAGONAL = np.float32(1.7321)  # of a cube, of its side
ROUNDED = 1e-6  # of the largest coordinate, by which boxes are larger for planes in float32


class Occluders(NamedTuple):
    """All static primitives, in any number of trees back to back.

    Attributes:
        rows: (primitives, ROW) float32, in world space, by number (`error_bounds`).
        first_quadric: rows from here on are those of quadrics.
        children: (nodes, 8) int32, as in a `Topology`.
        blocks: (leaves, BLOCK) float32, corners and edges of a leaf's triangles as structure of arrays.
        numbers: (leaves, 8) int32, a leaf's triangles, NONE for none; or one quadric.
        roots: (trees,) int32.
        boxes: (lights, nodes, BOXES) float32, of the children of each node.
        error_radii: (lights, n) float32, how far from each triangle a ray from the light can report a hit.
        leaf_radii: (lights, leaves, 8) float32, the same side by side for each leaf, negative for none.
        light_space: (lights, primitives, LIGHT_ROW) float32, or (lights, 0, LIGHT_ROW) where no ray tests candidates.
        farthest: how long rays may be to be certain of a hit.
    """

    rows: F32x2D
    first_quadric: int
    children: I32x2D
    blocks: F32x2D
    numbers: I32x2D
    roots: I32
    boxes: F32x3D
    error_radii: F32x2D
    leaf_radii: F32x3D
    light_space: F32x3D
    farthest: SureHitLength


def shape_of(
    triangles: NDArray[np.float32], boxes: NDArray[np.float32], numbers: NDArray[np.int32], threads: int
) -> Topology:
    """The shape of a tree over triangles (t, 9) and boxes (q, 6), whose primitives have these numbers (t + q,)."""
    shape = build_topology(np.ascontiguousarray(triangles), np.ascontiguousarray(boxes), np.zeros(2, np.int64), threads)
    return Topology(shape.children, shape.leaves, numbers[shape.order])


def joined(shapes: list[Topology]) -> tuple[Topology, NDArray[np.int32]]:
    """Several shapes as one, back to back, and the root of each, (n,) int32."""
    children, leaves, order, roots = [], [], [], []
    node = leaf = item = 0
    for shape in shapes:
        roots.append(node)
        moved = np.where(shape.children >= 0, shape.children + node, shape.children - leaf)
        children.append(np.where(shape.children == VACANT, VACANT, moved).astype(np.int32))
        leaves.append(shape.leaves + np.array([item, 0], np.int32))
        order.append(shape.order)
        node, leaf, item = node + len(shape.children), leaf + len(shape.leaves), item + len(shape.order)
    whole = Topology(np.concatenate(children), np.concatenate(leaves).astype(np.int32), np.concatenate(order))
    return whole, np.array(roots, np.int32)


@inlined
def error_radius(row, t, farthest, rounded):
    """How far from each of sixteen triangles, as columns of their rows and as seen, a ray no longer than `farthest` can
    report a hit; `rounded` more, for what is computed with it."""
    # |D| enters the bounds by the same part of itself, whatever it is: that is added at the end.
    m = bounds(factors_of(t), f32x16(TWO * farthest), farthest, t.highest, ZERO)
    depth = t.height - m.b
    part = maximum(m.u, maximum(m.v, m.w)) / depth + np.float32(1e-5)
    apart = part * (t.first + t.second) + (m.b / depth + np.float32(1e-6)) * farthest + t.corner_error
    apart = select(t.sure_side & (depth > ZERO), apart, FAR)

    # No hit is reported outside of the primitive's box: how far is that from the triangle, along an axis?
    room = f32x16(ZERO)
    for axis in range(3):
        corner, e1, e2 = row[axis], row[3 + axis], row[6 + axis]
        low, high = corner + minimum(ZERO, minimum(e1, e2)), corner + maximum(ZERO, maximum(e1, e2))
        room = maximum(room, maximum(high - row[BOX + axis], row[BOX + 3 + axis] - low))
    room = DIAGONAL * (room + np.float32(REPORTED) * t.away)
    return minimum(minimum(apart, room) + rounded, FAR)


@subkernel
def find_error_radii(rows, light, radius, farthest, rounded, radii):
    """Put how far from each of rows (n, ROW) a ray from a lamp, a ball around light (3,), can report a hit into radii
    (n rounded up to LANES,) float32 (`error_radius`)."""
    numbers, place = local_memory(64), (np.float32(light[0]), np.float32(light[1]), np.float32(light[2]))
    farthest, rounded = np.float32(farthest), np.float32(rounded)
    for first in range(0, len(rows), LANES):
        store(numbers, minimum(lane_numbers_x16() + np.int32(first), i32x16(np.int32(len(rows) - 1))))
        row = rows_at(rows, numbers)
        t = seen_from(place, np.float32(radius), row)
        store(address_of(radii) + 4 * first, error_radius(row, t, farthest, rounded))


@inlined
def _enclose(box, child, axis, low, high):
    """Let the box of a node's child reach from low to high along an axis, besides where it does already."""
    at = axis * WIDTH + child
    box[at], box[3 * WIDTH + at] = min(box[at], low), max(box[3 * WIDTH + at], high)


@subkernel
def _enclose_leaf(box, child, o, leaf, number, farthest):
    """Put a leaf's primitives, as a light sees them, into the box of a node's child; their error radii are put side by
    side."""
    room, leaf_radii = np.float32(REPORTED * farthest), o.leaf_radii[number, leaf]
    for k in range(WIDTH):
        i = o.numbers[leaf, k]
        leaf_radii[k] = -FAR
        if i == NONE:
            continue
        if i < o.first_quadric:
            leaf_radii[k] = o.error_radii[number, i]
        row, more = o.rows[i], leaf_radii[k]
        for axis in range(3):
            low, high = row[BOX + axis], row[BOX + 3 + axis]
            if i < o.first_quadric:
                least, most = interval(o.rows, i, axis)
                low, high = max(least - more, low - room), min(most + more, high + room)
            _enclose(box, child, axis, low, high)


@kernel
def enlarge_boxes(o, number, light, radius, farthest, largest):
    """Fit all boxes, and the light-space triangles, to light `number`, a ball of a radius around light (3,) float32.

    No ray from it is longer than `farthest`, and no coordinate larger than `largest`, in units of the scene."""
    o = without_refcount(o)
    boxes = o.boxes[number]
    find_error_radii(o.rows, light, radius, farthest, ROUNDED * largest, o.error_radii[number])
    if radius == 0.0:  # rays test candidates of points alone
        put_light_space(o.rows, o.farthest, light, o.light_space[number])
    boxes[:, : 3 * WIDTH], boxes[:, 3 * WIDTH :] = FAR, -FAR
    for node in range(len(o.children) - 1, -1, -1):  # children come after their parents
        for child in range(WIDTH):
            code = o.children[node, child]
            if code >= 0:
                for axis in range(3):
                    for k in range(axis * WIDTH, (axis + 1) * WIDTH):
                        _enclose(boxes[node], child, axis, boxes[code, k], boxes[code, 3 * WIDTH + k])
            elif code != VACANT:
                _enclose_leaf(boxes[node], child, o, ~code, number, farthest)


def blocks_of(
    shape: Topology, rows: NDArray[np.float32], first_quadric: int
) -> tuple[NDArray[np.float32], NDArray[np.int32]]:
    """blocks (leaves, BLOCK) and numbers (leaves, WIDTH) of a shape whose items are numbers of rows (n, ROW)."""
    first, count = shape.leaves.T
    count = np.where(shape.order[first] < first_quadric, count, 1)
    slots = first[:, None] + np.arange(WIDTH)
    there = np.arange(WIDTH) < count[:, None]
    numbers = np.where(there, shape.order[np.minimum(slots, len(shape.order) - 1)], NONE).astype(np.int32)
    triangles = there & (numbers < first_quadric)
    blocks = np.zeros((len(first), 9, WIDTH), np.float32)
    blocks.transpose(0, 2, 1)[triangles] = rows[numbers[triangles], :9]
    return blocks.reshape(-1, BLOCK), numbers
