"""Primary rays of a tile, in an order that keeps neighbours together.

A vector of sixteen is a block of 4 x 4 pixels, and blocks follow each other in Morton's order, which
makes 128 rays a block of 16 x 8.
"""

from __future__ import annotations

import numpy as np

from tracer.geometry.camera import primary_direction
from tracer.geometry.memory import data_pointer
from tracer.runtime.kernels import inlined, subkernel
from tracer.shading.wave import DIRECTION, ORIGIN, PATH_LENGTH, PIXEL, WEIGHT, row_of, wave_in
from tracer.simd import (
    address_of,
    any_lane,
    bits_of,
    f32x16,
    lane_numbers_x16,
    lane_of,
    mask16,
    ones,
    pack,
    pack_three,
    store,
    store_three,
    to_f32,
)

BLOCK = 4  # pixels
EDGE = 1  # blocks around the picture, where what is told of blocks leaves room
ALL_LANES = 0xFFFF  # of a block: every pixel


@inlined
def _block(number):
    """Column and row of a block in Morton's order: the even bits of its number and the odd ones."""
    column = row = 0
    for bit in range(8):
        column |= ((number >> (2 * bit)) & 1) << bit
        row |= ((number >> (2 * bit + 1)) & 1) << bit
    return column, row


@inlined
def blocks_of(tile):
    """How many blocks make the square, of a power of two, that a tile (left, top, right, bottom) fits in."""
    side = BLOCK
    while side < max(tile[2] - tile[0], tile[3] - tile[1]):
        side *= 2
    return (side // BLOCK) ** 2


@inlined
def block_at(tile, number):
    """Columns and rows of a block's pixels in the picture, and which of them are inside the tile."""
    column, row = _block(number)
    x = (lane_numbers_x16() & np.int32(BLOCK - 1)) + np.int32(tile[0] + BLOCK * column)
    y = (lane_numbers_x16() >> np.int32(2)) + np.int32(tile[1] + BLOCK * row)
    return x, y, (x < np.int32(tile[2])) & (y < np.int32(tile[3]))


@subkernel
def primary_wave(camera, tile, width, lanes, memory, place):
    """Primary rays of a tile, in a wave's memory, and in place (n,) int32 where each one's pixel is in the picture: of
    the pixels whose bits are set in lanes, int32 of all blocks of the picture and an edge of one around them."""
    n, stride = 0, 4 * memory.shape[1]
    for number in range(blocks_of(tile)):
        x, y, inside = block_at(tile, number)
        if not any_lane(inside):
            continue
        inside = inside & mask16(np.int64(lanes[lane_of(y, 0) // BLOCK + EDGE, lane_of(x, 0) // BLOCK + EDGE]))
        if not any_lane(inside):
            continue
        direction = primary_direction(camera, to_f32(x), to_f32(y))
        at = row_of(memory, 0) + 4 * n
        for axis in range(3):
            store(at + stride * (ORIGIN + axis), f32x16(camera.origin[axis]))
            store(at + stride * (WEIGHT + axis), f32x16(np.float32(1)))
        store_three(at + stride * DIRECTION, stride, pack_three(direction, inside))
        store(at + stride * PATH_LENGTH, f32x16(np.float32(0)))
        store(at + stride * PIXEL, lane_numbers_x16() + np.int32(n))
        store(address_of(place) + 4 * n, pack(y * np.int32(width) + x, inside))
        n += ones(bits_of(inside))
    return wave_in(memory, n)


@inlined
def write_hits(wave, place, buffers):
    """Write what primary rays hit into the picture."""
    depth, primitive = data_pointer(buffers.depth), data_pointer(buffers.primitive)
    u, v = data_pointer(buffers.u), data_pointer(buffers.v)
    for i in range(wave.size):
        depth[place[i]], primitive[place[i]] = wave.t[i], wave.primitive[i]
        u[place[i]], v[place[i]] = wave.u[i], wave.v[i]


@inlined
def read_hits(wave, place, buffers):
    """Read what primary rays hit from the picture."""
    depth, primitive = data_pointer(buffers.depth), data_pointer(buffers.primitive)
    u, v = data_pointer(buffers.u), data_pointer(buffers.v)
    for i in range(wave.size):
        wave.t[i], wave.primitive[i] = depth[place[i]], primitive[place[i]]
        wave.u[i], wave.v[i] = u[place[i]], v[place[i]]
