"""The squares that a picture is divided into, which threads share, and the order of their turns."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from tracer.shading.buffers import TILE

FEW = 4  # pixels of each block, at most, that are shaded in larger tiles
EACH = 3  # larger tiles, at least, for each thread

Tile = tuple[int, int, int, int, int]  # left, top, right, bottom, number


def tiles_of(width: int, height: int, side: int = TILE) -> list[Tile]:
    """Squares of so many pixels a side, row by row, and their numbers."""
    corners = [(x, y) for y in range(0, height, side) for x in range(0, width, side)]
    return [(x, y, min(x + side, width), min(y + side, height), number) for number, (x, y) in enumerate(corners)]


def tiles_to_shade(width: int, height: int, lanes: NDArray[np.int32], workers: int) -> list[Tile]:
    """Tiles for shading: larger ones where few pixels of each block are to be shaded, so that packets of rays are full,
    unless there would be too few for all threads.  lanes (rows, columns) int32 have the bits of each block's pixels."""
    tiles = tiles_of(width, height)
    few = int(np.bitwise_count(lanes).sum()) <= FEW * np.count_nonzero(lanes)
    return tiles_of(width, height, 2 * TILE) if few and len(tiles) >= 4 * EACH * workers else tiles


def nearest_first(tiles: list[Tile], x: float, y: float) -> list[Tile]:
    """The tiles, those near a point of the picture first."""
    return sorted(tiles, key=lambda tile: math.hypot((tile[0] + tile[2]) / 2 - x, (tile[1] + tile[3]) / 2 - y))
