"""Looking rays up in light buffers, sixteen at a time.

The live rays of a wave are packed, and each step is done for all of them before the next is begun: where none waits for
another, the processor has many on their way to memory at the same time.

1. In which cell of the cube is each?
2. What does the record of the cell say?  What ends before its near plane is lit; what ends behind its far plane is not.
3. Those in between, whose cells have few candidates, are tested against these (`candidates`).
4. What nothing static is in the way of asks what rests in the same way, and how near anything moves.

Whatever is not known then is traced.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from tracer.culling.counters import CANDIDATES_ONLY, CULLED, DYNAMIC_ONLY, STEPS
from tracer.culling.stages import vectors
from tracer.neighbours.lightbuffer.candidates import (
    BY_CANDIDATES,
    LIT_RAY,
    OPEN_RAY,
    SETTLED_RAY,
    SHADOWED_RAY,
    ask_candidates,
)
from tracer.neighbours.lightbuffer.cube import COUNT, FIRST, RECORD, WIDTH_BITS, cells_of
from tracer.neighbours.lightbuffer.items import LEAST
from tracer.runtime.kernels import inlined, subkernel
from tracer.simd import (
    address_of,
    as_f32,
    as_i32,
    bits_of,
    i32_at,
    i32x16,
    lane_numbers_x16,
    lanes_below,
    load_columns,
    load_f32,
    load_i32,
    load_i32x16,
    load_spread_bytes16,
    load_three,
    lowest_bit,
    mask16,
    maximum,
    ones,
    pack,
    pack_three,
    select,
    store,
    store_bytes,
    store_three,
)
from tracer.simd.records import F32x2D, I64x2D

# Columns of a light's row: of a cube the addresses of its cells, records, lists and rows, and how many cells its side
# has, 0 for no cube; first of all that never moves, then of what rests; the address of depths, of all that can move, 0
# where nothing can, and of what moves, and their side; and whether the light is answered for at all.
CELLS, RECORDS, LISTS, ROWS, SIDE = range(5)
STATIC, RESTING, DEPTHS, MOVING, DEPTHS_SIDE, KNOWN = 0, 5, 10, 11, 12, 13
COLUMNS = 14
ONE = np.float32(1)


class LightBuffers(NamedTuple):
    """What kernels are given.

    Attributes:
        table: (lights, COLUMNS) int64.
        reach: (lights, 4) float32, the squares of how long rays may be that ask the cube of what never moves, and to be
            sure of its hits; the same of what rests.
        moves: whether anything moves.
        single: whether steps and tests are counted by rays, not by vectors of sixteen.
    """

    table: I64x2D
    reach: F32x2D
    moves: bool
    single: bool


class _Cube(NamedTuple):
    """A cube, as addresses, with how long rays may be."""

    cells: Any
    records: Any
    lists: Any
    rows: Any
    side: Any
    reach: Any
    sure: Any


@inlined
def _cube_at(buffers, light, first):
    row, k = buffers.table[light], 0 if first == STATIC else 2
    return _Cube(
        row[first + CELLS], row[first + RECORDS], row[first + LISTS], row[first + ROWS], row[first + SIDE],
        buffers.reach[light, k], buffers.reach[light, k + 1],
    )  # fmt: skip


@subkernel
def _pack_live(points, count, batch, rays):
    """Pack where live rays end; how many there are."""
    n, at, stride = np.int64(0), address_of(rays.end), 4 * rays.end.shape[1]
    for v in range(vectors(count)):
        live = np.int64(batch.live[v])
        if live != 0:
            store_three(at + 4 * n, stride, pack_three(load_three(points.lifted, v), mask16(live)))
            n += ones(live)
    return n


@inlined
def _way(rays, light, k):
    """Where the k-th vector of rays leads from the light."""
    x, y, z = load_three(rays.end, k)
    return x - light[0], y - light[1], z - light[2]


@inlined
def _find_cells(side, light, rays, n):
    """Find the cell of each ray, in a cube with such a side, into rays.code."""
    wide = np.int32(side)
    for k in range(vectors(n)):
        _, face, column, row = cells_of(_way(rays, light, k), side)
        store(address_of(rays.code) + 64 * k, (face * wide + row) * wide + column)


@subkernel
def _find_records(cube, light, rays, n):
    """Find what each ray's cell names, into rays.code.

    One by one: these loads wait for nothing, and gathering takes several times as long."""
    _find_cells(cube.side, light, rays, n)
    cells, code = i32_at(cube.cells), i32_at(address_of(rays.code))
    for i in range(16 * vectors(n)):
        code[i] = cells[code[i]] >> np.int32(WIDTH_BITS)


@inlined
def _products(t, dx, dy, dz):
    """What the two planes of records, given as columns or one by one, say of ways."""
    return dx * t[0] + dy * t[1] + dz * t[2], dx * t[3] + dy * t[4] + dz * t[5]


@subkernel
def _ask_records(cube, light, rays, n, first):
    """Let records answer: each ray, or where it is not the `first` cube those that are lit but not settled, gets its
    answer in rays.answer.  How many are open, and put into questions, with candidates."""
    asked, least = np.int64(0), np.float32(3 * LEAST * LEAST)
    for k in range(vectors(n)):
        at, codes, there = address_of(rays.answer) + 64 * k, address_of(rays.code) + 64 * k, lanes_below(n, k)
        before = load_i32x16(at)
        if not first:
            there &= bits_of((before & np.int32(LIT_RAY | SETTLED_RAY)) == np.int32(LIT_RAY))
            if there == 0:
                continue
        dx, dy, dz = _way(rays, light, k)
        square, one = dx * dx + dy * dy + dz * dz, np.int64(load_i32(codes + 4 * lowest_bit(there)))
        if bits_of(load_i32x16(codes) == i32x16(np.int32(one))) & there == there:
            a = cube.records + 4 * RECORD * one
            near, far = _products(
                (load_f32(a), load_f32(a + 4), load_f32(a + 8), load_f32(a + 12), load_f32(a + 16), load_f32(a + 20)),
                dx, dy, dz,
            )  # fmt: skip
            following, left = i32x16(load_i32(a + 4 * FIRST)), i32x16(load_i32(a + 4 * COUNT))
        else:
            t = load_columns(cube.records, codes, RECORD)
            near, far = _products(t, dx, dy, dz)
            following, left = as_i32(t[FIRST]), as_i32(t[COUNT])
        in_reach = (square <= cube.reach) & (square >= least)
        lit, blocked = in_reach & (near < ONE), in_reach & (far > ONE) & (square <= cube.sure)
        answer = select(blocked, np.int32(SHADOWED_RAY), select(lit, np.int32(LIT_RAY), i32x16(OPEN_RAY)))
        store(at, answer if first else select(mask16(there), answer, before))
        some = mask16(there) & in_reach & ~lit & ~blocked & (left > np.int32(0))
        bits = bits_of(some)
        if bits != 0:
            a = 4 * asked
            store(address_of(rays.ray) + a, pack(lane_numbers_x16() + np.int32(16 * k), some))
            store(address_of(rays.next) + a, pack(following, some))
            store(address_of(rays.left) + a, pack(left, some))
            stride = 4 * rays.asked.shape[1]
            store_three(address_of(rays.asked) + a, stride, pack_three(load_three(rays.end, k), some))
            asked += ones(bits)
    return asked


@subkernel
def _settle(depths, side, light, rays, n):
    """Settle the lit rays to what is nearer than anything in `depths`; whether any are left."""
    _find_cells(side, light, rays, n)
    found, code = i32_at(depths), i32_at(address_of(rays.code))
    for i in range(16 * vectors(n)):
        code[i] = found[code[i]]
    some = np.int64(0)
    for k in range(vectors(n)):
        at = address_of(rays.answer) + 64 * k
        answer = load_i32x16(at)
        dx, dy, dz = _way(rays, light, k)
        depth = maximum(maximum(dx, -dx), maximum(maximum(dy, -dy), maximum(dz, -dz)))
        lit = (answer & np.int32(LIT_RAY)) > np.int32(0)
        settled = depth < as_f32(load_i32x16(address_of(rays.code) + 64 * k))
        store(at, select(lit & settled, answer | np.int32(SETTLED_RAY), answer))
        some |= bits_of(lit & ~settled) & lanes_below(n, k)
    return some != 0


@inlined
def _lookups(n, single):
    return n if single else vectors(n)


@inlined
def _ask_cube(cube, light, rays, n, first, single, counts):
    """Look rays up in a cube."""
    _find_records(cube, light, rays, n)
    counts[STEPS] += _lookups(n, single)
    asked = _ask_records(cube, light, rays, n, first)
    if asked > 0:
        ask_candidates(cube, light, rays, asked, single, counts)


@subkernel
def ask_buffers(buffers, points, position, number, count, rays, batch, counts):
    """Answer the live rays to light `number` at position (3,) that its buffers tell about; `rays` is memory."""
    row, single = buffers.table[number], buffers.single
    if row[KNOWN] == 0:
        return
    light = position[0], position[1], position[2]
    n = _pack_live(points, count, batch, rays)
    if n == 0:
        return
    _ask_cube(_cube_at(buffers, number, STATIC), light, rays, n, True, single, counts)
    settles, rests, side = row[DEPTHS] != 0, row[RESTING + SIDE] != 0, row[DEPTHS_SIDE]
    if settles:
        counts[STEPS] += _lookups(n, single)
        if _settle(row[DEPTHS], side, light, rays, n) and rests:
            _ask_cube(_cube_at(buffers, number, RESTING), light, rays, n, False, single, counts)
            if buffers.moves:
                counts[STEPS] += _lookups(n, single)
                _settle(row[MOVING], side, light, rays, n)
    _answer(buffers.moves, rays, n, count, batch, counts)


@subkernel
def _answer(moves, rays, n, count, batch, counts):
    """Give each of n rays its answer."""
    answers, at = address_of(rays.answer), address_of(rays.code)
    for k in range(vectors(n)):
        store_bytes(at + 16 * k, load_i32x16(answers + 64 * k))
    for v in range(vectors(count)):
        live = np.int64(batch.live[v])
        if live == 0:
            continue
        answer = load_spread_bytes16(at, mask16(live))
        at += ones(live)
        lit = bits_of((answer & np.int32(LIT_RAY)) > np.int32(0))
        blocked = bits_of((answer & np.int32(SHADOWED_RAY)) > np.int32(0))
        tested = bits_of((answer & np.int32(BY_CANDIDATES)) > np.int32(0))
        settled = bits_of((answer & np.int32(SETTLED_RAY)) > np.int32(0)) if moves else lit
        batch.live[v] = live & ~(blocked | lit)
        batch.lit[v] |= lit
        batch.settled[v] |= settled
        tested &= blocked | settled
        counts[CULLED] += ones((blocked | settled) & ~tested)
        counts[CANDIDATES_ONLY] += ones(tested)
        counts[DYNAMIC_ONLY] += ones(lit & ~settled)
        batch.candidates[v] |= tested
