"""Divide a face of the cube into regions of which one record tells what is in the way.

A region is a square of cells, at first the whole face.  Its items are those of its parent that some ray through it may
hit.  Once one of them covers all of it for certain, those that lie beyond its far plane everywhere are dropped: what
they could block is blocked already.  A region in which nothing is left, or one triangle that covers it, is done; any
other is cut into four, down to single cells.

The record of a region then has

- a near plane: nothing blocks what ends before it.  It is the near function of the item nearest at its middle, raised
  so that it lies before all others; or, if that is farther from the light there, a plane at right angles to the axis;
- a far plane: of the nearest item that covers the region, if there is one.  It surely blocks what ends behind;
- and the items, if they are few, with which rays are tested that end between the two.

An item that was dropped because of a cover needs no care further down, where another may be nearer: the cover stays
among the items, and so no near plane lies behind what it hid.  A ray that ends beyond the cover but before the far
plane is tested against the cover.
"""

from __future__ import annotations

import numpy as np

from tracer.geometry.memory import without_refcount
from tracer.neighbours.lightbuffer.cube import (
    BLOCKED,
    COUNT,
    COVERS,
    FIRST,
    HIGH_X,
    HIGH_Y,
    ITEM,
    KEEP,
    LESS,
    LIT,
    LOW_X,
    LOW_Y,
    NEAR,
    NEAREST,
    NEVER,
    NOTHING,
    NUMBER,
    OF_U,
    OF_V,
    SEAM,
    SPAN,
    WIDTH_BITS,
    U,
    V,
    W,
    axes_of,
)
from tracer.runtime.kernels import inlined, kernel, subkernel
from tracer.simd import (
    address_of,
    any_lane,
    bits_of,
    i32x16,
    lanes_below,
    load_columns,
    load_f32x16,
    load_i32,
    load_i32x16,
    lowest_bit,
    mask16,
    maximum,
    ones,
    pack,
    select,
    store,
)
from tracer.visibility.error_bounds import LANES, Functions, beside, inside

ZERO, ONE = np.float32(0), np.float32(1)
ROUNDED = np.float32(2e-6)  # of all coefficients, by which comparisons of planes may be wrong
# Columns of a region that waits: the first column and row of its cells, how many it is wide, and where in the arena
# the items of its parent begin and end.
COLUMN, ROW, WIDTH, BEGIN, END = range(5)
WAITING = 5
DEPTH = 3 * 16 + 1  # regions that wait, at most
# Rows of what is found of a region's items: the near function, and the inverse of the least depth.
NX, NY, NZ, NEAREST_ROW = range(4)
FOUND = 4
# What a division comes to: how many records and list entries there are, how many regions were looked at, and how many
# items of theirs.
RECORDS_USED, LISTED, LOOKED_AT, LOOKED_FOR = range(4)
CAME_TO = 4


@inlined
def _size(a):
    return maximum(a, -a)


@subkernel
def _filter(items, spans, arena, begin, end, x, y, half, found):
    """Keep those items, whose numbers stand in the arena from begin to end, that rays through the square of half this
    width around (x, y) may hit: from `end` on, their near functions in `found`.

    (how many; the one that covers the square and is nearest, or -1)."""
    rows, more, names = address_of(items), address_of(spans), address_of(arena)
    n, cover, best = np.int64(0), np.int64(-1), ZERO
    left, right, low, high = x - half, x + half, y - half, y + half
    for at in range(begin, end, LANES):
        there = lanes_below(end - at, 0)
        number = select(mask16(there), load_i32x16(names + 4 * at), i32x16(0))
        place = names + 4 * (end + n)  # which is free: put the numbers there for the columns
        store(place, number)
        s = load_columns(more, place, SPAN)
        met = (s[LOW_X] <= right) & (s[HIGH_X] >= left) & (s[LOW_Y] <= high) & (s[HIGH_Y] >= low) & mask16(there)
        if not any_lane(met):
            continue
        t = load_columns(rows, place, ITEM)
        u, v, w = (
            t[U] * x + t[U + 1] * y + t[U + 2],
            t[V] * x + t[V + 1] * y + t[V + 2],
            t[W] * x + t[W + 1] * y + t[W + 2],
        )
        du, dv, dw = (
            half * (_size(t[U]) + _size(t[U + 1])),
            half * (_size(t[V]) + _size(t[V + 1])),
            half * (_size(t[W]) + _size(t[W + 1])),
        )
        m = Functions(t[OF_U], t[OF_V], t[OF_U] + t[OF_V], ZERO)  # B is for the planes to tell
        met = met & ~beside(Functions(u + du, v + dv, w + dw, ZERO), m)
        if not any_lane(met):
            continue
        covers = met & (s[COVERS] > ZERO) & inside(Functions(u - du, v - dv, w - dw, ZERO), m)
        if any_lane(covers):
            far = (t[NEAR] * x + t[NEAR + 1] * y + t[NEAR + 2]) * t[KEEP] - t[LESS]
            store(address_of(found) + 4 * n, far)
            bits = bits_of(covers)
            while bits != 0:
                k = lowest_bit(bits)
                bits &= bits - 1
                if found[0, n + k] > best:
                    best, cover = found[0, n + k], np.int64(load_i32(place + 4 * k))
        stride = 4 * found.shape[1]
        a = address_of(found) + 4 * n
        store(a + NX * stride, pack(t[NEAR], met))
        store(a + NY * stride, pack(t[NEAR + 1], met))
        store(a + NZ * stride, pack(t[NEAR + 2], met))
        store(a + NEAREST_ROW * stride, pack(s[NEAREST], met))
        store(place, pack(number, met))
        n += ones(bits_of(met))
    return n, cover


