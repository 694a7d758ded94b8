"""Rays that end in a cell with few candidates: these are asked instead of the tree, sixteen rays at a time.

Each candidate's answer is taken where it is certain (`verdicts`).  One certain hit blocks the ray; where all are
certain to be missed nothing static does; any other ray is traced as if nothing were known.
"""

from __future__ import annotations

import numpy as np

from tracer.culling.certified.cells import SETTLED
from tracer.culling.certified.margins import (
    BOX,
    INSIDE,
    LAMP,
    LARGE,
    REPORTED,
    ROW,
    farthest_of,
    functions,
    length16,
    margins,
    rows_at,
    seen_from,
)
from tracer.geometry.bvh8.packet import segments_miss_box
from tracer.kernels import inlined, subkernel
from tracer.simd import (
    address_of,
    bits_of,
    gather_f32x16,
    gather_i32x16,
    i32x16,
    lanes_below,
    load_i32x16,
    local_memory,
    lowest_bit,
    mask16,
    maximum,
    ones,
    select,
    size_of,
    store,
)

WIDE, ROUNDING = np.float32(2 * REPORTED), np.float32(1e-6)


@subkernel
def verdicts(rows, numbers, farthest, light, point):
    """What sixteen shadow rays, from a light (3,) to their points, are certain to find.

    Each of one of rows (n, ROW), whose numbers, int32, are at an address: bits of those that hit, of those that miss.

    A hit is certain only of rays shorter than `farthest`."""
    row = rows_at(rows, numbers)
    direction = point[0] - light[0], point[1] - light[1], point[2] - light[2]
    t, reach = seen_from(light, row), size_of(direction)
    u, v, w, behind, d = functions(t, direction, point)
    near = length16((point[0] - t.corner[0], point[1] - t.corner[1], point[2] - t.corner[2]))
    along = maximum(d, -d)
    m = margins(t, reach, near, along, size_of(point))
    missed = (behind < -m.behind) | (u < -m.u) | (v < -m.v) | (w < -m.w)
    hit = (behind > m.behind) & (t.height > np.float32(LAMP) * along) & (farthest_of(farthest, numbers) > reach)
    hit = hit & (u > np.float32(INSIDE) * m.u) & (v > np.float32(INSIDE) * m.v) & (w > np.float32(INSIDE) * m.w)
    firm = t.firm & (reach < LARGE)
    return bits_of(hit & firm), bits_of((missed & firm) | _beside(row[BOX:ROW], light, direction, t.away))


@inlined
def _beside(box, light, direction, away):
    """In which lanes the segments pass by the boxes in which hits are reported, by more than roundings."""
    x0, y0, z0, x1, y1, z1 = box
    room = WIDE * away + ROUNDING * ((x1 - x0) + (y1 - y0) + (z1 - z0))
    low, high = (x0 - room, y0 - room, z0 - room), (x1 + room, y1 + room, z1 + room)
    return segments_miss_box(light, direction, low, high)


@subkernel
def ask_candidates(certified, points, light, number, asked, count, live, lit):
    """Ask the candidates of `count` points, whose numbers are `asked`, about light `number` at light (3,).

    Points of which these are certain are taken out of the bits `live`, and put into the bits `lit` where the light
    reaches them.  (how many they are, tests made)."""
    cells, rows = certified.cells, certified.rows
    lists, names, farthest = address_of(cells.lists), address_of(cells.names), certified.farthest
    at, stride, numbers = address_of(points.lifted), 4 * points.lifted.shape[1], local_memory(64)
    tests, answered = np.int64(0), np.int64(0)
    for k in range((count + 15) // 16):
        there = lanes_below(count, k)
        which = select(mask16(there), load_i32x16(address_of(asked) + 64 * k), i32x16(0))
        cell = gather_i32x16(address_of(points.unit), which)
        first = gather_i32x16(lists, cell * np.int32(cells.lists.shape[1]) + np.int32(number))
        length = gather_i32x16(names, first) & np.int32(SETTLED - 1)  # TOO_MANY stays more than a few
        asking = there & bits_of((length > np.int32(0)) & (length <= np.int32(certified.asked)))
        point = (
            gather_f32x16(at, which),
            gather_f32x16(at + stride, which),
            gather_f32x16(at + 2 * stride, which),
        )
        hit, unsure, j = np.int64(0), np.int64(0), 0
        testing = asking
        while testing != 0:
            j += 1
            testing = asking & ~hit & bits_of(length >= np.int32(j))
            if testing == 0:
                break
            name = gather_i32x16(names, select(mask16(testing), first + np.int32(j), i32x16(0)))
            store(numbers, select(mask16(testing), name, i32x16(0)))
            surely, missed = verdicts(rows, numbers, farthest, light, point)
            tests += ones(testing)
            hit |= testing & surely
            unsure |= testing & ~(surely | missed)
        known = asking & (hit | ~unsure)
        answered += ones(known)
        while known != 0:
            lane = lowest_bit(known)
            known &= known - 1
            i = np.int64(asked[16 * k + lane])
            bit = np.int32(1) << np.int32(i & 15)
            live[i >> 4] &= ~bit
            if (hit >> lane) & 1 == 0:
                lit[i >> 4] |= bit
    return answered, tests
