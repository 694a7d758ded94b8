"""The margin rule: when is a triangle certain to be missed, or hit, by every shadow ray that ends in a cell?

Whatever is proved here has to hold of the float32 numbers that the ray kernels compute.  Shadow rays start
at the light L and end at P, direction d = P - L.  With a corner a, edges e1 and e2, the normal n = e1 x e2
and s = L - a, both structures compare

    U = d . (e2 x s)     V = d . (s x e1)     D = -d . n     T = s . n

and report a hit where, times the sign of D, these are not negative: U, V, D - U - V and D - T, and T is
positive.  All but T are *linear in P*: over a convex cell they are greatest and least at its corners.

Rounding.  With eps = 2^-24, the components of s and d are wrong by eps of themselves, those of a cross
product by less than 3 eps of the product of the lengths, a dot product by 3 eps of the same.  So U is
wrong by at most 9 eps |s| |e2| |d|, V likewise, and D by 9 eps |e1| |e2| |d|.  D and T share one n: what it is
wrong by tells in D - T by the distance of P from a alone, D - T = (a - P) . n, and the rest by the length
of n: that is how rays can end so close above their own triangle.  D - U - V bears the errors of all
three, and the reciprocal that u, v and t are multiplied with adds a few roundings of numbers no greater
than D.  The fast structure takes a triangle to be 2e-6 of itself larger.  The margins m of `measure` are the
sum of all of that, a quarter enlarged.

- *Hit*: where all four functions are greater than m at all corners of the cell, and the light lies off the
  triangle's plane by more than its own margin and than where rays begin, the test reports a hit for every ray.
  The structures must let it: they ask only where the ray's t lies in a box, or passes a plane, and t is wrong by
  up to 13 eps |s| |n| / D.  Across the triangle's plane that is 13 eps |d|, which the fast structure's boxes are
  padded for if no ray is longer than `farthest`; along it the point must lie so far inside the triangle that
  it stays there, for which U, V and D - U - V must exceed 13 eps |s| |e| |d| more: 2.5 m in all.
- *Miss*: where one function is less than -m at all corners, no ray does.  The same holds of any sum of two
  functions with positive factors, as both would have to be at least -m: that is a plane through
  an edge of the triangle, tilted as need be.
- *Miss by a plane*: a hit has D - T of at least -m, so D of T - m at least: the *depth*.  It puts the point where
  line and plane meet at barycentric coordinates no less than -m / depth, so beyond any plane that the
  triangle lies before by no more than 2 (m / depth) of the triangle's extent across that plane, and beyond P
  by no more than the margin of D - T allows.  A plane that all segments lie behind, and the triangle before by
  more than that, parts them.  The same sum for the whole scene's longest ray makes the boxes of `occluders`
  larger: no ray that misses such a box can report a hit on what is in it.  Where there is no depth,
  nothing follows (the light lies in the triangle's plane, as far as float32 can tell): such triangles are
  compared one by one.

What rests under a transform is known less well: it is carried to the world, or rays to it, in float32.  Its
corners are then somewhere within `blur` of where they are taken to be, and a ray that hits it passes that near
by a point of the triangle as it is taken.  U changes by no more than |e| |d| for each unit of length between two such
rays, five times that where the light is as near as the triangle is long; so the margins grow by 5 blur |e| |d|, and
that of D - T by 4 blur |n|.  Only which side of the plane the light is on is known worse by as much as it is far.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from tracer.kernels import inlined, subkernel
from tracer.simd import address_of, all_lanes, any_lane, largest, load_f64x8, select, smallest

EPSILON = 2.0**-24  # the largest relative error of a float32 rounding
ENLARGED = 2.5e-6  # of a triangle, by which the fast structure takes it to be larger, and a little
SURPLUS = 1.25
INSIDE = 2.5  # margins that a hit is to be inside of a triangle by
LONGEST = 13 * EPSILON  # times a ray's length: what boxes must be padded by for it to be sure of a hit
LAMP = 2e-5  # of a segment from the light: what lies in it may be nearer than rays begin
CORNERS = 8  # of a cell: three below and three above, and the last of them twice more, which makes a vector


class Measured(NamedTuple):
    """A triangle against a cell: its functions at the cell's corners, vectors of float64, times the sign of T; their
    margins; height, |T|; greatest, the largest |D|; reached, the least, 0 where D's sign is not sure; and whether
    that of T is."""

    u: Any
    v: Any
    w: Any
    beyond: Any
    of_u: Any
    of_v: Any
    of_w: Any
    of_beyond: Any
    height: Any
    greatest: Any
    reached: Any
    firm: Any


@inlined
def cross(a, b):
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@inlined
def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@inlined
def length(a):
    return math.sqrt(dot(a, a))


@inlined
def row_of(rows, i):
    """Corner and edges of the i-th of rows (n, 9), in float64."""
    return (
        (np.float64(rows[i, 0]), np.float64(rows[i, 1]), np.float64(rows[i, 2])),
        (np.float64(rows[i, 3]), np.float64(rows[i, 4]), np.float64(rows[i, 5])),
        (np.float64(rows[i, 6]), np.float64(rows[i, 7]), np.float64(rows[i, 8])),
    )


@inlined
def margins(s, e1, e2, across, blur, near, reach, largest, height):
    """Margins of U, V, D - U - V and D - T, and of D, for corners known to `blur`, a normal as long as `across`, points
    no further than `near` from the corner, directions no longer than `reach`, |D| no more than `largest` and
    |T| `height`."""
    ls, l1, l2 = length(s), length(e1), length(e2)
    beside = 5.0 * blur * max(l1, l2)
    u, v = reach * (9 * EPSILON * ls * l2 + beside), reach * (9 * EPSILON * ls * l1 + beside)
    tilt = 4 * EPSILON * l1 * l2
    d = reach * (tilt + 5 * EPSILON * across)
    enlarged = (ENLARGED + 6 * EPSILON) * largest
    return (
        SURPLUS * (u + enlarged),
        SURPLUS * (v + enlarged),
        SURPLUS * (u + v + d + enlarged),
        SURPLUS
        * (near * tilt + 4.0 * blur * across + 5 * EPSILON * across * (reach + ls) + 6 * EPSILON * (largest + height)),
        SURPLUS * (d + reach * blur * (l1 + l2)),
    )


@inlined
def measure(directions, reach, light, rows, i, blur):
    """Triangle i of rows (n, 9) against directions (3, CORNERS) from a light to a cell, none longer than `reach`."""
    a, e1, e2 = row_of(rows, i)
    s = light[0] - a[0], light[1] - a[1], light[2] - a[2]
    nd = cross(e2, e1)
    height = -dot(s, nd)
    turned = 1.0 if height >= 0.0 else -1.0
    height = abs(height)
    nu, nv = cross(e2, s), cross(s, e1)
    at = address_of(directions)
    x, y, z = load_f64x8(at), load_f64x8(at + 8 * CORNERS), load_f64x8(at + 16 * CORNERS)
    u = x * (turned * nu[0]) + y * (turned * nu[1]) + z * (turned * nu[2])
    v = x * (turned * nv[0]) + y * (turned * nv[1]) + z * (turned * nv[2])
    det = x * (turned * nd[0]) + y * (turned * nd[1]) + z * (turned * nd[2])
    least, most = smallest(det), largest(det)
    greatest = max(abs(least), abs(most))
    px, py, pz = x + s[0], y + s[1], z + s[2]
    near = math.sqrt(largest(px * px + py * py + pz * pz))
    m = margins(s, e1, e2, length(nd), blur, near, reach, greatest, height)
    return Measured(
        u, v, det - u - v, det - height, m[0], m[1], m[2], m[3], height, greatest,
        least if least > m[4] else (-most if most < -m[4] else 0.0),
        height > firm_height(s, e1, e2, blur),
    )  # fmt: skip


@inlined
def firm_height(s, e1, e2, blur):
    """|T| beyond which its sign is sure."""
    ls, l1, l2 = length(s), length(e1), length(e2)
    return ls * (32 * EPSILON * l1 * l2 + 1.25 * blur * (l1 + l2)) + blur * l1 * l2


@inlined
def surely_hit(q):
    """Whether every ray of the cell hits the triangle that was measured, none being too long."""
    # D - T is greater than its margin at all corners: so is D, and with T firm its sign is that of every ray.
    inside = (q.u > INSIDE * q.of_u) & (q.v > INSIDE * q.of_v) & (q.w > INSIDE * q.of_w)
    inside = all_lanes(inside & (q.beyond > q.of_beyond))
    return inside and is_past_the_lamp(q)


@inlined
def is_past_the_lamp(q):
    """Whether the triangle lies where rays from the light have begun, whatever they are."""
    return q.firm and q.height > LAMP * q.greatest


@inlined
def _parted_by_two(x, y):
    """Whether some sum of two functions with positive factors, margins added to both, is negative at all corners."""
    if any_lane((x >= 0.0) & (y >= 0.0)):
        return False
    ratio = -x / y
    return largest(select(y < 0.0, ratio, 0.0 * x)) < smallest(select(y > 0.0, ratio, x * 0.0 + np.inf))


@inlined
def surely_missed(q):
    """Whether no ray of the cell hits the triangle that was measured, by its own planes."""
    u, v, w, b = q.u + q.of_u, q.v + q.of_v, q.w + q.of_w, q.beyond + q.of_beyond
    if not q.firm:
        return _missed_both_ways(q)
    if not (any_lane(b >= 0.0) and any_lane(u >= 0.0) and any_lane(v >= 0.0) and any_lane(w >= 0.0)):
        return True
    return (
        _parted_by_two(u, b)
        or _parted_by_two(v, b)
        or _parted_by_two(w, b)
        or _parted_by_two(u, v)
        or _parted_by_two(u, w)
        or _parted_by_two(v, w)
    )


@inlined
def _beyond_margin(way, q):
    """Whether one function, times a sign, is below its margin at all corners; D itself for D - T."""
    return not (
        any_lane(q.u * way >= -q.of_u)
        and any_lane(q.v * way >= -q.of_v)
        and any_lane(q.w * way >= -q.of_w)
        and any_lane((q.beyond + q.height) * way >= -(q.of_beyond + q.of_w))
    )


@inlined
def _missed_both_ways(q):
    """The same where the light lies in the triangle's plane, as far as one can tell: D may have either sign."""
    return _beyond_margin(1.0, q) and _beyond_margin(-1.0, q)