@inlined
def _far_plane(items, cover):
    keep = items[cover, KEEP]
    return (
        items[cover, NEAR] * keep,
        items[cover, NEAR + 1] * keep,
        items[cover, NEAR + 2] * keep - items[cover, LESS],
    )


@subkernel
def _drop_hidden(items, arena, first, count, cover, x, y, half, found):
    """Drop those of `count` items, from `first` on in the arena, that lie beyond the far plane of one that covers the
    square; how many remain."""
    names, stride = address_of(arena), 4 * found.shape[1]
    fx, fy, fz = _far_plane(items, cover)
    size = abs(fx) + abs(fy) + abs(fz)
    least = fx * x + fy * y + fz - half * (abs(fx) + abs(fy)) - ROUNDED * size
    n = np.int64(0)
    for k in range(0, count, LANES):
        number, a = load_i32x16(names + 4 * (first + k)), address_of(found) + 4 * k
        nx, ny, nz = load_f32x16(a + NX * stride), load_f32x16(a + NY * stride), load_f32x16(a + NZ * stride)
        nearest = load_f32x16(a + NEAREST_ROW * stride)
        room = ROUNDED * (_size(nx) + _size(ny) + _size(nz) + size)
        before = (nx - fx) * x + (ny - fy) * y + (nz - fz) + half * (_size(nx - fx) + _size(ny - fy)) + room
        stays = ((before >= ZERO) & (nearest >= least)) | (number == np.int32(cover))
        stays = stays & mask16(lanes_below(count - k, 0))
        a = address_of(found) + 4 * n
        store(a + NX * stride, pack(nx, stays))
        store(a + NY * stride, pack(ny, stays))
        store(a + NZ * stride, pack(nz, stays))
        store(a + NEAREST_ROW * stride, pack(nearest, stays))
        store(names + 4 * (first + n), pack(number, stays))
        n += ones(bits_of(stays))
    return n


@inlined
def _put_plane(record, first, plane, face):
    """Put a plane, in the order of a face's axes, into a record."""
    ax, ay, az, sign = axes_of(face)
    record[first + ax], record[first + ay], record[first + az] = plane[0], plane[1], plane[2] * np.float32(sign)


@subkernel
def _near_plane(found, count, x, y, half):
    """A plane before which nothing is blocked by any of so many items."""
    nearest, at, highest = 0, ZERO - NEVER, ZERO
    for k in range(count):
        middle = found[NX, k] * x + found[NY, k] * y + found[NZ, k]
        most = middle + half * (abs(found[NX, k]) + abs(found[NY, k]))
        highest = max(highest, min(most, found[NEAREST_ROW, k]))
        if min(middle, found[NEAREST_ROW, k]) > at:
            nearest, at = k, min(middle, found[NEAREST_ROW, k])
    nx, ny, nz = found[NX, nearest], found[NY, nearest], found[NZ, nearest]
    middle, spread, raised = nx * x + ny * y + nz, half * (abs(nx) + abs(ny)), ZERO
    for k in range(count):
        dx, dy = found[NX, k] - nx, found[NY, k] - ny
        over = dx * x + dy * y + (found[NZ, k] - nz) + half * (abs(dx) + abs(dy))
        raised = max(raised, min(over, found[NEAREST_ROW, k] - (middle - spread)))
    raised += ROUNDED * (abs(nx) + abs(ny) + abs(nz) + raised)
    highest += ROUNDED * highest
    if middle + raised < highest:
        return nx, ny, nz + raised
    return ZERO, ZERO, highest


