"""Which primitives lie in each voxel?

A triangle lies in those from which neither its plane nor the sides of a box and edges part it (separating axes), as far
from it as a hit on it may be reported.  A primitive of which float32 tells less, a quadric or a triangle that a light
lies in the plane of, lies in all voxels that the box outside of which no hit is reported meets.
"""

from __future__ import annotations

import numpy as np

from tracer.geometry.memory import without_refcount
from tracer.neighbours.voxels.grid import ROOM
from tracer.runtime.kernels import inlined, kernel, subkernel
from tracer.visibility.error_bounds import BOX, cross, dot, row_of


@inlined
def _range(low, high, start, per_unit, count):
    """First and last voxel along an axis that a range meets, in the grid."""
    first, last = np.floor((low - start) * per_unit - ROOM), np.floor((high - start) * per_unit + ROOM)
    return np.int64(min(max(first, 0.0), count)), np.int64(min(max(last, -1.0), count - 1))


@inlined
def _parts(axis, a, b, c, half, room):
    """Whether the projections of a triangle, with a box's centre at the origin, and of the box to an axis are apart."""
    pa, pb, pc = dot(axis, a), dot(axis, b), dot(axis, c)
    reach = half * (abs(axis[0]) + abs(axis[1]) + abs(axis[2])) + room * dot(axis, axis) ** 0.5
    return min(pa, min(pb, pc)) > reach or max(pa, max(pb, pc)) < -reach


@subkernel
def _apart(a, b, c, half, room):
    """Whether a triangle is further than `room` from the cube around the origin with half sides `half`."""
    e1, e2, e3 = (
        (b[0] - a[0], b[1] - a[1], b[2] - a[2]),
        (c[0] - b[0], c[1] - b[1], c[2] - b[2]),
        (a[0] - c[0], a[1] - c[1], a[2] - c[2]),
    )
    if _parts(cross(e1, e2), a, b, c, half, room):
        return True
    for k in range(3):
        e = e1 if k == 0 else (e2 if k == 1 else e3)
        if _parts((0.0, -e[2], e[1]), a, b, c, half, room):
            return True
        if _parts((e[2], 0.0, -e[0]), a, b, c, half, room):
            return True
        if _parts((-e[1], e[0], 0.0), a, b, c, half, room):
            return True
    return False


@kernel
def list_contents(rows, reach, more, grid, starts, names):
    """Count the primitives of each voxel into starts[1:] where `names` is empty; else put their numbers into names (m,)
    int32, those of voxel v from starts[v + 1] on, which ends up as where they end.

    rows (n, ROW) float32; reach (n,) float32, how far from each a hit may be reported: negative for those of which none
    is, and inf for those of which only the box (6,) at BOX tells that, `more` units of the scene larger."""
    rows, counts = without_refcount(rows), len(names) == 0
    side = 1.0 / grid.per_unit
    half = 0.5 * side
    for i in range(len(rows)):
        if reach[i] < 0.0:
            continue
        loose, room = reach[i] == np.inf, ROOM * side + reach[i]
        a, e1, e2 = row_of(rows, i)
        b, c = (a[0] + e1[0], a[1] + e1[1], a[2] + e1[2]), (a[0] + e2[0], a[1] + e2[1], a[2] + e2[2])
        low = min(a[0], min(b[0], c[0])), min(a[1], min(b[1], c[1])), min(a[2], min(b[2], c[2]))
        high = max(a[0], max(b[0], c[0])), max(a[1], max(b[1], c[1])), max(a[2], max(b[2], c[2]))
        if loose:
            low = np.float64(rows[i, BOX]), np.float64(rows[i, BOX + 1]), np.float64(rows[i, BOX + 2])
            high = np.float64(rows[i, BOX + 3]), np.float64(rows[i, BOX + 4]), np.float64(rows[i, BOX + 5])
            room = ROOM * side + more
        x0, x1 = _range(low[0] - room, high[0] + room, grid.x, grid.per_unit, grid.nx)
        y0, y1 = _range(low[1] - room, high[1] + room, grid.y, grid.per_unit, grid.ny)
        z0, z1 = _range(low[2] - room, high[2] + room, grid.z, grid.per_unit, grid.nz)
        one = x0 == x1 and y0 == y1 and z0 == z1
        for x in range(x0, x1 + 1):
            for y in range(y0, y1 + 1):
                for z in range(z0, z1 + 1):
                    if not one and not loose:
                        mx, my, mz = grid.x + (x + 0.5) * side, grid.y + (y + 0.5) * side, grid.z + (z + 0.5) * side
                        at, bt = (a[0] - mx, a[1] - my, a[2] - mz), (b[0] - mx, b[1] - my, b[2] - mz)
                        if _apart(at, bt, (c[0] - mx, c[1] - my, c[2] - mz), half, room):
                            continue
                    v = (x * grid.ny + y) * grid.nz + z + 1
                    if not counts:
                        names[starts[v]] = i
                    starts[v] += 1
