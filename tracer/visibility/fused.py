"""Fuse occluders: several triangles that hide a cell from the light together.

A tessellated plate hides the light by many triangles, none of which does so alone.  Each hides the part of the cell
where all its functions exceed their error bounds.  The functions are linear, so the part is convex, and it is given by
their values at the cell's three corners.  The cell begins as one polygon; each triangle cuts its part off all that is
left.  When nothing is left, every ray of the shaft is certain to hit one of the triangles.
"""

from __future__ import annotations

from tracer.runtime.kernels import inlined, subkernel
from tracer.simd import address_of, lanes_below
from tracer.visibility.classify import FUNCTIONS, put_hidden_parts
from tracer.visibility.error_bounds import LANES

FUSED = 12  # candidates that are fused, at most
PIECES, VERTICES = 24, 12  # of a cell of which parts are cut off: polygons, and corners of one, at most
SLIVER = 1e-15  # of the cell: pieces with less area are narrower by far than any error bound


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
    """A function, given at the cell's corners, at a vertex (3,) in barycentric coordinates."""
    return f[0] * vertex[0] + f[1] * vertex[1] + f[2] * vertex[2]


@subkernel
def _cut(polygon, count, f, sign, out):
    """Cut a convex polygon (any, 3) to where sign * f >= 0, into out; how many vertices it has, -1 for too many.

    Parts of no width to speak of are nothing: the error bounds have more than that to spare."""
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
    """Cut what the lane's triangle hides off all pieces; how many are left, or -1 for too many."""
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
        for k in range(s.vertices[left]):
            for axis in range(3):
                s.pieces[p, k, axis] = s.pieces[left, k, axis]
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
def fuse(s, o, light, count):
    """How many of the `count` primitives in s.found hide the whole cell together, those first; 0 where they do not.

    s is a worker's `Scratch`, o are the `Occluders`, light (3,) is a position."""
    if count > FUSED or count < 2:
        return 0
    # Find the part of the cell that each hides.
    s.found[count:LANES] = s.found[0]  # all sixteen lanes are computed
    certain = put_hidden_parts(o.rows, address_of(s.found), o.farthest, light, s.shaft, address_of(s.parts))
    certain &= lanes_below(count, 0)
    parts = 0
    for k in range(count):
        if (certain >> k) & 1 and _hides_some(s.parts, k):
            s.lanes[parts] = k
            parts += 1
    if parts < 2 or not _hide_corners(s, parts):
        return 0

    # Begin with the whole cell, and cut part after part off it.
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
