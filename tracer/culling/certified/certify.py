"""One cell and one light: LIT, FULL, CANDIDATES, or nothing yet.

Primitives that may come between are taken from the cell that this one is a part of, or, where that had too
many, from the tree.  What is certain to be missed is passed over (`margins`).  Nothing left: LIT.  One that is
certain to be hit: FULL.  Several that are so together: FULL as well, and these are *fused occluders*: each
hides the part of the cell where all its functions exceed their margins, a convex one, and cutting these
parts off one after the other leaves nothing.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.culling.certified.beam import PLANES, Beam, make_beam, meets_box
from tracer.culling.certified.margins import (
    INSIDE,
    before_plane,
    depth_of,
    is_past_the_lamp,
    measure,
    row_of,
    surely_hit,
    surely_missed,
)
from tracer.culling.certified.occluders import BLOCK, BOXES, STACK, children_met, triangles_met
from tracer.culling.modes import FULL_SHADOW, NON_SHADOW
from tracer.geometry.bvh8.tree import WIDTH
from tracer.kernels import inlined, subkernel
from tracer.simd import address_of, i64_at, lane_of, local_memory, lowest_bit

UNTRIED, FULL, LIT, CANDIDATES = 0, FULL_SHADOW, NON_SHADOW, 3
MOST = 48  # candidates that a cell keeps for its parts
TOO_MANY = 255  # instead of how many there are
FUNCTIONS = 4
FUSED = 12  # candidates that are fused at most
PIECES, VERTICES = 24, 12  # of a cell of which parts are cut off
SLIVER = 1e-15  # of the cell: pieces with less area are narrower by far than any margin

STEPS, TESTS, CERTIFICATES = range(3)  # counters
COUNTERS = 3


class Scratch(NamedTuple):
    """What a worker certifies in: a beam; found (MOST + 1,) int32; parts (FUSED, FUNCTIONS, 3) float64, the functions
    of fused occluders at the cell's corners; pieces (PIECES, VERTICES, 3) float64, polygons in barycentric
    coordinates, and vertices (PIECES,) int64, how many each has; spare (2, VERTICES, 3)."""

    beam: Beam
    found: NDArray[np.int32]
    parts: NDArray[np.float64]
    pieces: NDArray[np.float64]
    vertices: NDArray[np.int64]
    spare: NDArray[np.float64]


def scratch() -> Scratch:
    return Scratch(
        make_beam(),
        np.zeros(MOST + 1, np.int32),
        np.zeros((FUSED, FUNCTIONS, 3)),
        np.zeros((PIECES, VERTICES, 3)),
        np.zeros(PIECES, np.int64),
        np.zeros((2, VERTICES, 3)),
    )


@inlined
def _measured(b, o, light, i):
    return measure(b.directions, b.reach[0], light, o.rows, i, np.float64(o.blurs[i]))


@inlined
def _passes(b, o, i, q):
    """Whether no ray of the beam hits the triangle that was measured."""
    if surely_missed(q):
        return True
    depth = depth_of(q)
    if not depth > 0.0:
        return False
    a, e1, e2 = row_of(o.rows, i)
    parted = False
    for k in range(PLANES):
        parted |= before_plane(a, e1, e2, np.float64(o.blurs[i]), b.planes[k], q, depth, b.reach[0])
    return parted


@subkernel
def _meet(s, o, light, i, count, counts):
    """Take primitive i among the `count` found, if it may come between: how many there are then, or -1 where it hides
    the whole cell and all others are forgotten."""
    if i >= len(o.rows):
        if not meets_box(s.beam, o.quadric_boxes[i - len(o.rows)]):
            return count
    else:
        counts[TESTS] += 1
        q = _measured(s.beam, o, light, i)
        if surely_hit(q) and s.beam.reach[0] < o.farthest:
            s.found[0] = i
            return -1
        if _passes(s.beam, o, i, q):
            return count
    if count <= MOST:
        s.found[count] = i
    return count + 1


@subkernel
def _from_list(s, o, light, given, given_count, counts):
    """Take primitives from given (given_count,) int32."""
    count = 0
    for k in range(given_count):
        count = _meet(s, o, light, given[k], count, counts)
        if count < 0:
            return count
    return count


@subkernel
def _from_tree(s, o, number, light, counts):
    """Take primitives from the tree; more than MOST where they are too many."""
    count, stack = 0, i64_at(local_memory(STACK))
    for k in range(o.loose_count[number]):
        count = _meet(s, o, light, o.loose[number, k], count, counts)
        if count < 0:
            return count
    boxes, pending = address_of(o.boxes[number]), 0
    blocks, reaches = address_of(o.blocks), address_of(o.reaches[number])
    for root in o.roots:
        stack[0], pending = np.int64(root), 1
        while pending > 0:
            pending -= 1
            node = stack[pending]
            counts[STEPS] += 1
            met = np.int64(children_met(boxes + 4 * BOXES * node, s.beam))
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
                if o.numbers[leaf, 0] >= len(o.rows):
                    triangles = np.int64(1)
                else:
                    triangles = triangles_met(blocks + 4 * BLOCK * leaf, reaches + 4 * WIDTH * leaf, s.beam)
                while triangles != 0:
                    i = np.int64(o.numbers[leaf, lowest_bit(triangles)])
                    triangles &= triangles - 1
                    count = _meet(s, o, light, i, count, counts)
                    if count < 0:
                        return count
                if count > MOST:
                    return count
    return count


@subkernel
def certify(s, o, number, light, given, given_count, counts):
    """(certificate, how many primitives it names) of the cell and light that s.beam was put to; s.found names them.

    Candidates are those of `given` (given_count,), where there are no more than MOST, or come from the tree.
    More than MOST make CANDIDATES of TOO_MANY, which are not named."""
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
    return CANDIDATES, count


# --- fused occluders --------------------------------------------------------------------------------


@subkernel
def _put_part(s, o, light, i, part):
    """The functions of triangle i less their margins, at the cell's three corners, whatever the height above; False
    where it hides nothing, or cannot be told to."""
    if i >= len(o.rows):
        return False
    q = _measured(s.beam, o, light, i)
    if not is_past_the_lamp(q):
        return False
    return (
        _put_function(s.parts[part, 0], q.u, INSIDE * q.of_u)
        and _put_function(s.parts[part, 1], q.v, INSIDE * q.of_v)
        and _put_function(s.parts[part, 2], q.w, INSIDE * q.of_w)
        and _put_function(s.parts[part, 3], q.beyond, q.of_beyond)
    )


@inlined
def _put_function(row, function, margin):
    """A function less its margin at the three corners, whichever is less of below and above; whether it is positive
    somewhere."""
    some = False
    for k in range(3):
        row[k] = min(lane_of(function, k), lane_of(function, 3 + k)) - margin
        some |= row[k] > 0.0
    return some


@inlined
def _at(f, vertex):
    return f[0] * vertex[0] + f[1] * vertex[1] + f[2] * vertex[2]


@subkernel
def _cut(polygon, count, f, sign, out):
    """The part of a convex polygon where sign * f >= 0; how many vertices it has, or -1 where they are too many.

    Parts of no width to speak of are nothing: there is more than that to spare in the margins."""
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
def _cut_off(s, part, pieces):
    """Cut a part off all pieces; how many are left, or -1 where they are too many."""
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
            f = s.parts[part, j]
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
    if count > FUSED or count < 2 or s.beam.reach[0] >= o.farthest:
        return 0
    parts = 0
    for k in range(count):
        i = s.found[k]
        if _put_part(s, o, light, i, parts):
            s.found[k], s.found[parts] = s.found[parts], i
            parts += 1
    if parts < 2:
        return 0
    s.pieces[0, :3] = 0.0
    for k in range(3):
        s.pieces[0, k, k] = 1.0
    s.vertices[0] = 3
    pieces = 1
    for part in range(parts):
        pieces = _cut_off(s, part, pieces)
        if pieces < 0:
            return 0
        if pieces == 0:
            return part + 1
    return 0
