"""Certify the cells that rays requested, and their parts: round by round, each round in parallel.

A task is a cell and the requests in it.  Running it finds certificates for all lights that have none there, and sorts
the requests by the part of the cell that they lie in.  Nothing is written that others read.  `commit` then takes
results over in the order of the tasks, so that cells get the same numbers whoever ran what, and says which parts are
the tasks of the next round.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.geometry.memory import without_refcount
from tracer.neighbours.certified.cell_prism import put_cell
from tracer.neighbours.certified.cells import (
    CANDIDATES,
    CONTENT,
    FINAL,
    LEAF,
    NOBODY,
    OVERFLOW,
    SETTLED,
    TOO_MANY,
    UNTRIED,
    add_cell,
    set_below,
    set_state,
    state_of,
)
from tracer.neighbours.certified.certify import MOST, certify
from tracer.neighbours.certified.gather_requests import facing_lights
from tracer.neighbours.certified.quadtree import part_of, place_of_part
from tracer.runtime.kernels import inlined, kernel, subkernel
from tracer.simd import i64_at, local_memory
from tracer.visibility.error_bounds import dot, row_of
from tracer.visibility.shaft import put_light

DEEPEST = 2.0**-12  # of a triangle's edges: no cell is smaller
SMALLEST = 8.0  # times how far above a surface rays may end: shorter cells would be mostly error
KEPT = 0xFF  # instead of a result: the light has its certificate, or needs none


class Tasks(NamedTuple):
    """n tasks and their results.

    Attributes:
        cell: (n,) int32.
        first, last: (n,) int32, the requests in the cell are those from first to last - 1.
        state: (n, lights) uint8, results; KEPT where there is none.
        amount: (n, lights) uint8, how many primitives each names, as in `Cells.names`.
        doubt: (n,) bool, whether a part of the cell may tell more for some light.
        names: (n, lights, MOST) int32, the primitives.
        parts: (n, 5) int32, where the requests of each part begin and the last end; all 0 where parts are not tasks.
    """

    cell: NDArray[np.int32]
    first: NDArray[np.int32]
    last: NDArray[np.int32]
    state: NDArray[np.uint8]
    amount: NDArray[np.uint8]
    doubt: NDArray[np.bool_]
    names: NDArray[np.int32]
    parts: NDArray[np.int32]


def make_tasks(n: int, lights: int) -> Tasks:
    """Memory for n tasks."""
    return Tasks(
        np.empty(n, np.int32),
        np.empty(n, np.int32),
        np.empty(n, np.int32),
        np.empty((n, lights), np.uint8),
        np.empty((n, lights), np.uint8),
        np.empty(n, np.bool_),
        np.empty((n, lights, MOST), np.int32),
        np.empty((n, 5), np.int32),
    )


def tasks_in(room: Tasks, todo: NDArray[np.int32]) -> Tasks:
    """Tasks for todo (n, 3) int32, cell, first and last request, in the memory for more."""
    tasks = Tasks._make(a[: len(todo)] for a in room)
    tasks.cell[:], tasks.first[:], tasks.last[:] = todo.T
    return tasks


@inlined
def _part(cells, cell, u, v):
    """Which of a cell's four parts a point of its triangle lies in."""
    size = cells.place[cell, 2]
    part, _u, _v = part_of((u - cells.place[cell, 0]) / size, (v - cells.place[cell, 1]) / size)
    return part


@subkernel
def _sort_points(cells, cell, points, first, last, parts):
    """Sort requests first to last - 1 by the parts of a cell, in place; where they begin, into parts (5,)."""
    following = i64_at(local_memory(32))  # where the next request of each part goes
    for k in range(5):
        parts[k] = 0
    for i in range(first, last):
        points.spare[0, i], points.spare[1, i] = points.u[i], points.v[i]
        parts[1 + _part(cells, cell, points.u[i], points.v[i])] += 1
    parts[0] = first
    for k in range(4):
        following[k] = parts[k]
        parts[k + 1] += parts[k]
    for i in range(first, last):
        u, v = points.spare[0, i], points.spare[1, i]
        k = _part(cells, cell, u, v)
        points.u[following[k]], points.v[following[k]] = u, v
        following[k] += 1


