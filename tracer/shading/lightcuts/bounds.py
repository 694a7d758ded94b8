"""What a cluster of lights can send to points, at most: sixteen points at a time.

The light of a cluster at a point lies between 0, where nothing of it is visible, and the sum of its colours times the
greatest that its geometry allows: the least distance from the point to the cluster's box, the greatest cosine of any of
its lights with the normal, and with the direction in which the viewer is mirrored (Phong's highlight).  What one
representative says of it lies there too, so that it is wrong by no more than that.  Bounds are computed in float32 and
enlarged by more than that may be wrong by.
"""

from __future__ import annotations

import numpy as np

from tracer.runtime.kernels import inlined
from tracer.shading.lightcuts.block import point_row
from tracer.shading.points import DIFFUSE_ROW, EXPONENT_ROW, SHINE_ROW, SPECULAR_ROW
from tracer.simd import any_lane, f32x16, load_three, maximum, minimum, power, select, size_of, square_root

ZERO, ONE, HALF = np.float32(0), np.float32(1), np.float32(0.5)
TINY = np.float32(1e-24)  # squares of distances are taken to be no less
ROUNDED = np.float32(2e-6)  # of coordinates, by which a height above a surface may be wrong
ENLARGED = np.float32(1.0001)


@inlined
def mirrored_direction(normal, direction):
    """Where the viewer's rays of this direction go on to from mirrors of this normal."""
    s = np.float32(-2) * (normal[0] * direction[0] + normal[1] * direction[1] + normal[2] * direction[2])
    return direction[0] + s * normal[0], direction[1] + s * normal[1], direction[2] + s * normal[2]


@inlined
def _highest(axis, away, half, room):
    """How far along an axis the lights of a box lie, at most; its middle is `away`, and `half` its half sides."""
    nx, ny, nz = axis
    return (
        nx * away[0] + ny * away[1] + nz * away[2]
        + maximum(nx, -nx) * half[0] + maximum(ny, -ny) * half[1] + maximum(nz, -nz) * half[2]
        + room
    )  # fmt: skip


@inlined
def _beyond(away, half):
    """How far away the nearest side of an interval is, 0 from inside."""
    return maximum(maximum(away, -away) - half, ZERO)


@inlined
def greatest_terms(points, mirror, box, falls, v):
    """The greatest diffuse and specular term of any light of a box (6,) at a vector of points, each without a colour,
    and the square of the least distance.

    mirror are the directions in which the viewer is mirrored there."""
    half = HALF * (box[3] - box[0]), HALF * (box[4] - box[1]), HALF * (box[5] - box[2])
    middle = HALF * (box[0] + box[3]), HALF * (box[1] + box[4]), HALF * (box[2] + box[5])
    px, py, pz = load_three(points.position, v)
    away = middle[0] - px, middle[1] - py, middle[2] - pz
    bx, by, bz = _beyond(away[0], half[0]), _beyond(away[1], half[1]), _beyond(away[2], half[2])
    near = maximum(bx * bx + by * by + bz * bz, TINY)
    inverse = ONE / square_root(near)
    room = ROUNDED * (size_of((px, py, pz)) + size_of(away))
    high = _highest(load_three(points.normal, v), away, half, room)
    facing = _highest(load_three(points.geometric, v), away, half, room) > ZERO
    cosine = select(facing, minimum(maximum(high, ZERO) * inverse, ONE), ZERO)
    shine, specular = point_row(points, SHINE_ROW, v), f32x16(ZERO)
    shines = (shine > ZERO) & (cosine > ZERO)
    if any_lane(shines):
        along = minimum(maximum(_highest(mirror, away, half, room), ZERO) * inverse, ONE)
        specular = select(shines, power(along, point_row(points, EXPONENT_ROW, v)), ZERO)
    if falls:
        return cosine * (inverse * inverse), specular * (inverse * inverse), near
    return cosine, specular, near


@inlined
def colored(points, color, diffuse, specular, v):
    """The sum over the channels of what light of a colour (3,) becomes by these terms at a vector of points."""
    total = f32x16(ZERO)
    for c in range(3):
        local = point_row(points, DIFFUSE_ROW + c, v) * diffuse + point_row(points, SPECULAR_ROW + c, v) * specular
        total = total + color[c] * local
    return total


@inlined
def greatest_light(points, mirror, box, color, falls, v):
    """The most that a cluster can send to a vector of points: a bound of what its representative may be wrong by."""
    diffuse, specular, _ = greatest_terms(points, mirror, box, falls, v)
    return ENLARGED * colored(points, color, diffuse, specular, v)
