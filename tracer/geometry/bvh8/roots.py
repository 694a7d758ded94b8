"""Sixteen rays and the children of a root, which even rays that have nothing else in common must all be tested with."""

from __future__ import annotations

import numpy as np

from tracer.geometry.bvh8.layout import QUADRIC
from tracer.geometry.bvh8.packet import ROW, T_MIN, T, lanes_inside
from tracer.geometry.bvh8.packet_leaf import quadric_in_child
from tracer.geometry.bvh8.packet_tree import code_of, quadrics_in
from tracer.geometry.bvh8.placed import child_planes, root_of
from tracer.geometry.queries import TESTS
from tracer.geometry.triangle_test import ZERO
from tracer.geometry.wide_tree.topology import WIDTH
from tracer.runtime.kernels import inlined
from tracer.simd import as_i32, bits_of, i32x16, load_f32x16, maximum, ones, select, store

CLOSED = np.int32(0x7FFFFFFF)  # key of a child that a ray does not enter: no distance at all


@inlined
def open_rays(memory, v):
    """How many rays of a vector there are to trace."""
    a = memory + 64 * v
    return ones(bits_of(load_f32x16(a + T * ROW) > load_f32x16(a + T_MIN * ROW)))


@inlined
def open_root(memory, v, trees, first, room, nearest, counts):
    """Test sixteen rays against the children of a root and write a row of keys for each child.

    A key is the bits of the distance at which the ray enters the child, the lowest four replaced by the child's
    number, counted from `first` (which only makes the distance less); or CLOSED.  Quadrics among the children are
    tested right away."""
    root = root_of(trees)
    quadrics = quadrics_in(root)
    for c in range(WIDTH):
        box, key = root + 4 * c, i32x16(CLOSED)
        if (quadrics >> c) & 1:
            counts[TESTS] += 1
            quadric_in_child(None, memory, box, np.int64(1) << v, trees, ~code_of(root, c) - QUADRIC, nearest)
        else:
            enter, leave = lanes_inside(None, memory, v, child_planes(box))
            distance = as_i32(maximum(enter, ZERO)) & np.int32(~15)
            key = select(enter <= leave, distance | np.int32(first + c), CLOSED)
        store(room + 64 * (first + c), key)