@inlined
def _can_split(cells, o, cell, scale):
    """Whether a leaf may be divided: its parts are not too small."""
    size = abs(np.float64(cells.place[cell, 2])) * 0.5
    if size < DEEPEST:
        return False
    _a, e1, e2 = row_of(o.rows, cells.owner[cell] >> 1)
    shortest = min(dot(e1, e1), dot(e2, e2)) * size * size
    return shortest > (SMALLEST * scale.max_height) ** 2


@subkernel
def put_cell_of(cells, o, cell, scale, s):
    """Put the worker's shaft to a cell; False where that cannot be certified."""
    owner, place = np.int64(cells.owner[cell]), cells.place[cell]
    u, v, size = np.float64(place[0]), np.float64(place[1]), np.float64(place[2])
    return put_cell(s.shaft, o.rows, owner >> 1, 1.0 - 2.0 * (owner & 1), u, v, size, scale)


@subkernel
def _certify(cells, o, place, light, cell, few, s, counts):
    """Certify the cell that the worker's shaft was put to for a light at a place: (state, how many it names)."""
    if not put_light(s.shaft, place, 0.0):
        return np.int64(CANDIDATES), np.int64(TOO_MANY)

    # Start from the candidates of the cell that this one is a part of, where they are known.
    parent, given, count = np.int64(cells.parent[cell]), cells.names[:0], np.int64(TOO_MANY)
    if parent != 0 and state_of(cells.words[parent], light) == CANDIDATES:
        start = np.int64(cells.lists[parent, light])
        if start != OVERFLOW:
            count = np.int64(cells.names[start]) & (SETTLED - 1)
            given = cells.names[start + 1 : start + 1 + count]
    return certify(s, o, light, place, given, count, few, counts)


@subkernel
def _run_task(cells, o, lights, stationary, scale, task, tasks, points, patience, few, most, s, counts):
    """Run one task, as `run_tasks` says."""
    cell = np.int64(tasks.cell[task])
    first, last = tasks.first[task], tasks.last[task]
    owner, word = np.int64(cells.owner[cell]), cells.words[cell]
    facing = facing_lights(o, lights, stationary, owner)
    put, placed, doubt, made = False, True, False, 0
    for light in range(len(lights)):
        tasks.state[task, light] = KEPT
        if not (facing >> np.uint64(2 * light)) & np.uint64(1):
            continue
        state = np.int64(state_of(word, light))
        if state != UNTRIED:
            doubt |= state == CANDIDATES and not _is_settled(cells, cell, light)
            continue
        if made == most:
            continue

        # Certify the cell for this light.
        made += 1
        if not put:
            put, placed = True, put_cell_of(cells, o, cell, scale, s)
        state, amount = np.int64(CANDIDATES), np.int64(TOO_MANY)
        if placed:
            place = np.float64(lights[light, 0]), np.float64(lights[light, 1]), np.float64(lights[light, 2])
            state, amount = _certify(cells, o, place, light, cell, few, s, counts)
        tasks.state[task, light], tasks.amount[task, light] = state, amount
        if amount != TOO_MANY:
            for k in range(amount & (SETTLED - 1)):
                tasks.names[task, light, k] = s.found[k]
        doubt |= state == CANDIDATES and (amount & SETTLED == 0 or amount == TOO_MANY)

    # Let the parts be looked into where they may tell more: those that there are, or new ones.
    tasks.parts[task, :] = 0
    tasks.doubt[task] = doubt
    if doubt and placed:
        leaf = cells.child[cell] == LEAF or cells.child[cell] == CONTENT
        if cells.child[cell] >= 0 or (
            leaf
            and cells.requests[cell] + last - first >= patience
            and _can_split(cells, o, cell, scale)
            and (put or put_cell_of(cells, o, cell, scale, s))
        ):
            _sort_points(cells, cell, points, first, last, tasks.parts[task])


