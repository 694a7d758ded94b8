"""Which modes depend on an object that starts or stops, and dropping them.

All shadow rays of a primitive to a light run in their pyramid, the convex hull of both, but for the little by which
rays end above the surface.  A box that it does not meet has never blocked one of them, and never will.  They keep
clear of one another where a plane separates them, and if one does, then one that is parallel to a face of either, or
to an edge of each (Gottschalk, Lin, Manocha 1996).  A triangle's pyramid is a tetrahedron; a quadric is taken for its
box.

Where an object that rested starts, what it alone may have blocked is unknown: FULL_SHADOW is dropped.  Where one
stops, what it blocks from now on is: NON_SHADOW is dropped.  The other half of a mode stays true either way.  A unit
that loses something must be seen whole anew.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tracer.culling.modes import DYNAMIC, FULLY_RENDERED, MAX_CULLED_LIGHTS, occlusion_bits
from tracer.geometry.memory import without_refcount
from tracer.geometry.primitives import Outlines
from tracer.runtime.kernels import inlined, kernel, subkernel
from tracer.runtime.parallel import for_each_chunk

CHUNK = 1 << 12  # units a thread takes at a time
# By so much of the largest coordinates boxes are wider than they are: five times what rays are lifted off surfaces by,
# and what float32 leaves of a ray from a distant light.
MARGIN, LIGHT_MARGIN = 1e-4, 1e-6


@inlined
def _apart(points, n, box, ax, ay, az):
    """Whether the first n of points (9, 3) and a box, middle and half its size (6,), keep clear of one another along an
    axis."""
    reach = box[3] * abs(ax) + box[4] * abs(ay) + box[5] * abs(az)
    low, high = np.inf, -np.inf
    for i in range(n):
        x = (points[i, 0] - box[0]) * ax + (points[i, 1] - box[1]) * ay + (points[i, 2] - box[2]) * az
        low, high = min(low, x), max(high, x)
    return low > reach or high < -reach


@inlined
def _apart_across(points, n, box, x, y, z):
    """The same along the three axes at right angles to a direction and to an edge of the box."""
    return (
        _apart(points, n, box, 0.0, -z, y) or _apart(points, n, box, z, 0.0, -x) or _apart(points, n, box, -y, x, 0.0)
    )


@inlined
def _between(points, i, j):
    return points[j, 0] - points[i, 0], points[j, 1] - points[i, 1], points[j, 2] - points[i, 2]


@inlined
def _apart_at_face(points, n, box, i, j, k):
    """The same along the normal of three points."""
    ax, ay, az = _between(points, i, j)
    bx, by, bz = _between(points, i, k)
    return _apart(points, n, box, ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx)


@subkernel
def _meets(points, n, box):
    """Whether a pyramid over a triangle (n = 4) or a box (n = 9), its top the first of points (9, 3), meets a box given
    by its middle and half its size (6,)."""
    if (
        _apart(points, n, box, 1.0, 0.0, 0.0)
        or _apart(points, n, box, 0.0, 1.0, 0.0)
        or _apart(points, n, box, 0.0, 0.0, 1.0)
    ):
        return False
    if n == 4 and (
        _apart_at_face(points, n, box, 1, 2, 3)
        or _apart_at_face(points, n, box, 0, 1, 2)
        or _apart_at_face(points, n, box, 0, 2, 3)
        or _apart_at_face(points, n, box, 0, 3, 1)
    ):
        return False
    for i in range(1, n):
        x, y, z = _between(points, 0, i)
        if _apart_across(points, n, box, x, y, z):
            return False
        if n == 4:
            x, y, z = _between(points, i, i % 3 + 1)
            if _apart_across(points, n, box, x, y, z):
                return False
    return True


@subkernel
def _put_primitive(outlines, primitive, points):
    """The corners of a primitive, or of its box, into points[1:]; how many points that makes with a light."""
    t = len(outlines.triangles)
    if primitive >= t:
        for i in range(8):
            for k in range(3):
                points[1 + i, k] = outlines.boxes[primitive - t, k + 3 * ((i >> k) & 1)]
        return 9
    row, o = outlines.triangles[primitive], outlines.object_of[primitive]
    for i in range(3):
        x, y, z = np.float64(row[0]), np.float64(row[1]), np.float64(row[2])
        if i > 0:
            x, y, z = x + row[3 * i], y + row[3 * i + 1], z + row[3 * i + 2]
        for k in range(3):
            m = outlines.to_world[o, 4 * k : 4 * k + 4]
            points[1 + i, k] = m[0] * x + m[1] * y + m[2] * z + m[3]
    return 4


@inlined
def _widen(points, n, bounds, box):
    """A box (6,) of lower and upper bounds as its middle and half its size, MARGIN wider."""
    extent, far = 0.0, 0.0
    for k in range(3):
        low, high = np.float64(bounds[k]), np.float64(bounds[k + 3])
        box[k], box[k + 3] = 0.5 * (high + low), 0.5 * (high - low)
        extent, far = max(extent, max(-low, high)), max(far, abs(points[0, k]))
        for i in range(1, n):
            extent = max(extent, abs(points[i, k]))
    for k in range(3, 6):
        box[k] += MARGIN * extent + LIGHT_MARGIN * far


@kernel
def _drop(words, outlines, lights, boxes, mode, first, last):
    """Drop `mode` of each light, at lights (l, 3), from those units first to last - 1 whose pyramid meets a box, the
    first of boxes (k, 6) being around all others."""
    words, outlines, lights, boxes = without_refcount((words, outlines, lights, boxes))
    points, box = np.empty((9, 3)), np.empty(6)
    for unit in range(first, last):
        word, n = np.uint64(words[unit]), 0
        kept = word
        for light in range(min(len(lights), MAX_CULLED_LIGHTS)):
            bit = np.uint64(mode) << np.uint64(2 + 2 * light)
            if word & bit == 0 or occlusion_bits(word) == DYNAMIC:
                continue
            if n == 0:
                n = _put_primitive(outlines, unit, points)
            for k in range(3):
                points[0, k] = lights[light, k]
            for b in range(len(boxes)):
                _widen(points, n, boxes[b], box)
                meets = _meets(points, n, box)
                if b > 0 and meets:
                    kept &= ~bit
                if meets != (b == 0):
                    break  # it keeps clear of all, or meets one
        if kept != word:
            words[unit] = kept & ~np.uint64(3) if occlusion_bits(word) == FULLY_RENDERED else kept


def drop_dependent(
    words: NDArray[np.unsignedinteger],
    outlines: Outlines,
    lights: NDArray[np.float32],
    boxes: NDArray[np.float32],
    mode: int,
    threads: int,
) -> None:
    """Drop a shadow mode, FULL_SHADOW or NON_SHADOW, of each of the lights (l, 3) from all words (units,) that may
    depend on what is in any of boxes (k, 6); FULLY_RENDERED goes back to INIT where anything is dropped."""
    if not len(boxes):
        return
    around = np.concatenate([boxes[:, :3].min(0), boxes[:, 3:].max(0)])[None]
    given = words, outlines, lights, np.concatenate([around, boxes]), mode

    def work(chunk: int, worker: int) -> None:
        _drop(*given, chunk * CHUNK, min(len(words), (chunk + 1) * CHUNK))

    for_each_chunk(work, -(-len(words) // CHUNK), threads)
