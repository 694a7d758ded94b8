"""A naive twin of virtual cells: down the quadtree from a whole triangle, and cells numbered by counting them."""

from __future__ import annotations

import math
from functools import cache

import numpy as np

Cell = tuple[int, int, bool]  # column, strip, whether it stands on its head


@cache
def numbers(n: int) -> dict[Cell, int]:
    """The cells of a triangle of n strips in their order."""
    cells = []
    for strip in range(n):
        for column in range(n - strip):
            cells.append((column, strip, False))
            if column + strip < n - 1:
                cells.append((column, strip, True))
    return {cell: number for number, cell in enumerate(cells)}


def cell_of(count: int, u: float, v: float) -> int:
    """Which of a triangle's `count` cells a point is in, given by its weights of the second and the third corner."""
    n = math.isqrt(count)
    at, here = np.array([float(u), float(v)]) * n, np.array([[0, 0], [n, 0], [0, n]], np.float64)
    for _ in range(n.bit_length() - 1):
        x, y = np.linalg.solve(np.stack([here[1] - here[0], here[2] - here[0]], axis=1), at - here[0])
        middle = (here + np.roll(here, -1, axis=0)) / 2  # of the edges 0-1, 1-2 and 2-0
        if x >= 0.5:
            here = np.array([middle[0], here[1], middle[1]])
        elif y >= 0.5:
            here = np.array([middle[2], middle[1], here[2]])
        elif x + y > 0.5:
            here = np.array([middle[1], middle[2], middle[0]])
        else:
            here = np.array([here[0], middle[0], middle[2]])
    column, strip = np.floor(here.mean(axis=0))
    return numbers(n)[int(column), int(strip), bool((here.mean(axis=0) % 1).sum() > 1)]
