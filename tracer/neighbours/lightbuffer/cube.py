"""The cube around a light: six faces of cells, by direction.

Face 2 k looks up along axis k, face 2 k + 1 down.  A direction belongs to the face of its largest component, its
*depth* z, and lies there at (x / z, y / z), which are the other two components in their order: between -1 and 1.

A face is divided as `divide` says.  Its *items* are the primitives that a ray through the face may hit, with a row of
ITEM numbers and one of SPAN numbers each.  What is then kept are cells and their records.
"""

from __future__ import annotations

import numpy as np

from tracer.runtime.kernels import inlined
from tracer.simd import maximum, minimum, select, to_i32

FACES = 6
HUGE = 1e30
HALF, ZERO = np.float32(0.5), np.float32(0)
SEAM = 1e-6  # by so much a cell reaches over its edge: more than the roundings that may send a direction next door

# Columns of an item: coefficients, of (x, y, 1) on the face, of U, V and D - U - V (`tracer.visibility.error_bounds`),
# which are greater than minus the bound at the end wherever a ray may hit; of the *near* function, which times the
# depth of a point is at least 1 wherever the item may block it; their error bounds; and what makes of it the *far*
# function, which times the depth is more than 1 only where the item surely does: times KEEP, less LESS.
U, V, W, NEAR, OF_U, OF_V, KEEP, LESS = 0, 3, 6, 9, 12, 13, 14, 15
ITEM = 16
# Columns of a span: least and greatest x and y of hits; the inverse of their least depth; 1 for what may cover a cell
# for certain, else 0; and the number of the item's row.
LOW_X, HIGH_X, LOW_Y, HIGH_Y, NEAREST, COVERS, NUMBER = range(7)
SPAN = 8

# Columns of what is known of a cell.  Two planes, each three numbers: their products with the way from the light to a
# point say that nothing is in between where the first is less than 1, and that something is where the second is more
# than 1.  Then the first of its candidates in the lists, and how many there are, int32; where rays are not tested
# against any, there are 0, and the first number is that of the row of what covers the cell, -1 for nothing.
LIT, BLOCKED, FIRST, COUNT = 0, 3, 6, 7
RECORD = 8
WIDTH_BITS = 5  # of a cell's number: the logarithm of how many cells its region is wide; the rest names its record
NOTHING = 0  # the record of cells in which nothing is: the first of every cube
NEVER = np.float32(1e30)  # instead of a coefficient of a plane: no point is before it


@inlined
def axes_of(face):
    """The axes of x, y and z on a face, and the sign of the last."""
    axis = face >> 1
    return (1 if axis == 0 else 0), (1 if axis == 2 else 2), axis, (-1.0 if face & 1 else 1.0)


@inlined
def widened(low, high, least, most, near, far):
    """The range of x / z, joined by that of x between least and most where z is between near > 0 and far."""
    return min(low, least / (far if least > 0.0 else near)), max(high, most / (near if most > 0.0 else far))


@inlined
def box_on_face(box, light, room, axes):
    """Where a box (6,), `room` larger on all sides, lies on a face around light (3,): (left, right, low, high),
    all of it for one that reaches behind the light, and from what depth on to which."""
    ax, ay, az, sign = axes
    z0, z1 = box[az] - light[az] - room, box[3 + az] - light[az] + room
    if sign < 0.0:
        z0, z1 = -z1, -z0
    if not z0 > 0.0:
        return -HUGE, HUGE, -HUGE, HUGE, z0, z1
    left, right = widened(HUGE, -HUGE, box[ax] - light[ax] - room, box[3 + ax] - light[ax] + room, z0, z1)
    low, high = widened(HUGE, -HUGE, box[ay] - light[ay] - room, box[3 + ay] - light[ay] + room, z0, z1)
    return left, right, low, high, z0, z1


@inlined
def cells_of(direction, side):
    """(depth, face, column, row) of sixteen directions, the last three int32; `side` cells are a face's edge.

    Where a direction is no number, or nothing, they are any that there are."""
    dx, dy, dz = direction
    ax, ay, az = maximum(dx, -dx), maximum(dy, -dy), maximum(dz, -dz)
    along_x = (ax >= ay) & (ax >= az)
    along_z = ~along_x & (az > ay)
    depth = maximum(maximum(ax, ay), az)
    major = select(along_x, dx, select(along_z, dz, dy))
    face = select(along_x, np.int32(0), select(along_z, np.int32(4), np.int32(2)))
    face = face + select(major < ZERO, np.int32(1), np.int32(0))
    half = HALF * np.float32(side)
    scale = half / depth
    most = np.float32(side) - HALF
    column = minimum(maximum(select(along_x, dy, dx) * scale + half, ZERO), most)
    row = minimum(maximum(select(along_z, dy, dz) * scale + half, ZERO), most)
    return depth, face, to_i32(column), to_i32(row)
