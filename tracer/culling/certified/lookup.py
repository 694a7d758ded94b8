"""Which cell a shadow ray ends in, for sixteen points at a time; and what rays wanted to know in vain.

A point is looked up where its shadow rays end, a little above the surface.  Its coordinates in the triangle are
found from there, and one that is not where the prisms of `beam` allow for it has no cell: its rays are traced.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.culling.certified.beam import LOWEST, OFFSET
from tracer.culling.certified.cells import (
    ALONG_U,
    ALONG_V,
    BEYOND_U,
    BEYOND_V,
    CANDIDATES,
    CORNER,
    LEAF,
    NORMAL,
    RECEIVER,
    ROOTS,
    UNTRIED,
    Cells,
    make_cells,
)
from tracer.culling.certified.sights import SIGHT
from tracer.culling.modes import MAX_CULLED_LIGHTS
from tracer.kernels import inlined, subkernel
from tracer.simd import (
    address_of,
    any_lane,
    as_f32,
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


class Wanted(NamedTuple):
    """Points whose rays found no certificate: key (ROOM,) int32, the cell or, where there is none yet, -1 less the
    owner; u and v (ROOM,) float32.  of (3,) int64: how many there are, of how many one is kept, and how many were
    seen."""

    key: NDArray[np.int32]
    u: NDArray[np.float32]
    v: NDArray[np.float32]
    of: NDArray[np.int64]


class Certified(NamedTuple):
    """What a tile is told of certified cells, and asks: the cells; sights (lights, n, SIGHT) float32 of what they name;
    still (lights,) bool, which lights are certified; how high above a cell a ray may end; how many candidates are asked
    at most; whether rays are so dear that every look-up pays; that one in `every` so many vectors of points says what
    it wants, the first being that of this `turn`; and what the tile wants."""

    cells: Cells
    sights: NDArray[np.float32]
    still: NDArray[np.bool_]
    highest: float
    asked: int
    dear: bool
    every: int
    turn: int
    wanted: Wanted


def nothing_wanted() -> Wanted:
    """Room for nothing."""
    return Wanted(np.empty(0, np.int32), np.empty(0, np.float32), np.empty(0, np.float32), np.zeros(3, np.int64))


def nothing_told(lights: int) -> Certified:
    """What tiles are told where nothing is certified."""
    sights, still = np.empty((0, 0, SIGHT), np.float32), np.empty(0, np.bool_)
    return Certified(make_cells(1, lights, 1), sights, still, 0.0, 0, False, 1, 0, nothing_wanted())


@inlined
def _at(row, first, x, y, z):
    return row[first] * x + row[first + 1] * y + row[first + 2] * z


@subkernel
def find_cells(certified, points, count):
    """The cells of points, sixteen by sixteen, into points.unit, which tells their primitives.

    points.lifted are where their rays end; points.spots get u, v and, as int32, their owner, NOWHERE for none.
    Unless rays are `dear`, triangles without a root are not looked at any closer."""
    cells, highest = certified.cells, certified.highest
    child, receivers, lifted, spots = address_of(cells.child), address_of(cells.receivers), points.lifted, points.spots
    stride, rooted_at = 4 * lifted.shape[1], address_of(cells.rooted)
    for k in range((count + 15) // 16):
        at = 64 * k
        numbers = address_of(points.unit) + at
        primitive = load_i32x16(numbers)
        if not certified.dear:
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
        u, v, height = _at(row, ALONG_U, x, y, z), _at(row, ALONG_V, x, y, z), _at(row, NORMAL, x, y, z)
        above = maximum(height, -height)
        largest = maximum(maximum(px, -px), maximum(maximum(py, -py), maximum(pz, -pz)))
        inside = (above >= np.float32(LOWEST * OFFSET) * largest) & (above <= highest) & (above > ZERO)
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
        store(numbers, _descend(child, cell, u, v))


@inlined
def _descend(child, cell, u, v):
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


@subkernel
def want(certified, points, count, untried, doubtful):
    """Note the points of which something could be certified: bits, 16 to an int32, of those with a light of
    which nothing is known yet (`untried`), and of those with one of which a part of the cell may tell more."""
    cells, wanted, spots = certified.cells, certified.wanted, points.spots
    for k in range(certified.turn, (count + 15) // 16, certified.every):
        bits = np.int64(untried[k] | doubtful[k])
        if bits == 0:
            continue
        cell = load_i32x16(address_of(points.unit) + 64 * k)
        leaf = bits_of(gather_i32x16(address_of(cells.child), cell) == np.int32(LEAF))
        somewhere = bits_of(as_i32(load_f32x16(address_of(spots) + 8 * spots.shape[1] + 64 * k)) > np.int32(NOWHERE))
        bits = (np.int64(untried[k]) | (np.int64(doubtful[k]) & leaf)) & somewhere & lanes_below(count, k)
        while bits != 0:
            i = 16 * k + lowest_bit(bits)
            bits &= bits - 1
            _note(wanted, _key(points.unit[i], spots[2].view(np.int32)[i]), spots[0, i], spots[1, i])


@inlined
def _key(cell, owner):
    return cell if cell > 0 else -1 - owner


@inlined
def _note(wanted, key, u, v):
    """Keep a point: all at first and, each time there is no more room, every other one."""
    wanted.of[2] += 1
    if wanted.of[2] % wanted.of[1] != 0:
        return
    if wanted.of[0] == len(wanted.key):
        kept = 0
        for k in range(1, len(wanted.key), 2):
            wanted.key[kept], wanted.u[kept], wanted.v[kept] = wanted.key[k], wanted.u[k], wanted.v[k]
            kept += 1
        wanted.of[0], wanted.of[1] = kept, 2 * wanted.of[1]
        if wanted.of[2] % wanted.of[1] != 0:
            return
    n = wanted.of[0]
    wanted.key[n], wanted.u[n], wanted.v[n] = key, u, v
    wanted.of[0] = n + 1


@subkernel
def _wanting(cells, still, cell, facing):
    """Bits of the cells of sixteen points in which a light of which more could be known faces them; facing
    (lights, 16) are more than 0 where it does."""
    words, size = address_of(cells.words), cells.words.itemsize
    low = gather_i32x16(words, cell if size == 4 else cell << np.int32(1))
    high = low if size == 4 else gather_i32x16(words + 4, cell << np.int32(1))
    leaf = bits_of(gather_i32x16(address_of(cells.child), cell) == np.int32(LEAF))
    bits = np.int64(0)
    for number in range(len(still)):
        if not still[number]:
            continue
        faces = bits_of(load_f32x16(facing + 64 * number) > ZERO)
        field, shift = (low if 2 + 2 * number < 32 else high), (2 + 2 * number) % 32
        field = (field >> np.int32(shift)) & np.int32(3)
        bits |= faces & (bits_of(field == np.int32(UNTRIED)) | (bits_of(field == np.int32(CANDIDATES)) & leaf))
    return bits


@subkernel
def seek(certified, wanted, lights, origin, hits, place, there):
    """Note in wanted what sixteen primary hits are about to want, found by their coordinates in the triangle.

    Rays come from origin (3,) and, where they are `there`, have hit what pixels at `place` of pictures say: primitive,
    u and v (height, width)."""
    cells, receivers, child = certified.cells, address_of(certified.cells.receivers), address_of(certified.cells.child)
    facing, numbers = local_memory(FACING), local_memory(64)
    primitive = gather_i32x16(address_of(hits[0]), place)
    u, v = gather_f32x16(address_of(hits[1]), place), gather_f32x16(address_of(hits[2]), place)
    hit = there & (primitive > np.int32(NOWHERE))
    primitive = select(hit, primitive, i32x16(0))
    store(numbers, primitive)
    row = load_columns(receivers, numbers, RECEIVER)
    back = _at(row, NORMAL, origin[0] - row[CORNER], origin[1] - row[CORNER + 1], origin[2] - row[CORNER + 2]) < ZERO
    way = select(back, -ONE, ONE)
    with_cells = hit & (_at(row, NORMAL, row[NORMAL], row[NORMAL + 1], row[NORMAL + 2]) > HALF)
    if not any_lane(with_cells):
        return
    for number in range(len(certified.still)):
        x, y, z = lights[number, 0], lights[number, 1], lights[number, 2]
        above = _at(row, NORMAL, x - row[CORNER], y - row[CORNER + 1], z - row[CORNER + 2])
        store(facing + 64 * number, way * above)
    root = select(back, as_i32(row[ROOTS + 1]), as_i32(row[ROOTS]))
    cell = _descend(child, select(with_cells, root, i32x16(0)), u, v)
    # A root that is not there yet is cell 0, of which nothing is known: wanted where any light faces it.
    bits = _wanting(cells, certified.still, cell, facing) & bits_of(with_cells)
    while bits != 0:
        lane = lowest_bit(bits)
        bits &= bits - 1
        owner = 2 * lane_of(primitive, lane) + ((bits_of(back) >> lane) & 1)
        _note(wanted, _key(lane_of(cell, lane), owner), lane_of(u, lane), lane_of(v, lane))
