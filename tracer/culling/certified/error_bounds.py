"""Error bounds: when is a triangle certain to be missed, or hit, by every shadow ray that ends in a cell?

Whatever is proved here has to hold of the float32 numbers that the ray kernels compute.  Shadow rays start
at the light L and end at P, direction d = P - L.  With a corner a, edges e1 and e2, the normal n = e1 x e2
and s = L - a, both structures compare

    U = d . (e2 x s)     V = d . (s x e1)     D = -d . n     T = s . n

and report a hit where, times the sign of D, these are not negative: U, V, D - U - V and D - T, and T is
positive.  All but T are *linear in P*: over a convex cell they are greatest and least at its corners.

Rounding. With eps = 2^-24, the components of s and d are wrong by eps of themselves, those of a cross product by
less than 3 eps of the product of the lengths, a dot product by 3 eps of the same. So U is wrong by at most 9 eps
|s| |e2| |d|, V likewise, and D by 9 eps |e1| |e2| |d|. D and T share one n: what it is wrong by tells in D - T by
the distance of P from a alone, D - T = (a - P) . n, and the rest by the length of n: that is how rays can end so
close above their own triangle; s, d and the dot products add 4 eps of |n| times |s| and |d|, and t = T / D two
roundings. D - U - V bears the errors of all three, and the reciprocal that u and v are multiplied with adds a few
roundings of numbers no greater than D. The fast structure takes a triangle to be 2e-6 of itself larger. The error
bounds m are the sum of all of that, a quarter enlarged. The functions are computed here in float32, too, which adds
errors of our own: as much again to U, V and D; but D - T is taken from P - a, which is hardly wrong where it matters,
close to the triangle.

- *Hit*: where all four functions are greater than m at all corners of the cell, and the light lies off the
  triangle's plane by more than its own error bound and than where rays begin, the test reports a hit for every ray.
  The structures must let it: they ask only where the ray's t lies in a box, or passes a plane, and t is wrong by
  up to 13 eps |s| |n| / D.  Across the triangle's plane that is 13 eps |d|, which the fast structure's boxes are
  padded for if no ray is longer than `Farthest` says; along it the point must lie so far inside the triangle that
  it stays there, for which U, V and D - U - V must exceed 13 eps |s| |e| |d| more: 2.5 m in all.
- *Miss*: where one function is less than -m at all corners, no ray does.  The same holds of any sum of two
  functions with positive factors, as both would have to be at least -m: that is a plane through
  an edge of the triangle, tilted as need be.
- *Miss by a plane*: a hit has D - T of at least -m, so D of T - m at least: the *depth*.  It puts the point where
  line and plane meet at barycentric coordinates no less than -m / depth, so beyond any plane that the
  triangle lies before by no more than 2 (m / depth) of the triangle's extent across that plane, and beyond P
  by no more than the error bound of D - T allows.  A plane that all segments lie behind, and the triangle before by
  more than that, parts them.  The same sum for the whole scene's longest ray makes the boxes of `occluders`
  larger: no ray that misses such a box can report a hit on what is in it.  Where there is no depth,
  these say nothing: the light lies in the triangle's plane, as far as float32 can tell.
- *Miss by a box*: but wherever the functions are noise, a hit counts only near the triangle: the kd-tree's test
  asks that (`hit_triangle`), and the fast structure tests the box of a triangle's block.  What passes that box by
  does not hit.

A lamp shines from many points, all in a ball around its centre. U, V, D and T are linear in where the ray starts, too,
as long as their sign is not turned: d x s has no square of L. So for rays to one point P they are greatest and least at
the centre and, times the ball's radius, the length of their gradient to either side: (P - a) x e2 is that of U,
e1 x (P - a) that of V, n that of D and of T, and D - T has none. The bounds hold of all of the ball if lengths and
distances are taken a radius longer.

What rests under a transform is known less well in the kd-tree: rays are carried to it, in float32.  Its
corners are then somewhere within `blur` of where they are taken to be, and a ray that hits it passes that near
by a point of the triangle as it is taken.  U changes by no more than |e| |d| for each unit of length between two such
rays, five times that where the light is as near as the triangle is long; so the bounds grow by 5 blur |e| |d|, and
that of D - T by 4 blur |n|.  Only which side of the plane the light is on is known worse by as much as it is far.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from tracer.runtime.kernels import inlined
from tracer.simd import address_of, load_columns, load_i32x16, maximum, select, square_root

EPSILON = 2.0**-24  # the largest relative error of a float32 rounding
ENLARGED = 2.5e-6  # the part of itself by which the fast structure takes a triangle to be larger, and a little
SURPLUS = 1.25  # by which all bounds are enlarged
INSIDE = 1.75  # bounds by which a certain hit lies inside of a triangle: 2.5 m and our own error
LONGEST = 13 * EPSILON  # times a ray's length: what boxes must be padded by for it to be sure of a hit
LAMP = 2e-5  # of the way from the light: what lies in it may be nearer than rays begin
# Columns of a primitive's row: a corner, two edges, how far its corners may be elsewhere, and a box (6,) outside of
# which no hit is reported, but for REPORTED of the light's distance.  Quadrics have the box alone.
BLUR, BOX, ROW = 9, 10, 16
REPORTED = 4e-5  # more than 3 of the kd-tree's 1e-5, turned, by objects whose axes differ by a tenth in length
LANES = 16  # rows that are looked at together
SMALL, LARGE = np.float32(1e-30), np.float32(1e12)  # volumes and lengths outside of which float32 may lose more

ZERO, ONE, TWO, THREE, FOUR, FIVE, NINE = (np.float32(k) for k in (0, 1, 2, 3, 4, 5, 9))
_EPSILON, _SURPLUS, _TWICE = np.float32(EPSILON), np.float32(SURPLUS), np.float32(2 * SURPLUS)
_LARGER = np.float32(ENLARGED + 6 * EPSILON)
_FIRM, _FIRM_BLUR = np.float32(44 * EPSILON), np.float32(1.25)


class SeenTriangles(NamedTuple):
    """Sixteen triangles as a lamp sees them; vectors of lanes, lengths in units of the scene.

    Attributes:
        corner: the first corner, three coordinates.
        s: from there to the lamp's centre.
        e1, e2: the two edges at that corner.
        u, v, d: vectors whose dot products with a direction from the centre are U, V and D, times the sign of T.
        height, highest: |T|, the light's height above the plane times the normal's length: at least, and at most.
        away, first, second, across: lengths of s, e1, e2 and the normal.
        turned: the sign of T, by which u, v and d are turned.
        unsure: by how much T must differ from 0 for its sign to be certain.
        blur: how far the corners may be elsewhere.
        firm: whether the sign of T is certain.
        sane: whether float32 can tell anything at all.
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
    turned: Any
    unsure: Any
    blur: Any
    firm: Any
    sane: Any


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


