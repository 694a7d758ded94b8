"""Rays walk from the points in which they end towards the light, from voxel to voxel, sixteen at a time.

They step as in J. Amanatides and A. Woo, "A Fast Voxel Traversal Algorithm for Ray Tracing", Eurographics 1987, but
where a voxel ends is computed anew for each, so that errors do not add up.  In each voxel a ray asks what lies there
(`light_space`).  One certain hit blocks it; where any primitive cannot tell, the ray is
traced as if nothing were known.  A ray that comes to a voxel of which all is known, or to the light, or out of the
grid, has its answer.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tracer.culling.counters import STEPS
from tracer.culling.modes import FULL_SHADOW, NON_SHADOW, Words
from tracer.geometry.boxes import inverse
from tracer.runtime.kernels import inlined, subkernel
from tracer.simd import (
    address_of,
    bits_of,
    floor,
    gather_i32x16,
    i32_at,
    i32x16,
    load_i32x16,
    local_memory,
    lowest_bit,
    mask16,
    minimum,
    ones,
    select,
    store,
)
from tracer.simd.records import I32, Bytes, F32x2D, F32x3D, reading
from tracer.visibility.ask_list import ASKED, KNOWN, ask_list
from tracer.visibility.grid import Grid, place_of, within

ZERO, ONE = np.float32(0), np.float32(1)


class VoxelView(NamedTuple):
    """All voxels, as kernels that are called by address read them.

    Attributes:
        grid: the voxels.
        words: their states, with one more word for all that lies outside: in the bits of the occlusion mode 1 where
            anything static lies in the voxel, and for each light its state as a shadow mode (`tracer.culling.modes`).
        starts: (voxels + 1,) int32, where in names the primitives of each voxel begin.
        names: (m,) int32, numbers of primitives.
        light_space: (held lights, primitives, LIGHT_ROW) float32 (`tracer.visibility.light_space`).
        known: (lights,) bool, those of the held lights about which anything is known.
        resting: (k, 6) float32, boxes around what rests now.
        by_ray: whether steps and tests are counted ray by ray, or for vectors of sixteen.
        cell: (pixels,) int32, gets the voxel at each primary hit; empty where nobody wants to know.
    """

    grid: Grid
    words: Words
    starts: I32
    names: I32
    light_space: F32x3D
    known: Bytes
    resting: F32x2D
    by_ray: bool
    cell: I32


voxel_view_at = reading(VoxelView)


@inlined
def words_of(words, number, light):
    """The low halves of the words of sixteen voxels, the halves that hold a light's state, and by how many bits in."""
    shift = np.int32((2 + 2 * light) % 32)
    if words.size == 4:
        word = gather_i32x16(words.address, number)
        return word, word, shift
    wide = number << np.int32(1)
    word = gather_i32x16(words.address, wide)
    return word, word if 2 + 2 * light < 32 else gather_i32x16(words.address + 4, wide), shift


@inlined
def full_and_null(state):
    """Bits of the voxels that are full, and of those that are null, by their states."""
    return bits_of(state == np.int32(FULL_SHADOW)), bits_of(state == np.int32(NON_SHADOW))


@subkernel
def _ask(voxels, rows, light, end, direction, number, occupied, seen, masks, counts):
    """Ask what lies in the voxels `number`, at an address, of the rays `occupied`, bits: those that are blocked for
    certain, and those of which nobody can tell.

    seen and masks are addresses of SEEN int32 and int64: primitives and the rays that have asked them."""
    blocked = unsure = np.int64(0)
    which = i32_at(number)
    while occupied != 0:
        voxel = which[lowest_bit(occupied)]
        here = bits_of(load_i32x16(number) == np.int32(voxel)) & occupied
        occupied &= ~here
        first, last = voxels.starts[voxel], voxels.starts[voxel + 1]
        names = address_of(voxels.names) + 4 * np.int64(first)
        hit, unclear = ask_list(
            rows, names, last - first, light, end, direction, here, seen, masks, voxels.by_ray, counts
        )
        blocked |= hit
        unsure |= unclear
    return blocked, unsure


