"""Where a node is split whose references stand for many primitives each, by the surface area heuristic.

A group counts with all its primitives on each side that it reaches to.  Of few references every face is tried; of many,
planes at even distances, and then the faces next to the best: so planes come to lie between pieces of the scene.
"""

from __future__ import annotations

import numpy as np

from tracer.geometry.kdtree.build import best_binned_split, split_cost
from tracer.runtime.kernels import subkernel

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
