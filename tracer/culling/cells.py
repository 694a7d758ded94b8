"""Virtual cells: what carries modes where whole primitives are too large (the paper's future work).

A floor is hardly ever seen whole, and hardly ever lies in one shadow, so that the paper's modes say
nothing of it.  Here a large triangle is cut, in thought only, into 4^k congruent cells, the leaves
of a quadtree over its barycentric coordinates.  k is fixed for each triangle, such that all cells
of a scene have about the same area.  What is small, round or moves is one cell.  With cells for
primitives, the paper's rules stay as they are.

Units are numbered through: those of primitive p begin at first[p].  In a triangle they come in strips
from its first edge, v = 0, to its third corner: a strip's cells by growing u, and the upright ones,
which lie as the triangle does, by turns with those that stand on their heads.  So with n = 2^k strips,
strip j begins at cell j (2 n - j), and no tree is walked to find a cell.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from tracer.geometry.intersect import hit_triangle
from tracer.geometry.memory import data_pointer, without_refcount
from tracer.geometry.queries import hits_alone
from tracer.geometry.rays import INFINITY, MISS
from tracer.runtime.kernels import inlined, kernel, subkernel
from tracer.simd import (
    address_of,
    gather_i32x16,
    i32x16,
    load_f32x16,
    load_i32x16,
    maximum,
    minimum,
    select,
    square_root,
    store,
    to_f32,
    to_i32,
)

AIM = 1 << 18  # cells that all static triangles together are to have, about: what is smaller stays whole
MAX_UNITS = 2_000_000  # of a scene, where it has no more primitives
MAX_LEVEL = 9  # of a triangle: one that dwarfs the scene is not to take all the cells
ZERO, ONE = np.float32(0), np.float32(1)


def levels(areas: NDArray[np.float64], others: int = 0) -> NDArray[np.int64]:
    """(t,) how often triangles of these areas (t,) are cut into four: as often as leaves cells of about one area,
    with which, and `others` besides, there are at most MAX_UNITS, or as many as there are primitives."""
    bound = max(MAX_UNITS, len(areas) + others)
    area, largest = float(areas.sum()) / AIM, areas.max(initial=0.0)
    while 0.0 < area < largest < math.inf:
        cuts = np.round(0.5 * np.log2(np.maximum(areas / area, 1.0)))
        result = np.minimum(cuts, MAX_LEVEL).astype(np.int64)
        if (4**result).sum() + others <= bound:
            return result
        area *= 2.0
    return np.zeros(len(areas), np.int64)


def first_units(triangles: NDArray[np.float32], object_of: NDArray[np.int32]) -> NDArray[np.int32]:
    """(p + 1,) the first unit of each primitive, and how many there are, of triangles (t, 9) and all that
    object_of (p,) speaks of."""
    counts = np.ones(len(object_of), np.int64)
    static = np.flatnonzero(object_of[: len(triangles)] == 0)
    edges = triangles[static, 3:].astype(np.float64)
    areas = 0.5 * np.linalg.norm(np.cross(edges[:, :3], edges[:, 3:]), axis=1)
    counts[static] = 4 ** levels(areas, len(counts) - len(static))
    return np.concatenate([[0], np.cumsum(counts)]).astype(np.int32)


def primitives_are_units() -> NDArray[np.int32]:
    """What kernels are given for `first` where there are no cells: nothing."""
    return np.empty(0, np.int32)


def corners_of(triangle: NDArray[np.float32], count: int, cell: int) -> NDArray[np.float64]:
    """(3, 3) corners of a cell, of the `count` cells of a triangle (9,), corner and edges."""
    n = math.isqrt(count)
    j = n - 1 - math.isqrt(count - cell - 1)
    i, inverted = divmod(cell - j * (2 * n - j), 2)
    places = [(i + 1, j + 1), (i, j + 1), (i + 1, j)] if inverted else [(i, j), (i + 1, j), (i, j + 1)]
    corner, *edges = triangle.reshape(3, 3).astype(np.float64)
    return corner + np.array(places) / n @ np.array(edges)


@inlined
def cells_at(first, primitive, u, v):
    """Units of sixteen primitives at weights u and v of their corners; rounding may have led a little outside."""
    start = gather_i32x16(address_of(first), primitive)
    side = square_root(to_f32(gather_i32x16(address_of(first) + 4, primitive) - start))
    last, x, y = side - ONE, u * side, v * side
    i = to_i32(minimum(maximum(x, ZERO), last))
    j = to_i32(minimum(maximum(y, ZERO), last - to_f32(i)))
    inverted = ((x - to_f32(i)) + (y - to_f32(j)) > ONE) & (to_f32(i + j) < last)
    strip = j * (to_i32(side + side) - j)
    return start + strip + (i + i) + select(inverted, i32x16(1), i32x16(0))


@inlined
def cell_at(first, primitive, u, v):
    """The same of one primitive."""
    start = np.int64(first[primitive])
    side = square_root(np.float32(first[primitive + 1] - start))
    last, x, y = side - ONE, u * side, v * side
    i = np.int64(minimum(maximum(x, ZERO), last))
    j = np.int64(minimum(maximum(y, ZERO), last - np.float32(i)))
    inverted = (x - np.float32(i)) + (y - np.float32(j)) > ONE and i + j < np.int64(last)
    return start + j * (2 * np.int64(side) - j) + 2 * i + np.int64(inverted)


@subkernel
def hits_unit(world, ray, primitive, first, unit):
    """Whether a ray in world space meets this unit of a primitive, nothing else asked."""
    if len(first) == 0 or first[primitive + 1] - first[primitive] == 1:
        return hits_alone(world, ray, primitive)
    t, u, v = hit_triangle(ray, data_pointer(world.triangles), primitive)
    return t < INFINITY and cell_at(first, primitive, u, v) == unit


@kernel
def units_of(first, primitives, u, v, units):
    """The unit, or MISS, at each of n pixels that see `primitives` at these weights of their corners; all (n,)."""
    first, primitives, u, v = without_refcount((first, primitives, u, v))
    whole = len(units) & ~15
    for at in range(0, 4 * whole, 64):
        seen = load_i32x16(address_of(primitives) + at)
        there = seen > np.int32(MISS)
        weights = load_f32x16(address_of(u) + at), load_f32x16(address_of(v) + at)
        found = cells_at(first, select(there, seen, i32x16(0)), weights[0], weights[1])
        store(address_of(units) + at, select(there, found, i32x16(MISS)))
    for i in range(whole, len(units)):
        units[i] = MISS if primitives[i] == MISS else cell_at(first, primitives[i], u[i], v[i])
