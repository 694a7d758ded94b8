"""The nodes that a ray enters on its way through the trees of a structure, one by one."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.scene.arrays import Float64


class Visit(NamedTuple):
    """A node that a ray enters.

    Attributes:
        tree: which tree it is of, in words.
        node: its number in the memory of that tree.
        leaf: whether it is a leaf.
        level: how many nodes are above it in its tree.
        corners: (8, 3), those of its box in the world; their numbers have the bits of x, y and z, 1 for the upper.
        enter, leave: the ray's interval of t in it.
        tested: the primitives that the ray is tested against there.
        hits: those that it hits, with the t of each.
    """

    tree: str
    node: int
    leaf: bool
    level: int
    corners: Float64
    enter: float
    leave: float
    tested: tuple[int, ...] = ()
    hits: tuple[tuple[int, float], ...] = ()


WORLD = np.eye(3, 4)


def corners_of(box: NDArray, to_world: Float64 = WORLD) -> Float64:
    """The corners (8, 3) of a box (6,) under an affine map (3, 4)."""
    bits = (np.arange(8)[:, None] >> np.arange(3)) & 1
    corners = np.where(bits == 1, box[3:], box[:3]).astype(np.float64)
    placed: Float64 = corners @ to_world[:, :3].T + to_world[:, 3]
    return placed