@inlined
def _is_settled(cells, cell, light):
    """Whether rays will test a cell's candidates for a light, so that it need not be divided for it."""
    length = cells.names[cells.lists[cell, light]]
    return length & SETTLED != 0 and length != TOO_MANY


@kernel
def run_tasks(cells, o, lights, stationary, scale, first, last, tasks, points, patience, few, most, s, counts):
    """Run tasks first to last - 1: find certificates, and sort requests into parts.

    cells are `Cells`, o the `Occluders`, scale the `SceneScale`, points the `RequestPoints`, s a worker's `Scratch`.
    Certificates are for those of lights (n, 3) float32 that are `stationary` (n,) bool, `most` at a time.  A leaf is
    divided once `patience` points have requested it, but not for a light with no more than `few` candidates, which rays
    will test.  counts (COUNTERS,) int64 are added to."""
    cells, o, tasks, points, s = without_refcount((cells, o, tasks, points, s))
    for task in range(first, last):
        _run_task(cells, o, lights, stationary, scale, task, tasks, points, patience, few, most, s, counts)


@subkernel
def _divide(cells, cell, stack):
    """Make the four parts of a leaf, which take over what is certified of it; the number of the first."""
    owner = cells.owner[cell]
    child = cells.used[0]
    for part in range(4):
        u, v, size = place_of_part(cells.place[cell, 0], cells.place[cell, 1], cells.place[cell, 2], part)
        add_cell(cells, cell, owner, u, v, size)
    cells.child[cell] = child
    for light in range(cells.lists.shape[1]):
        if state_of(cells.words[cell], light) != CANDIDATES or _is_settled(cells, cell, light):
            set_below(cells, cell, light, stack)
    return child


@inlined
def _put_list(cells, cell, light, amount, names):
    """Let a cell's certificate for a light name the first of these."""
    if amount == TOO_MANY or amount == 0:
        cells.lists[cell, light] = OVERFLOW if amount == TOO_MANY else NOBODY
        return
    at, count = cells.named[0], np.int64(amount) & (SETTLED - 1)
    cells.lists[cell, light] = at
    cells.names[at] = amount
    for k in range(count):
        cells.names[at + 1 + k] = names[k]
    cells.named[0] = at + 1 + count


@kernel
def commit(cells, o, scale, tasks, following):
    """Take over the results of tasks, in their order; how many tasks follow from them.

    Those go into following (at least 4 per task, 3) int32: cell, first and last request.  cells need room for four new
    ones for each task, and for all names."""
    stack = np.empty(256, np.int64)
    more = 0
    for task in range(len(tasks.cell)):
        cell = np.int64(tasks.cell[task])

        # Take certificates over, unless a task of a whole that this cell is part of was first.
        for light in range(tasks.state.shape[1]):
            state = tasks.state[task, light]
            if state == KEPT or state_of(cells.words[cell], light) != UNTRIED:
                continue
            set_state(cells, cell, light, state)
            _put_list(cells, cell, light, tasks.amount[task, light], tasks.names[task, light])
            if cells.child[cell] >= 0 and (state != CANDIDATES or _is_settled(cells, cell, light)):
                set_below(cells, cell, light, stack)

        # Leave a cell alone whose parts are not looked into.
        parts = tasks.parts[task]
        if parts[4] == 0:
            if cells.child[cell] == LEAF or cells.child[cell] == CONTENT:
                cells.requests[cell] += tasks.last[task] - tasks.first[task]
                cells.child[cell] = LEAF if tasks.doubt[task] else CONTENT
                if not _can_split(cells, o, cell, scale):
                    cells.child[cell] = FINAL
            continue

        # Let its parts be tasks, where they have requests.
        child = np.int64(cells.child[cell])
        if child < 0:
            child = _divide(cells, cell, stack)
        for k in range(4):
            if parts[k + 1] > parts[k]:
                following[more, 0], following[more, 1], following[more, 2] = child + k, parts[k], parts[k + 1]
                more += 1
    return more
