"""A tree over the lights of a scene: boxes around their samples, halved where they lie farthest apart.

Lights that are close together are mostly hidden together, so that one proof tells of all that are below a node
(compare B. Walter et al., "Lightcuts: A Scalable Approach to Illumination", SIGGRAPH 2005, section 4).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

LEAVES = 2048  # at most, so that a region of very many lights is decided by groups of them


class LightTree(NamedTuple):
    """n nodes over l lights; node 0 is the root.

    Attributes:
        boxes: (n, 6) float32, the lower and the upper corner around all samples of the lights below.
        children: (n,) int32, the first of two that follow each other, 0 for a leaf.
        lights: (n, 2) int32, the first and the last + 1 of its lights in `order`.
        order: (l,) int32, numbers of lights.
    """

    boxes: NDArray[np.float32]
    children: NDArray[np.int32]
    lights: NDArray[np.int32]
    order: NDArray[np.int32]


def halved(places: NDArray, most: int, unit: int = 1) -> tuple[NDArray[np.int32], list[int], list[tuple[int, int]]]:
    """Halve places (n, 3) along their longest side until no more than `most` are together, by whole `unit`s.

    Returns (order (n,), children, spans): an order in which places that are together follow each other; and of each
    node the first of two children, which come after it, 0 for none, and the first and the last + 1 of its places in the
    order."""
    order = np.arange(len(places), dtype=np.int32)
    children, spans, node = [0], [(0, len(places))], 0
    while node < len(spans):
        first, last = spans[node]
        if last - first > most:
            here = order[first:last]
            axis = int(np.argmax(np.ptp(places[here], axis=0)))
            order[first:last] = here[np.argsort(places[here, axis], kind="stable")]
            middle = first + unit * max(1, (last - first) // (2 * unit))
            children[node] = len(spans)
            children += [0, 0]
            spans += [(first, middle), (middle, last)]
        node += 1
    return order, children, spans


def build_light_tree(boxes: NDArray[np.float32]) -> LightTree:
    """The tree over lights whose samples lie in boxes (l, 6) float32, l > 0."""
    order, children, lights = halved(boxes[:, :3] + boxes[:, 3:], max(1, -(-len(boxes) // LEAVES)))
    around = np.empty((len(lights), 6), np.float32)
    for node in range(len(lights) - 1, -1, -1):  # children come after their parents
        first, last = lights[node]
        below = around[children[node] : children[node] + 2] if children[node] else boxes[order[first:last]]
        around[node, :3], around[node, 3:] = below[:, :3].min(0), below[:, 3:].max(0)
    return LightTree(around, np.array(children, np.int32), np.array(lights, np.int32), order)
