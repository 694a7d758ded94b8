"""Invalidate certificates that an object's motion makes untrue, and drop the cells that are used least.

When an object starts to move, certificates that name one of its primitives go.  When it comes to rest, those that said
that nothing comes between, or only these candidates, go where it may come between now.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tracer.culling.modes import FULLY_RENDERED
from tracer.geometry.memory import without_refcount
from tracer.neighbours.certified.cells import (
    CANDIDATES,
    FULL,
    LIT,
    NOBODY,
    OVERFLOW,
    ROOTS,
    SETTLED,
    UNTRIED,
    set_state,
    state_of,
)
from tracer.neighbours.certified.tasks import put_cell_of
from tracer.runtime.kernels import inlined, kernel, subkernel
from tracer.visibility.shaft import box_outside, put_light


@inlined
def _names_one(cells, cell, light, gone):
    """Whether a certificate names one of the primitives that are gone (p,) bool."""
    at, found = np.int64(cells.lists[cell, light]), False
    for k in range(at + 1, at + 1 + (cells.names[at] & (SETTLED - 1) if at != OVERFLOW else 0)):
        found |= gone[cells.names[k]]
    return found


@subkernel
def _meets_any(s, boxes, light):
    """Whether a box (k, 6) may meet the shaft from a light (3,) to the cell that s.shaft was put to."""
    if not put_light(s.shaft, (np.float64(light[0]), np.float64(light[1]), np.float64(light[2])), 0.0):
        return True
    met = False
    for k in range(len(boxes)):
        b = boxes[k]
        met |= not box_outside(s.shaft, (b[0], b[1], b[2]), (b[3], b[4], b[5]))
    return met


@kernel
def invalidate_certificates(cells, o, lights, scale, gone, boxes, near, s):
    """Drop the certificates that name primitives which are gone, and those that boxes may come between from now on.

    gone (primitives,) bool; boxes (lights, k, 6), inverted for none; lights (n, 3) are positions; scale is the
    `SceneScale`, o the `Occluders`, s a worker's `Scratch`.  near (primitives,) are words like modes, without the bits
    of those lights from which something in a box may come before a primitive.  A cell that took its certificate over
    from another loses it with that one."""
    cells, o, s = without_refcount((cells, o, s))
    dropped = np.zeros(cells.used[0], np.uint64)
    for cell in range(1, cells.used[0]):
        word, owner, parent = cells.words[cell], np.int64(cells.owner[cell]), np.int64(cells.parent[cell])
        placed, tried = False, False
        for light in range(len(lights)):
            state = state_of(word, light)
            if state == UNTRIED or (state == CANDIDATES and cells.lists[cell, light] == OVERFLOW):
                continue
            bit = np.uint64(1) << np.uint64(light)

            # Drop what names a primitive that is gone, or was taken over from a cell that lost it.
            drop = _names_one(cells, cell, light, gone)
            if state == FULL and cells.lists[cell, light] == NOBODY:
                drop = dropped[parent] & bit != 0

            # Drop what something new may come between.
            if not drop and state != FULL and state_of(near[owner >> 1], light) == UNTRIED:
                if not tried:
                    placed, tried = put_cell_of(cells, o, cell, scale, s), True
                drop = not placed or _meets_any(s, boxes[light], lights[light])
            if drop:
                set_state(cells, cell, light, UNTRIED)
                cells.lists[cell, light] = NOBODY
                dropped[cell] |= bit


@kernel
def copy_kept(cells, kept, target):
    """Copy the cells of those owners that are `kept` (owners,) bool to a target with room, and lead rays there."""
    cells, target = without_refcount((cells, target))
    place, moved = np.zeros(cells.used[0], np.int32), np.zeros(cells.named[0], np.int32)
    roots = cells.receivers.view(np.int32)
    for cell in range(1, cells.used[0]):
        owner = cells.owner[cell]
        if not kept[owner]:
            continue
        to = target.used[0]
        target.used[0] = to + 1
        place[cell] = to
        target.words[to], target.child[to] = cells.words[cell], cells.child[cell]
        target.parent[to], target.owner[to] = place[cells.parent[cell]], owner
        target.requests[to] = cells.requests[cell]
        for k in range(3):
            target.place[to, k] = cells.place[cell, k]
        for light in range(cells.lists.shape[1]):
            start = np.int64(cells.lists[cell, light])
            target.lists[to, light] = start
            if start in (OVERFLOW, NOBODY):
                continue
            if moved[start] == 0:  # several cells may share a list
                at, length = target.named[0], 1 + (cells.names[start] & (SETTLED - 1))
                for k in range(length):
                    target.names[at + k] = cells.names[start + k]
                target.named[0] = at + length
                moved[start] = at
            target.lists[to, light] = moved[start]

    # Renumber children and roots.
    for cell in range(1, target.used[0]):
        if target.child[cell] >= 0:
            target.child[cell] = place[target.child[cell]]
    for owner in range(len(kept)):
        root = roots[owner >> 1, ROOTS + (owner & 1)]
        roots[owner >> 1, ROOTS + (owner & 1)] = place[root] if root < len(place) else 0
        target.rooted[owner >> 1] = 0
    for owner in range(len(kept)):
        if roots[owner >> 1, ROOTS + (owner & 1)] != 0:
            target.rooted[owner >> 1] = 1


def all_marked(primitives: int, word: type[np.unsignedinteger]) -> NDArray[np.unsignedinteger]:
    """A word for each primitive that marks every light as LIT, to be cleared where something may darken it."""
    return np.full(primitives, (~word(0) // word(3)) * word(LIT) & ~word(3) | word(FULLY_RENDERED), word)
