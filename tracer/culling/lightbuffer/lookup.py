"""Looking rays up in light buffers, sixteen at a time.

A cube's record says for most points whether anything is between them and the light: what ends before its near plane is
lit, and what ends behind its far plane is not.  Where all lanes of a vector have one record, it is read once.  Points in
between are tested against the record's candidates, those of one record together; each answer is taken where it is
certain.  Whatever is not known then is traced.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from tracer.culling.certified.light_space import LIGHT_ROW, verdicts_on
from tracer.culling.counters import CANDIDATES_ONLY, CULLED, DYNAMIC_ONLY, STEPS, TESTS
from tracer.culling.lightbuffer.cube import SEAM, cells_of
from tracer.culling.lightbuffer.items import LEAST
from tracer.culling.lightbuffer.shapes import BLOCKED, COUNT, FIRST, LIT, RECORD, WIDTH_BITS
from tracer.culling.stages import vectors
from tracer.kernels import inlined, subkernel
from tracer.simd import (
    as_i32,
    bits_of,
    f32x16,
    gather_f32x16,
    gather_i32x16,
    i32x16,
    load_columns,
    load_f32,
    load_f32x16,
    load_i32,
    load_i64,
    load_three,
    local_memory,
    lowest_bit,
    ones,
    store,
    store_three,
)
from tracer.simd.records import F32x2D, I64x2D

# Columns of a light's row: of a cube the addresses of its cells, records, lists and rows, and how many cells its side
# has, 0 for no cube; first of all that never moves, then of what rests; of what moves the address of depths, and that
# side; and whether the light is answered for at all.
CELLS, RECORDS, LISTS, ROWS, SIDE = range(5)
STATIC, RESTING, DEPTHS, DEPTHS_SIDE, KNOWN = 0, 5, 10, 11, 12
COLUMNS = 13
ZERO, ONE = np.float32(0), np.float32(1)


class LightBuffers(NamedTuple):
    """What kernels are given.

    Attributes:
        table: (lights, COLUMNS) int64.
        reach: (lights, 4) float32, the squares of how long rays may be that ask the cube of what never moves, and to be
            sure of its hits; the same of what rests.
        moves: whether anything moves.
        tries: regions that the rays of one vector are looked for in, at most, beside that of those before.
        single: whether steps and tests are counted by rays, not by vectors of sixteen.
    """

    table: I64x2D
    reach: F32x2D
    moves: bool
    tries: int
    single: bool


# A node: the region that the last rays were in, as offsets in bytes: the ranges of x / z and y / z, and the sign of z;
# which components of a way, as offsets, are x, y and z; and the address of the region's record.
LEFT, RIGHT, LOW, HIGH, SIGN = range(0, 20, 4)
ALONG_X, ALONG_Y, ALONG_Z, RECORD_AT = range(24, 56, 8)
NODE = 64  # bytes


@subkernel
def _ask_candidates(cube, record, light, way, asked, single, counts):
    """Test the candidates of a record for those rays, as bits, that are asked; (blocked, lit)."""
    count, first = np.int64(load_i32(record + 4 * COUNT)), np.int64(load_i32(record + 4 * FIRST))
    open_rays, missed = asked, asked if count > 0 else np.int64(0)
    blocked = np.int64(0)
    direction = load_f32x16(way), load_f32x16(way + 64), load_f32x16(way + 128)
    end = load_f32x16(way + 192), load_f32x16(way + 256), load_f32x16(way + 320)
    for k in range(count):
        row = cube.rows + 4 * LIGHT_ROW * np.int64(load_i32(cube.lists + 4 * (first + k)))
        t = (
            f32x16(load_f32(row)), f32x16(load_f32(row + 4)), f32x16(load_f32(row + 8)), f32x16(load_f32(row + 12)),
            f32x16(load_f32(row + 16)), f32x16(load_f32(row + 20)), f32x16(load_f32(row + 24)),
            f32x16(load_f32(row + 28)), f32x16(load_f32(row + 32)), f32x16(load_f32(row + 36)),
            f32x16(load_f32(row + 40)), f32x16(load_f32(row + 44)), f32x16(load_f32(row + 48)),
            f32x16(load_f32(row + 52)), f32x16(load_f32(row + 56)), f32x16(load_f32(row + 60)),
        )  # fmt: skip
        counts[TESTS] += ones(open_rays) if single else 1
        hit, miss = verdicts_on(t, light, direction, end)
        blocked |= np.int64(hit) & open_rays
        missed &= np.int64(miss)
        open_rays &= ~np.int64(hit)
        if open_rays == 0:
            break
    return blocked, missed & ~blocked


class _Cube(NamedTuple):
    """A cube, as addresses."""

    cells: Any
    records: Any
    lists: Any
    rows: Any
    side: Any


@inlined
def _cube_at(row, first):
    return _Cube(row[first + CELLS], row[first + RECORDS], row[first + LISTS], row[first + ROWS], row[first + SIDE])


@inlined
def _go_to(cube, node, face, column, row, code):
    """Put the region of a cell into a node."""
    axis, sign = face >> 1, -ONE if face & 1 else ONE
    width, cell = np.int64(1) << (code & ((1 << WIDTH_BITS) - 1)), np.float32(2) / np.float32(cube.side)
    left, low = np.float32(column & -width) * cell - ONE, np.float32(row & -width) * cell - ONE
    wide, room = cell * np.float32(width), np.float32(SEAM)
    store(node + LEFT, left - room)
    store(node + RIGHT, left + wide + room)
    store(node + LOW, low - room)
    store(node + HIGH, low + wide + room)
    store(node + SIGN, sign)
    store(node + ALONG_X, np.int64(64 if axis == 0 else 0))
    store(node + ALONG_Y, np.int64(64 if axis == 2 else 128))
    store(node + ALONG_Z, np.int64(64 * axis))
    store(node + RECORD_AT, cube.records + 4 * RECORD * (code >> WIDTH_BITS))


@inlined
def _in_node(node, way):
    """Mask of those of sixteen ways that lead into a node's region."""
    z = load_f32x16(way + load_i64(node + ALONG_Z)) * load_f32(node + SIGN)
    x, y = load_f32x16(way + load_i64(node + ALONG_X)), load_f32x16(way + load_i64(node + ALONG_Y))
    inside = (x >= z * load_f32(node + LEFT)) & (x <= z * load_f32(node + RIGHT)) & (z >= np.float32(LEAST))
    return inside & (y >= z * load_f32(node + LOW)) & (y <= z * load_f32(node + HIGH))


