"""How wrong float32 may be about triangles and shadow rays, and what is certain in spite of it: the numbers and the
evaluator of the proof (`tracer.visibility`), each of them once.

Kernels hold sixteen triangles, or rays, as vectors of lanes.  What does not depend on rays is found once for triangles
(`seen_from`, `factors`); with how far rays reach that gives `bounds`; and the extremes of U, V, W and B that a hull of
rays has, compared with these bounds, give the verdict: `surely_hit`, `surely_missed`.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from tracer.runtime.kernels import inlined
from tracer.simd import address_of, f32x16, load_columns, load_i32x16, maximum, select, square_root

EPSILON = 2.0**-24  # the largest relative error of a float32 rounding
ENLARGED = 2.5e-6  # the part of itself by which the fast structure takes a triangle to be larger, and a little
SURPLUS = 1.25  # by which all bounds are enlarged
INSIDE = 1.75  # bounds by which a certain hit lies inside of a triangle: 2.5 m and our own error
LONGEST = 13 * EPSILON  # times a ray's length: what boxes must be padded by for it to be sure of a hit
LAMP = 2e-5  # of the way from the light: what lies in it may be nearer than rays begin
# Columns of a primitive's row: a corner, two edges, how far its corners may be elsewhere, and a box (6,) outside of
# which no hit is reported, but for REPORTED of the light's distance.  Quadrics have the box alone.
CORNER_ERROR, BOX, ROW = 9, 10, 16
REPORTED = 4e-5  # more than 3 of the kd-tree's 1e-5, rotated, by objects whose axes differ by a tenth in length
LANES = 16  # rows that are looked at together
SMALL, LARGE = np.float32(1e-30), np.float32(1e12)  # volumes and lengths outside of which float32 may lose more
_UNKNOWN = np.float32(np.inf)

ZERO, HALF, ONE, TWO, THREE, FOUR, FIVE, EIGHT, NINE = (np.float32(k) for k in (0, 0.5, 1, 2, 3, 4, 5, 8, 9))
_EPSILON, _SURPLUS, _TWICE = np.float32(EPSILON), np.float32(SURPLUS), np.float32(2 * SURPLUS)
LARGER = np.float32(2 * SURPLUS * (ENLARGED + 7 * EPSILON))
_INSIDE = np.float32(INSIDE)
_WIDE, _ROUNDED = np.float32(2 * REPORTED), np.float32(1e-6)
_T = np.float32(44 * EPSILON)


class SeenTriangles(NamedTuple):
    """Sixteen triangles as a lamp sees them; vectors of lanes, lengths in units of the scene.

    Attributes:
        corner: the first corner, three coordinates.
        s: from there to the lamp's centre.
        e1, e2: the two edges at that corner.
        u, v, d: vectors whose dot products with a direction from the centre are U, V and D, times the sign of T.
        height, highest: |T|, the light's height above the plane times the normal's length: at least, and at most.
        away, first, second, across: lengths of s, e1, e2 and the normal.
        side: the sign of T: on which side of the triangle the light is.
        unsure: by how much T must differ from 0 for its sign to be certain.
        corner_error: how far the corners may be elsewhere.
        sure_side: whether that sign is certain.
        in_range: whether float32 can tell anything at all.
    """

    corner: Any
    s: Any
    e1: Any
    e2: Any
    u: Any
    v: Any
    d: Any
    height: Any
    highest: Any
    away: Any
    first: Any
    second: Any
    across: Any
    side: Any
    unsure: Any
    corner_error: Any
    sure_side: Any
    in_range: Any


class SureHitLength(NamedTuple):
    """How long a ray may be to be certain of a hit, in units of the scene.

    Attributes:
        fixed: triangles with a lower number never move, the others rest.
        static: for the former.
        resting: for the latter.
    """

    fixed: int
    static: float
    resting: float


class Functions(NamedTuple):
    """U, V, W = D - U - V and B = D - T of triangles; or the least, or the greatest, that they are for some rays."""

    u: Any
    v: Any
    w: Any
    b: Any


class Factors(NamedTuple):
    """What the error bounds of triangles do not owe to rays: see `bounds`.  `d` is what W has for D alone."""

    u: Any
    v: Any
    w: Any
    d: Any
    near: Any
    far: Any
    fixed: Any


@inlined
def cross(a, b):
    """The cross product of two vectors, each three numbers or three vectors of lanes."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@inlined
