"""Which cell a shadow ray ends in, for sixteen points at a time.

A point is looked up where its shadow rays end, a little above the surface.  Its coordinates in the triangle are
found from there, and one that is not where the prisms of `shaft` allow for it has no cell: its rays are traced.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.culling.certified.candidates import QUESTION_ROWS, ask_candidates
from tracer.culling.certified.cells import (
    ALONG_U,
    ALONG_V,
    BEYOND_U,
    BEYOND_V,
    CANDIDATES,
    CORNER,
    NORMAL,
    RECEIVER,
    ROOTS,
)
from tracer.culling.certified.shaft import LOWEST
from tracer.culling.counters import CANDIDATES_ONLY, CULLED, DYNAMIC_ONLY, TESTS
from tracer.culling.shadow_modes import answer, look_up, trusted, words_of
from tracer.culling.stages import vectors
from tracer.geometry.offsets import RAY_OFFSET
from tracer.kernels import inlined, subkernel
from tracer.simd import (
    address_of,
    any_lane,
    as_i32,
    bits_of,
    gather_i32x16,
    i32x16,
    lane_numbers_x16,
    lanes_below,
    load_columns,
    load_f32x16,
    load_i32x16,
    mask16,
    maximum,
    minimum,
    ones,
    pack,
    select,
    store,
)
from tracer.simd.records import IntRow, Memory, Row, Rows, row_count, rows_of

ZERO, HALF, ONE, TWO = np.float32(0), np.float32(0.5), np.float32(1), np.float32(2)
NOWHERE = -1  # instead of an owner


@inlined
def affine(row, first, x, y, z):
    return row[first] * x + row[first + 1] * y + row[first + 2] * z


class CellPoints(NamedTuple):
    """What is looked up for n points of a wave, in rows: the cell of each as its unit, and its word
    (`tracer.culling.shadow_modes.PointWords`); u and v in the triangle, and the owner there, NOWHERE for none; as bits,
    sixteen points a number, which have a light of which nothing is known yet (`untried`), and which have one of which
    only candidates are (`doubtful`); and, one after the other, the points that test candidates, with room for that."""

    memory: Memory
    unit: IntRow
    low: IntRow
    high: IntRow
    looked_up: IntRow
    u: Row
    v: Row
    owner: IntRow
    untried: IntRow
    doubtful: IntRow
    asked: IntRow
    questions: Annotated[NDArray[np.float32], Rows(QUESTION_ROWS, "float32")]


cell_points_in = rows_of(CellPoints)
CELL_POINT_ROWS = row_count(CellPoints)


@subkernel
def find_cells(certified, points, count, found):
    """Find the cells in which the shadow rays of points end, sixteen by sixteen; points.lifted are those ends.

    Unless rays are costly, triangles without a root are not looked at any closer."""
    highest, child, receivers = certified.highest, address_of(certified.child), address_of(certified.receivers)
    lifted, rooted_at = points.lifted, address_of(certified.rooted)
    stride = 4 * lifted.shape[1]
    for k in range(vectors(count)):
        found.looked_up[k] = found.untried[k] = found.doubtful[k] = 0
        at = 64 * k
        numbers = address_of(points.primitive) + at
        primitive = load_i32x16(numbers)
        if not certified.costly_rays:
            rooted = (gather_i32x16(rooted_at, primitive) > np.int32(0)) & mask16(lanes_below(count, k))
            if not any_lane(rooted):
                store(address_of(found.unit) + at, i32x16(0))
                store(address_of(found.owner) + at, i32x16(NOWHERE))
                continue

        # Lead the end of the ray into the triangle: coordinates along its sides, and the height above it.
        row = load_columns(receivers, numbers, RECEIVER)
        px = load_f32x16(address_of(lifted) + at)
        py = load_f32x16(address_of(lifted) + stride + at)
        pz = load_f32x16(address_of(lifted) + 2 * stride + at)
        x, y, z = px - row[CORNER], py - row[CORNER + 1], pz - row[CORNER + 2]
        u, v, height = affine(row, ALONG_U, x, y, z), affine(row, ALONG_V, x, y, z), affine(row, NORMAL, x, y, z)

        # Leave out what does not lie in the prism that certificates speak of.
        above = maximum(height, -height)
        largest = maximum(maximum(px, -px), maximum(maximum(py, -py), maximum(pz, -pz)))
        inside = (above >= np.float32(LOWEST * RAY_OFFSET) * largest) & (above <= np.float32(highest)) & (above > ZERO)
        beyond = row[BEYOND_U] + row[BEYOND_V]
        inside = inside & (u >= -row[BEYOND_U]) & (v >= -row[BEYOND_V]) & (u + v <= ONE + beyond)

        # Go down from the root of the side that the ray ends on.
        back = height < ZERO
        owner = (primitive << np.int32(1)) + select(back, i32x16(1), i32x16(0))
        u, v = minimum(maximum(u, ZERO), ONE), minimum(maximum(v, ZERO), ONE)
        store(address_of(found.u) + at, u)
        store(address_of(found.v) + at, v)
        store(address_of(found.owner) + at, select(inside, owner, i32x16(NOWHERE)))
        cell = select(back, as_i32(row[ROOTS + 1]), as_i32(row[ROOTS]))
        cell = select(inside & mask16(lanes_below(count, k)), cell, i32x16(0))
        store(address_of(found.unit) + at, descend(child, cell, u, v))


@subkernel
def cull_by_certificates(certified, points, found, light, number, count, asks, batch, counts):
    """Answer the rays to light `number` at light (3,) that certificates say all about and, where it `asks`, those with
    few candidates by testing these."""
    if number >= len(certified.stationary) or certified.stationary[number] == 0:
        return
    words, asks, asked = certified.words, asks and certified.max_asked > 0, np.int64(0)
    for v in range(vectors(count)):
        live = np.int64(batch.live[v])
        if live == 0:
            continue
        look_up(words, v, found)
        full, non = trusted(found, number, v)
        answer(batch, v, full, non)
        counts[CULLED] += ones(live & full)
        counts[DYNAMIC_ONLY] += ones(live & non)
        live &= ~(full | non)
        if live == 0:
            continue
        # Take note of what is not known yet.
        _, field, shift = words_of(found, number, v)
        some = bits_of((field & np.int32(3 << shift)) == np.int32(CANDIDATES << shift)) & live
        found.untried[v] |= live & ~some
        found.doubtful[v] |= some
        if asks:
            which = lane_numbers_x16() + np.int32(16 * v)
            store(address_of(found.asked) + 4 * asked, pack(which, mask16(some)))
            asked += ones(some)
    if asked > 0:
        known, tests = ask_candidates(certified, points, found, light, number, asked, batch.live, batch.lit)
        counts[CANDIDATES_ONLY] += known
        counts[TESTS] += tests


@subkernel
def record_cells(wave, found, place, cell):
    """Write the cells of primary hits into the picture; place (n,) says where each pixel of the tile is."""
    for i in range(wave.size):
        cell[place[wave.pixel[i]]] = found.unit[i]


@inlined
def descend(child, cell, u, v):
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
