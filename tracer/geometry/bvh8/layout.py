"""How an 8-wide tree lies in memory: nodes of 256 aligned bytes, and leaves that are blocks of 8 triangles.

A node holds the boxes of its eight children as structure of arrays, so that a handful of vector operations test them
all, and one code per child: the number of an inner node, of a block or of a quadric.  The box of an empty slot is a
point so far away that every slab test misses it; its code is that of block 0, which is empty.
(Wald, Benthin, Boulos 2008; Dammertz, Hanika, Keller 2008.)

A large tree is a crown with pieces below it (`pieces`).  In the crown, the code of a piece stands for the piece's root,
which a table tells once the piece is built; it never changes, so that nobody's order depends on when that was.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

NODE_SIZE, BLOCK_SIZE = 64, 96  # float32 numbers
QUADRIC = 1 << 30  # in a leaf's code: k < QUADRIC is block k, else quadric k - QUADRIC
PIECE = 1 << 30  # in a node's code: k < PIECE is node k, else the root of piece k - PIECE
EMPTY = np.float32(3e37)  # every coordinate of the box of an empty slot
NO_PRIMITIVE = 0x7FFFFFFF  # in the unused lanes of a block

# Offsets, in numbers, into a node and into a block.
CHILDREN = 48
PRIMITIVES, BOX, COUNT = 72, 80, 86


class Tree(NamedTuple):
    """One tree, whose root is node 0.

    nodes (n, NODE_SIZE) and blocks (m, BLOCK_SIZE) are float32, C-contiguous and aligned to 64 bytes.
    A node has the boxes of its children (6, 8), lower x of all eight first, and from CHILDREN their codes, int32:
    c >= 0 is node c (see PIECE), c < 0 is leaf ~c (see QUADRIC).  A block has the corners and edges of its triangles
    (9, 8), from PRIMITIVES their numbers, int32, from BOX the box (6,) that its parent holds too, and at COUNT how many
    there are, int32.
    """

    nodes: NDArray[np.float32]
    blocks: NDArray[np.float32]
