"""When does a blocker hide every light of a box from every point of another?

A shadow ray goes from L, in the lights' box, to P, in the region.  With the lights before the blocker's plane and the
region behind it, the ray meets the plane in one point X.  For a fixed P, what the lights' box looks like on the plane
is the convex hull of its corners' images, and likewise for a fixed L.  So all X lie between the images of the 64 pairs
of corners; if the rectangle around these lies in the triangle, so do all X.

What float32 computes of the triangle is wrong by some part of it: rho, of the numbers U, V and D - U - V over D
(`tracer.culling.certified.error_bounds`).  So the rectangle must lie further inside than that.  Besides, rays must be
short enough for the boxes in which the structures look for a hit, start before the plane by more than the part of a ray
in which nothing counts, and end behind it by more than D - T may be wrong.

All of this is computed in float64, whose own errors are far below the part by which all bounds are enlarged.
"""

from __future__ import annotations

from tracer.culling.certified.error_bounds import ENLARGED, EPSILON, INSIDE, LAMP, SURPLUS
from tracer.runtime.kernels import inlined, subkernel

ROUNDED = 1e-6  # of lengths: room around what is computed here


@inlined
def box_of(boxes, i):
    """Centre and half sides of the i-th of boxes (n, 6), lower and upper corners: six float64."""
    return (
        (0.5 * (boxes[i, 0] + boxes[i, 3]), 0.5 * (boxes[i, 1] + boxes[i, 4]), 0.5 * (boxes[i, 2] + boxes[i, 5])),
        (0.5 * (boxes[i, 3] - boxes[i, 0]), 0.5 * (boxes[i, 4] - boxes[i, 1]), 0.5 * (boxes[i, 5] - boxes[i, 2])),
    )


@inlined
def along(row, point):
    """A row (4,) of a blocker's frame at a point: one of its coordinates."""
    return row[0] * point[0] + row[1] * point[1] + row[2] * point[2] + row[3]


@inlined
def _reach(row, half):
    """By how much a coordinate may change within a box of these half sides."""
    return half[0] * abs(row[0]) + half[1] * abs(row[1]) + half[2] * abs(row[2])


@inlined
def _corner(box, k):
    """The k-th corner of a box."""
    center, half = box
    return (
        center[0] + (half[0] if k & 1 else -half[0]),
        center[1] + (half[1] if k & 2 else -half[1]),
        center[2] + (half[2] if k & 4 else -half[2]),
    )


@inlined
def _diagonal(half):
    """Half of the diagonal of a box, or more."""
    return half[0] + half[1] + half[2]


@subkernel
def _images(frame, lights, region, sign):
    """The rectangle (least u, least v, greatest u, greatest v) around all points in which rays may meet a plane.

    `sign` turns heights so that the lights' are positive."""
    u0, v0, u1, v1 = 1e300, 1e300, -1e300, -1e300
    for i in range(8):
        light = _corner(lights, i)
        lu, lv, lh = along(frame[0], light), along(frame[1], light), sign * along(frame[2], light)
        for j in range(8):
            point = _corner(region, j)
            pu, pv, ph = along(frame[0], point), along(frame[1], point), -sign * along(frame[2], point)
            part = lh / (lh + ph)
            u, v = lu + part * (pu - lu), lv + part * (pv - lv)
            u0, v0, u1, v1 = min(u0, u), min(v0, v), max(u1, u), max(v1, v)
    return u0, v0, u1, v1


@subkernel
def hides(blockers, i, region, lights, longest_sure):
    """Whether the i-th of `Blockers` blocks every ray from a box of lights to a region.

    Boxes are pairs of centre and half sides; rays no longer than `longest_sure`, in units of the scene, are certain of
    a hit on it."""
    frame, shape = blockers.frames[i], blockers.shapes[i]
    height, depth = along(frame[2], lights[0]), along(frame[2], region[0])
    sign = 1.0 if height >= 0.0 else -1.0
    tall, deep = _reach(frame[2], lights[1]), _reach(frame[2], region[1])
    height, depth = sign * height, -sign * depth
    if not height > tall or not depth > deep:
        return False

    # Most blockers are not between the centres.
    part, box = height / (height + depth), blockers.boxes[i]
    u, v = along(frame[0], lights[0]), along(frame[1], lights[0])
    u, v = u + part * (along(frame[0], region[0]) - u), v + part * (along(frame[1], region[0]) - v)
    if u < box[0] or v < box[1] or u > box[2] or v > box[3]:
        return False

    # Bound lengths: of rays, and from both of their ends to the triangle's corners.
    dx, dy, dz = lights[0][0] - region[0][0], lights[0][1] - region[0][1], lights[0][2] - region[0][2]
    longest = (dx * dx + dy * dy + dz * dz) ** 0.5 + _diagonal(lights[1]) + _diagonal(region[1])
    most = height + depth + tall + deep
    height, depth = height - tall, depth - deep
    before = (height + 2.0 * tall) / (height + 2.0 * tall + depth)
    away, near = before * longest + shape[2], longest + shape[2]
    steep = longest / (height + depth)  # 1 over the least cosine with the normal
    if not steep * longest < longest_sure:
        return False

    # What float32 may be wrong by.
    behind = EPSILON * (4.0 * near * shape[1] + 4.0 * (longest + away) + 3.0 * away)
    firm = height > 2.0 * away * EPSILON * (44.0 * shape[1] + 8.0) and height > LAMP * most
    rho = EPSILON * steep * (9.0 * away * shape[0] + 13.0 * shape[1] + 5.0) + ENLARGED
    if not firm or not depth > 2.0 * SURPLUS * behind:
        return False

    # All rays pass through the triangle, further inside than errors reach.
    u0, v0, u1, v1 = _images(frame, lights, region, sign)
    u, v, du, dv = 0.5 * (u0 + u1), 0.5 * (v0 + v1), 0.5 * (u1 - u0), 0.5 * (v1 - v0)
    room = 2.0 * INSIDE * rho * shape[2] + ROUNDED * (longest + away)
    for k in range(3):
        a, b, c = blockers.sides[i, k, 0], blockers.sides[i, k, 1], blockers.sides[i, k, 2]
        if not a * u + b * v + c > abs(a) * du + abs(b) * dv + room:
            return False
    return True
