"""Blocks of 4 x 4 pixels: what a progressive picture knows of each pixel, and the order in which they are shaded.

Each pixel of a block has its turn, in the order of Bayer's matrix (1973), so that the first turns, and any later run
of 4, lie as evenly as possible.  The bits of a number say which pixels of a block have been shaded.  Around the picture
there is a border of blocks, none of whose pixels is ever shaded.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.geometry.memory import aligned_rows
from tracer.geometry.rays import MISS
from tracer.runtime.kernels import inlined
from tracer.shading.primary import ALL_LANES, BLOCK, EDGE
from tracer.simd import address_of

TURNS = BLOCK * BLOCK
# The turn of each pixel of a block, row by row.
BAYER = np.array([[0, 8, 2, 10], [12, 4, 14, 6], [3, 11, 1, 9], [15, 7, 13, 5]])

# Planes of a block, one number for each of its pixels: the surface's number, as the bits of int32 (MISS for none); its
# normal; where it is, seen from the eye; the local light it has where nothing is in the way; of those that have been
# shaded, what arrives of that, and what mirrors and glass send besides.
SURFACE, NORMAL, POSITION, UNSHADOWED, LOCAL, SENT, PLANES = 0, 1, 4, 7, 10, 13, 16
PLANE = 4 * TURNS  # bytes


class Planes(NamedTuple):
    """values (blocks, PLANES * TURNS) float32, row by row with the edges, or none where a picture is not shaded in
    parts; and how many blocks are in a row."""

    values: NDArray[np.float32]
    columns: int


NO_PLANES = Planes(np.empty((0, PLANES * TURNS), np.float32), 0)


def blocks_in(width: int, height: int) -> tuple[int, int]:
    """Rows and columns of the blocks of a picture, with the edges."""
    return -(-height // BLOCK) + 2 * EDGE, -(-width // BLOCK) + 2 * EDGE


def make_planes(width: int, height: int) -> Planes:
    """Room for what is known of a picture's pixels, in which nothing is seen yet."""
    rows, columns = blocks_in(width, height)
    values = aligned_rows(rows * columns, PLANES * TURNS)
    values[:] = 0
    values.view(np.int32)[:, :TURNS] = MISS
    return Planes(values, columns)


def lanes_of(first: int, count: int) -> int:
    """The pixels of a block, as bits, whose turn is one of `count` from `first` on, around the end."""
    turns = (BAYER.reshape(-1) - first) % TURNS
    return int(sum(1 << lane for lane in range(TURNS) if turns[lane] < count))


def pixels_of(lanes: NDArray[np.int32], width: int, height: int) -> NDArray[np.bool_]:
    """(height, width): the pixels of each block, edges and all, whose bits are set."""
    inside = lanes[EDGE:-EDGE, EDGE:-EDGE, None, None]
    lane = np.arange(TURNS).reshape(BLOCK, BLOCK)
    set_ = (inside >> lane & 1).astype(np.bool_)
    return set_.transpose(0, 2, 1, 3).reshape(inside.shape[0] * BLOCK, -1)[:height, :width]


def all_blocks(width: int, height: int, lanes: int = ALL_LANES) -> NDArray[np.int32]:
    """(rows, columns) these pixels of each block of a picture, and none of the edges' blocks."""
    found = np.zeros(blocks_in(width, height), np.int32)
    found[EDGE:-EDGE, EDGE:-EDGE] = lanes
    return found


@inlined
def block_of(x, y):
    """Row and column of a pixel's block, the edges counted."""
    return y // BLOCK + EDGE, x // BLOCK + EDGE


@inlined
def planes_at(planes, row, column):
    """Address of a block's planes."""
    return address_of(planes.values) + PLANES * PLANE * (row * planes.columns + column)
