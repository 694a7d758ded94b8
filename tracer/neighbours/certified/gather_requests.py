"""Gather requests into tasks: sorted by the cells to begin with.

A request names the cell that its ray ended in.  Where the cell that this is a part of waits for the same light, that
larger one is the task: one certificate may answer for all its parts.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.geometry.memory import without_refcount
from tracer.neighbours.certified.cells import NORMAL, ROOTS, add_cell
from tracer.runtime.kernels import inlined, kernel, subkernel
from tracer.visibility.error_bounds import cross, dot, row_of


class RequestPoints(NamedTuple):
    """The requests (n,) of tasks, cell by cell.

    Attributes:
        u, v: (n,) float32, coordinates in the triangle.
        spare: (2, n) float32, memory to sort them in.
    """

    u: NDArray[np.float32]
    v: NDArray[np.float32]
    spare: NDArray[np.float32]


@inlined
def _has_cells(row):
    """Whether a receiver's row is that of a triangle with cells."""
    return row[NORMAL] != 0 or row[NORMAL + 1] != 0 or row[NORMAL + 2] != 0


@inlined
def facing_lights(o, lights, stationary, owner):
    """Bits, two apart, of `stationary` (n,) lights (n, 3) that an owner's side of its triangle faces."""
    a, e1, e2 = row_of(o.rows, owner >> 1)
    up, side, bits = cross(e1, e2), 1.0 - 2.0 * (owner & 1), np.uint64(0)
    for light in range(len(lights)):
        x, y, z = np.float64(lights[light, 0]), np.float64(lights[light, 1]), np.float64(lights[light, 2])
        if stationary[light] and side * dot(up, (x - a[0], y - a[1], z - a[2])) > 0.0:
            bits |= np.uint64(1) << np.uint64(2 * light)
    return bits


@inlined
def _untried(word, bits):
    """Those of the bits, two apart, whose lights have no certificate in a word."""
    states = np.uint64(word) >> np.uint64(2)
    return bits & ~(states | states >> np.uint64(1))


@subkernel
def _first_untried(cells, o, lights, stationary, cell):
    """The cell to begin with, where one was requested.

    That is the largest which it is a part of and which waits for a light that its part waits for."""
    waiting = _untried(cells.words[cell], facing_lights(o, lights, stationary, np.int64(cells.owner[cell])))
    parent = np.int64(cells.parent[cell])
    while parent != 0 and _untried(cells.words[parent], waiting) != 0:
        cell, parent = parent, np.int64(cells.parent[parent])
    return cell


@subkernel
def _root_of(cells, owner, more, patience):
    """The root of an owner, made once `patience` points have requested it, `more` of them now; 0 for none."""
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
    """Where a key's group is noted: cells first, then owners."""
    return key if key >= 0 else rooms - 1 - key


@inlined
def _group(slots, at, keys, groups, key):
    """Put a key into its group, a new one where there is none: (how many groups there are, which this is)."""
    group = np.int64(slots[at]) - 1
    if group < 0:
        group = groups
        keys[group], groups = key, groups + 1
        slots[at] = groups
    return groups, group


@kernel
def gather_tasks(cells, o, lights, stationary, key, u, v, patience, slots, points):
    """Gather requests into tasks (k, 3) int32, cell, first and last request, and sort these into points.

    key (n,) int32 are the cells that requests lie in, or -1 - owner where there is none yet; u and v (n,) float32 their
    coordinates; points the `RequestPoints` for n.  Roots that `patience` points have requested, this time or before,
    are made; there must be room.  slots (room for cells and owners,) int32 are 0, and are again afterwards."""
    cells, o, points = without_refcount((cells, o, points))
    n, rooms, groups = len(key), len(cells.words), np.int64(0)
    # Group requests by their key.
    of, keys, size = np.empty(n, np.int32), np.empty(2 * n, np.int32), np.zeros(2 * n, np.int32)
    for i in range(n):
        groups, of[i] = _group(slots, _slot(np.int64(key[i]), rooms), keys, groups, key[i])
        size[of[i]] += 1

    # Find the cell that each group begins with, 0 for none.
    first = np.zeros(groups, np.int64)
    for g in range(groups):  # before roots are made: a cell whose owner has none is of what has moved since
        if keys[g] > 0 and cells.rooted[cells.owner[keys[g]] >> 1] != 0:
            first[g] = _first_untried(cells, o, lights, stationary, np.int64(keys[g]))
    for g in range(len(first)):
        if keys[g] < 0:
            first[g] = _root_of(cells, -1 - np.int64(keys[g]), size[g], patience)

    # Merge the groups that begin with the same cell.
    into = np.empty(len(first), np.int64)
    for g in range(len(first)):
        groups, into[g] = _group(slots, first[g], keys, groups, np.int32(first[g]))
    starts = np.zeros(groups + 1, np.int32)
    for g in range(len(first)):
        starts[into[g] + 1] += size[g]

    # Make a task of each.
    tasks, count = np.empty((groups, 3), np.int32), 0
    for g in range(groups):
        slots[_slot(np.int64(keys[g]), rooms)] = 0
        starts[g + 1] += starts[g]
        if keys[g] > 0 and starts[g + 1] > starts[g]:
            tasks[count, 0], tasks[count, 1], tasks[count, 2] = keys[g], starts[g], starts[g + 1]
            count += 1

    # Sort the requests by task.
    for i in range(n):
        g = into[of[i]]
        points.u[starts[g]], points.v[starts[g]] = u[i], v[i]
        starts[g] += 1
    return tasks[:count]
