"""Requests for certificates: points whose shadow rays found none, or too little.

Primary hits request what they are about to need before the frame is shaded (`request_at_hits`).  The rays of later
bounces request what they have missed (`request_at_points`), and get it in the next frame.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tracer.culling.modes import MAX_CULLED_LIGHTS
from tracer.culling.stages import vectors
from tracer.neighbours.certified.cells import CANDIDATES, CORNER, LEAF, NORMAL, RECEIVER, ROOTS, UNTRIED
from tracer.neighbours.certified.lookup import NOWHERE, affine
from tracer.neighbours.certified.quadtree import descend
from tracer.runtime.kernels import inlined, subkernel
from tracer.simd import (
    address_of,
    any_lane,
    as_i32,
    bits_of,
    gather_f32x16,
    gather_i32x16,
    i32x16,
    lane_of,
    lanes_below,
    load_columns,
    load_f32x16,
    load_i32x16,
    local_memory,
    lowest_bit,
    select,
    store,
)
from tracer.simd.records import F32x2D, I32x2D, I64x2D

ZERO, HALF, ONE = np.float32(0), np.float32(0.5), np.float32(1)
ROOM = 4096  # requests that a tile can make
FACING = 64 * MAX_CULLED_LIGHTS  # bytes: sixteen numbers for each light


class Requests(NamedTuple):
    """Points that request certificates, with a leading axis of tiles, or in kernels those of one.

    Attributes:
        key: (ROOM,) int32, the cell or, where there is none yet, -1 less the owner.
        u, v: (ROOM,) float32, coordinates in the triangle.
        of: (3,) int64, how many there are, one in how many is kept, and how many were made.
    """

    key: I32x2D
    u: F32x2D
    v: F32x2D
    of: I64x2D


def make_requests(tiles: int) -> Requests:
    """Room for the requests of so many tiles: arrays with a row for each."""
    of = np.zeros((tiles, 3), np.int64)
    of[:, 1] = 1
    shape = (tiles, ROOM)
    return Requests(np.empty(shape, np.int32), np.empty(shape, np.float32), np.empty(shape, np.float32), of)


@inlined
def requests_of(rows, tile):
    """The requests of one tile, of those of all."""
    return Requests(rows.key[tile], rows.u[tile], rows.v[tile], rows.of[tile])


@subkernel
def request_at_points(certified, requests, found, count):
    """Request for `count` points of a wave of which more could be certified.

    certified is a `CertificateView`, requests those of the tile, found are `CellPoints`."""
    for k in range(certified.first_vector, vectors(count), certified.stride):
        bits = np.int64(found.untried[k] | found.doubtful[k])
        if bits == 0:
            continue
        cell = load_i32x16(address_of(found.unit) + 64 * k)
        leaf = bits_of(gather_i32x16(address_of(certified.child), cell) == np.int32(LEAF))
        somewhere = bits_of(load_i32x16(address_of(found.owner) + 64 * k) > np.int32(NOWHERE))
        bits = (np.int64(found.untried[k]) | (np.int64(found.doubtful[k]) & leaf)) & somewhere & lanes_below(count, k)
        while bits != 0:
            i = 16 * k + lowest_bit(bits)
            bits &= bits - 1
            _add_request(requests, _key(found.unit[i], found.owner[i]), found.u[i], found.v[i])


@inlined
def _key(cell, owner):
    """What a request is filed under: its cell, or its owner."""
    return cell if cell > 0 else -1 - owner


@inlined
def _add_request(requests, key, u, v):
    """Keep a request: all at first and, each time there is no more room, every other one."""
    requests.of[2] += 1
    if requests.of[2] % requests.of[1] != 0:
        return
    if requests.of[0] == len(requests.key):
        kept = 0
        for k in range(1, len(requests.key), 2):
            requests.key[kept], requests.u[kept], requests.v[kept] = requests.key[k], requests.u[k], requests.v[k]
            kept += 1
        requests.of[0], requests.of[1] = kept, 2 * requests.of[1]
        if requests.of[2] % requests.of[1] != 0:
            return
    n = requests.of[0]
    requests.key[n], requests.u[n], requests.v[n] = key, u, v
    requests.of[0] = n + 1


@subkernel
def _with_requests(certified, cell, facing):
    """Bits of the points, of sixteen in cells, that a light faces for which more could be known.

    facing (lights, 16) float32, at an address, are positive where a light does."""
    words, size = certified.words.address, certified.words.size
    low = gather_i32x16(words, cell if size == 4 else cell << np.int32(1))
    high = low if size == 4 else gather_i32x16(words + 4, cell << np.int32(1))
    leaf = bits_of(gather_i32x16(address_of(certified.child), cell) == np.int32(LEAF))
    bits = np.int64(0)
    for number in range(len(certified.stationary)):
        if certified.stationary[number] == 0:
            continue
        faces = bits_of(load_f32x16(facing + 64 * number) > ZERO)
        field, shift = (low if 2 + 2 * number < 32 else high), (2 + 2 * number) % 32
        field = (field >> np.int32(shift)) & np.int32(3)
        bits |= faces & (bits_of(field == np.int32(UNTRIED)) | (bits_of(field == np.int32(CANDIDATES)) & leaf))
    return bits


@subkernel
def request_at_hits(certified, requests, lights, origin, hits, place, there):
    """Request what sixteen primary hits are about to need.

    Rays come from origin (3,) and, where they are `there`, have hit what pixels at `place` of the pictures `hits` say:
    primitive, u and v (height, width).  lights (n, 3) float32 are positions; certified is a `CertificateView`."""
    receivers, child = address_of(certified.receivers), address_of(certified.child)
    facing, numbers = local_memory(FACING), local_memory(64)
    primitive = gather_i32x16(address_of(hits[0]), place)
    u, v = gather_f32x16(address_of(hits[1]), place), gather_f32x16(address_of(hits[2]), place)
    hit = there & (primitive > np.int32(NOWHERE))
    primitive = select(hit, primitive, i32x16(0))
    store(numbers, primitive)

    # Find the side of each triangle that was hit.
    row = load_columns(receivers, numbers, RECEIVER)
    back = affine(row, NORMAL, origin[0] - row[CORNER], origin[1] - row[CORNER + 1], origin[2] - row[CORNER + 2]) < ZERO
    way = select(back, -ONE, ONE)
    with_cells = hit & (affine(row, NORMAL, row[NORMAL], row[NORMAL + 1], row[NORMAL + 2]) > HALF)
    if not any_lane(with_cells):
        return

    # Find the lights on that side.
    for number in range(len(certified.stationary)):
        x, y, z = lights[number, 0], lights[number, 1], lights[number, 2]
        above = affine(row, NORMAL, x - row[CORNER], y - row[CORNER + 1], z - row[CORNER + 2])
        store(facing + 64 * number, way * above)

    # Find the leaves; a root that is not there yet is cell 0, of which nothing is known.
    root = select(back, as_i32(row[ROOTS + 1]), as_i32(row[ROOTS]))
    cell = descend(child, select(with_cells, root, i32x16(0)), u, v)

    # Request where a light faces a leaf that has no answer for it.
    bits = _with_requests(certified, cell, facing) & bits_of(with_cells)
    while bits != 0:
        lane = lowest_bit(bits)
        bits &= bits - 1
        owner = 2 * lane_of(primitive, lane) + ((bits_of(back) >> lane) & 1)
        _add_request(requests, _key(lane_of(cell, lane), owner), lane_of(u, lane), lane_of(v, lane))
