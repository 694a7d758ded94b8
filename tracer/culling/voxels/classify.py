"""Classify voxels against a light, from coarse to fine: children inherit what is proved of a block.

*Full*: one triangle is certain to be hit by every ray that enters the voxel on its way from the light.  *Null*: nothing
static can be hit before a ray has left the voxel's near side behind: all that the shaft between light and voxel meets
is certain to be missed.  Any other voxel is *unknown*.

A ray that goes on beyond the voxel has larger functions still: U, V and D - U - V grow in step with their bounds,
and D - T by more than its own where these clear theirs.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.culling.certified.error_bounds import ROW, ZERO
from tracer.culling.certified.light_space import FARTHEST, LIGHT_ROW, U, V
from tracer.culling.certified.tree_walk import WALK, begin_walk, walk_on
from tracer.culling.modes import FULL_SHADOW, NON_SHADOW, add_shadow
from tracer.culling.voxels import grid as voxel_grid
from tracer.culling.voxels.box_judge import judge_box
from tracer.culling.voxels.box_shaft import BoxShaft, make_box_shaft, put_box
from tracer.geometry.memory import borrowed
from tracer.geometry.wide_tree.topology import WIDTH
from tracer.runtime.kernels import inlined, kernel, subkernel
from tracer.simd import (
    address_of,
    any_lane,
    bits_of,
    gather_f32x16,
    i32_at,
    i64_at,
    lanes_below,
    load_columns,
    load_i32x16,
    local_memory,
    lowest_bit,
    mask16,
    maximum,
    minimum,
    ones,
    pack,
    select,
    store,
)

HIDDEN = -1  # instead of a number of primitives
MOST = 64  # primitives that a node keeps for its parts, at most
LANES = 16
WAITING = 4 * (LANES + WIDTH)  # bytes: one leaf more than are judged together
DEPTHS = 5  # of nodes: blocks, their parts and so on
NODES = 8 * DEPTHS * 5 * 8  # bytes: nodes that wait, five numbers each
STEPS, TESTS, CERTIFICATES = range(3)  # counters
COUNTERS = 3
COARSE, ROOM = voxel_grid.BLOCK, voxel_grid.ROOM
HUGE = np.float32(3e38)


class Light(NamedTuple):
    """Light `number` at place (3,) float32, in a slot of `Occluders`; no ray from it is longer than `longest`."""

    number: int
    slot: int
    place: NDArray[np.float32]
    longest: float


class Room(NamedTuple):
    """What a worker classifies in.

    Attributes:
        shaft: of the node at hand.
        found: (DEPTHS, MOST + 32) int32, what the shafts of a node and those around it meet.
        hiders: (LANES,) int32, what has hidden parts of this block from the light, the newest of them.
        state: (2,) int64, how many hiders there are, and which is replaced next.
    """

    shaft: BoxShaft
    found: NDArray[np.int32]
    hiders: NDArray[np.int32]
    state: NDArray[np.int64]


@inlined
def _outside(rows, radii, numbers, t, firm, shaft):
    """Mask of sixteen primitives that lie outside of a shaft, enlarged by their error radii; those that are not firm as
    the boxes that their rows (`light_space`) begin with."""
    row = load_columns(rows, numbers, ROW)
    radius = gather_f32x16(radii, load_i32x16(numbers))
    outside = radius < -HUGE
    for axis in range(3):
        corner, e1, e2 = row[axis], row[3 + axis], row[6 + axis]
        low, high = corner + minimum(ZERO, minimum(e1, e2)), corner + maximum(ZERO, maximum(e1, e2))
        low, high = select(firm, low - radius, t[U + axis]), select(firm, high + radius, t[V + axis])
        outside = outside | (low > np.float32(shaft.box[3 + axis])) | (high < np.float32(shaft.box[axis]))
    for k in range(len(shaft.planes)):
        nx, ny, nz = np.float32(shaft.planes[k, 0]), np.float32(shaft.planes[k, 1]), np.float32(shaft.planes[k, 2])
        e1, e2 = row[3] * nx + row[4] * ny + row[5] * nz, row[6] * nx + row[7] * ny + row[8] * nz
        least = row[0] * nx + row[1] * ny + row[2] * nz + minimum(ZERO, minimum(e1, e2)) - radius
        x = t[U] if nx > ZERO else t[V]
        y = t[U + 1] if ny > ZERO else t[V + 1]
        z = t[U + 2] if nz > ZERO else t[V + 2]
        outside = outside | (select(firm, least, x * nx + y * ny + z * nz) > np.float32(shaft.planes[k, 3]))
    return outside


@inlined
def _judge(rows, radii, light_space, numbers, light, shaft, center, half):
    """Of sixteen primitives, their numbers at an address: bits of those that every ray which enters the cube around
    center (3,) float32 is certain to hit, and of those that none hits before it leaves the cube."""
    t = load_columns(light_space, numbers, LIGHT_ROW)
    hit, missed = judge_box(t, light.place, center, (half, half, half), np.float32(light.longest))
    if any_lane(~hit & ~missed):
        missed = missed | _outside(rows, radii, numbers, t, t[FARTHEST] >= ZERO, shaft)
    return bits_of(hit), bits_of(missed)


@subkernel
def _meet(o, light, room, center, half, numbers, n, found, count, counts):
    """Judge n <= 16 primitives, their numbers at an address; those that may come between join the `count` found.

    How many there are then, or HIDDEN where one hides the whole cube."""
    counts[TESTS] += n
    rows, radii = address_of(o.rows), address_of(o.error_radii[light.slot])
    hit, missed = _judge(rows, radii, address_of(o.light_space[light.slot]), numbers, light, room.shaft, center, half)
    there = lanes_below(n, 0)
    hit &= there
    if hit != 0:
        room.hiders[room.state[1]] = i32_at(numbers)[lowest_bit(hit)]
        room.state[0], room.state[1] = min(LANES, room.state[0] + 1), (room.state[1] + 1) % LANES
        return np.int64(HIDDEN)
    kept = there & ~missed
    store(address_of(found) + 4 * min(count, MOST), pack(load_i32x16(numbers), mask16(kept)))
    return count + ones(kept)


@subkernel
def _hidden(o, light, room, center, half, counts):
    """Whether something hides a cube that has hidden another part of the block."""
    if room.state[0] == 0:
        return False
    counts[TESTS] += room.state[0]
    rows, radii, numbers = address_of(o.rows), address_of(o.error_radii[light.slot]), address_of(room.hiders)
    hit, _missed = _judge(rows, radii, address_of(o.light_space[light.slot]), numbers, light, room.shaft, center, half)
    return hit & lanes_below(room.state[0], 0) != 0


@subkernel
def _from_list(o, light, room, center, half, given, given_count, found, counts):
    """Find primitives among given (given_count,) int32."""
    count, numbers = np.int64(0), local_memory(64)
    for first in range(0, given_count, LANES):
        for k in range(LANES):
            i32_at(numbers)[k] = given[min(first + k, given_count - 1)]
        n = min(LANES, given_count - first)
        count = _meet(o, light, room, center, half, numbers, n, found, count, counts)
        if count < 0:
            return count
    return count


@subkernel
def _from_tree(o, light, room, center, half, found, counts):
    """Find primitives in the tree: how many, more than MOST for too many, or HIDDEN as `_meet` says."""
    count, n = np.int64(0), np.int64(0)
    walk, waiting = begin_walk(local_memory(WALK)), local_memory(WAITING)
    numbers = i32_at(waiting)
    for k in range(LANES + WIDTH):
        numbers[k] = 0
    while True:
        n = walk_on(walk, o, light.slot, room.shaft, numbers, n, LANES, counts)
        if n > 0:
            count = _meet(o, light, room, center, half, waiting, min(n, LANES), found, count, counts)
        if n < LANES or count < 0 or count > MOST:
            return count
        n -= LANES
        for k in range(n):
            numbers[k] = numbers[LANES + k]


@subkernel
def come_between(o, light, room, center, half, given, given_count, found, counts):
    """Find what may come between a light and the cube around center (3,) float32, to which room.shaft was put: how many
    primitives, more than MOST for too many, or HIDDEN where one hides the whole cube.

    Their numbers go into found (MOST + 2 LANES,) int32.  They are among given (given_count,) int32, or anywhere where
    that is more than MOST."""
    if _hidden(o, light, room, center, half, counts):
        return np.int64(HIDDEN)
    if given_count <= MOST:
        return _from_list(o, light, room, center, half, given, given_count, found, counts)
    return _from_tree(o, light, room, center, half, found, counts)


@subkernel
def _fill(words, grid, light, x, y, z, size, mode):
    """Let all voxels of a node have a state."""
    for i in range(x, x + size):
        for j in range(y, y + size):
            for k in range(z, z + size):
                add_shadow(words, (i * grid.ny + j) * grid.nz + k, light, mode)


@inlined
def make_room():
    """Memory to classify in."""
    found = np.zeros((DEPTHS, MOST + 2 * LANES), np.int32)
    return Room(make_box_shaft(), found, np.zeros(LANES, np.int32), np.zeros(2, np.int64))


@kernel
def classify_blocks(o, grid, words, light, rounded, blocks, counts):
    """Put the states of all voxels of blocks (n,), which are still unknown, for a `Light` into their words.

    o are `Occluders` whose only light that is; words are `Words` of voxels; rounded is more, in units of the scene,
    than planes are wrong by in float32.  counts (COUNTERS,) int64 are added to."""
    o = borrowed(o)
    room = make_room()
    met = np.zeros(DEPTHS, np.int64)  # how many primitives each depth has found
    waiting, side = i64_at(local_memory(NODES)), 1.0 / grid.per_unit
    place = np.float64(light.place[0]), np.float64(light.place[1]), np.float64(light.place[2])
    many_y, many_z = grid.ny // COARSE, grid.nz // COARSE
    for block in blocks:
        x, yz = block // (many_y * many_z), block % (many_y * many_z)
        waiting[0], waiting[1], waiting[2] = x * COARSE, yz // many_z * COARSE, yz % many_z * COARSE
        waiting[3], waiting[4], pending = COARSE, 0, 1
        room.state[0] = room.state[1] = 0  # what is proved of a block does not depend on those before it
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
            put_box(room.shaft, place, middle, half, rounded)
            center, reach = (np.float32(middle[0]), np.float32(middle[1]), np.float32(middle[2])), np.float32(half)
            counts[CERTIFICATES] += 1
            found, given, above = room.found[depth], np.int64(MOST + 1), room.found[max(depth, 1) - 1]
            if depth > 0:
                given = met[depth - 1]
            count = come_between(o, light, room, center, reach, above, given, found, counts)
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
