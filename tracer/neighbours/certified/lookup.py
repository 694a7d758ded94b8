"""Look up the cells in which shadow rays end, for sixteen points at a time.

A point is looked up where its shadow rays end, a little above the surface.  Its coordinates in the triangle are found
from there.  One that ends where no prism of a `shaft` reaches has no cell: its rays are traced.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.culling.counters import CANDIDATES_ONLY, TESTS
from tracer.culling.modes import look_up, shadow_modes
from tracer.culling.shadow_testing import answer, classify_by_modes
from tracer.culling.stages import vectors
from tracer.geometry.rays import RAY_OFFSET
from tracer.neighbours.certified.candidates import QUESTION_ROWS, ask_candidates
from tracer.neighbours.certified.cell_prism import LOWEST
from tracer.neighbours.certified.cells import (
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
from tracer.neighbours.certified.quadtree import enter_parts
from tracer.runtime.kernels import inlined, subkernel
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

ZERO, ONE = np.float32(0), np.float32(1)
NOWHERE = -1  # instead of an owner


@inlined
def affine(row, first, x, y, z):
    """The dot product of a vector, three columns of a receiver's row, and (x, y, z)."""
    return row[first] * x + row[first + 1] * y + row[first + 2] * z


class CellPoints(NamedTuple):
    """What is looked up for n points of a wave, in rows.

    Attributes:
        unit: the cell of each point, 0 for none.
        low, high, looked_up: its word (`tracer.culling.modes.PointModes`).
        u, v, owner: coordinates in the triangle, and the owner there, NOWHERE for none.
        untried, doubtful: bits, sixteen points a number: those with a light for which nothing is known yet, and those
            with one for which only candidates are.
        asked: vectors that are on their way down, then points that test candidates, one after the other.
        questions: memory for both.
    """

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
    """Find the cells of `count` points: where their shadow rays end, points.lifted (3, n) float32.

    certified is a `CertificateView`, found are `CellPoints`.  Unless rays are `costly_rays`, triangles without a root
    are not looked at any closer."""
    highest, child, receivers = certified.highest, address_of(certified.child), address_of(certified.receivers)
    lifted, rooted_at = points.lifted, address_of(certified.rooted)
    stride, divided = 4 * lifted.shape[1], np.int64(0)
    for k in range(vectors(count)):
        found.looked_up[k] = found.untried[k] = found.doubtful[k] = 0
        at = 64 * k
        numbers = address_of(points.primitive) + at
        primitive = load_i32x16(numbers)

        # Leave triangles without cells alone.
        if not certified.costly_rays:
            rooted = (gather_i32x16(rooted_at, primitive) > np.int32(0)) & mask16(lanes_below(count, k))
            if not any_lane(rooted):
                store(address_of(found.unit) + at, i32x16(0))
                store(address_of(found.owner) + at, i32x16(NOWHERE))
                continue

        # Find height and coordinates above the triangle.
        row = load_columns(receivers, numbers, RECEIVER)
        px = load_f32x16(address_of(lifted) + at)
        py = load_f32x16(address_of(lifted) + stride + at)
        pz = load_f32x16(address_of(lifted) + 2 * stride + at)
        x, y, z = px - row[CORNER], py - row[CORNER + 1], pz - row[CORNER + 2]
        u, v, height = affine(row, ALONG_U, x, y, z), affine(row, ALONG_V, x, y, z), affine(row, NORMAL, x, y, z)

        # Accept what ends within the prisms.
        above = maximum(height, -height)
        largest = maximum(maximum(px, -px), maximum(maximum(py, -py), maximum(pz, -pz)))
        inside = (above >= np.float32(LOWEST * RAY_OFFSET) * largest) & (above <= np.float32(highest)) & (above > ZERO)
        beyond = row[BEYOND_U] + row[BEYOND_V]
        inside = inside & (u >= -row[BEYOND_U]) & (v >= -row[BEYOND_V]) & (u + v <= ONE + beyond)

        # Go down from the root of that side.
        back = height < ZERO
        owner = (primitive << np.int32(1)) + select(back, i32x16(1), i32x16(0))
        u, v = minimum(maximum(u, ZERO), ONE), minimum(maximum(v, ZERO), ONE)
        store(address_of(found.u) + at, u)
        store(address_of(found.v) + at, v)
        store(address_of(found.owner) + at, select(inside, owner, i32x16(NOWHERE)))
        cell = select(back, as_i32(row[ROOTS + 1]), as_i32(row[ROOTS]))
        cell = select(inside & mask16(lanes_below(count, k)), cell, i32x16(0))
        store(address_of(found.unit) + at, cell)
        inside_u, inside_v = _inside(found, k)
        store(inside_u, u)
        store(inside_v, v)
        found.asked[divided] = k
        divided += any_lane(cell > np.int32(0))
    _descend_together(child, found, divided)


@inlined
def _inside(found, k):
    """Where the coordinates of the k-th vector of points in their cells are kept on the way down."""
    return address_of(found.questions) + 64 * k, address_of(found.questions) + 4 * found.questions.shape[1] + 64 * k


@subkernel
def _descend_together(child, found, active):
    """Go down to the leaves from the cells `found.unit`, one level after the other: of the vectors `found.asked`, so
    many of them, which are written over.

    Cells lie far apart in memory.  One vector after the other would wait for it at every level; so all wait at once."""
    while active > 0:
        left = np.int64(0)
        for a in range(active):
            k = np.int64(found.asked[a])
            unit, (inside_u, inside_v) = address_of(found.unit) + 64 * k, _inside(found, k)
            cell = load_i32x16(unit)
            below = gather_i32x16(child, cell)
            inner = below > np.int32(-1)
            cell, u, v = enter_parts(cell, below, inner, load_f32x16(inside_u), load_f32x16(inside_v))
            store(unit, cell)
            store(inside_u, u)
            store(inside_v, v)
            found.asked[left] = k
            left += any_lane(inner)
        active = left


@subkernel
def cull_by_certificates(certified, points, found, light, number, count, asks, batch, counts):
    """Answer the rays to light `number` at light (3,) of which certificates tell all.

    Where it `asks`, also those with few candidates, by testing these.  batch is a `ShadowBatch`, counts are the shadow
    counters."""
    if number >= len(certified.stationary) or certified.stationary[number] == 0:
        return
    asks = asks and certified.max_asked > 0
    words, asked = certified.words, np.int64(0)
    for v in range(vectors(count)):
        if batch.live[v] == 0:
            continue
        look_up(words, v, found)
        full, lit = classify_by_modes(found, number, v)
        answer(batch, v, full, lit, counts)
        live = np.int64(batch.live[v])
        if live == 0:
            continue

        # Take note of what is not known yet.
        some = bits_of(shadow_modes(found, number, v) == np.int32(CANDIDATES)) & live
        found.untried[v] |= live & ~some
        found.doubtful[v] |= some
        if asks:
            batch.candidates[v] |= some
            which = lane_numbers_x16() + np.int32(16 * v)
            store(address_of(found.asked) + 4 * asked, pack(which, mask16(some)))
            asked += ones(some)
    if asked > 0:
        known, tests = ask_candidates(certified, points, found, light, number, asked, batch.live, batch.lit)
        counts[CANDIDATES_ONLY] += known
        counts[TESTS] += tests
        for v in range(vectors(count)):  # of some of these, too many are named, or one is in doubt
            batch.candidates[v] &= ~np.int64(batch.live[v])
