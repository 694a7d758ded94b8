"""One cell and one light: LIT, FULL, CANDIDATES, or nothing yet.

Primitives that may come between are taken from the cell that this one is a part of, or, where that had too
many, from the tree.  What is certain to be missed is passed over (`error_bounds`).  Nothing left: LIT.  One that is
certain to be hit: FULL.  Several that are so together: FULL as well, and these are *fused occluders*: each
hides the part of the cell where all its functions exceed their error bounds, a convex one, and cutting these
parts off one after the other leaves nothing.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.culling.certified.cells import CANDIDATES, FULL, LIT, SETTLED, TOO_MANY
from tracer.culling.certified.classify import FUNCTIONS, classify_occluders, put_hidden_parts
from tracer.culling.certified.error_bounds import LANES
from tracer.culling.certified.occluders import BLOCK, BOXES, STACK, children_met, triangles_met
from tracer.culling.certified.shaft import Shaft, make_shaft
from tracer.geometry.wide_tree.topology import WIDTH
from tracer.kernels import inlined, subkernel
from tracer.simd import (
    address_of,
    i32_at,
    i64_at,
    lanes_below,
    load_i32x16,
    local_memory,
    lowest_bit,
    mask16,
    ones,
    pack,
    store,
)

WAITING = 4 * (LANES + WIDTH)  # bytes: one leaf more than are asked together
MOST = 48  # candidates that a cell keeps for its parts
FUSED = 12  # candidates that are fused at most
PIECES, VERTICES = 24, 12  # of a cell of which parts are cut off
SLIVER = 1e-15  # of the cell: pieces with less area are narrower by far than any error bound

STEPS, TESTS, CERTIFICATES = range(3)  # counters
COUNTERS = 3


class Scratch(NamedTuple):
    """What a worker certifies in: a shaft; found (MOST + 16,) int32; parts (FUNCTIONS, 3, 16) float32, the functions
    of fused occluders at the cell's corners, and lanes (16,) int64, which of them are; pieces (PIECES, VERTICES, 3)
    float64, polygons in barycentric coordinates, and vertices (PIECES,) int64, how many each has; spare (2,
    VERTICES, 3)."""

    shaft: Shaft
    found: NDArray[np.int32]
    parts: NDArray[np.float32]
    lanes: NDArray[np.int64]
    pieces: NDArray[np.float64]
    vertices: NDArray[np.int64]
    spare: NDArray[np.float64]


def scratch() -> Scratch:
    return Scratch(
        make_shaft(),
        np.zeros(MOST + LANES, np.int32),
        np.zeros((FUNCTIONS, 3, LANES), np.float32),
        np.zeros(LANES, np.int64),
        np.zeros((PIECES, VERTICES, 3)),
        np.zeros(PIECES, np.int64),
        np.zeros((2, VERTICES, 3)),
    )


@subkernel
def _meet(s, o, light, numbers, n, count, counts):
    """Take those of n <= 16 primitives, their numbers at an address, that may come between, to the `count` found.

    How many there are then, or -1 where one hides the whole cell: all others are forgotten."""
    counts[TESTS] += n
    hit, missed = classify_occluders(o.rows, numbers, o.farthest, light, s.shaft)
    there = lanes_below(n, 0)
    hit &= there
    if hit != 0:
        s.found[0] = i32_at(numbers)[lowest_bit(hit)]
        return -1
    kept = there & ~missed
    store(address_of(s.found) + 4 * min(count, MOST), pack(load_i32x16(numbers), mask16(kept)))
    return count + ones(kept)


@subkernel
def _from_list(s, o, light, given, given_count, counts):
    """Take primitives from given (given_count,) int32."""
    count, numbers = np.int64(0), local_memory(64)
    for first in range(0, given_count, LANES):
        for k in range(LANES):
            i32_at(numbers)[k] = given[min(first + k, given_count - 1)]
        count = _meet(s, o, light, numbers, min(LANES, given_count - first), count, counts)
        if count < 0:
            return count
    return count


@subkernel
def _from_tree(s, o, number, light, counts):
    """Take primitives from the tree; more than MOST where they are too many."""
    count, stack, waiting = np.int64(0), i64_at(local_memory(STACK)), local_memory(WAITING)
    numbers, n = i32_at(waiting), 0
    for k in range(LANES + WIDTH):
        numbers[k] = 0
    boxes, blocks, leaf_radii = address_of(o.boxes[number]), address_of(o.blocks), address_of(o.leaf_radii[number])
    for root in o.roots:
        stack[0], pending = np.int64(root), 1
        while pending > 0:
            pending -= 1
            node = stack[pending]
            counts[STEPS] += 1
            met = np.int64(children_met(boxes + 4 * BOXES * node, s.shaft))
            while met != 0:
                child = lowest_bit(met)
                met &= met - 1
                code = np.int64(o.children[node, child])
                if code >= 0:
                    stack[pending] = code
                    pending += 1
                    continue
                counts[STEPS] += 1
                leaf = ~code
                if o.numbers[leaf, 0] >= o.first_quadric:
                    those = np.int64(1)
                else:
                    those = triangles_met(blocks + 4 * BLOCK * leaf, leaf_radii + 4 * WIDTH * leaf, s.shaft)
                while those != 0:
                    numbers[n] = o.numbers[leaf, lowest_bit(those)]
                    those &= those - 1
                    n += 1
                if n >= LANES:
                    count = _meet(s, o, light, waiting, LANES, count, counts)
                    if count < 0 or count > MOST:
                        return count
                    n -= LANES
                    for k in range(n):
                        numbers[k] = numbers[LANES + k]
    return _meet(s, o, light, waiting, n, count, counts) if n > 0 else count


@subkernel
def certify(s, o, number, light, given, given_count, few, counts):
    """(certificate, how many primitives it names) of the cell and light that s.shaft was put to; s.found names them.

    Candidates are those of `given` (given_count,), where there are no more than MOST, or come from the tree.
    More than MOST make CANDIDATES of TOO_MANY, which are not named; `few` that rays can ask are SETTLED besides."""
    counts[CERTIFICATES] += 1
    if given_count <= MOST:
        count = _from_list(s, o, light, given, given_count, counts)
    else:
        count = _from_tree(s, o, number, light, counts)
    if count < 0:
        return FULL, 1
    if count == 0:
        return LIT, 0
    if count > MOST:
        return CANDIDATES, TOO_MANY
    fused = _fused(s, o, light, count)
    if fused > 0:
        return FULL, fused
    return CANDIDATES, count + (SETTLED if count <= few else 0)


# --- fused occluders --------------------------------------------------------------------------------


@inlined
def _hides_some(parts, lane):
    """Whether each function of the lane's triangle is positive somewhere."""
    some = True
    for j in range(FUNCTIONS):
        some &= parts[j, 0, lane] > 0.0 or parts[j, 1, lane] > 0.0 or parts[j, 2, lane] > 0.0
    return some