@subkernel
def walk(voxels, light, number, end, begin, open_, counts):
    """Let those of sixteen rays whose bits are `open_` walk from their ends towards light `number` at light (3,):
    bits of those that are blocked, and of those that nothing static blocks.

    end are three vectors, begin the numbers of the voxels in which they lie."""
    grid, rows = voxels.grid, address_of(voxels.light_space[number])
    direction = end[0] - light[0], end[1] - light[1], end[2] - light[2]
    px, py, pz = place_of(grid, end[0], end[1], end[2])
    lx, ly, lz = place_of(grid, light[0], light[1], light[2])
    dx, dy, dz = lx - px, ly - py, lz - pz
    ix, iy, iz = inverse(dx), inverse(dy), inverse(dz)
    forth = dx >= ZERO, dy >= ZERO, dz >= ZERO
    there = mask16(open_)
    px, py, pz = select(there, px, ZERO), select(there, py, ZERO), select(there, pz, ZERO)
    # The near sides of the voxels, on the way to the light the far ones, and how to go on.
    i, j, k = floor(px), floor(py), floor(pz)
    bx, by, bz = i + select(forth[0], ONE, ZERO), j + select(forth[1], ONE, ZERO), k + select(forth[2], ONE, ZERO)
    sx, sy, sz = select(forth[0], ONE, -ONE), select(forth[1], ONE, -ONE), select(forth[2], ONE, -ONE)
    tx, ty, tz = (bx - px) * ix, (by - py) * iy, (bz - pz) * iz
    nx, ny = np.int32(grid.ny * grid.nz), np.int32(grid.nz)
    x_on, y_on = select(forth[0], i32x16(nx), -nx), select(forth[1], i32x16(ny), -ny)
    z_on = select(forth[2], i32x16(np.int32(1)), np.int32(-1))

    numbers, seen, masks = local_memory(64), local_memory(KNOWN), local_memory(ASKED)
    store(seen, i32x16(np.int32(-1)))
    blocked = lit = np.int64(0)
    at, (word, field, shift) = begin, words_of(voxels.words, begin, number)
    for _ in range(grid.nx + grid.ny + grid.nz + 3):
        counts[STEPS] += ones(open_) if voxels.by_ray else 1
        occupied = bits_of((word & np.int32(1)) == np.int32(1)) & open_
        if occupied != 0:
            store(numbers, at)
            hit, unsure = _ask(voxels, rows, light, end, direction, numbers, occupied, seen, masks, counts)
            blocked |= hit
            open_ &= ~(hit | unsure)
        # Go on to the next voxel, unless the light comes before it.
        first = minimum(tx, minimum(ty, tz))
        arrived = open_ & bits_of(first >= ONE)
        along_x = tx <= minimum(ty, tz)
        along_y = ~along_x & (ty <= tz)
        bx, by, bz = (
            select(along_x, bx + sx, bx),
            select(along_y, by + sy, by),
            select(along_x | along_y, bz, bz + sz),
        )
        i, j, k = select(along_x, i + sx, i), select(along_y, j + sy, j), select(along_x | along_y, k, k + sz)
        tx, ty, tz = (bx - px) * ix, (by - py) * iy, (bz - pz) * iz
        inside = within((i, j, k), grid.nx, grid.ny, grid.nz)
        lit |= arrived | (open_ & ~bits_of(inside))
        open_ &= ~lit
        if open_ == 0:
            break
        at = at + select(along_x, x_on, select(along_y, y_on, z_on))
        at = select(mask16(open_), at, i32x16(np.int32(0)))
        word, field, shift = words_of(voxels.words, at, number)
        full, null = full_and_null((field >> shift) & np.int32(3))
        blocked |= open_ & full
        lit |= open_ & null
        open_ &= ~(full | null)
        if open_ == 0:
            break
    return blocked, lit
