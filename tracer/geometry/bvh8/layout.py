"""The 8-wide tree as the traversal sees it: nodes of 256 aligned bytes, leaves of one block of 8 triangles.

A node holds the boxes of its eight children as structure of arrays, so that a handful of vector
operations test them all, and one code per child: an inner node's number, a block's, or a quadric's.
Empty slots have far degenerate boxes, that any slab test misses, and lead to block 0, which is empty.
(Wald, Benthin, Boulos 2008; Dammertz, Hanika, Keller 2008.)
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

NODE_SIZE, BLOCK_SIZE = 64, 96  # float32 numbers
QUADRIC = 1 << 30  # in a leaf's code: k < QUADRIC is block k, else quadric k - QUADRIC
EMPTY = np.float32(3e37)  # every coordinate of the box of an empty slot
NO_PRIMITIVE = 0x7FFFFFFF  # in the unused lanes of a block

# Where a node or a block has these; boxes are lower x of all children, then lower y and so on.
CHILDREN = 48
PRIMITIVES, BOX, COUNT = 72, 80, 86


class Tree(NamedTuple):
    """One tree, its root node 0.

    nodes (n, NODE_SIZE) and blocks (m, BLOCK_SIZE) float32, C-contiguous and aligned to 64 bytes.
    In a node the boxes of the children (6, 8), and from CHILDREN their codes, int32: c >= 0 is node
    c, c < 0 the leaf ~c (see QUADRIC).  In a block corners and edges (9, 8), from PRIMITIVES the
    triangles' numbers, int32, from BOX the box (6,) that its parent holds too, at COUNT how many
    there are, int32.
    """

    nodes: NDArray[np.float32]
    blocks: NDArray[np.float32]