@inlined
def _put_ints(record, first, count):
    store(address_of(record) + 4 * FIRST, np.int32(first))
    store(address_of(record) + 4 * COUNT, np.int32(count))


@kernel
def divide_face(items, spans, count, face, side, longest, cells, records, lists, arena, found, alone, state):
    """Divide a face with `count` items into cells (side, side) int32, which name records (r, RECORD) float32.

    Their numbers count from 1 on; 0 is NOTHING.  Up to `longest` candidates of a record are put into lists (l,) int32.
    There is room for a record of each cell, and `longest` list entries.  arena (a,) int32 has room for all items as
    often as regions lie in one another, and LANES more each time; found (FOUND, n + LANES) float32 and alone (n,) int32
    are memory.  What it came to is added to state (CAME_TO,) int64."""
    items, spans, cells, records, lists = without_refcount((items, spans, cells, records, lists))
    arena, found, alone, state = without_refcount((arena, found, alone, state))
    waiting = np.empty((DEPTH, WAITING), np.int64)
    for k in range(count):
        arena[k], alone[k] = k, -1
    waiting[0, COLUMN], waiting[0, ROW], waiting[0, WIDTH], waiting[0, BEGIN], waiting[0, END] = 0, 0, side, 0, count
    pending, used, listed = 1, np.int64(0), np.int64(0)
    cell = np.float32(2.0 / side)
    while pending > 0:
        # Find the items of the next region.
        pending -= 1
        column, row, width = waiting[pending, COLUMN], waiting[pending, ROW], waiting[pending, WIDTH]
        begin, end = waiting[pending, BEGIN], waiting[pending, END]
        half = np.float32(0.5) * cell * np.float32(width)
        x, y = cell * np.float32(column) - ONE + half, cell * np.float32(row) - ONE + half
        half += np.float32(2 * SEAM)
        state[LOOKED_AT] += 1
        state[LOOKED_FOR] += end - begin
        n, cover = _filter(items, spans, arena, begin, end, x, y, half, found)
        if cover >= 0 and n > 1:
            n = _drop_hidden(items, arena, end, n, cover, x, y, half, found)

        # Cut it into four, unless it is done.
        single = n == 1 and cover >= 0
        if n > 0 and not single and width > 1:
            part = width // 2
            for k in range(4):
                waiting[pending, COLUMN], waiting[pending, ROW] = column + part * (k & 1), row + part * (k >> 1)
                waiting[pending, WIDTH], waiting[pending, BEGIN], waiting[pending, END] = part, end, end + n
                pending += 1
            continue

        # Put its record, which is the same wherever one triangle is all there is.
        number = np.int64(NOTHING)
        if single and alone[cover] >= 0:
            number = np.int64(alone[cover])
        elif n > 0:
            record = records[used]
            used += 1
            number = used
            covering = load_i32(address_of(spans[cover]) + 4 * NUMBER) if cover >= 0 else np.int32(-1)
            if single:
                alone[cover] = number
                _put_plane(record, LIT, (items[cover, NEAR], items[cover, NEAR + 1], items[cover, NEAR + 2]), face)
                _put_ints(record, covering, 0)
            else:
                _put_plane(record, LIT, _near_plane(found, n, x, y, half), face)
                asked = n if n <= longest else 0
                _put_ints(record, listed if asked > 0 else np.int64(covering), asked)
                for k in range(asked):
                    lists[listed + k] = load_i32(address_of(spans[arena[end + k]]) + 4 * NUMBER)
                listed += asked
            if cover >= 0:
                _put_plane(record, BLOCKED, _far_plane(items, cover), face)
            else:
                record[BLOCKED] = record[BLOCKED + 1] = record[BLOCKED + 2] = ZERO
        code = np.int32((number << WIDTH_BITS) | lowest_bit(np.int64(width)))
        for i in range(row, row + width):
            for k in range(column, column + width):
                cells[i, k] = code
    state[RECORDS_USED] += used
    state[LISTED] += listed
