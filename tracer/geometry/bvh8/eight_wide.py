"""One ray against eight boxes or eight triangles at once: the children of a node, or a block.  They are the lanes."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from tracer.geometry.bvh8.layout import PRIMITIVES, QUADRIC
from tracer.geometry.bvh8.packet import DIRECTION, FAR, INVERSE, NUMBER, ORIGIN, ROW, T_MIN, T, U, V, three_of
from tracer.geometry.bvh8.placed import block_planes, code_of, triangles_of
from tracer.geometry.intersect import hit_quadric
from tracer.geometry.rays import MISS, Ray
from tracer.geometry.triangle_test import ZERO, crossing, terms_of
from tracer.geometry.wide_tree.topology import WIDTH
from tracer.runtime.kernels import inlined, subkernel
from tracer.simd import (
    any_lane,
    as_f32,
    as_i32,
    bits_of,
    lane_of,
    load_f32,
    load_f32x8,
    load_i32,
    load_i32x8,
    lowest_bit,
    mask8,
    maximum,
    minimum,
    select,
    smallest,
    store,
)

NOBODY = np.int32(0x7FFFFFFF)


class SingleRay(NamedTuple):
    """One ray, with the inverse of its direction and the offsets in a node of the planes that it meets first."""

    ox: Any
    oy: Any
    oz: Any
    dx: Any
    dy: Any
    dz: Any
    ix: Any
    iy: Any
    iz: Any
    near_x: Any
    near_y: Any
    near_z: Any
    t_min: Any


class Best(NamedTuple):
    """The nearest hit so far."""

    t: Any
    number: Any
    u: Any
    v: Any


@inlined
def _near(inverse):
    """Offset, from a box's lower plane, of the plane that is met first."""
    return np.int64(as_i32(inverse) >> 31) & 96


@inlined
def single_ray_at(a):
    """The ray whose column in a packet's memory begins at an address."""
    (ox, oy, oz), (dx, dy, dz), (ix, iy, iz) = three_of(a, ORIGIN), three_of(a, DIRECTION), three_of(a, INVERSE)
    near_x, near_y, near_z = _near(ix), _near(iy), _near(iz)
    return SingleRay(ox, oy, oz, dx, dy, dz, ix, iy, iz, near_x, near_y, near_z, load_f32(a + T_MIN * ROW))


@inlined
def children_of(node, r, far):
    """t where a ray enters and leaves each of a node's eight children."""
    ax, bx = (load_f32x8(node + r.near_x) - r.ox) * r.ix, (load_f32x8(node + 96 - r.near_x) - r.ox) * r.ix
    ay, by = (load_f32x8(node + 32 + r.near_y) - r.oy) * r.iy, (load_f32x8(node + 128 - r.near_y) - r.oy) * r.iy
    az, bz = (load_f32x8(node + 64 + r.near_z) - r.oz) * r.iz, (load_f32x8(node + 160 - r.near_z) - r.oz) * r.iz
    return maximum(maximum(ax, ay), maximum(az, r.t_min)), minimum(minimum(bx, by), minimum(bz, far))


@inlined
def children_at(node, a):
    """As `children_of`, for one ray and one node, the ray from its column in a packet's memory: to test both planes
    takes less time than to find out from the direction which of them comes first."""
    (ox, oy, oz), (ix, iy, iz) = three_of(a, ORIGIN), three_of(a, INVERSE)
    ax, bx = (load_f32x8(node) - ox) * ix, (load_f32x8(node + 96) - ox) * ix
    ay, by = (load_f32x8(node + 32) - oy) * iy, (load_f32x8(node + 128) - oy) * iy
    az, bz = (load_f32x8(node + 64) - oz) * iz, (load_f32x8(node + 160) - oz) * iz
    enter = maximum(maximum(minimum(ax, bx), minimum(ay, by)), maximum(minimum(az, bz), load_f32(a + T_MIN * ROW)))
    leave = minimum(minimum(maximum(ax, bx), maximum(ay, by)), minimum(maximum(az, bz), load_f32(a + T * ROW)))
    return enter, leave


@inlined
def _inside_block(block, r, t):
    """Mask of those of eight t that lie where a ray is in a block's box."""
    x0, y0, z0, x1, y1, z1 = block_planes(block)
    ax, bx = (x0 - r.ox) * r.ix, (x1 - r.ox) * r.ix
    ay, by = (y0 - r.oy) * r.iy, (y1 - r.oy) * r.iy
    az, bz = (z0 - r.oz) * r.iz, (z1 - r.oz) * r.iz
    enter = maximum(maximum(minimum(ax, bx), minimum(ay, by)), minimum(az, bz))
    leave = minimum(minimum(maximum(ax, bx), maximum(ay, by)), maximum(az, bz))
    return (t >= enter) & (t <= leave)


