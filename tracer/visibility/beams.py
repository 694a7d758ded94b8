"""Beams: all shadow rays from a lamp to some neighbouring points, with what may come between.

A lamp's samples lie in a ball.  A beam is what lies between the ball and the points, bounded by a box and by planes:
four around the way from the lamp to the points, and one along the surface that they lie on.  It is made for vectors of
sixteen points that are shaded together, as a shaft is for a cell (`shaft`), and used at once.

Beams of many rays are older than ray tracing by packets (P. Heckbert and P. Hanrahan, "Beam Tracing Polygonal Objects",
SIGGRAPH 1984).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.runtime.kernels import inlined, subkernel
from tracer.simd import (
    f32x16,
    i32_at,
    largest,
    load_three,
    local_memory,
    lowest_bit,
    mask16,
    maximum,
    minimum,
    select,
    smallest,
    square_root,
)
from tracer.visibility.error_bounds import ONE, ZERO, cross, dot
from tracer.visibility.shaft import box_outside
from tracer.visibility.tree_walk import WALK, begin_walk, walk_on

SIDES = 4  # planes around a beam; one more is along the surface
AROUND = np.float32(1e-5)  # of the way from the lamp: what the planes are moved out by for rounding
AT = np.float32(1e-6)  # of coordinates: the same
HUGE, TWO = np.float32(3e38), np.float32(2)


class Beam(NamedTuple):
    """What `put_beam` makes, a `shaft.Shaft` in float32.

    Attributes:
        planes: (SIDES + 1, 4) float32, outward normals and offsets: the beam lies where normal . x <= offset.
        box: (6,) float32, the lower and upper corner around it, lamp included.
    """

    planes: NDArray[np.float32]
    box: NDArray[np.float32]


@inlined
def make_beam():
    """Memory for a beam."""
    return Beam(np.empty((SIDES + 1, 4), np.float32), np.empty(6, np.float32))


@inlined
def _unit(a):
    """A vector of length 1, or of 0 where it has no direction."""
    size = square_root(dot(a, a))
    scale = ONE / size if size > ZERO else ZERO
    return a[0] * scale, a[1] * scale, a[2] * scale


@inlined
def _across(a):
    """A unit vector across a unit vector."""
    x, y, z = abs(a[0]), abs(a[1]), abs(a[2])
    if x <= y and x <= z:
        return _unit((ZERO, a[2], -a[1]))
    if y <= z:
        return _unit((a[2], ZERO, -a[0]))
    return _unit((a[1], -a[0], ZERO))


@inlined
def _points_of(lifted, bits, v, some):
    """Where the v-th vector's points are, those whose bits are set; the others are at `some` place."""
    x, y, z = load_three(lifted, v)
    mask = mask16(np.int64(bits[v]))
    return select(mask, x, some[0]), select(mask, y, some[1]), select(mask, z, some[2])


@inlined
def _put_box(beam, low, high, light, radius, within):
    """Put a beam's box around points between two corners and a lamp: how far its planes must be further out for
    rounding, or -1 where the points are not all within a box (6,) of which anything is known."""
    inside, size, away = True, ZERO, ZERO
    for axis in range(3):
        inside &= low[axis] >= within[axis] and high[axis] <= within[3 + axis]
        size = max(size, max(abs(light[axis]), max(abs(low[axis]), abs(high[axis]))))
        away += max(abs(low[axis] - light[axis]), abs(high[axis] - light[axis]))
    rounded = AROUND * (away + radius) + AT * size
    for axis in range(3):
        beam.box[axis] = min(low[axis], light[axis] - radius) - rounded
        beam.box[3 + axis] = max(high[axis], light[axis] + radius) + rounded
    return rounded if inside else -ONE


@inlined
def _put_planes(beam, slopes, along, right, top, normal, floor, light, out):
    """Put a beam's planes: four that lean outwards by slopes from the way along its middle, so far out from the light,
    and one along the surface, where points are no higher than `floor` towards the light."""
    for k in range(SIDES):
        side, sign = (right if k < 2 else top), (ONE if k % 2 == 0 else -ONE)
        slope = slopes[0] if k == 0 else (slopes[1] if k == 1 else (slopes[2] if k == 2 else slopes[3]))
        scale = ONE / square_root(ONE + slope * slope)
        for axis in range(3):
            beam.planes[k, axis] = (sign * side[axis] - slope * along[axis]) * scale
        _put_offset(beam, k, light, out)
    for axis in range(3):
        beam.planes[SIDES, axis] = -normal[axis]
    _put_offset(beam, SIDES, light, floor)


@inlined
def _put_offset(beam, k, light, out):
    """Let the k-th plane be so far out from the light."""
    p = beam.planes
    p[k, 3] = p[k, 0] * light[0] + p[k, 1] * light[1] + p[k, 2] * light[2] + out