@subkernel
def _ask_apart(cube, node, light, way, asked, sure, tries, single, counts):
    """Look rays up that are not all in one region, each in that of its own: as `_ask_cube`."""
    memory = local_memory(4 * 64)
    dx, dy, dz = load_f32x16(way), load_f32x16(way + 64), load_f32x16(way + 128)
    depth, face, column, row = cells_of((dx, dy, dz), cube.side)
    side = np.int32(cube.side)
    code = gather_i32x16(cube.cells, (face * side + row) * side + column)
    number = code >> np.int32(WIDTH_BITS)
    store(memory, number)
    t = load_columns(cube.records, memory, RECORD)
    there = np.int64(bits_of(depth >= np.float32(LEAST))) & asked
    lit = np.int64(bits_of(dx * t[LIT] + dy * t[LIT + 1] + dz * t[LIT + 2] < ONE)) & there
    blocked = np.int64(bits_of(dx * t[BLOCKED] + dy * t[BLOCKED + 1] + dz * t[BLOCKED + 2] > ONE)) & there & sure
    counts[STEPS] += ones(asked) if single else 1
    # Test the candidates of those in between, of one record after the other.
    rest, tested = there & ~(lit | blocked) & bits_of(as_i32(t[COUNT]) > np.int32(0)), np.int64(0)
    while rest != 0 and tries > 0:
        tries -= 1
        first = load_i32(memory + 4 * lowest_bit(rest))
        together = np.int64(bits_of(number == i32x16(first))) & rest
        rest &= ~together
        record = cube.records + 4 * RECORD * np.int64(first)
        hit, missed = _ask_candidates(cube, record, light, way, together, single, counts)
        blocked |= hit
        lit |= missed
        tested |= hit | missed
    # The next rays will be where the first of these was.
    store(memory, face)
    store(memory + 64, column)
    store(memory + 128, row)
    store(memory + 192, code)
    at = memory + 4 * lowest_bit(asked)
    _go_to(
        cube, node, np.int64(load_i32(at)), np.int64(load_i32(at + 64)), np.int64(load_i32(at + 128)),
        np.int64(load_i32(at + 192)),
    )  # fmt: skip
    return blocked, lit, tested