@inlined
def _first_lane(block, t, bits):
    """The lane with the least t of several, given as bits; of equal ones that of the lowest number."""
    if bits & (bits - 1) == 0:
        return lowest_bit(bits)
    mask = mask8(bits)
    mask = mask & (t == smallest(select(mask, t, FAR)))
    numbers = load_i32x8(block + 4 * PRIMITIVES)
    return lowest_bit(bits_of(mask & (numbers == smallest(select(mask, numbers, NOBODY)))))


@inlined
def _replace(a, value, mask):
    """Write an int32 to an address where a mask is -1; where it is 0, write what was there."""
    old = load_i32(a)
    store(a, np.int32(old ^ ((old ^ value) & mask)))


@inlined
def nearest_in_block(block, a):
    """Test a ray with a block's triangles and keep the nearest hit in its column, the address of which is a.

    Whether there is one nobody can predict, and so it is no branch."""
    r, far = single_ray_at(a), load_f32(a + T * ROW)
    m = terms_of(r.ox, r.oy, r.oz, triangles_of(block))
    crosses, sign, u, v, area = crossing(r.dx, r.dy, r.dz, m)
    scale = np.float32(1) / area
    t = as_f32(as_i32(m.height) ^ sign) * scale
    bits = bits_of(crosses & (t > r.t_min) & (t <= far) & _inside_block(block, r, t))
    lane = _first_lane(block, t, bits) & (WIDTH - 1)
    nearest, number = lane_of(t, lane), load_i32(block + 4 * (PRIMITIVES + lane))
    first = np.int64(nearest == far) & np.int64(number < load_i32(a + NUMBER * ROW))
    nearer = np.int32(-(np.int64(bits != 0) & (np.int64(nearest < far) | first)))
    _replace(a + T * ROW, as_i32(nearest), nearer)
    _replace(a + NUMBER * ROW, number, nearer)
    _replace(a + U * ROW, as_i32(lane_of(u * scale, lane)), nearer)
    _replace(a + V * ROW, as_i32(lane_of(v * scale, lane)), nearer)


@inlined
def any_of_eight(block, r, far):
    """The number of the first triangle in a block that a ray hits nearer than far, or MISS."""
    m = terms_of(r.ox, r.oy, r.oz, triangles_of(block))
    crosses, sign, _u, _v, area = crossing(r.dx, r.dy, r.dz, m)
    if not any_lane(crosses):
        return np.int32(MISS)
    t = as_f32(as_i32(m.height) ^ sign) * (np.float32(1) / area)
    bits = bits_of(crosses & (t > r.t_min) & (t < far) & _inside_block(block, r, t))
    return load_i32(block + 4 * (PRIMITIVES + lowest_bit(bits))) if bits != 0 else np.int32(MISS)


@inlined
def _quadric(r, trees, i, enter, leave):
    """t of a ray on a quadric inside its box, or FAR."""
    t = hit_quadric(Ray(r.ox, r.oy, r.oz, r.dx, r.dy, r.dz, r.t_min, FAR), trees.quadrics, i)
    return t if t >= enter and t <= leave else FAR


@subkernel
def nearest_quadric(r, best, trees, node, quadrics, enter, leave):
    """The nearer of `best` and the nearest hit on those children of a node, given as bits, that are quadrics."""
    while quadrics != 0:
        c = lowest_bit(quadrics)
        quadrics &= quadrics - 1
        i = ~code_of(node, c) - QUADRIC
        t = _quadric(r, trees, i, lane_of(enter, c), lane_of(leave, c))
        if t < best.t or (t == best.t and trees.triangles + i < best.number):
            best = Best(t, np.int32(trees.triangles + i), ZERO, ZERO)
    return best


@subkernel
def any_quadric(r, far, trees, node, c):
    """The number of the quadric that is a node's c-th child if a ray hits it nearer than far, or MISS."""
    enter, leave = children_of(node, r, far)
    i = ~code_of(node, c) - QUADRIC
    t = _quadric(r, trees, i, lane_of(enter, c), lane_of(leave, c))
    return np.int32(trees.triangles + i) if t < far else np.int32(MISS)