class ErrorBounds(NamedTuple):
    """By how much float32 may be wrong: of U, V, D - U - V (w), D - T (behind), and D."""

    u: Any
    v: Any
    w: Any
    behind: Any
    d: Any


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
def seen_from(light, radius, row):
    """Sixteen triangles, columns of their rows, as a lamp sees them, whose samples lie in a ball around light (3,).

    The height is the least of any point of the ball, distances are the greatest; firm and sane hold for all of them."""
    e1, e2, blur = row[3:6], row[6:9], row[BLUR]
    s = light[0] - row[0], light[1] - row[1], light[2] - row[2]
    n = cross(e1, e2)
    # Turn all functions so that T is positive.
    facing = dot(s, n)
    turned = select(facing >= ZERO, ONE, -ONE)
    first, second, across = length16(e1), length16(e2), length16(n)
    away, height, reach = length16(s) + radius, facing * turned, radius * across
    highest, height = height + reach, height - reach

    # Is T's sign certain?
    unsure = away * (_FIRM * first * second + _FIRM_BLUR * blur * (first + second)) + blur * first * second + SMALL
    sane = maximum(away, maximum(first, second)) < LARGE
    firm = sane & (height > unsure)
    u, v, d = scaled(cross(e2, s), turned), scaled(cross(s, e1), turned), scaled(n, -turned)
    return SeenTriangles(
        row[0:3], s, e1, e2, u, v, d, height, highest, away, first, second, across, turned, unsure, blur, firm, sane
    )


@inlined
def functions(t, direction, end):
    """(U, V, D - U - V, D - T, D) of triangles as seen, for rays of a direction that end at a point."""
    u, v, d = dot(t.u, direction), dot(t.v, direction), dot(t.d, direction)
    behind = dot(t.d, (end[0] - t.corner[0], end[1] - t.corner[1], end[2] - t.corner[2]))
    return u, v, d - u - v, behind, d


@inlined
def error_bounds(t, longest, near, along, coordinates):
    """Bounds for triangles as seen, our own errors included.

    They hold for directions no longer than `longest`, ends no further than `near` from the triangle's corner and with
    no more than this sum of absolute `coordinates`, and |D| no more than `along`."""
    # Bound what the ray kernels compute.
    blurred = FIVE * t.blur * maximum(t.first, t.second)
    u = longest * (NINE * _EPSILON * t.away * t.second + blurred)
    v = longest * (NINE * _EPSILON * t.away * t.first + blurred)
    tilt = FOUR * _EPSILON * t.first * t.second
    d, enlarged = longest * (tilt + FIVE * _EPSILON * t.across), _LARGER * along
    behind = near * tilt + FOUR * t.blur * t.across + FOUR * _EPSILON * t.across * (longest + t.away)
    behind = behind + THREE * _EPSILON * t.highest
    # Bound what is computed here.
    ours = TWO * near * tilt + TWO * _EPSILON * t.across * coordinates
    return ErrorBounds(
        _TWICE * (u + enlarged) + SMALL,
        _TWICE * (v + enlarged) + SMALL,
        _TWICE * (u + v + d + enlarged) + SMALL,
        _SURPLUS * (behind + ours) + SMALL,
        _TWICE * (d + longest * t.blur * (t.first + t.second)) + SMALL,
    )
