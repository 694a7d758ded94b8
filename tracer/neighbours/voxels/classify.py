"""Classify voxels against a light, from coarse to fine: children inherit what is proved of a block.

*Full*: one triangle is certain to be hit by every ray that enters the voxel on its way from the light.  *Null*: nothing
static can be hit before a ray has left the voxel's near side behind: all that the shaft between light and voxel meets
is certain to be missed.  Any other voxel is *unknown*.
"""

from __future__ import annotations

import numpy as np

from tracer.culling.modes import FULL_SHADOW, NON_SHADOW, add_shadow
from tracer.geometry.memory import without_refcount
from tracer.neighbours.voxels.grid import BLOCK, ROOM
from tracer.runtime.kernels import kernel, subkernel
from tracer.simd import i64_at, local_memory
from tracer.visibility.box_candidates import MOST, come_between, forget_occluders, make_scratch
from tracer.visibility.budget import CERTIFICATES
from tracer.visibility.error_bounds import LANES

DEPTHS = 5  # of nodes: blocks, their parts and so on
NODES = 8 * DEPTHS * 5 * 8  # bytes: nodes that wait, five numbers each


@subkernel
def _fill(words, grid, light, x, y, z, size, mode):
    """Let all voxels of a node have a state."""
    for i in range(x, x + size):
        for j in range(y, y + size):
            for k in range(z, z + size):
                add_shadow(words, (i * grid.ny + j) * grid.nz + k, light, mode)


@kernel
def classify_blocks(o, grid, words, light, blocks, counts):
    """Put the states of all voxels of blocks (n,), which are still unknown, for a `Light` into their words.

    o are `Occluders` whose only light that is; words are `Words` of voxels.  counts (COUNTERS,) int64 are added to."""
    o = without_refcount(o)
    scratch, of_depth = make_scratch(), np.zeros((DEPTHS, MOST + 2 * LANES), np.int32)  # what a node's shaft meets
    met = np.zeros(DEPTHS, np.int64)  # how many primitives each depth has found
    waiting, side = i64_at(local_memory(NODES)), 1.0 / grid.per_unit
    many_y, many_z = grid.ny // BLOCK, grid.nz // BLOCK
    for block in blocks:
        x, yz = block // (many_y * many_z), block % (many_y * many_z)
        waiting[0], waiting[1], waiting[2] = x * BLOCK, yz // many_z * BLOCK, yz % many_z * BLOCK
        waiting[3], waiting[4], pending = BLOCK, 0, 1
        forget_occluders(scratch)
        while pending > 0:
            pending -= 1
            at = 5 * pending
            x, y, z, size, depth = waiting[at], waiting[at + 1], waiting[at + 2], waiting[at + 3], waiting[at + 4]
            half = (0.5 * size + ROOM) * side
            middle = (
                grid.x + (x + 0.5 * size) * side,
                grid.y + (y + 0.5 * size) * side,
                grid.z + (z + 0.5 * size) * side,
            )
            counts[CERTIFICATES] += 1
            found, given, above = of_depth[depth], np.int64(MOST + 1), of_depth[max(depth, 1) - 1]
            if depth > 0:
                given = met[depth - 1]
            count = come_between(o, light, scratch, middle, half, above, given, found, counts)
            if count < 0:
                _fill(words, grid, light.number, x, y, z, size, FULL_SHADOW)
            elif count == 0:
                _fill(words, grid, light.number, x, y, z, size, NON_SHADOW)
            elif size > 1:
                met[depth], part = count, size // 2
                for k in range(8):
                    waiting[at], waiting[at + 1] = x + (k & 1) * part, y + (k >> 1 & 1) * part
                    waiting[at + 2], waiting[at + 3], waiting[at + 4] = z + (k >> 2) * part, part, depth + 1
                    at += 5
                pending += 8