@inlined
def depth_of(q):
    """The least |D| of a ray that hits; 0 where it may be anything."""
    return max(q.height - q.of_beyond if q.firm else 0.0, q.reached)


@inlined
def before_plane(a, e1, e2, blur, plane, q, depth, reach):
    """Whether a triangle that was measured lies before a plane (4,), normal and offset, that no segment crosses, so
    that none hits it; depth > 0."""
    uncertain = max(q.of_u, max(q.of_v, q.of_w)) / depth
    n = plane[0], plane[1], plane[2]
    g = dot(n, a) - plane[3] - blur
    g1, g2 = g + dot(n, e1), g + dot(n, e2)
    least, most = min(g, min(g1, g2)), max(g, max(g1, g2))
    return least > 2.0 * uncertain * (most - least) + q.of_beyond / depth * reach


SURE_MISS, SURE_HIT, UNSURE = 0, 1, 2


@inlined
def _size(a):
    """No less than the length of a vector, and soon known."""
    return abs(a[0]) + abs(a[1]) + abs(a[2])


@subkernel
def verdict(rows, i, blur, farthest, light, point):
    """What a shadow ray from a light to a point, both (3,), is certain to find of triangle i of rows (n, 9): SURE_HIT,
    unless it is longer than `farthest`, SURE_MISS, or UNSURE where float32 may say either."""
    a, e1, e2 = row_of(rows, i)
    s = light[0] - a[0], light[1] - a[1], light[2] - a[2]
    d = point[0] - light[0], point[1] - light[1], point[2] - light[2]
    n = cross(e1, e2)
    height, det = dot(s, n), -dot(d, n)
    turned = 1.0 if height >= 0.0 else -1.0
    height, det = abs(height), turned * det
    ls, l1, l2, reach = _size(s), _size(e1), _size(e2), _size(d)
    if not height > ls * (32 * EPSILON * l1 * l2 + 1.25 * blur * (l1 + l2)) + blur * l1 * l2:
        return UNSURE
    across, tilt, beside = _size(n), 4 * EPSILON * l1 * l2, 5.0 * blur * max(l1, l2)
    near = _size((d[0] + s[0], d[1] + s[1], d[2] + s[2]))
    m = near * tilt + 4.0 * blur * across + 5 * EPSILON * across * (reach + ls) + 6 * EPSILON * (abs(det) + height)
    behind = det - height
    if behind < -SURPLUS * m:
        return SURE_MISS
    sure = behind > SURPLUS * m and height > LAMP * abs(det) and reach < farthest
    q = cross(s, d)
    u, v = turned * dot(e2, q), -turned * dot(e1, q)
    w = det - u - v
    enlarged = (ENLARGED + 6 * EPSILON) * abs(det)
    mu = SURPLUS * (reach * (9 * EPSILON * ls * l2 + beside) + enlarged)
    mv = SURPLUS * (reach * (9 * EPSILON * ls * l1 + beside) + enlarged)
    mw = mu + mv + SURPLUS * reach * (tilt + 5 * EPSILON * across)
    if u < -mu or v < -mv or w < -mw:
        return SURE_MISS
    return SURE_HIT if sure and u > INSIDE * mu and v > INSIDE * mv and w > INSIDE * mw else UNSURE
