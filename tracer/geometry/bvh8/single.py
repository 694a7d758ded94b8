"""One ray through a BVH8: its eight children, and a block's eight triangles, are the lanes.

For rays that have nothing in common.  The answers are those of `packet`, bit for bit.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from tracer.geometry.bvh8.intersect import ZERO, crossing, terms_of, triangles_of
from tracer.geometry.bvh8.packet import (
    BLOCK,
    BOX,
    CHILDREN,
    FAR,
    NODE,
    NUMBERS,
    STACK,
    STEPS,
    TESTS,
    _push_sorted,
    inverse,
)
from tracer.geometry.bvh8.tree import QUADRIC
from tracer.geometry.intersect import hit_quadric
from tracer.geometry.rays import Ray
from tracer.kernels import inlined, subkernel
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
    load_i64,
    lowest_bit,
    maximum,
    minimum,
    select,
    smallest,
    store,
)

NOBODY = np.int32(0x7FFFFFFF)
SINGLE_MEMORY = STACK + 64  # scratch, then the stack


class Line(NamedTuple):
    """A ray with its inverse direction and the offsets of near planes in a node."""

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
def line_of(ray):
    ix, iy, iz = inverse(ray.dx), inverse(ray.dy), inverse(ray.dz)
    return Line(
        ray.ox, ray.oy, ray.oz, ray.dx, ray.dy, ray.dz, ix, iy, iz,
        np.int64(96 if ix < ZERO else 0), np.int64(96 if iy < ZERO else 0), np.int64(96 if iz < ZERO else 0), ray.t_min,
    )  # fmt: skip


@inlined
def _children(node, r, far):
    """Where a ray enters and leaves eight children."""
    ax, bx = (load_f32x8(node + r.near_x) - r.ox) * r.ix, (load_f32x8(node + 96 - r.near_x) - r.ox) * r.ix
    ay, by = (load_f32x8(node + 32 + r.near_y) - r.oy) * r.iy, (load_f32x8(node + 128 - r.near_y) - r.oy) * r.iy
    az, bz = (load_f32x8(node + 64 + r.near_z) - r.oz) * r.iz, (load_f32x8(node + 160 - r.near_z) - r.oz) * r.iz
    return maximum(maximum(ax, ay), maximum(az, r.t_min)), minimum(minimum(bx, by), minimum(bz, far))


@inlined
def _block_interval(block, r, far):
    x0, y0, z0 = load_f32(block + BOX), load_f32(block + BOX + 4), load_f32(block + BOX + 8)
    x1, y1, z1 = load_f32(block + BOX + 12), load_f32(block + BOX + 16), load_f32(block + BOX + 20)
    ax, bx = (x0 - r.ox) * r.ix, (x1 - r.ox) * r.ix
    ay, by = (y0 - r.oy) * r.iy, (y1 - r.oy) * r.iy
    az, bz = (z0 - r.oz) * r.iz, (z1 - r.oz) * r.iz
    enter = maximum(maximum(minimum(ax, bx), minimum(ay, by)), maximum(minimum(az, bz), r.t_min))
    return enter, minimum(minimum(maximum(ax, bx), maximum(ay, by)), minimum(maximum(az, bz), far))


@inlined
def _hits_in_block(block, r, far):
    """(mask, t, u area, v area, 1 / area) of a ray on eight triangles."""
    enter, leave = _block_interval(block, r, far)
    m = terms_of(r.ox, r.oy, r.oz, triangles_of(block))
    crosses, sign, u, v, area = crossing(r.dx, r.dy, r.dz, m)
    scale = np.float32(1) / area
    t = as_f32(as_i32(m.height) ^ sign) * scale
    return crosses & (t >= enter) & (t <= leave) & (t > r.t_min), t, u, v, scale


@inlined
def _nearest_in_block(block, r, best):
    mask, t, u, v, scale = _hits_in_block(block, r, best.t)
    mask = mask & (t <= best.t)
    if not any_lane(mask):
        return best
    nearest = smallest(select(mask, t, FAR))
    mask = mask & (t == nearest)
    numbers = load_i32x8(block + NUMBERS)
    number = smallest(select(mask, numbers, NOBODY))
    if nearest == best.t and number >= best.number:
        return best
    lane = lowest_bit(bits_of(mask & (numbers == number)))
    return Best(nearest, number, lane_of(u * scale, lane), lane_of(v * scale, lane))


@inlined
def _quadric(r, trees, i, enter, leave):
    """t of a ray on a quadric inside its box, or FAR."""
    t = hit_quadric(Ray(r.ox, r.oy, r.oz, r.dx, r.dy, r.dz, r.t_min, FAR), trees.quadrics, i)
    return t if t >= enter and t <= leave else FAR


@subkernel
def closest_of_one(r, best, trees, stack, counts):
    """The nearest of best and what a ray meets in a tree."""
    store(stack, np.int64(0))
    pending = 1
    scratch = stack - 64
    while pending > 0:
        pending -= 1
        entry = load_i64(stack + 8 * pending)
        if as_f32(np.int32(entry >> 32)) > best.t:
            continue
        code = np.int64(np.int32(entry & 0xFFFFFFFF))
        if code < 0:
            counts[TESTS] += 1
            best = _nearest_in_block(trees.blocks + BLOCK * ~code, r, best)
            continue
        counts[STEPS] += 1
        node = trees.nodes + NODE * code
        enter, leave = _children(node, r, best.t)
        children = bits_of(enter <= leave)
        store(scratch, maximum(enter, ZERO))
        store(scratch + 32, leave)
        bottom = pending
        while children != 0:
            c = lowest_bit(children)
            children &= children - 1
            code = np.int64(load_i32(node + CHILDREN + 4 * c))
            if ~code >= QUADRIC:
                counts[TESTS] += 1
                i = ~code - QUADRIC
                t = _quadric(r, trees, i, lane_of(enter, c), lane_of(leave, c))
                if t < best.t or (t == best.t and trees.triangles + i < best.number):
                    best = Best(t, np.int32(trees.triangles + i), ZERO, ZERO)
                continue
            entry = (np.int64(load_i32(scratch + 4 * c)) << 32) | (code & 0xFFFFFFFF)
            pending = _push_sorted(stack, pending, bottom, entry)
    return best


@subkernel
def any_of_one(r, far, trees, stack, counts):
    """Whether a ray meets anything in a tree nearer than far."""
    store(stack, np.int64(0))
    pending = 1
    while pending > 0:
        pending -= 1
        code = load_i64(stack + 8 * pending)
        if code < 0:
            counts[TESTS] += 1
            mask, t, _u, _v, _scale = _hits_in_block(trees.blocks + BLOCK * ~code, r, far)
            if any_lane(mask & (t < far)):
                return True
            continue
        counts[STEPS] += 1
        node = trees.nodes + NODE * code
        enter, leave = _children(node, r, far)
        children = bits_of(enter <= leave)
        while children != 0:
            c = lowest_bit(children)
            children &= children - 1
            code = np.int64(load_i32(node + CHILDREN + 4 * c))
            if ~code >= QUADRIC:
                counts[TESTS] += 1
                if _quadric(r, trees, ~code - QUADRIC, lane_of(enter, c), lane_of(leave, c)) < far:
                    return True
                continue
            store(stack + 8 * pending, code)
            pending += 1
    return False
