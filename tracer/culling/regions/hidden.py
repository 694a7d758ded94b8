"""When does a patch hide every light of a box from every point of another?

A shadow ray goes from L, in the lights' box, to P, in the region.  With the lights before the patch's plane and the
region behind it, the ray meets the plane in one point X.  For a fixed P, what the lights' box looks like on the plane
is the convex hull of its corners' images, and likewise for a fixed L.  So all X lie between the images of the 64 pairs
of corners; if no outline of the patch meets the rectangle around these, and its centre lies on the patch, then all of
it does.

So every ray, in exact arithmetic, meets one of the patch's triangles (a patch that is not quite flat is met near X: the
rectangle is larger by that).  What float32 computes of this triangle is wrong by some part of it: rho, of the numbers
U, V and D - U - V over D (`tracer.culling.certified.error_bounds`).  A triangle alone is hit for certain by a ray that
passes through it further inside than that.  Where rays may pass along an edge that two triangles share, the fast
structure lets none slip through as long as rho is less than EDGE, the part of itself by which it takes each triangle to
be larger.  Besides, rays must be short enough for the boxes in which the structures look for a hit, start before the
plane by more than the part of a ray in which nothing counts, and end behind it by more than D - T may be wrong.

All of this is computed in float64, whose own errors are far below the part by which all bounds are enlarged.
"""

from __future__ import annotations

from tracer.culling.certified.error_bounds import EPSILON, INSIDE, LAMP, SURPLUS
from tracer.geometry.triangle_test import EDGE
from tracer.kernels import inlined, subkernel

SEAM = 0.9 * float(EDGE)  # of a triangle: errors must be less for rays not to slip past its edges
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
    """A row (4,) of a patch's frame at a point: one of its coordinates."""
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
def _meets(edges, first, last, u0, v0, u1, v1):
    """Whether one of edges first to last - 1 meets a rectangle."""
    u, v, du, dv = 0.5 * (u0 + u1), 0.5 * (v0 + v1), 0.5 * (u1 - u0), 0.5 * (v1 - v0)
    for k in range(first, last):
        au, av, bu, bv = edges[k, 0] - u, edges[k, 1] - v, edges[k, 2] - u, edges[k, 3] - v
        apart = min(au, bu) > du or max(au, bu) < -du or min(av, bv) > dv or max(av, bv) < -dv
        if not apart and abs(au * bv - av * bu) <= du * abs(bv - av) + dv * abs(bu - au):
            return True
    return False


@subkernel
def _contains(edges, first, last, u, v):
    """Whether a point lies within an outline, edges first to last - 1: a line from it crosses an odd number."""
    inside = False
    for k in range(first, last):
        au, av, bu, bv = edges[k, 0] - u, edges[k, 1] - v, edges[k, 2] - u, edges[k, 3] - v
        if (av > 0.0) != (bv > 0.0) and (au * bv - av * bu > 0.0) == (bv > av):
            inside = not inside
    return inside


@subkernel
def hides(patches, i, region, lights, longest_sure):
    """Whether the i-th of `Patches` blocks every ray from a box of lights to a region.

    Boxes are pairs of centre and half sides; rays no longer than `longest_sure`, in units of the scene, are certain of
    a hit on it."""
    frame, shape = patches.frames[i], patches.shapes[i]
    height, depth = along(frame[2], lights[0]), along(frame[2], region[0])
    sign = 1.0 if height >= 0.0 else -1.0
    tall, deep = _reach(frame[2], lights[1]), _reach(frame[2], region[1])
    height, depth = sign * height, -sign * depth
    if not height > tall or not depth > deep:
        return False

    # Most patches are not between the centres.
    part, box = height / (height + depth), patches.boxes[i]
    u, v = along(frame[0], lights[0]), along(frame[1], lights[0])
    u, v = u + part * (along(frame[0], region[0]) - u), v + part * (along(frame[1], region[0]) - v)
    if u < box[0] or v < box[1] or u > box[2] or v > box[3]:
        return False

    # Bound lengths: of rays, and from both of their ends to any corner of the triangle that they meet.
    dx, dy, dz = lights[0][0] - region[0][0], lights[0][1] - region[0][1], lights[0][2] - region[0][2]
    longest = (dx * dx + dy * dy + dz * dz) ** 0.5 + _diagonal(lights[1]) + _diagonal(region[1])
    most, off = height + depth + tall + deep, shape[3] + shape[4] * (longest + shape[2])
    height, depth = height - tall - off, depth - deep - off
    if not height > 0.0 or not depth > 0.0:
        return False
    before = (height + 2.0 * tall) / (height + 2.0 * tall + depth)
    away, near = before * longest + shape[2], longest + shape[2]
    steep = longest / (height + depth)  # 1 over the least cosine with the normal
    if not steep * longest < longest_sure:
        return False

    # What float32 may be wrong by.
    behind = EPSILON * (4.0 * near * shape[1] + 4.0 * (longest + away) + 3.0 * away)
    firm = height > 2.0 * away * EPSILON * (44.0 * shape[1] + 8.0) and height > LAMP * most
    rho = EPSILON * steep * (9.0 * away * shape[0] + 21.0 * shape[1] + 5.0)
    if not firm or not depth > 2.0 * SURPLUS * behind:
        return False

    # All rays pass through the patch, further inside than errors reach.
    u0, v0, u1, v1 = _images(frame, lights, region, sign)
    room = 2.0 * INSIDE * (rho + 2.0 * float(EDGE)) * shape[2] + 2.0 * steep * off + ROUNDED * (longest + away)
    u0, v0, u1, v1 = u0 - room, v0 - room, u1 + room, v1 + room
    first, seams, last = patches.ranges[i, 0], patches.ranges[i, 1], patches.ranges[i, 2]
    if _meets(patches.edges, first, seams, u0, v0, u1, v1):
        return False
    if not rho < SEAM and _meets(patches.edges, seams, last, u0, v0, u1, v1):
        return False
    return _contains(patches.edges, first, seams, 0.5 * (u0 + u1), 0.5 * (v0 + v1))
