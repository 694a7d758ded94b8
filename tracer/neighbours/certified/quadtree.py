"""How a triangle is divided into cells: the one place that knows the layout of the quadtree.

A cell is a triangle within its triangle, with corners (u, v), (u + size, v) and (u, v + size) in barycentric
coordinates.  It has four parts: one at each corner, and the middle one, which is upside down and has a negative size:

    v
    | \\
    | 2 \\
    |-----\\
    | \\ 3 | \\
    | 0 \\ | 1 \\
    +-----------  u

`part_of` finds the part of one point, and runs in Python too (`part_of.py_func`).  `descend` goes down to the leaves
of sixteen points at once, by the same comparisons.  `place_of_part` says where a part lies.
"""

from __future__ import annotations

import numpy as np

from tracer.runtime.kernels import inlined
from tracer.simd import any_lane, gather_i32x16, i32x16, select

HALF, ONE, TWO = np.float32(0.5), np.float32(1), np.float32(2)


@inlined
def part_of(u, v):
    """The part of a cell in which a point lies, 0 to 3, and its coordinates there: (part, u, v).

    (u, v) are the point's coordinates in the cell, from 0 to 1."""
    if u + v <= 0.5:
        return 0, u + u, v + v
    if u >= 0.5:
        return 1, u + u - 1, v + v
    if v >= 0.5:
        return 2, u + u, v + v - 1
    return 3, 1 - (u + u), 1 - (v + v)


@inlined
def descend(child, cell, u, v):
    """The leaves in which sixteen points lie.

    child is the address of `Cells.child`, cell (16,) int32 where each begins, and (u, v) (16,) float32 its coordinates
    in that cell, from 0 to 1."""
    below = gather_i32x16(child, cell)
    inner = below > np.int32(-1)
    while any_lane(inner):
        cell, u, v = enter_parts(cell, below, inner, u, v)
        below = gather_i32x16(child, cell)
        inner = below > np.int32(-1)
    return cell


@inlined
def enter_parts(cell, below, inner, u, v):
    """Sixteen points' cells one level down, and their coordinates there, where the cell is divided (`inner`).

    below (16,) int32 are the first parts of the cells."""
    # Find the part of each point, as `part_of` does.
    first = u + v <= HALF
    second, third = (u >= HALF) & ~first, (v >= HALF) & ~first
    third = third & ~second
    middle = ~(first | second | third)
    part = select(first, i32x16(0), select(second, i32x16(1), select(third, i32x16(2), i32x16(3))))

    # Enter it, in the part's own coordinates.
    u, v = u * TWO, v * TWO
    part_u = select(second, u - ONE, select(middle, ONE - u, u))
    part_v = select(third, v - ONE, select(middle, ONE - v, v))
    return select(inner, below + part, cell), select(inner, part_u, u), select(inner, part_v, v)


@inlined
def place_of_part(u, v, size, part):
    """Where a part of the cell at (u, v) with a size lies: (u, v, size), float32."""
    half = HALF * size
    if part == 0:
        return u, v, half
    if part == 1:
        return u + half, v, half
    if part == 2:
        return u, v + half, half
    return u + half, v + half, -half
