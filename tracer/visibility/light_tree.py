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


def build_light_tree(boxes: NDArray[np.float32]) -> LightTree:
    """The tree over lights whose samples lie in boxes (l, 6) float32, l > 0."""
    centers, most = boxes[:, :3] + boxes[:, 3:], max(1, -(-len(boxes) // LEAVES))
    order = np.arange(len(boxes), dtype=np.int32)
    children, lights = [0], [(0, len(boxes))]
    node = 0
    while node < len(lights):
        first, last = lights[node]
        if last - first > most:
            here = order[first:last]
            places = centers[here]
            axis = int(np.argmax(np.ptp(places, axis=0)))
            order[first:last] = here[np.argsort(places[:, axis], kind="stable")]
            middle = (first + last) // 2
            children[node] = len(lights)
            children += [0, 0]
            lights += [(first, middle), (middle, last)]
        node += 1
    around = np.empty((len(lights), 6), np.float32)
    for node in range(len(lights) - 1, -1, -1):  # children come after their parents
        first, last = lights[node]
        below = around[children[node] : children[node] + 2] if children[node] else boxes[order[first:last]]
        around[node, :3], around[node, 3:] = below[:, :3].min(0), below[:, 3:].max(0)
    return LightTree(around, np.array(children, np.int32), np.array(lights, np.int32), order)