@inlined
def _hide_corners(s, count):
    """Whether each corner of the cell is hidden by some of the triangles of s.lanes: few others are worth cutting."""
    corners = 0
    for part in range(count):
        lane = s.lanes[part]
        for k in range(3):
            inside = True
            for j in range(FUNCTIONS):
                inside &= s.parts[j, k, lane] >= 0.0
            corners |= inside << k
    return corners == 7


@inlined
def _at(f, vertex):
    return f[0] * vertex[0] + f[1] * vertex[1] + f[2] * vertex[2]


@subkernel
def _cut(polygon, count, f, sign, out):
    """The part of a convex polygon where sign * f >= 0; how many vertices it has, or -1 where they are too many.

    Parts of no width to speak of are nothing: there is more than that to spare in the error bounds."""
    kept = 0
    for i in range(count):
        j = i + 1 if i + 1 < count else 0
        a, b = sign * _at(f, polygon[i]), sign * _at(f, polygon[j])
        if kept + 2 > VERTICES:
            return -1
        if a >= 0.0:
            for k in range(3):
                out[kept, k] = polygon[i, k]
            kept += 1
        if (a > 0.0 and b < 0.0) or (a < 0.0 and b > 0.0):
            t = a / (a - b)
            for k in range(3):
                out[kept, k] = polygon[i, k] + t * (polygon[j, k] - polygon[i, k])
            kept += 1
    return kept if _area(out, kept) > SLIVER else 0


@inlined
def _area(polygon, count):
    """Twice the area of a polygon, by its first two coordinates."""
    sum_ = 0.0
    for k in range(2, count):
        x, y = polygon[k - 1, 0] - polygon[0, 0], polygon[k - 1, 1] - polygon[0, 1]
        sum_ += x * (polygon[k, 1] - polygon[0, 1]) - y * (polygon[k, 0] - polygon[0, 0])
    return abs(sum_)


@subkernel
def _cut_off(s, lane, pieces):
    """Cut off all pieces what the lane's triangle hides; how many are left, or -1 where they are too many."""
    left = pieces
    for p in range(pieces - 1, -1, -1):
        inside, spare = s.spare[0], s.spare[1]
        count = s.vertices[p]
        for k in range(count):
            for axis in range(3):
                inside[k, axis] = s.pieces[p, k, axis]
        # The piece's own place is free for what is left of it.
        left -= 1
        s.vertices[p] = s.vertices[left]
        s.pieces[p] = s.pieces[left]
        for j in range(FUNCTIONS):
            if left >= PIECES:
                return -1
            f = s.parts[j, 0, lane], s.parts[j, 1, lane], s.parts[j, 2, lane]
            outside = _cut(inside, count, f, -1.0, s.pieces[left])
            if outside < 0:
                return -1
            s.vertices[left] = outside
            left += outside > 0
            count = _cut(inside, count, f, 1.0, spare)
            if count < 0:
                return -1
            if count == 0:
                break
            inside, spare = spare, inside
    return left


@subkernel
def _fused(s, o, light, count):
    """How many of the primitives found hide the whole cell together, those first; 0 where they do not."""
    if count > FUSED or count < 2:
        return 0
    s.found[count:LANES] = s.found[0]  # all sixteen are looked at
    certain = put_hidden_parts(o.rows, address_of(s.found), o.farthest, light, s.shaft, address_of(s.parts))
    certain &= lanes_below(count, 0)
    parts = 0
    for k in range(count):
        if (certain >> k) & 1 and _hides_some(s.parts, k):
            s.lanes[parts] = k
            parts += 1
    if parts < 2 or not _hide_corners(s, parts):
        return 0
    s.pieces[0, :3] = 0.0
    for k in range(3):
        s.pieces[0, k, k] = 1.0
    s.vertices[0] = 3
    pieces = 1
    for part in range(parts):
        pieces = _cut_off(s, s.lanes[part], pieces)
        if pieces < 0:
            return 0
        if pieces == 0:
            for k in range(part + 1):  # lanes ascend, so none is overwritten before it is read
                s.found[k] = s.found[s.lanes[k]]
            return part + 1
    return 0
