"""From requests to tasks: points sorted by the cells to begin with."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.culling.certified.cells import NORMAL, ROOTS, add_cell
from tracer.culling.certified.error_bounds import cross, dot, row_of
from tracer.geometry.memory import borrowed
from tracer.kernels import inlined, kernel, subkernel


class RequestPoints(NamedTuple):
    """Points (n,) that request more, cell by cell: u and v float32; and room to sort them, (2, n) float32."""

    u: NDArray[np.float32]
    v: NDArray[np.float32]
    spare: NDArray[np.float32]


@inlined
def _has_cells(row):
    return row[NORMAL] != 0 or row[NORMAL + 1] != 0 or row[NORMAL + 2] != 0


@inlined
def facing_lights(o, lights, stationary, owner):
    """Bits, two apart, of the `stationary` (n,) lights on an owner's side of its triangle."""
    a, e1, e2 = row_of(o.rows, owner >> 1)
    up, side, bits = cross(e1, e2), 1.0 - 2.0 * (owner & 1), np.uint64(0)
    for light in range(len(lights)):
        x, y, z = np.float64(lights[light, 0]), np.float64(lights[light, 1]), np.float64(lights[light, 2])
        if stationary[light] and side * dot(up, (x - a[0], y - a[1], z - a[2])) > 0.0:
            bits |= np.uint64(1) << np.uint64(2 * light)
    return bits


@inlined
def _untried(word, bits):
    """Those of the bits, two apart, of lights for which a word has no certificate."""
    states = np.uint64(word) >> np.uint64(2)
    return bits & ~(states | states >> np.uint64(1))


@subkernel
def _first_untried(cells, o, lights, stationary, cell):
    """The cell to begin with where rays request more of this one: the whole that it is a part of, as long as that waits
    for a light like the part."""
    waiting = _untried(cells.words[cell], facing_lights(o, lights, stationary, np.int64(cells.owner[cell])))
    parent = np.int64(cells.parent[cell])
    while parent != 0 and _untried(cells.words[parent], waiting) != 0:
        cell, parent = parent, np.int64(cells.parent[parent])
    return cell


@subkernel
def _root_of(cells, owner, more, patience):
    """The root of an owner, which is made once so many points have requested it; 0 for none."""
    row, side = cells.receivers[owner >> 1], ROOTS + (owner & 1)
    if not _has_cells(row):  # it has begun to move since
        return np.int64(0)
    root = np.int64(row.view(np.int32)[side])
    if root == 0:
        cells.waiting[owner] += more
        if cells.waiting[owner] >= patience:
            root = np.int64(add_cell(cells, 0, owner, np.float32(0), np.float32(0), np.float32(1)))
            row.view(np.int32)[side] = root
            cells.rooted[owner >> 1] = 1
    return root


@inlined
def _slot(key, rooms):
    return key if key >= 0 else rooms - 1 - key


@inlined
def _group(slots, at, keys, groups, key):
    """How many groups there are with that of a key, and which that is."""
    group = np.int64(slots[at]) - 1
    if group < 0:
        group = groups
        keys[group], groups = key, groups + 1
        slots[at] = groups
    return groups, group


@kernel
def gather_tasks(cells, o, lights, stationary, key, u, v, patience, slots, points):
    """Sort points by the cells to begin with into points, whose arrays are as long: tasks' (cell, first, last), (n, 3)
    int32.  key (n,) int32 are the cells that they lie in, or -1 - owner where that has none yet.

    Roots that so many points have requested, this time or before, are made; there must be room.  slots (cells with
    their room and owners,) int32 are 0, and are again afterwards."""
    cells, o, points = borrowed(cells), borrowed(o), borrowed(points)
    n, rooms, groups = len(key), len(cells.words), np.int64(0)
    of, keys, size = np.empty(n, np.int32), np.empty(2 * n, np.int32), np.zeros(2 * n, np.int32)
    for i in range(n):
        groups, of[i] = _group(slots, _slot(np.int64(key[i]), rooms), keys, groups, key[i])
        size[of[i]] += 1
    first = np.zeros(groups, np.int64)  # the cell that each group begins with, 0 for none
    for g in range(groups):  # before roots are made: a cell whose owner has none is of what has moved since
        if keys[g] > 0 and cells.rooted[cells.owner[keys[g]] >> 1] != 0:
            first[g] = _first_untried(cells, o, lights, stationary, np.int64(keys[g]))
    for g in range(len(first)):
        if keys[g] < 0:
            first[g] = _root_of(cells, -1 - np.int64(keys[g]), size[g], patience)
    into = np.empty(len(first), np.int64)
    for g in range(len(first)):
        groups, into[g] = _group(slots, first[g], keys, groups, np.int32(first[g]))
    starts = np.zeros(groups + 1, np.int32)
    for g in range(len(first)):
        starts[into[g] + 1] += size[g]
    tasks, count = np.empty((groups, 3), np.int32), 0
    for g in range(groups):
        slots[_slot(np.int64(keys[g]), rooms)] = 0
        starts[g + 1] += starts[g]
        if keys[g] > 0 and starts[g + 1] > starts[g]:
            tasks[count, 0], tasks[count, 1], tasks[count, 2] = keys[g], starts[g], starts[g + 1]
            count += 1
    for i in range(n):
        g = into[of[i]]
        points.u[starts[g]], points.v[starts[g]] = u[i], v[i]
        starts[g] += 1
    return tasks[:count]
