"""The tree of lights as a block of points sees it: without those that are proved to be hidden from all of its points.

The bound of Lightcuts takes all lights of a cluster to be visible, as nothing is known about them.  Here it is known of
some that they are not, from the regions that the points lie in (`tracer.neighbours.regions`): they are left out of
sums, boxes and representatives, so that a cluster that is hidden costs nothing, and one that is hidden in part is
bounded by what is left of it."""

from __future__ import annotations

import numpy as np

from tracer.runtime.kernels import inlined, subkernel
from tracer.shading.lightcuts.block import BLOCK


@subkernel
def see(looks, block, seen):
    """Put whether any point of a block must look at each lamp into seen (lamps,) bool; whether that has changed.

    looks (lamps, words) int64 have a bit for each vector; those of a block are eight of a word."""
    word, shift, changed = block.first >> 6, block.first & 63, False
    for lamp in range(len(looks)):
        now = np.uint8((looks[lamp, word] >> shift) & ((1 << BLOCK) - 1) != 0)
        changed |= now != seen[lamp]
        seen[lamp] = now
    return changed


@inlined
def _copy(part, node, child):
    """A node of which one child is left is that child."""
    part.children[node], part.reps[node], part.falls[node] = part.children[child], part.reps[child], part.falls[child]
    for c in range(3):
        part.colors[node, c] = part.colors[child, c]
    for c in range(6):
        part.boxes[node, c] = part.boxes[child, c]


@inlined
def _shines(colors, node):
    return colors[node, 0] + colors[node, 1] + colors[node, 2]


@subkernel
def leave_out_hidden(whole, chances, seen, part):
    """Make `part` the tree `whole` without the lights of lamps that are not seen; both are `Clusters`.

    Nodes keep their places; chances (n,) are those by which representatives are drawn."""
    for node in range(len(whole.children) - 1, -1, -1):
        child = np.int64(whole.children[node])
        if child == 0:
            light = whole.reps[node]
            there = seen[whole.owners[light]] != 0
            part.children[node], part.reps[node], part.falls[node] = 0, light, whole.falls[node]
            for c in range(3):
                part.colors[node, c] = whole.colors[node, c] if there else np.float32(0)
            for c in range(6):
                part.boxes[node, c] = whole.boxes[node, c]
            continue
        left, right = _shines(part.colors, child), _shines(part.colors, child + 1)
        if left == np.float32(0) or right == np.float32(0):
            _copy(part, node, child if right == np.float32(0) else child + 1)
            continue
        part.children[node], part.falls[node] = child, whole.falls[node]
        part.reps[node] = part.reps[child] if chances[node] * (left + right) < left else part.reps[child + 1]
        for c in range(3):
            part.colors[node, c] = part.colors[child, c] + part.colors[child + 1, c]
            part.boxes[node, c] = min(part.boxes[child, c], part.boxes[child + 1, c])
            part.boxes[node, 3 + c] = max(part.boxes[child, 3 + c], part.boxes[child + 1, 3 + c])
