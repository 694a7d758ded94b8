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
from tracer.culling.lightbuffer.cube import cells_of
from tracer.culling.lightbuffer.items import LEAST
from tracer.culling.lightbuffer.shapes import BLOCKED, COUNT, FIRST, LIT, RECORD
from tracer.culling.stages import vectors
from tracer.kernels import inlined, subkernel
from tracer.simd import (
    address_of,
    bits_of,
    f32x16,
    gather_f32x16,
    gather_i32x16,
    i32x16,
    load_columns,
    load_f32,
    load_i32,
    load_three,
    local_memory,
    lowest_bit,
    ones,
    store,
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
        groups: records of one vector whose candidates are tested, at most.
        single: whether steps and tests are counted by rays, not by vectors of sixteen.
    """

    table: I64x2D
    reach: F32x2D
    moves: bool
    groups: int
    single: bool


class _Way(NamedTuple):
    """Sixteen rays: where they end, what leads there from the light, the square of its length, and its largest
    component."""

    end: Any
    direction: Any
    square: Any
    depth: Any


@inlined
def _times(plane, direction):
    return plane[0] * direction[0] + plane[1] * direction[1] + plane[2] * direction[2]


@subkernel
def _ask_candidates(cube, record, light, way, asked, single, counts):
    """Test the candidates of a record for those rays, as bits, that are asked; (blocked, lit)."""
    count, first = np.int64(load_i32(record + 4 * COUNT)), np.int64(load_i32(record + 4 * FIRST))
    open_rays, missed = asked, asked if count > 0 else np.int64(0)
    blocked = np.int64(0)
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
        hit, miss = verdicts_on(t, light, way.direction, way.end)
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


@subkernel
def _ask_cube(cube, reach, sure, light, way, live, groups, single, counts):
    """Look live rays, as bits, up in a cube: (blocked, lit, those of either that candidates have answered), as bits."""
    _, face, column, row = cells_of(way.direction, cube.side)
    side = np.int32(cube.side)
    number = gather_i32x16(cube.cells, (face * side + row) * side + column)
    counts[STEPS] += ones(live) if single else 1
    sane = bits_of((way.depth >= np.float32(LEAST)) & (way.square <= reach)) & live
    memory = local_memory(64)
    store(memory, number)
    first = load_i32(memory + 4 * lowest_bit(live))
    same = bits_of(number == i32x16(first)) & live
    if same == live:
        a = cube.records + 4 * RECORD * np.int64(first)
        near = load_f32(a + 4 * LIT), load_f32(a + 4 * LIT + 4), load_f32(a + 4 * LIT + 8)
        far = load_f32(a + 4 * BLOCKED), load_f32(a + 4 * BLOCKED + 4), load_f32(a + 4 * BLOCKED + 8)
        lit, blocked = bits_of(_times(near, way.direction) < ONE), bits_of(_times(far, way.direction) > ONE)
    else:
        t = load_columns(cube.records, memory, RECORD)
        lit = bits_of(_times((t[LIT], t[LIT + 1], t[LIT + 2]), way.direction) < ONE)
        blocked = bits_of(_times((t[BLOCKED], t[BLOCKED + 1], t[BLOCKED + 2]), way.direction) > ONE)
    lit, blocked = np.int64(lit) & sane, np.int64(blocked) & sane & bits_of(way.square <= sure)
    rest, tested, tries = sane & ~(lit | blocked), np.int64(0), groups
    while rest != 0 and tries > 0:
        tries -= 1
        first = load_i32(memory + 4 * lowest_bit(rest))
        asked = bits_of(number == i32x16(first)) & rest
        rest &= ~asked
        record = cube.records + 4 * RECORD * np.int64(first)
        if load_i32(record + 4 * COUNT) == 0:
            continue
        hit, missed = _ask_candidates(cube, record, light, way, asked, single, counts)
        blocked |= hit
        lit |= missed
        tested |= hit | missed
    return blocked, lit, tested


@subkernel
def ask_buffers(buffers, points, position, number, count, batch, counts):
    """Answer the live rays to light `number` at position (3,) that its buffers tell about."""
    row = buffers.table[number]
    if row[KNOWN] == 0:
        return
    light = position[0], position[1], position[2]
    static, resting, depths = _cube_at(row, STATIC), _cube_at(row, RESTING), row[DEPTHS]
    for v in range(vectors(count)):
        live = np.int64(batch.live[v])
        if live == 0:
            continue
        x, y, z = load_three(points.lifted, v)
        direction = x - light[0], y - light[1], z - light[2]
        depth, face, column, line = cells_of(direction, row[DEPTHS_SIDE])
        way = _Way((x, y, z), direction, _times(direction, direction), depth)
        # Ask what never moves, and about what that leaves lit what rests.
        blocked, lit, tested = _ask_cube(
            static, buffers.reach[number, 0], buffers.reach[number, 1], light, way, live, buffers.groups,
            buffers.single, counts,
        )
        if resting.side != 0 and lit != 0:
            hit, lit, more = _ask_cube(
                resting, buffers.reach[number, 2], buffers.reach[number, 3], light, way, lit, buffers.groups,
                buffers.single, counts,
            )
            blocked |= hit
            tested |= more
        # What is nearer than anything that moves is settled.
        settled = lit
        if buffers.moves and lit != 0:
            side = np.int32(row[DEPTHS_SIDE])
            beyond = gather_f32x16(depths, (face * side + line) * side + column)
            counts[STEPS] += ones(lit) if buffers.single else 1
            settled = np.int64(bits_of(depth < beyond)) & lit
        batch.live[v] = live & ~(blocked | lit)
        batch.lit[v] |= lit
        batch.settled[v] |= settled
        tested &= blocked | settled
        counts[CULLED] += ones((blocked | settled) & ~tested)
        counts[CANDIDATES_ONLY] += ones(tested)
        counts[DYNAMIC_ONLY] += ones(lit & ~settled)