def dot(a, b):
    """The dot product of two vectors, like `cross`."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@inlined
def length(a):
    """The length of three numbers."""
    return math.sqrt(dot(a, a))


@inlined
def length16(a):
    """Lengths (16,) float32 of sixteen vectors, rounded up."""
    return square_root(dot(a, a) + np.float32(1e-36))


@inlined
def scaled(a, x):
    """A vector times a number."""
    return a[0] * x, a[1] * x, a[2] * x


@inlined
def grown(box, room):
    """The lower and the upper corners of boxes, six vectors of lanes, that are larger on all sides."""
    return (box[0] - room, box[1] - room, box[2] - room), (box[3] + room, box[4] + room, box[5] + room)


@inlined
def row_of(rows, i):
    """Corner and edges of the i-th of rows (n, ROW), in float64: three vectors."""
    return (
        (np.float64(rows[i, 0]), np.float64(rows[i, 1]), np.float64(rows[i, 2])),
        (np.float64(rows[i, 3]), np.float64(rows[i, 4]), np.float64(rows[i, 5])),
        (np.float64(rows[i, 6]), np.float64(rows[i, 7]), np.float64(rows[i, 8])),
    )


@inlined
def sure_hit_length(farthest, numbers):
    """Lengths (16,) that rays may have to be certain to hit the primitives whose numbers, int32, are at an address."""
    fixed = load_i32x16(numbers) < np.int32(farthest.fixed)
    return select(fixed, np.float32(farthest.static), np.float32(farthest.resting))


@inlined
def rows_at(rows, numbers):
    """The columns (ROW vectors of sixteen) of those of rows (n, ROW) whose numbers, int32, are at an address."""
    return load_columns(address_of(rows), numbers, ROW)


@inlined
def unsure_of_t(away, first, second, error):
    """By how much T must differ from 0 for its sign to be certain, of a light no more than `away` from a triangle's
    corner; lengths of its edges, and how far its corners may be elsewhere."""
    edges, tilt = first * second, TWO * error * (first + second + TWO * error)
    return _SURPLUS * ((away + error) * tilt + error * edges) + _T * away * edges + SMALL


@inlined
def seen_from(light, radius, row):
    """Sixteen triangles, columns of their rows, as a lamp sees them, whose samples lie in a ball around light (3,).

    The height is the least of any point of the ball, distances the greatest; the last two hold for all of them."""
    e1, e2, error = row[3:6], row[6:9], row[CORNER_ERROR]
    s = light[0] - row[0], light[1] - row[1], light[2] - row[2]
    n = cross(e1, e2)
    # Give all functions such signs that T is positive.
    facing = dot(s, n)
    side = select(facing >= ZERO, ONE, -ONE)
    first, second, across = length16(e1), length16(e2), length16(n)
    away, height, reach = length16(s) + radius, facing * side, radius * across
    highest, height = height + reach, height - reach

    # Is T's sign certain?
    unsure = unsure_of_t(away, first, second, error)
    in_range = maximum(away, maximum(first, second)) < LARGE
    sure = in_range & (height > unsure)
    u, v, d = scaled(cross(e2, s), side), scaled(cross(s, e1), side), scaled(n, -side)
    return SeenTriangles(
        row[0:3], s, e1, e2, u, v, d, height, highest, away, first, second, across, side, unsure, error, sure, in_range
    )


@inlined
def reported_box(t, row):
    """The lower and the upper corners of the boxes outside of which no ray from a light reports a hit on triangles as
    seen, whose rows' columns these are; with room for rounding."""
    box = row[BOX:ROW]
    room = _WIDE * t.away + _ROUNDED * ((box[3] - box[0]) + (box[4] - box[1]) + (box[5] - box[2]))
    return grown(box, room)


@inlined
def functions(t, direction, end):
    """(`Functions`, D) of triangles as seen, for rays of a direction that end at a point."""
    u, v, d = dot(t.u, direction), dot(t.v, direction), dot(t.d, direction)
    b = dot(t.d, (end[0] - t.corner[0], end[1] - t.corner[1], end[2] - t.corner[2]))
    return Functions(u, v, d - u - v, b), d


@inlined
def factors(first, second, longer, across, away, highest, error):
    """The `Factors` of triangles with edges of these lengths, the longer of both, and a normal of length `across`.

    The light is no more than `away` from their corner, |T| no more than `highest`; corners may be elsewhere by
    `error`."""
    moved, edges = FIVE * error * (longer + error), _EPSILON * (first * second)
    u, v = _TWICE * (NINE * _EPSILON * away * second + moved), _TWICE * (NINE * _EPSILON * away * first + moved)
    d = _TWICE * (FOUR * edges + FIVE * _EPSILON * across)
    fixed = FOUR * across * (error + _EPSILON * away) + THREE * _EPSILON * highest
    far = _SURPLUS * FOUR * _EPSILON * across
    # 4 edges are the structures' error, 8 more our own.
    return Factors(u, v, u + v + d, d, _SURPLUS * (FOUR + EIGHT) * edges, far, _SURPLUS * fixed)