@inlined
def _ask_cube(cube, node, reach, sure, light, way, square, live, tries, single, counts):
    """Look live rays, as bits, up in a cube: (blocked, lit, those of either that candidates have answered), as bits.

    Their ways lie at an address.  The node is where the rays before these were."""
    asked, certain = np.int64(bits_of(square <= reach)) & live, np.int64(bits_of(square <= sure))
    here = np.int64(bits_of(_in_node(node, way))) & asked
    if here != asked:
        return _ask_apart(cube, node, light, way, asked, certain, tries, single, counts)
    counts[STEPS] += ones(here) if single else 1
    dx, dy, dz = load_f32x16(way), load_f32x16(way + 64), load_f32x16(way + 128)
    record = load_i64(node + RECORD_AT)
    a = record + 4 * LIT
    lit = np.int64(bits_of(dx * load_f32(a) + dy * load_f32(a + 4) + dz * load_f32(a + 8) < ONE)) & here
    a = record + 4 * BLOCKED
    blocked = np.int64(bits_of(dx * load_f32(a) + dy * load_f32(a + 4) + dz * load_f32(a + 8) > ONE)) & here & certain
    rest, tested = here & ~(lit | blocked), np.int64(0)
    if rest != 0 and load_i32(record + 4 * COUNT) != 0:
        hit, missed = _ask_candidates(cube, record, light, way, rest, single, counts)
        blocked |= hit
        lit |= missed
        tested = hit | missed
    return blocked, lit, tested


@subkernel
def ask_buffers(buffers, points, position, number, count, batch, counts):
    """Answer the live rays to light `number` at position (3,) that its buffers tell about."""
    row = buffers.table[number]
    if row[KNOWN] == 0:
        return
    light = position[0], position[1], position[2]
    static, resting, depths = _cube_at(row, STATIC), _cube_at(row, RESTING), row[DEPTHS]
    way, node, resting_node = local_memory(6 * 64), local_memory(NODE), local_memory(NODE)
    for a in (node, resting_node):  # where nothing is yet
        store(a + LEFT, ONE)
        store(a + RIGHT, -ONE)
        store(a + LOW, ONE)
        store(a + HIGH, -ONE)
        store(a + SIGN, ONE)
        store(a + ALONG_X, np.int64(0))
        store(a + ALONG_Y, np.int64(0))
        store(a + ALONG_Z, np.int64(0))
        store(a + RECORD_AT, static.records)
    tries, single = buffers.tries, buffers.single
    for v in range(vectors(count)):
        live = np.int64(batch.live[v])
        if live == 0:
            continue
        x, y, z = load_three(points.lifted, v)
        dx, dy, dz = x - light[0], y - light[1], z - light[2]
        square = dx * dx + dy * dy + dz * dz
        store_three(way, 64, (dx, dy, dz))
        store_three(way + 192, 64, (x, y, z))
        # Ask what never moves, and about what that leaves lit what rests.
        reach, sure = buffers.reach[number, 0], buffers.reach[number, 1]
        blocked, lit, tested = _ask_cube(
            static, node, reach, sure, light, way, square, live, tries, single, counts
        )
        if resting.side != 0 and lit != 0:
            reach, sure = buffers.reach[number, 2], buffers.reach[number, 3]
            hit, lit, more = _ask_cube(
                resting, resting_node, reach, sure, light, way, square, lit, tries, single, counts
            )
            blocked |= hit
            tested |= more
        # What is nearer than anything that moves is settled.
        settled = lit
        if buffers.moves and lit != 0:
            side = np.int32(row[DEPTHS_SIDE])
            depth, face, column, line = cells_of((dx, dy, dz), row[DEPTHS_SIDE])
            beyond = gather_f32x16(depths, (face * side + line) * side + column)
            counts[STEPS] += ones(lit) if single else 1
            settled = np.int64(bits_of(depth < beyond)) & lit
        batch.live[v] = live & ~(blocked | lit)
        batch.lit[v] |= lit
        batch.settled[v] |= settled
        tested &= blocked | settled
        counts[CULLED] += ones((blocked | settled) & ~tested)
        counts[CANDIDATES_ONLY] += ones(tested)
        counts[DYNAMIC_ONLY] += ones(lit & ~settled)
