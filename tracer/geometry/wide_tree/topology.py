"""The topology of an 8-wide tree: which nodes and leaves hang on which, without boxes and without geometry."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

WIDTH = 8  # children of a node, and triangles of a leaf
MAX_DEPTH = 64  # nodes between a root and a leaf, a top-level BVH's included
TOP_LEVEL_DEPTH = 24  # of these, those of a top-level BVH; enough for 16 million trees under it
VACANT = -0x80000000  # no child


class Topology(NamedTuple):
    """Parents come before their children, and leaves are in the order of nodes.

    children (n, 8) int32: c >= 0 is node c, c < 0 leaf ~c, VACANT none.  leaves (m, 2) int32: where the leaf's
    items begin in `order`, and its weight, which is the number of its triangles, or WIDTH for an item that has
    the leaf to itself.  order (items,) int32: the numbers of the items, leaf by leaf.
    """

    children: NDArray[np.int32]
    leaves: NDArray[np.int32]
    order: NDArray[np.int32]
