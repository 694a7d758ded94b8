"""The matrices of all objects of a scene at a time, evaluated together.

The chains of objects that move together begin with the same transforms.  So chains are kept as a tree: every node is
the product of its parent's matrix and one more transform, and all products at one depth are one array operation.  (For
hundreds of objects, one chain after the other took longer than everything else that placing them takes.)
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from tracer.scene.animation import Animation, Chain, TrackSet
from tracer.scene.arrays import Float64


class Chains:
    """The transform chains of n objects under an animation."""

    def __init__(self, animation: Animation, chains: Sequence[Chain]) -> None:
        self._animation = animation
        constants: dict[bytes, int] = {np.eye(4).tobytes(): 0}
        matrices = [np.eye(4)]
        numbers = {name: i for i, name in enumerate(animation.tracks)}
        # Node 0 is the identity; of the others parent, depth and step: a constant, or ~ the number of a track.
        nodes: dict[tuple[int, int], int] = {(0, 0): 0}
        depth = [0]
        self._leaf = np.zeros(len(chains), np.intp)
        for i, chain in enumerate(chains):
            node = 0
            for element in chain:
                if isinstance(element, str):
                    if element not in numbers:
                        continue  # names that no track bears mean the identity
                    step = ~numbers[element]
                else:
                    matrix = np.asarray(element, np.float64)
                    step = constants.setdefault(matrix.tobytes(), len(matrices))
                    matrices += [matrix] * (step == len(matrices))
                if (node, step) not in nodes:
                    nodes[node, step] = len(depth)
                    depth.append(depth[node] + 1)
                node = nodes[node, step]
            self._leaf[i] = node
        self._constants = np.stack(matrices)
        parents, steps = np.array(list(nodes)).T
        steps = np.where(steps < 0, len(matrices) + ~steps, steps)
        depths = np.array(depth)
        by_depth = np.split(np.argsort(depths, kind="stable"), np.cumsum(np.bincount(depths))[:-1])[1:]
        self._levels = [(level, parents[level], steps[level]) for level in by_depth]
        self._count = len(depth)
        hidden: dict[str, list[int]] = {}
        for i, chain in enumerate(chains):
            for name in {element for element in chain if isinstance(element, str)} & numbers.keys():
                hidden.setdefault(name, []).append(i)
        self._hidden_by: list[tuple[TrackSet, NDArray[np.int64]]] = [
            (animation.tracks[name], np.array(which, np.int64))
            for name, which in hidden.items()
            if animation.tracks[name].visibility is not None
        ]

    def matrices(self, time: float) -> Float64:
        """(n, 4, 4) from the space of each chain's last element to the world: what `Animation.matrix` gives of each."""
        steps = np.concatenate([self._constants, self._animation.matrices(time)])
        placed = np.empty((self._count, 4, 4))
        placed[0] = np.eye(4)
        for nodes, parents, which in self._levels:
            with np.errstate(all="ignore"):  # what grows beyond all numbers is not placed
                placed[nodes] = placed[parents] @ steps[which]
        return placed[self._leaf]

    def visible(self, time: float) -> NDArray[np.bool_]:
        """(n,) true where every named track of a chain is visible."""
        visible = np.ones(len(self._leaf), np.bool_)
        for tracks, objects in self._hidden_by:
            if not tracks.visible(time):
                visible[objects] = False
        return visible