@inlined
def factors_of(t):
    """The `Factors` of triangles as seen."""
    return factors(t.first, t.second, maximum(t.first, t.second), t.across, t.away, t.highest, t.corner_error)


@inlined
def bound_of_b(f, longest, near, coordinates):
    """That of `bounds` for B alone."""
    return f.near * near + f.far * (longest + HALF * coordinates) + (f.fixed + SMALL)


@inlined
def _if_known(longest):
    """A length of rays, or infinity where they are so long that float32 may lose more: no bound is exceeded then."""
    return select(longest < LARGE, longest, _UNKNOWN)


@inlined
def bounds(f, longest, near, along, coordinates):
    """By how much float32 may be wrong about U, V, W and B, our own errors included (`Functions`).

    They hold for directions no longer than `longest`, ends no further than `near` from the triangle's corner and with
    no more than this sum of absolute `coordinates`, and |D| no more than `along`.  For longer directions than `LARGE`
    they are infinite."""
    longest = _if_known(longest)
    larger, b = LARGER * along + SMALL, bound_of_b(f, longest, near, coordinates)
    return Functions(f.u * longest + larger, f.v * longest + larger, f.w * longest + larger, b)


# Factors in a row of `light_space` are four numbers: u, v, b and none for w, which is u + v there.  |n| <= |e1| |e2|,
# |T| <= |n| |s| and |s| <= |d| + |P - a| make `bounds` of B no more than 1.25 eps |e1| |e2| times
#     12 |P - a| + 4 |d| + 2 |P| + (4 + 3) (|d| + |P - a|)
# and that of corner_error no more than 5 corner_error |n| / |s| times |d| + |P - a|.
OF_NEAR, OF_LONGEST, OF_COORDINATES = np.float32(12 + 7), np.float32(4 + 7), np.float32(2)
_ROW_B, _ROW_CORNER_ERROR, _MORE = np.float32(1.26 * EPSILON), np.float32(5.01 / 11), np.float32(1.001)


@inlined
def row_factors(t, f):
    """The factors of U, V and B in rows, of triangles as seen."""
    half_d = HALF * f.d
    b = _ROW_B * (t.first * t.second) + _ROW_CORNER_ERROR * t.corner_error * t.across / t.away
    return _MORE * (f.u + half_d), _MORE * (f.v + half_d), b


@inlined
def row_bounds(u, v, b, longest, near, along, coordinates):
    """Bounds by the factors of a row, no narrower than those of `bounds`."""
    longest = _if_known(longest)
    larger = LARGER * along + SMALL
    b = b * (OF_NEAR * near + OF_LONGEST * longest + OF_COORDINATES * coordinates) + SMALL
    return Functions(u * longest + larger, v * longest + larger, (u + v) * longest + larger, b)


# --- the evaluator ----------------------------------------------------------------------------------------


@inlined
def spread_in_box(gradient, half):
    """By how much a linear function may differ from its value in the middle of a box with half sides `half` (3,), or of
    a point where that is None."""
    if half is None:
        return f32x16(ZERO)
    x, y, z = gradient
    return half[0] * maximum(x, -x) + half[1] * maximum(y, -y) + half[2] * maximum(z, -z)


@inlined
def spread_in_ball(gradient, radius):
    """By how much a linear function may differ from its value in the middle of a ball."""
    return radius * length16(gradient)


@inlined
def inside(least, m):
    """Whether rays surely pass through triangles, as far as U, V and W tell: the least of each, and their bounds m."""
    return (least.u > _INSIDE * m.u) & (least.v > _INSIDE * m.v) & (least.w > _INSIDE * m.w)


@inlined
def beside(most, m):
    """Whether rays surely pass triangles by, as far as U, V and W tell: the greatest of each, and their bounds m."""
    return (most.u < -m.u) | (most.v < -m.v) | (most.w < -m.w)


@inlined
def surely_hit(least, m):
    """Whether rays surely hit triangles whose sides are certain, beyond the lamp, for rays that are not too long."""
    return (least.b > m.b) & inside(least, m)


@inlined
def surely_missed(most, m):
    """Whether rays surely miss triangles whose sides are certain."""
    return (most.b < -m.b) | beside(most, m)
