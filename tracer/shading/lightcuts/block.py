"""A block of points, the tree of lights, and the memory in which a cut is made for it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tracer.geometry.queries import EVERYTHING, any_hits
from tracer.geometry.rays import Rays
from tracer.runtime.kernels import inlined, subkernel
from tracer.shading.wave import row_of
from tracer.simd import address_of, load_f32x16, load_i32x16, select, store
from tracer.simd.records import F32, I32, Bytes, F32x2D

BLOCK = 8  # vectors of sixteen points
POINTS = 16 * BLOCK
ROOM = POINTS + 16  # rays of a block, and a vector to spare
DARK = np.float32(3 / 64)  # sum of three channels: of what is darker, errors are parts of this


class Clusters(NamedTuple):
    """The tree, as in `CutTree`, with the samples (l, 3) and the rows (lamps, 4) of lamps, and the query of the
    structure that rays are asked of (`tracer.geometry.queries`)."""

    boxes: F32x2D
    colors: F32x2D
    children: I32
    reps: I32
    falls: Bytes
    owners: I32
    samples: F32x2D
    rows: F32x2D
    any_hit: int
    data: int


class CutWork(NamedTuple):
    """Memory of one worker for one block and cuts of up to m nodes.

    origin and direction (3, ROOM), t_min and t_max (ROOM,), blocked (ROOM,): a packet of rays, those of the
    points whose bits are in reached (BLOCK,), vector by vector.  asked (POINTS,): how many
    rays each point has asked for.  kept (m, 2 POINTS): the diffuse and the specular term
    of each representative at each point that it reaches, or what is drawn (`drawn`).  mirror (3, POINTS).  estimate
    and bound (POINTS,): the sum over the channels of what arrives at each point, and by what it may be wrong.  nodes,
    heap and keys (m,): the cut, those of its nodes that may be parted, the worst first, and by what part of the
    estimate each may be wrong."""

    origin: F32x2D
    direction: F32x2D
    t_min: F32
    t_max: F32
    blocked: Bytes
    reached: I32
    asked: I32
    kept: F32x2D
    mirror: F32x2D
    estimate: F32
    bound: F32
    nodes: I32
    heap: I32
    keys: F32


class Block(NamedTuple):
    """Vectors `first` to `last` - 1 of the points of a wave, of which there are `size`."""

    first: int
    last: int
    size: int


@inlined
def of_block(row, v, block):
    """The address of a vector of points in a row (POINTS,) of memory."""
    return address_of(row) + 64 * (v - block.first)


@inlined
def point_row(points, row, v):
    """The v-th vector of one of the rows of points."""
    return load_f32x16(row_of(points.memory, row) + 64 * v)


@inlined
def color_of(colors, node):
    """The colour of a cluster."""
    return colors[node, 0], colors[node, 1], colors[node, 2]


@inlined
def is_dark(colors, node):
    """Whether nothing of a cluster shines."""
    return colors[node, 0] + colors[node, 1] + colors[node, 2] == np.float32(0)


@inlined
def count_asked(work, block, v, asks):
    """Count the rays of a vector of points, by a mask."""
    at = of_block(work.asked, v, block)
    store(at, load_i32x16(at) + select(asks, np.int32(1), np.int32(0)))


@subkernel
def trace_rays(clusters, n, work, counts):
    """Ask all geometry about the first n of the packet's rays."""
    if n > 0:
        rays = Rays(work.origin, work.direction, work.t_min, work.t_max)
        any_hits(clusters, rays, EVERYTHING, work.blocked, 0, n, counts)
