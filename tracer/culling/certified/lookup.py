"""Which cell a shadow ray ends in, for sixteen points at a time.

A point is looked up where its shadow rays end, a little above the surface.  Its coordinates in the triangle are
found from there, and one that is not where the prisms of `shaft` allow for it has no cell: its rays are traced.
"""

from __future__ import annotations

import numpy as np

from tracer.culling.certified.cells import (
    ALONG_U,
    ALONG_V,
    BEYOND_U,
    BEYOND_V,
    CORNER,
    NORMAL,
    RECEIVER,
    ROOTS,
)
from tracer.culling.certified.shaft import LOWEST
from tracer.culling.modes import MAX_CULLED_LIGHTS
from tracer.geometry.offsets import RAY_OFFSET
from tracer.kernels import inlined, subkernel
from tracer.simd import (
    address_of,
    any_lane,
    as_f32,
    as_i32,
    gather_i32x16,
    i32x16,
    lanes_below,
    load_columns,
    load_f32x16,
    load_i32x16,
    mask16,
    maximum,
    minimum,
    select,
    store,
)

ZERO, HALF, ONE, TWO = np.float32(0), np.float32(0.5), np.float32(1), np.float32(2)
NOWHERE = -1  # instead of an owner
ROOM = 4096  # points that a tile can ask for
FACING = 64 * MAX_CULLED_LIGHTS  # bytes


@inlined
def affine(row, first, x, y, z):
    return row[first] * x + row[first + 1] * y + row[first + 2] * z


@subkernel
def find_cells(certified, points, count):
    """The cells of points, sixteen by sixteen, into points.unit, which tells their primitives.

    points.lifted are where their rays end; points.spots get u, v and, as int32, their owner, NOWHERE for none.
    Unless rays are `costly_rays`, triangles without a root are not looked at any closer."""
    cells, highest = certified.cells, certified.highest
    child, receivers, lifted, spots = address_of(cells.child), address_of(cells.receivers), points.lifted, points.spots
    stride, rooted_at = 4 * lifted.shape[1], address_of(cells.rooted)
    for k in range((count + 15) // 16):
        at = 64 * k
        numbers = address_of(points.unit) + at
        primitive = load_i32x16(numbers)
        if not certified.costly_rays:
            rooted = (gather_i32x16(rooted_at, primitive) > np.int32(0)) & mask16(lanes_below(count, k))
            if not any_lane(rooted):
                store(numbers, i32x16(0))
                store(address_of(spots) + 2 * stride + at, i32x16(NOWHERE))
                continue
        row = load_columns(receivers, numbers, RECEIVER)
        px = load_f32x16(address_of(lifted) + at)
        py = load_f32x16(address_of(lifted) + stride + at)
        pz = load_f32x16(address_of(lifted) + 2 * stride + at)
        x, y, z = px - row[CORNER], py - row[CORNER + 1], pz - row[CORNER + 2]
        u, v, height = affine(row, ALONG_U, x, y, z), affine(row, ALONG_V, x, y, z), affine(row, NORMAL, x, y, z)
        above = maximum(height, -height)
        largest = maximum(maximum(px, -px), maximum(maximum(py, -py), maximum(pz, -pz)))
        inside = (above >= np.float32(LOWEST * RAY_OFFSET) * largest) & (above <= highest) & (above > ZERO)
        beyond = row[BEYOND_U] + row[BEYOND_V]
        inside = inside & (u >= -row[BEYOND_U]) & (v >= -row[BEYOND_V]) & (u + v <= ONE + beyond)
        back = height < ZERO
        owner = (primitive << np.int32(1)) + select(back, i32x16(1), i32x16(0))
        u, v = minimum(maximum(u, ZERO), ONE), minimum(maximum(v, ZERO), ONE)
        store(address_of(spots) + at, u)
        store(address_of(spots) + stride + at, v)
        store(address_of(spots) + 2 * stride + at, as_f32(select(inside, owner, i32x16(NOWHERE))))
        cell = select(back, as_i32(row[ROOTS + 1]), as_i32(row[ROOTS]))
        cell = select(inside & mask16(lanes_below(count, k)), cell, i32x16(0))
        store(numbers, descend(child, cell, u, v))


@inlined
def descend(child, cell, u, v):
    """From roots to the leaves that (u, v) lie in."""
    below = gather_i32x16(child, cell)
    inner = below > np.int32(-1)
    while any_lane(inner):
        first = u + v <= HALF
        second, third = (u >= HALF) & ~first, (v >= HALF) & ~first
        third = third & ~second
        which = select(first, i32x16(0), select(second, i32x16(1), select(third, i32x16(2), i32x16(3))))
        turned = ~(first | second | third)
        u, v = u * TWO, v * TWO
        nu = select(second, u - ONE, select(turned, ONE - u, u))
        nv = select(third, v - ONE, select(turned, ONE - v, v))
        cell = select(inner, below + which, cell)
        u, v = select(inner, nu, u), select(inner, nv, v)
        below = gather_i32x16(child, cell)
        inner = below > np.int32(-1)
    return cell