@subkernel
def put_beam(beam, points, bits, first, last, light, radius, within):
    """Put a beam around the rays from a lamp, a ball of a radius around light (3,) float32, to where those points of
    vectors first to last - 1 are lifted whose `bits` are set, at least one.

    False where nothing is known of such rays: they end outside the box within (6,) float32, or too near the lamp."""
    v = first
    while bits[v] == 0:
        v += 1
    i, lifted, up = 16 * v + lowest_bit(np.int64(bits[v])), points.lifted, points.geometric
    some = lifted[0, i], lifted[1, i], lifted[2, i]

    # Bound the points by a box.
    low = high = f32x16(some[0]), f32x16(some[1]), f32x16(some[2])
    for v in range(first, last):
        if bits[v] != 0:
            x, y, z = _points_of(lifted, bits, v, some)
            low = minimum(low[0], x), minimum(low[1], y), minimum(low[2], z)
            high = maximum(high[0], x), maximum(high[1], y), maximum(high[2], z)
    least = smallest(low[0]), smallest(low[1]), smallest(low[2])
    most = largest(high[0]), largest(high[1]), largest(high[2])
    rounded = _put_box(beam, least, most, light, radius, within)
    if rounded < ZERO:
        return False

    # Find how wide the way from the lamp to the points is, as slopes of planes that touch the ball.
    half = np.float32(0.5)
    x, y, z = half * (least[0] + most[0]), half * (least[1] + most[1]), half * (least[2] + most[2])
    along = _unit((x - light[0], y - light[1], z - light[2]))
    right = _across(along)
    top, normal = cross(along, right), (up[0, i], up[1, i], up[2, i])
    near, floor = f32x16(HUGE), f32x16(HUGE)
    slopes = f32x16(-HUGE), f32x16(-HUGE), f32x16(-HUGE), f32x16(-HUGE)
    for v in range(first, last):
        if bits[v] != 0:
            x, y, z = _points_of(lifted, bits, v, some)
            way = x - light[0], y - light[1], z - light[2]
            far, aside, above = dot(way, along), dot(way, right), dot(way, top)
            near, floor, scale = minimum(near, far), minimum(floor, dot(way, normal)), ONE / far
            slopes = (
                maximum(slopes[0], (aside - radius) * scale),
                maximum(slopes[1], (-aside - radius) * scale),
                maximum(slopes[2], (above - radius) * scale),
                maximum(slopes[3], (-above - radius) * scale),
            )
    if not smallest(near) > TWO * radius + rounded:
        return False
    widest = largest(slopes[0]), largest(slopes[1]), largest(slopes[2]), largest(slopes[3])
    lowest = max(-smallest(floor), radius) + rounded
    _put_planes(beam, widest, along, right, top, normal, lowest, light, radius + rounded)
    return True


@subkernel
def put_cone(beam, point, normal, light, radius, within):
    """Put a beam around the rays from a lamp, a ball of a radius around light (3,) float32, to one point, which is on
    a surface with this normal; all are tuples of float32.

    False where nothing is known of such rays (`put_beam`)."""
    rounded = _put_box(beam, point, point, light, radius, within)
    way = point[0] - light[0], point[1] - light[1], point[2] - light[2]
    far = square_root(dot(way, way))
    if rounded < ZERO or not far > TWO * radius + rounded:
        return False
    along, slope = (way[0] / far, way[1] / far, way[2] / far), -radius / far
    right = _across(along)
    slopes, lowest = (slope, slope, slope, slope), max(-dot(way, normal), radius) + rounded
    _put_planes(beam, slopes, along, right, cross(along, right), normal, lowest, light, radius + rounded)
    return True


@subkernel
def primitives_met(o, number, beam, most, room, counts):
    """Find the primitives that may come between light `number` and the points of a beam, `most` of them; how many, or
    -1 for more.

    o are the `Occluders`.  Their numbers, int32, go to the address `room`, with room for eight more."""
    walk = begin_walk(local_memory(WALK))
    count = walk_on(walk, o, number, beam, i32_at(room), np.int64(0), most + 1, counts)
    return np.int64(-1) if count > most else count


@inlined
def passes_by(beam, box):
    """Whether a beam misses a box (6,) float32, made larger by more than roundings, which is empty where its lower
    corner is far above the upper one."""
    b = beam.box
    rx, ry, rz = (
        AROUND * (abs(box[0]) + abs(box[3]) + abs(b[0]) + abs(b[3])),
        AROUND * (abs(box[1]) + abs(box[4]) + abs(b[1]) + abs(b[4])),
        AROUND * (abs(box[2]) + abs(box[5]) + abs(b[2]) + abs(b[5])),
    )
    low, high = (box[0] - rx, box[1] - ry, box[2] - rz), (box[3] + rx, box[4] + ry, box[5] + rz)
    return box_outside(beam, low, high)
