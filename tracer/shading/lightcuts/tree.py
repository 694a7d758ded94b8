"""The tree of lights: every sample of a lamp is a light, and every node a cluster of those below it.

It is built from the top down: a node is parted where what is left of its error, the sum of both children's intensity
times the square of their diagonal, is least (the metric of section 4 of the paper, without cones as all lights shine
alike in all directions).  A node is represented by one of its lights, that of one of its children, drawn by their
intensities.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.runtime.kernels import inlined, kernel
from tracer.scene.lights import COLOR, FALLS_OFF, Lamps
from tracer.simd.records import I32, Bytes, F32x2D

BINS = 16  # along each axis
SEED = 2005


class CutTree(NamedTuple):
    """n nodes over l lights, which are the samples of all lamps; children come after their parents.

    Attributes:
        boxes: (n, 6) float32, the lower and the upper corner around the lights below.
        colors: (n, 3) float32, the sum of their colours; exactly the light's own for a leaf.
        children: (n,) int32, the first of two that follow each other, 0 for a leaf.
        reps: (n,) int32, the light that represents the node.
        falls: (n,) bool, whether the light falls off with the square of the distance.  Where some of a scene's lights
            do and others do not, the root alone is a cluster of both, and part of no cut.
        owners: (l,) int32, the lamp of each light.
        spans: (n, 2) int32, the first and the last + 1 of the lights below in `order`.
        order: (l,) int32, numbers of lights.
        chances: (n,) float32 from 0 to 1, by which representatives are drawn.
    """

    boxes: F32x2D
    colors: F32x2D
    children: I32
    reps: I32
    falls: Bytes
    owners: I32
    spans: NDArray[np.int32]
    order: NDArray[np.int32]
    chances: NDArray[np.float32]

    @property
    def bytes(self) -> int:
        """Memory that it takes, in bytes."""
        return sum(array.nbytes for array in self)


@inlined
def _bin_of(place, low, scale):
    """Which bin of an axis a coordinate falls in."""
    return max(0, min(BINS - 1, int((place - low) * scale)))


@kernel
def _part(places, brightness, order, first, last):
    """Sort lights order[first:last] into two parts; where the second begins.

    places (l, 3) and brightness (l,) float64."""
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for k in range(first, last):
        for axis in range(3):
            low[axis] = min(low[axis], places[order[k], axis])
            high[axis] = max(high[axis], places[order[k], axis])
    best, best_axis, best_bin = np.inf, -1, 0
    power, boxes = np.empty(BINS), np.empty((BINS, 6))
    after, box = np.empty(BINS), np.empty(6)
    for axis in range(3):
        if not high[axis] > low[axis]:
            continue
        scale = BINS / (high[axis] - low[axis])
        power[:] = 0.0
        boxes[:, :3] = np.inf
        boxes[:, 3:] = -np.inf
        for k in range(first, last):
            place = places[order[k]]
            b = _bin_of(place[axis], low[axis], scale)
            power[b] += brightness[order[k]]
            for c in range(3):
                boxes[b, c], boxes[b, 3 + c] = min(boxes[b, c], place[c]), max(boxes[b, 3 + c], place[c])
        for way in range(2):  # what lies after each border, then before it
            total, error = 0.0, 0.0
            box[:3], box[3:] = np.inf, -np.inf
            for step in range(BINS - 1):
                b = BINS - 1 - step if way == 0 else step
                total += power[b]
                for c in range(3):
                    box[c], box[3 + c] = min(box[c], boxes[b, c]), max(box[3 + c], boxes[b, 3 + c])
                error = 0.0
                if box[0] <= box[3]:
                    for c in range(3):
                        error += (box[3 + c] - box[c]) ** 2
                error *= total
                if way == 0:
                    after[b] = error
                elif error + after[b + 1] < best:
                    best, best_axis, best_bin = error + after[b + 1], axis, b
    if best_axis < 0:  # all in one place
        return (first + last) // 2
    scale, middle = BINS / (high[best_axis] - low[best_axis]), first
    for k in range(first, last):
        light = order[k]
        if _bin_of(places[light, best_axis], low[best_axis], scale) <= best_bin:
            order[k], order[middle] = order[middle], light
            middle += 1
    return middle if first < middle < last else (first + last) // 2


@kernel
def _topology(places, brightness, order, parted):
    """Children (n,) int32 and spans (n, 2) int32 of the tree over `order`, which is sorted; its root is parted at
    `parted` unless that is 0."""
    count = len(order)
    children, spans = np.zeros(2 * count - 1, np.int32), np.zeros((2 * count - 1, 2), np.int32)
    spans[0, 1] = count
    used = 1
    for node in range(2 * count - 1):
        first, last = spans[node, 0], spans[node, 1]
        if last - first > 1:
            middle = parted if node == 0 and parted > 0 else _part(places, brightness, order, first, last)
            children[node] = used
            spans[used, 0], spans[used, 1] = first, middle
            spans[used + 1, 0], spans[used + 1, 1] = middle, last
            used += 2
    return children, spans


@kernel
def _fill(places, rows, order, spans, children, chances, boxes, colors, reps):
    """Boxes, colours and representatives, from the leaves up: places (l, 3) float32, rows (l, 3) float64."""
    sums = np.zeros((len(children), 3))
    for node in range(len(children) - 1, -1, -1):
        child = np.int64(children[node])
        if child == 0:
            light = order[spans[node, 0]]
            reps[node] = light
            for c in range(3):
                boxes[node, c] = boxes[node, 3 + c] = places[light, c]
                sums[node, c] = rows[light, c]
        else:
            left, right = sums[child].sum(), sums[child + 1].sum()
            reps[node] = reps[child] if chances[node] * (left + right) < left or right == 0.0 else reps[child + 1]
            for c in range(3):
                boxes[node, c] = min(boxes[child, c], boxes[child + 1, c])
                boxes[node, 3 + c] = max(boxes[child, 3 + c], boxes[child + 1, 3 + c])
                sums[node, c] = sums[child, c] + sums[child + 1, c]
        for c in range(3):
            colors[node, c] = sums[node, c]


def build_cut_tree(lamps: Lamps) -> CutTree:
    """The tree over the samples of lamps, of which there is at least one."""
    counts = np.diff(lamps.first)
    owners = np.repeat(np.arange(len(counts), dtype=np.int32), counts)
    rows = lamps.rows[owners].astype(np.float64)
    falls = rows[:, FALLS_OFF] != 0.0
    order = np.argsort(falls, kind="stable").astype(np.int32)
    mixed = 0 < falls.sum() < len(falls)
    brightness = rows[:, COLOR : COLOR + 3].sum(1)
    parted = int((~falls).sum()) if mixed else 0
    children, spans = _topology(lamps.samples.astype(np.float64), brightness, order, parted)
    n = len(children)
    chances = np.random.default_rng(SEED).random(n).astype(np.float32)
    boxes, colors, reps = np.empty((n, 6), np.float32), np.empty((n, 3), np.float32), np.empty(n, np.int32)
    _fill(lamps.samples, rows[:, COLOR : COLOR + 3], order, spans, children, chances, boxes, colors, reps)
    return CutTree(boxes, colors, children, reps, falls[order[spans[:, 0]]], owners, spans, order, chances)
