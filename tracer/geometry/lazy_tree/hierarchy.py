"""What stands for many primitives while a tree is built: groups of primitives, and groups of such groups.

A group never holds parts of two pieces of a file unless it holds both as a whole, so that planes between pieces are
found without a look at what is in them (Hunt, Mark, Fussell 2007).  Within a piece neighbours in the file's order are
grouped: what a mesh lists together mostly lies together.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.geometry.boxes import NO_BOX, interval
from tracer.runtime.kernels import kernel
from tracer.scene.arrays import Float32, Int32

LEAST, BRANCHES = 16, 16  # primitives in a group of those; groups in a group


class Hierarchy(NamedTuple):
    """Groups (g,) over the primitives of an object.

    boxes (g, 6) float32; first (g,) int32, the number of the first child: of a primitive, or ~ that of a group; so many
    children, counts (g,) int32, whose numbers follow; weights (g,) int32, primitives in all.  The last `roots` groups
    together hold everything.
    """

    boxes: Float32
    first: Int32
    counts: Int32
    weights: Int32
    roots: int


@kernel
def _bound_primitives(triangles, quadric_boxes, first, counts, boxes):
    """Boxes (g, 6) around so many primitives each; the numbers of quadrics follow those of triangles (t, 9)."""
    for g in range(len(first)):
        for k in range(3):
            boxes[g, k], boxes[g, k + 3] = np.inf, -np.inf
        for i in range(first[g], first[g] + counts[g]):
            for k in range(3):
                if i < len(triangles):
                    low, high = interval(triangles, i, k)
                else:
                    low, high = quadric_boxes[i - len(triangles), k], quadric_boxes[i - len(triangles), k + 3]
                boxes[g, k], boxes[g, k + 3] = min(boxes[g, k], low), max(boxes[g, k + 3], high)


def _cut(sizes: NDArray[np.int64], most: int) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
    """Runs of these sizes (n,), one behind the other, cut into groups of no more than so many: where each group begins,
    how many are in it, and of which run it is."""
    pieces = -(-sizes // most)
    run = np.repeat(np.arange(len(sizes)), pieces)
    within = np.arange(len(run)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    starts = (np.cumsum(sizes) - sizes)[run] + within * most
    return starts, np.minimum(most, sizes[run] - within * most), run


def hierarchy_over(
    triangles: Float32, quadric_boxes: Float32, starts: NDArray[np.int64], sizes: NDArray[np.int64]
) -> Hierarchy:
    """Groups over runs of primitives: so many, sizes (n,), from the numbers starts (n,) on.

    triangles (t, 9) float32 are corners and edges; boxes (q, 6) float32 are around quadrics, whose numbers follow.
    """
    starts, sizes = starts[sizes > 0], sizes[sizes > 0]
    # Group primitives, within each run alone.
    begin, counts, run = _cut(sizes, LEAST)
    first = starts[run] + begin - (np.cumsum(sizes) - sizes)[run]
    boxes = np.empty((len(first), 6), np.float32)
    _bound_primitives(triangles, quadric_boxes, first, counts, boxes)
    levels = [(boxes, first, counts, counts)]
    done = 0  # groups on the levels below
    # Group groups, first those of a run and then all, until few are left.
    while len(boxes) > BRANCHES:
        if len(run) == run[-1] + 1:
            run = np.zeros_like(run)
        begin, counts, run = _cut(np.bincount(run), BRANCHES)
        lower = np.minimum.reduceat(boxes[:, :3], begin)
        upper = np.maximum.reduceat(boxes[:, 3:], begin)
        weights = np.add.reduceat(levels[-1][3], begin)
        done, first = done + len(boxes), ~(done + begin)
        boxes = np.concatenate([lower, upper], axis=1)
        levels.append((boxes, first, counts, weights))
    every, *numbers = (np.concatenate(part) for part in zip(*levels, strict=True))
    one, two, three = (part.astype(np.int32) for part in numbers)
    return Hierarchy(every.astype(np.float32), one, two, three, len(boxes))


def bounds_of_roots(hierarchy: Hierarchy) -> Float32:
    """Boxes (roots, 6) of the groups that hold everything; a single inverted one where there is nothing."""
    return hierarchy.boxes[len(hierarchy.boxes) - hierarchy.roots :] if hierarchy.roots else NO_BOX[None]
